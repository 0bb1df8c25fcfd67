// A camera that turns about a point with the horizon level; moved by mouse, fingers and keys.

const TURN = Math.PI / 36; // [rad] a key press
const MOVE = 0.05; // of the distance, a key press
const NEARER = 0.85; // of the distance, a key press
const STEEPEST = Math.PI / 2 - 0.001; // [rad]
const STILL = 6; // pixels; a pointer that moves less has clicked
const FILLED = 0.93; // of the picture by the whole
const SOUTH = -Math.PI / 2;
const VIEWS = {
  iso: [SOUTH + 0.6, 0.55],
  top: [SOUTH, STEEPEST],
  below: [SOUTH, -STEEPEST],
  front: [SOUTH, 0],
  side: [0, 0],
};

class Orbit {
  // changed(): after every move. clicked(event): where a pointer was pressed and released.
  constructor(canvas, box, changed, clicked) {
    Object.assign(this, { canvas, changed, clicked });
    this.camera = new THREE.PerspectiveCamera(40, 1);
    this.camera.up.set(0, 0, 1);
    this.box = box;
    this.centre = box.getCenter(new THREE.Vector3());
    this.radius = box.getSize(new THREE.Vector3()).length() / 2;
    this.pointers = new Map();
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => this.up(event));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  look(view) {
    [this.azimuth, this.elevation] = VIEWS[view];
    this.target = this.centre.clone();
    this.distance = this.fitting();
    this.update();
  }

  // The distance [m] from which the whole box is seen.
  fitting() {
    const tall = Math.tan((this.camera.fov * Math.PI) / 360) * FILLED;
    const [away, right] = [this.away(), new THREE.Vector3(-Math.sin(this.azimuth), Math.cos(this.azimuth), 0)];
    const up = away.clone().cross(right);
    const corner = ([x, y, z]) => new THREE.Vector3(x, y, z).sub(this.centre);
    const { min, max } = this.box;
    const corners = [min.x, max.x].flatMap((x) =>
      [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => corner([x, y, z]))),
    );
    const needed = (c) => Math.max(Math.abs(c.dot(up)), Math.abs(c.dot(right)) / this.camera.aspect) / tall;
    return Math.max(...corners.map((c) => c.dot(away) + needed(c)));
  }

  // From the target to the camera, of length 1.
  away() {
    const level = Math.cos(this.elevation);
    return new THREE.Vector3(level * Math.cos(this.azimuth), level * Math.sin(this.azimuth), Math.sin(this.elevation));
  }

  turn(sideways, upwards) {
    this.azimuth += sideways;
    this.elevation = Math.min(STEEPEST, Math.max(-STEEPEST, this.elevation + upwards));
    this.update();
  }

  // By parts of the distance, to the right and up on the screen.
  shift(right, up) {
    const [x, y] = [0, 1].map((k) => new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, k));
    this.target.addScaledVector(x, right * this.distance).addScaledVector(y, up * this.distance);
    this.update();
  }

  zoom(times) {
    this.distance = Math.min(10 * this.radius, Math.max(0.02 * this.radius, this.distance * times));
    this.update();
  }

  update() {
    this.camera.position.copy(this.away()).multiplyScalar(this.distance).add(this.target);
    this.camera.near = Math.max(this.distance - 3 * this.radius, this.distance / 100);
    this.camera.far = this.distance + 3 * this.radius;
    this.camera.lookAt(this.target);
    this.camera.updateMatrix();
    this.camera.updateProjectionMatrix();
    this.changed();
  }

  down(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, event);
    this.still = this.pointers.size === 1 && event.button === 0 ? event : null;
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    if (this.still && distanceOf(event, this.still) > STILL) this.still = null;
    if (this.still) return;
    const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
    const size = this.canvas.clientHeight;
    const field = 2 * Math.tan((this.camera.fov * Math.PI) / 360);
    if (this.pointers.size > 1) {
      const other = [...this.pointers.values()].find((pointer) => pointer.pointerId !== event.pointerId);
      this.zoom(Math.max(distanceOf(before, other), 1) / Math.max(distanceOf(event, other), 1));
      this.shift((-dx / size / 2) * field, (dy / size / 2) * field);
    } else if (event.buttons & 6 || event.shiftKey) {
      this.shift((-dx / size) * field, (dy / size) * field);
    } else {
      this.turn((-dx / size) * Math.PI, (dy / size) * Math.PI);
    }
    this.pointers.set(event.pointerId, event);
  }

  up(event) {
    this.pointers.delete(event.pointerId);
    if (this.still && event.type === "pointerup") this.clicked(event);
    this.still = null;
  }

  // The page scrolls under a picture that nobody has touched.
  wheel(event) {
    if (document.activeElement !== this.canvas && !event.ctrlKey) return;
    event.preventDefault();
    this.zoom(Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 100) * 0.0015));
  }

  key(event) {
    const arrow = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (arrow && event.shiftKey) this.shift(MOVE * arrow[0], MOVE * arrow[1]);
    else if (arrow) this.turn(TURN * arrow[0], TURN * arrow[1]);
    else if (event.key === "+" || event.key === "=") this.zoom(NEARER);
    else if (event.key === "-") this.zoom(1 / NEARER);
    else return;
    event.preventDefault();
  }
}

function distanceOf(a, b) {
  return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
}

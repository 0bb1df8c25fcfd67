// A camera that turns about a point with the horizon level; moved by mouse, fingers and keys.

const TURN = Math.PI / 36; // [rad] a key press
const MOVE = 0.05; // of the distance, a key press
const NEARER = 0.85; // of the distance, a key press
const STEEPEST = Math.PI / 2 - 0.001; // [rad]
const STILL = 6; // pixels; a pointer that moves less has clicked
const SOUTH = -Math.PI / 2;
const VIEWS = {
  iso: [SOUTH + 0.6, 0.55],
  top: [SOUTH, STEEPEST],
  below: [SOUTH, -STEEPEST],
};

class Orbit {
  // changed(): after every move. clicked(event): where a pointer was pressed and released.
  constructor(canvas, box, changed, clicked) {
    Object.assign(this, { canvas, changed, clicked });
    this.camera = new THREE.PerspectiveCamera(40, 1);
    this.camera.up.set(0, 0, 1);
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
    const upright = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(upright, Math.atan(Math.tan(upright) * this.camera.aspect));
    this.distance = (0.95 * this.radius) / Math.sin(narrow);
    this.update();
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
    const level = Math.cos(this.elevation);
    const away = [level * Math.cos(this.azimuth), level * Math.sin(this.azimuth), Math.sin(this.elevation)];
    this.camera.position.fromArray(away).multiplyScalar(this.distance).add(this.target);
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

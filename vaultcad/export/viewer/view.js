// The view: three.js's scene, drawn when something changed, and what its buttons do. Runs with `stage` and `scene`.

const KEPT = { x: -1, y: 1, z: -1 }; // the half behind the section, as the first view looks
// Of lamp and sky; colours that tell deviations are to be as in the legend.
const LIGHTS = { ideal: [0.45, 0.62], "as-built": [0.14, 0.9], points: [0.45, 0.62] };

const head = readScene(scene);
const parts = head.parts.map((part) => new Part(part, head));
const clouds = head.clouds.map((cloud) => new Cloud(cloud, head));
const canvas = stage.querySelector("canvas");
const form = stage.querySelector("form");
const tip = stage.querySelector(".view-tip");
const said = stage.querySelector(".view-said");
const renderer = new THREE.WebGLRenderer({ canvas, antialias: true });
renderer.localClippingEnabled = true;
const world = new THREE.Scene();
world.add(...parts.flatMap((part) => part.meshes), ...clouds.map((cloud) => cloud.points));
const box = new THREE.Box3();
for (const part of parts) box.expandByObject(part.front);
const lamp = new THREE.DirectionalLight("#ffffff");
const sky = new THREE.HemisphereLight("#ffffff", "#e4e1da");
world.add(lamp, lamp.target, sky);
const cap = new Cap(parts, box, head.stone, world);
const measure = new Measure(world);
const orbit = new Orbit(canvas, box, changed, clicked);
let asked = false;
let plane = null;

function changed() {
  if (!asked) requestAnimationFrame(draw);
  asked = true;
}

function draw() {
  asked = false;
  renderer.setClearColor(getComputedStyle(canvas).backgroundColor);
  lamp.position.copy(orbit.camera.position);
  lamp.target.position.copy(orbit.target);
  renderer.render(world, orbit.camera);
}

function resized() {
  renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
  renderer.setSize(canvas.clientWidth, canvas.clientHeight, false);
  orbit.camera.aspect = canvas.clientWidth / canvas.clientHeight;
  if (orbit.target) orbit.update();
}

const chosen = (name) => form.elements[name].value;
const ticked = (name) => form.elements[name].checked;

function applied() {
  [lamp.intensity, sky.intensity] = LIGHTS[chosen("show")];
  for (const part of parts) part.look(chosen("show"), Number(chosen("enlarge")), ticked("masonry"));
  for (const cloud of clouds) cloud.look(chosen("show"), ticked("around"));
  form.querySelector(".view-enlarge").hidden = chosen("show") !== "as-built";
  cut();
  if (!ticked("measure")) measure.clear();
  legend();
  changed();
}

function cut() {
  const axis = chosen("axis");
  form.elements.at.disabled = form.elements.flip.disabled = !axis;
  plane = null;
  if (axis) {
    const at = box.min[axis] + Number(chosen("at")) * (box.max[axis] - box.min[axis]);
    const way = ticked("flip") ? -KEPT[axis] : KEPT[axis];
    plane = new THREE.Plane(new THREE.Vector3(), -way * at);
    plane.normal[axis] = way;
    const told = (axis === "z" ? at + head.height : at).toFixed(2).replace("-", "−");
    form.elements.at.setAttribute("aria-valuetext", `${axis} ${told} m`);
    form.elements.place.value = `${axis} = ${told} m`;
  } else form.elements.place.value = "";
  SECTIONS.splice(0, 1, ...(plane ? [plane] : []));
  cap.look(plane, ticked("masonry"));
}

function legend() {
  const bar = stage.querySelector(".view-legend");
  bar.replaceChildren();
  const span = (className, text, style = {}) => {
    const made = Object.assign(document.createElement("span"), { className, textContent: text });
    Object.assign(made.style, style);
    return made;
  };
  if (chosen("show") !== "ideal") {
    const stops = head.stops.map(([share, rgb]) => `rgb(${rgb.join(" ")}) ${50 * (1 + share)}%`).join(", ");
    bar.append(
      span("", `−${1000 * head.limit} mm into the room`),
      span("view-scale", "", { background: `linear-gradient(to right, ${stops})` }),
      span("", `+${1000 * head.limit} mm into the stone`),
    );
    return;
  }
  const shown = parts.filter((part) => !part.stone);
  const named = new Map(shown.map((part) => [part.name, part.colour]));
  if (head.owners.length > 1) named.clear();
  for (const [name, colour] of named) {
    const item = span("", "");
    item.append(span("swatch", "", { background: colour }), name);
    bar.append(item);
  }
  if (!named.size) bar.append("each component in a colour of its own; point at it to see what it is");
}

function picked(x, y) {
  const shown = { parts, clouds, plane, spacing: head.spacing, masonry: ticked("masonry") };
  return pick(x, y, { camera: orbit.camera, ...shown });
}

function placeOf(event) {
  const { left, top, width, height } = canvas.getBoundingClientRect();
  return [((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2];
}

function taken(hit) {
  const what = hit ? told(hit, chosen("show"), head, clouds) : "nothing there";
  if (hit && ticked("measure")) measure.add(truePlace(hit, chosen("show")));
  said.textContent = ticked("measure") ? `${measure.told} · ${what}` : what;
  changed();
}

function clicked(event) {
  taken(picked(...placeOf(event)));
}

let hovering = null;
function hovered(event) {
  tip.hidden = true;
  if (event.buttons || event.pointerType === "touch") return;
  if (!hovering) requestAnimationFrame(showTip);
  hovering = event;
}

function showTip() {
  const event = hovering;
  hovering = null;
  const hit = picked(...placeOf(event));
  tip.hidden = !hit;
  if (!hit) return;
  tip.textContent = told(hit, chosen("show"), head, clouds);
  const { left, top, width } = canvas.getBoundingClientRect();
  const right = event.clientX - left > width / 2;
  Object.assign(tip.style, {
    left: right ? "auto" : `${event.clientX - left + 14}px`,
    right: right ? `${width - (event.clientX - left) + 14}px` : "auto",
    top: `${event.clientY - top + 14}px`,
  });
}

canvas.addEventListener("pointermove", hovered);
canvas.addEventListener("pointerleave", () => {
  tip.hidden = true;
});
canvas.addEventListener("keydown", (event) => {
  if (event.key === "Enter") taken(picked(0, 0));
  if (event.key === "Escape") {
    measure.clear();
    said.textContent = ticked("measure") ? measure.told : "";
    changed();
  }
});
for (const button of form.querySelectorAll("button[value]")) {
  if (button.type === "button") button.addEventListener("click", () => orbit.look(button.value));
}
form.addEventListener("input", applied);
form.elements.measure.addEventListener("input", () => {
  said.textContent = ticked("measure") ? measure.told : "";
});
form.addEventListener("submit", (event) => event.preventDefault());
form.addEventListener("reset", () => {
  setTimeout(() => {
    said.textContent = "";
    applied();
    orbit.look("iso");
  });
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
for (const [value, there] of [
  ["as-built", parts.some((part) => part.moved)],
  ["points", clouds.some((cloud) => !cloud.around)],
]) {
  form.querySelector(`[name="show"][value="${value}"]`).parentElement.hidden = !there;
}
form.elements.around.parentElement.hidden = !clouds.some((cloud) => cloud.around);
applied();
resized();
orbit.look("iso");
new ResizeObserver(resized).observe(canvas);

"use strict";
// Reads the scene that vaultcad/export/viewer/scene.py packs, and makes three.js's objects of it.

const ARRAYS = {
  xyz: [Uint16Array, 3],
  moved: [Int16Array, 3],
  index: [Uint32Array, 1],
  deviation: [Int16Array, 1],
  component: [Uint16Array, 1],
};
const UNKNOWN = -32768; // where there is no deviation
const GROUND = "#b9b6b0"; // of a surface under points
const SECTIONS = []; // the plane that cuts all, if there is one
const TOWARDS_EYE = 0.03; // m by which points come before the surface that they lie on

function readScene(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  for (const item of [...head.parts, ...head.clouds]) {
    for (const [name, [Type, width]] of Object.entries(ARRAYS)) {
      if (name in item) item[name] = summed(new Type(buffer, 4 + length + item[name][0], item[name][1]), width);
    }
    item.positions = Float32Array.from(item.xyz, (step, k) => item.low[k % 3] + step * item.step[k % 3]);
  }
  return head;
}

// Rows are kept as their differences.
function summed(array, width) {
  for (let k = width; k < array.length; k++) array[k] += array[k - width];
  return array;
}

// Red, green, blue from 0 to 1 of a deviation [m], null where it is not known.
function shade(deviation, { stops, limit, unknown }) {
  if (deviation === null) return unknown.map((channel) => channel / 255);
  const share = Math.min(1, Math.max(-1, deviation / limit));
  const k = Math.max(1, stops.findIndex(([at]) => at >= share));
  const [[low, a], [high, b]] = [stops[k - 1], stops[k]];
  return a.map((channel, c) => (channel + ((b[c] - channel) * (share - low)) / (high - low)) / 255);
}

// A component, or the rest of a vault's masonry: one geometry, drawn from the room in front and from the stone behind.
class Part {
  constructor(part, head) {
    Object.assign(this, part, { head, stone: part.id === 0 });
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setIndex(new THREE.BufferAttribute(part.index, 1));
    this.place(0);
    this.normals = this.geometry.getAttribute("normal").array;
    if (part.moved) this.geometry.setAttribute("color", new THREE.BufferAttribute(this.shades(), 3));
    const Material = this.stone ? THREE.MeshPhongMaterial : THREE.MeshLambertMaterial;
    const look = this.stone ? { flatShading: true, shininess: 0 } : {};
    const side = (side) => new THREE.Mesh(this.geometry, new Material({ ...look, side, clippingPlanes: SECTIONS }));
    this.front = side(THREE.FrontSide);
    this.back = side(THREE.BackSide);
    this.meshes = [this.front, this.back];
    for (const mesh of this.meshes) mesh.userData.part = this;
  }

  // So many times its displacement away from the ideal surface.
  place(times) {
    if (times === this.times) return;
    this.times = times;
    const at = times ? this.positions.map((v, k) => v + times * this.moved[k] * this.head.fine) : this.positions;
    this.geometry.setAttribute("position", new THREE.BufferAttribute(at, 3));
    this.geometry.deleteAttribute("normal");
    this.geometry.computeVertexNormals();
    this.geometry.computeBoundingSphere();
  }

  // Displacement [m] of a vertex into the stone: normals look out of it.
  into(vertex) {
    const along = (k) => this.moved[3 * vertex + k] * this.normals[3 * vertex + k];
    return -this.head.fine * (along(0) + along(1) + along(2));
  }

  shades() {
    const colours = new Float32Array(this.positions.length);
    for (let k = 0; 3 * k < colours.length; k++) colours.set(shade(this.into(k), this.head), 3 * k);
    return colours;
  }

  // show: "ideal", "as-built" or "points", under which it is but ground.
  look(show, enlarge, masonry) {
    const bent = show === "as-built" && Boolean(this.moved);
    this.place(bent ? enlarge : 0);
    const shaded = bent && !this.stone;
    const plain = this.stone ? this.head.stone : show === "points" ? GROUND : this.colour;
    for (const mesh of this.meshes) {
      mesh.visible = masonry || !this.stone;
      mesh.material.needsUpdate ||= mesh.material.vertexColors !== shaded;
      mesh.material.vertexColors = shaded;
      mesh.material.color.set(shaded ? "#ffffff" : plain);
    }
  }
}

// Points coloured by their deviation, drawn a little before where they are, so that the surface does not hide half of them.
class Cloud {
  constructor(cloud, head) {
    Object.assign(this, cloud);
    this.around = !cloud.deviation;
    this.geometry = new THREE.BufferGeometry();
    this.geometry.setAttribute("position", new THREE.BufferAttribute(this.positions, 3));
    const colours = new Float32Array(this.positions.length);
    for (let k = 0; 3 * k < colours.length; k++) colours.set(shade(this.at(k, head.fine), head), 3 * k);
    this.geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    const size = this.around ? { size: 2, sizeAttenuation: false } : { size: 1.5 * head.spacing };
    const material = new THREE.PointsMaterial({ vertexColors: true, clippingPlanes: SECTIONS, ...size });
    if (!this.around) material.onBeforeCompile = towardsEye;
    this.points = new THREE.Points(this.geometry, material);
    this.points.userData.cloud = this;
  }

  // Deviation [m] of a point, null where it is not known.
  at(k, fine) {
    return this.around || this.deviation[k] === UNKNOWN ? null : this.deviation[k] * fine;
  }

  look(show, around) {
    this.points.visible = this.around ? around : show === "points";
  }
}

function towardsEye(shader) {
  const nearer = `mvPosition.xyz -= normalize(mvPosition.xyz) * ${TOWARDS_EYE};\n\tgl_Position = projectionMatrix * mvPosition;`;
  shader.vertexShader = shader.vertexShader.replace("#include <project_vertex>", `#include <project_vertex>\n\t${nearer}`);
}

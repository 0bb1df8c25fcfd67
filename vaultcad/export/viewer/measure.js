// The distance between two places: two marks and a line between them, seen through the stone.

class Measure {
  constructor(scene) {
    this.places = [];
    this.geometry = new THREE.BufferGeometry();
    const look = { color: "#e03131", depthTest: false, transparent: true };
    this.marks = new THREE.Points(this.geometry, new THREE.PointsMaterial({ ...look, size: 11, sizeAttenuation: false }));
    this.line = new THREE.Line(this.geometry, new THREE.LineBasicMaterial(look));
    for (const mark of [this.marks, this.line]) {
      mark.renderOrder = 3;
      mark.frustumCulled = false;
    }
    scene.add(this.marks, this.line);
    this.clear();
  }

  // A third place begins anew.
  add(place) {
    this.places = this.places.length === 2 ? [place] : [...this.places, place];
    this.draw();
  }

  clear() {
    this.places = [];
    this.draw();
  }

  draw() {
    this.geometry.setFromPoints(this.places);
    this.marks.visible = this.places.length > 0;
    this.line.visible = this.places.length === 2;
  }

  get told() {
    const [a, b] = this.places;
    if (!a) return "take two places";
    if (!b) return "take the second place";
    const [level, rise] = [Math.hypot(a.x - b.x, a.y - b.y), Math.abs(a.z - b.z)].map((length) => length.toFixed(3));
    return `${a.distanceTo(b).toFixed(3)} m (level ${level}, plumb ${rise})`;
  }
}

// The face of cut masonry. Where a ray to the plane has left more closed surfaces than it has entered, there is stone:
// the stencil buffer counts them.

class Cap {
  constructor(parts, box, colour, world) {
    this.parts = parts;
    const count = (side, step) => {
      const uncoloured = { side, clippingPlanes: SECTIONS, colorWrite: false, depthWrite: false };
      const counting = { stencilWrite: true, stencilFail: step, stencilZFail: step, stencilZPass: step };
      return new THREE.MeshBasicMaterial({ ...uncoloured, ...counting, depthFunc: THREE.AlwaysDepth });
    };
    const materials = [
      count(THREE.BackSide, THREE.IncrementWrapStencilOp),
      count(THREE.FrontSide, THREE.DecrementWrapStencilOp),
    ];
    this.counters = parts.flatMap((part) => materials.map((material) => new THREE.Mesh(part.geometry, material)));
    for (const counter of this.counters) counter.renderOrder = 1;
    const size = 2 * box.getSize(new THREE.Vector3()).length();
    const stone = new THREE.Color(colour).multiplyScalar(0.6);
    const filled = { side: THREE.DoubleSide, stencilWrite: true, stencilFunc: THREE.NotEqualStencilFunc };
    this.face = new THREE.Mesh(
      new THREE.PlaneGeometry(size, size),
      new THREE.MeshBasicMaterial({ ...filled, color: stone }),
    );
    this.face.renderOrder = 2;
    this.centre = box.getCenter(new THREE.Vector3());
    world.add(...this.counters, this.face);
  }

  // plane: of the section, null for none.
  look(plane, masonry) {
    for (const mesh of [...this.counters, this.face]) mesh.visible = Boolean(plane && masonry);
    if (!plane) return;
    plane.projectPoint(this.centre, this.face.position);
    this.face.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), plane.normal);
  }
}

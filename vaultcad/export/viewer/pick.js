// What lies under a pointer, and what is known of it.

const NEARBY = 0.1; // m about a place on the ideal surface within which points tell its deviation

// The first thing shown at a place of the picture, x and y from -1 to 1: {point, object, ...}, or null.
// Who sees masonry from behind looks at the face of the section before it.
function pick(x, y, { camera, parts, clouds, plane, spacing, masonry }) {
  const ray = new THREE.Raycaster();
  ray.params.Points.threshold = spacing;
  ray.setFromCamera({ x, y }, camera);
  const there = (hit) => !plane || plane.distanceToPoint(hit.point) >= 0;
  const seen = (objects) => ray.intersectObjects(objects.filter((object) => object.visible), false).filter(there);
  const [surface] = seen(parts.flatMap((part) => part.meshes));
  if (surface && plane && masonry && surface.object === surface.object.userData.part.back) {
    return { ...surface, point: ray.ray.intersectPlane(plane, new THREE.Vector3()), cut: true };
  }
  const before = surface ? surface.distance + spacing : Infinity;
  const points = seen(clouds.map((cloud) => cloud.points)).filter((hit) => hit.distance < before);
  if (!points.length) return surface ?? null;
  const first = points[0].distance + 2 * spacing;
  const nearest = points.filter((hit) => hit.distance < first).reduce((a, b) => (b.distanceToRay < a.distanceToRay ? b : a));
  const cloud = nearest.object.userData.cloud;
  return { ...nearest, point: new THREE.Vector3().fromArray(cloud.positions, 3 * nearest.index) };
}

// Where the stone is, though the picture may enlarge by how much it has moved.
function truePlace(hit, show) {
  const part = hit.object.userData.part;
  if (hit.cut || !part?.moved || show !== "as-built") return hit.point.clone();
  const [shown, stands] = [part.geometry.getAttribute("position").array, part.positions];
  const corner = (array, k) => new THREE.Vector3().fromArray(array, 3 * k);
  const corners = [hit.face.a, hit.face.b, hit.face.c];
  const share = THREE.Triangle.getBarycoord(hit.point, ...corners.map((k) => corner(shown, k)), new THREE.Vector3());
  const out = new THREE.Vector3();
  corners.forEach((k, c) => {
    const moved = corner(part.moved, k).multiplyScalar(part.head.fine);
    out.addScaledVector(corner(stands, k).add(moved), share.getComponent(c));
  });
  return out;
}

// What it is and how far the stone is from the ideal there, in words.
function told(hit, show, head, clouds) {
  const { part, cloud } = hit.object.userData;
  if (cloud) return toldOfPoint(cloud, hit.index, head);
  if (hit.cut) return `${head.owners[part.owner]}: cut masonry`;
  const name = `${head.owners[part.owner]}: ${part.name}`;
  if (part.stone) return name;
  const whole = part.millimetres ? `; all of it: mean ${part.millimetres[0]} mm, 95 % within ${part.millimetres[1]} mm` : "";
  if (show === "as-built" && part.moved) {
    const corners = [hit.face.a, hit.face.b, hit.face.c];
    return `${name}; as built ${signed(corners.reduce((sum, k) => sum + part.into(k) / 3, 0))}${whole}`;
  }
  return `${name}; ${here(hit.point, clouds, head)}${whole}`;
}

function toldOfPoint(cloud, k, head) {
  const deviation = cloud.at(k, head.fine);
  if (cloud.around) return "off vaults and arches";
  const part = head.parts.find((one) => one.owner === cloud.owner && one.id === cloud.component[k]);
  const name = part ? `${head.owners[part.owner]}: ${part.name}` : "arch";
  return deviation === null ? name : `${name}; point ${signed(deviation)}`;
}

function here(place, clouds, head) {
  const reach = Math.max(NEARBY, 1.5 * head.spacing);
  let [sum, count] = [0, 0];
  for (const cloud of clouds.filter((one) => !one.around)) {
    const p = cloud.positions;
    for (let k = 0; 3 * k < p.length; k++) {
      const [dx, dy, dz] = [p[3 * k] - place.x, p[3 * k + 1] - place.y, p[3 * k + 2] - place.z];
      if (dx * dx + dy * dy + dz * dz < reach * reach && cloud.deviation[k] !== UNKNOWN) {
        sum += cloud.at(k, head.fine);
        count += 1;
      }
    }
  }
  return count ? `here ${signed(sum / count)}, the mean of ${count} point${count > 1 ? "s" : ""}` : "no points here";
}

function signed(deviation) {
  const mm = (1000 * deviation).toFixed(1);
  const way = Number(mm) > 0 ? " into the stone" : Number(mm) < 0 ? " into the room" : "";
  return `${Number(mm) > 0 ? "+" : ""}${mm.replace("-", "−")} mm${way}`;
}

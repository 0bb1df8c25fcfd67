"""The borders of triangles, and the gaps that OpenCASCADE's mesher leaves in level and plumb faces, filled."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.solid.mesh import Mesh
from vaultcad.errors import ExportError

ON_EDGE = 1e-6  # [m]

Floats = NDArray[np.float64]
Triangles = NDArray[np.int32]


def closed(mesh: Mesh) -> Mesh:
    """The mesh with what OpenCASCADE's mesher leaves out of level and plumb faces, most often slivers along arcs.

    Raises:
        ExportError: a gap lies in no such plane, so that it cannot be told what was there.
    """
    gaps: dict[tuple[int, float], list[list[int]]] = {}
    for row in loops(mesh.triangles):
        points = mesh.vertices[row]
        level = np.flatnonzero(np.ptp(points, axis=0) < ON_EDGE)
        if not len(level):
            low, high = (np.round(points.min(axis=0), 2).tolist(), np.round(points.max(axis=0), 2).tolist())
            raise ExportError(f"the masonry's mesh has a hole between {low} and {high} m; try another --thickness")
        gaps.setdefault((int(level[0]), round(float(points[0, level[0]]), 5)), []).append(row[::-1])
    if not gaps:
        return mesh
    filled = np.concatenate([_filled(mesh.vertices, rows, axis) for (axis, _), rows in gaps.items()])
    component = np.concatenate([mesh.component, np.zeros(len(filled), mesh.component.dtype)])
    return Mesh(mesh.vertices, np.concatenate([mesh.triangles, filled]).astype(np.int32), component)


def _filled(vertices: Floats, rows: list[list[int]], axis: int) -> NDArray[np.integer]:
    """Triangles between closed rows in one plane square to an axis, in the direction of the rows."""
    import manifold3d

    across = [(axis + 1) % 3, (axis + 2) % 3]
    if sum(area(vertices[row][:, across]) for row in rows) < 0:
        across.reverse()  # seen from the other side
    polygons = [vertices[row][:, across] for row in rows]
    triangles: NDArray[np.integer] = np.concatenate(rows)[manifold3d.triangulate(polygons)]
    return triangles


def area(row: Floats) -> float:
    """Area [m²] of a closed row of points (n, 2), positive if it is counterclockwise."""
    x, y = row.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def loops(triangles: Triangles) -> list[list[int]]:
    """The borders of a patch as closed rows of vertex indices, in the direction of its triangles."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).tolist()
    inner = {(b, a) for a, b in edges}
    following: dict[int, list[int]] = {}
    for a, b in edges:
        if (a, b) not in inner:
            following.setdefault(a, []).append(b)
    found = []
    while following:
        row = [next(iter(following))]
        while True:
            after = following[row[-1]]
            vertex = after.pop()
            if not after:
                del following[row[-1]]
            if vertex == row[0]:
                break
            row.append(vertex)
        found.append(row)
    return found

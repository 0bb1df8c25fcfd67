"""Triangles of a vault: its intrados, or its masonry as a closed mesh, made from the B-Rep."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from families.declaration.vault import Vault

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

ANGLE = 0.2  # [rad] between neighbouring triangles, so that small arcs stay round
WELD = 10  # decimals of a metre to which vertices on a common edge agree
MICRO = 5e-6  # [m] of edges as short as OpenCASCADE lets ends of curves miss a vertex: they are no edges


@dataclass(frozen=True)
class Mesh:
    """Vertices (n, 3) [m] and triangles (m, 3) of indices, counterclockwise seen from the room or from outside.

    `component` (m,) is 1 + index in the vault's components; on a solid it is 0 on the sides and 1 + their number on the
    extrados.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    component: NDArray[np.uint16]

    @property
    def areas(self) -> NDArray[np.float64]:
        """Areas (m,) of the triangles [m²]."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2  # type: ignore[no-any-return]  # numpy's stubs


def mesh(vault: Vault, tolerance: float = 0.002) -> Mesh:
    """The intrados; triangles deviate from it by no more than about `tolerance` [m]. They face the room."""
    from families.solid import brep

    shape = brep.surface(vault)
    ids = {name: k for k, name in enumerate(vault.components, 1)}
    found = [(face, ids[name]) for face, name in brep.face_names(shape, vault) if name in ids]
    return _meshed(shape, found, tolerance, inward=True)


def mesh_solid(
    vault: Vault, thickness: float = 0.15, tolerance: float = 0.002, shape: TopoDS_Shape | None = None
) -> Mesh:
    """The masonry as a closed mesh: every edge belongs to two triangles. They face outwards, away from the stone.

    `shape` is what `brep.masonry` made of the same vault and thickness, where that is at hand already.
    """
    from families.solid import brep

    shape = brep.masonry(vault, thickness) if shape is None else shape
    ids = {brep.SIDE: 0, **{name: k for k, name in enumerate((*vault.components, brep.EXTRADOS), 1)}}
    return _meshed(shape, [(face, ids[name]) for face, name in brep.face_names(shape, vault)], tolerance, inward=False)


def mesh_shape(shape: TopoDS_Shape, tolerance: float = 0.002) -> Mesh:
    """Any closed shape [mm] as a closed mesh without components. Its triangles face outwards."""
    from families.solid.occ.shapes import faces

    return _meshed(shape, [(face, 0) for face in faces(shape)], tolerance, inward=False)


def _meshed(shape: TopoDS_Shape, faces: list[tuple[TopoDS_Face, int]], tolerance: float, inward: bool) -> Mesh:
    from OCP.BRep import BRep_Tool
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopLoc import TopLoc_Location

    from families.declaration.units import MM

    BRepMesh_IncrementalMesh(shape, MM * tolerance, False, ANGLE, False)
    points, corners, names, offset = [], [], [], 0
    for face, name in faces:
        place = TopLoc_Location()
        part = BRep_Tool.Triangulation_s(face, place)
        if part is None:
            continue
        there = place.Transformation()
        nodes = np.array([part.Node(k).Transformed(there).Coord() for k in range(1, part.NbNodes() + 1)])
        triples = np.array([part.Triangle(k).Get() for k in range(1, part.NbTriangles() + 1)])
        backwards = (face.Orientation() == TopAbs_REVERSED) != inward
        corners.append((triples[:, ::-1] if backwards else triples) - 1 + offset)
        points.append(nodes)
        names.append(np.full(len(triples), name, np.uint16))
        offset += len(nodes)
    return _welded(np.concatenate(points) / MM, np.concatenate(corners), np.concatenate(names))


def _welded(points: NDArray[np.float64], corners: NDArray[np.int64], names: NDArray[np.uint16]) -> Mesh:
    """One vertex where faces meet, in the order of first use, and no triangle without an area."""
    places = np.round(points, WELD)
    ranked = np.lexsort(places.T)
    fresh = np.concatenate([[True], (places[ranked[1:]] != places[ranked[:-1]]).any(axis=1)])
    first = ranked[fresh]  # of those at one place, as the sort is stable
    where = np.empty(len(places), np.intp)
    where[ranked] = np.cumsum(fresh) - 1
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    vertices, triangles = _without_micro_edges(points[first[order]], rank[where][corners])
    a, b, c = triangles.T
    whole = (a != b) & (b != c) & (c != a)
    return Mesh(vertices, triangles[whole].astype(np.int32), names[whole])


def _without_micro_edges(
    vertices: NDArray[np.float64], triangles: NDArray[np.intp]
) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """The mesh with one vertex for all that micro-edges join."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    ends = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    length = np.abs(vertices[ends[:, 0]] - vertices[ends[:, 1]]).max(axis=1)
    micro = ends[(ends[:, 0] != ends[:, 1]) & (length < MICRO)]
    if not len(micro):
        return vertices, triangles
    size = len(vertices)
    _, group = connected_components(coo_array((np.ones(len(micro)), micro.T), (size, size)), directed=False)
    _, lowest = np.unique(group, return_index=True)
    kept, joined = np.unique(lowest[group], return_inverse=True)
    return vertices[kept], joined[triangles]

"""The outline of a vault, read from OpenCASCADE's faces of its intrados, which share their edges.

Faces of one component that pass into each other smoothly are one; where a component has a crease, as a pointed barrel
has at its crown, it is two fields of surface that meet there.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from math import cos, radians
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.pieces import BarrelPart, Lid, Part, Turned
from families.declaration.units import MM
from vaultcad.errors import NoSurfaceError
from vaultcad.nurbs.chart_choice import chart_of
from vaultcad.nurbs.outline import Edge, Face, Outline, Region

if TYPE_CHECKING:
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.TopoDS import TopoDS_Edge, TopoDS_Face

Array = NDArray[np.float64]
CREASE = cos(radians(5.0))  # of the angle between two faces of a component, from which on they are no one surface
APART = 0.06  # m, distance of nodes along an edge
FEWEST, MOST = 9, 129  # nodes of an edge
STEPS = 513  # places of an edge by which its length is measured
KEPT = 4  # outlines that are remembered


@lru_cache(maxsize=KEPT)
def outline_of(vault: Vault) -> Outline:
    """The outline of a vault's intrados.

    Raises:
        NoSurfaceError: OpenCASCADE cannot build it.
    """
    from families.solid import brep

    try:
        shape = brep.surface(vault)
    except ValueError as error:
        raise NoSurfaceError(str(error)) from error
    names = [(face, name) for face, name in brep.face_names(shape, vault) if name in vault.components]
    return _Reader(vault, names).outline()


class _Reader:
    """Reads faces of OpenCASCADE that share their edges."""

    def __init__(self, vault: Vault, faces: list[tuple[TopoDS_Face, str]]) -> None:
        from OCP.TopTools import TopTools_IndexedMapOfShape

        self.vault, self.faces = vault, faces
        self.known = TopTools_IndexedMapOfShape()  # of edges
        self.corner_map = TopTools_IndexedMapOfShape()
        self.shapes: list[TopoDS_Edge] = []
        self.sides: list[list[tuple[int, bool]]] = []
        self._read()

    def _read(self) -> None:
        from OCP.BRep import BRep_Tool
        from OCP.TopAbs import TopAbs_EDGE, TopAbs_FORWARD
        from OCP.TopExp import TopExp_Explorer
        from OCP.TopoDS import TopoDS

        for k, (face, _) in enumerate(self.faces):
            explorer = TopExp_Explorer(face, TopAbs_EDGE)
            while explorer.More():
                edge = TopoDS.Edge_s(explorer.Current())
                explorer.Next()
                if BRep_Tool.Degenerated_s(edge):
                    continue
                index = self.known.Add(edge) - 1
                if index == len(self.shapes):
                    self.shapes.append(TopoDS.Edge_s(edge.Oriented(TopAbs_FORWARD)))
                    self.sides.append([])
                self.sides[index].append((k, edge.Orientation() == TopAbs_FORWARD))

    def outline(self) -> Outline:
        """All of it."""
        region, face_of = self._grouped()
        kept = [k for k, sides in enumerate(self.sides) if len({face_of[face] for face, _ in sides}) == len(sides)]
        ends = {k: self._ends(self.shapes[k]) for k in kept}
        corner_ids = sorted({end for pair in ends.values() for end in pair})
        number = {end: k for k, end in enumerate(corner_ids)}
        places = [self._corner(end) for end in corner_ids]
        tangents = [np.zeros(3)] * len(places)
        edges: list[Edge] = []
        for k in kept:
            points, along = _spread(self.shapes[k])
            start, end = (number[corner] for corner in ends[k])
            inner = range(len(places), len(places) + len(points) - 2)
            places += list(points[1:-1])
            tangents += list(along[1:-1])
            edges.append(Edge((start, *inner, end), tuple((face_of[face], forward) for face, forward in self.sides[k])))
        nodes = np.array(places)
        faces = _faces(edges, region, nodes)
        outline = Outline((), faces, tuple(edges), nodes, np.array(tangents), len(corner_ids))
        return Outline(
            tuple(self._regions(outline, region, face_of)),
            faces,
            tuple(edges),
            nodes,
            outline.tangents,
            len(corner_ids),
        )

    def _grouped(self) -> tuple[list[int], list[int]]:
        """The region of each face to be, and the face to be of each that was read."""
        smooth = [k for k, sides in enumerate(self.sides) if len(sides) == 2 and self._smooth(k)]
        whole = _joined(len(self.faces), [tuple(face for face, _ in self.sides[k]) for k in smooth])
        # What closes about an axis keeps its faces: one alone would need a seam.
        closing = {region for region in set(whole) if self._closes(region, whole)}
        joined = _joined(
            len(self.faces),
            [(a, b) for k in smooth for a, b in [tuple(face for face, _ in self.sides[k])] if whole[a] not in closing],
        )
        region_of = {group: k for k, group in enumerate(dict.fromkeys(whole))}
        face_number = {group: k for k, group in enumerate(dict.fromkeys(joined))}
        region = [0] * len(face_number)
        for face, group in enumerate(joined):
            region[face_number[group]] = region_of[whole[face]]
        self.names = [self.faces[whole.index(group)][1] for group in region_of]
        return region, [face_number[group] for group in joined]

    def _closes(self, group: int, whole: list[int]) -> bool:
        """Whether faces close about an upright axis: their borders then are rings that do not hang together."""
        part = part_of(self.vault, self.faces[whole.index(group)][1])
        if not isinstance(part, Turned) or not (part.radius or self.faces[whole.index(group)][1] == part.names[0]):
            return False
        if not part.radius and part.names[0] == part.names[1]:
            return False
        border = [
            self._ends(self.shapes[k])
            for k, sides in enumerate(self.sides)
            if sum(whole[face] == group for face, _ in sides) == 1
        ]
        ids = {end: k for k, end in enumerate(sorted({end for pair in border for end in pair}))}
        return len(set(_joined(len(ids), [(ids[a], ids[b]) for a, b in border]))) > 1

    def _smooth(self, edge: int) -> bool:
        """Whether two faces of one component pass into each other there."""
        (a, _), (b, _) = self.sides[edge]
        if self.faces[a][1] != self.faces[b][1]:
            return False
        return all(
            abs(
                float(
                    _normal(self.shapes[edge], self.faces[a][0], at) @ _normal(self.shapes[edge], self.faces[b][0], at)
                )
            )
            > CREASE
            for at in (0.3, 0.5, 0.7)
        )

    def _ends(self, edge: TopoDS_Edge) -> tuple[int, int]:
        from OCP.TopExp import TopExp

        first, last = TopExp.FirstVertex_s(edge), TopExp.LastVertex_s(edge)
        return self.corner_map.Add(first), self.corner_map.Add(last)

    def _corner(self, index: int) -> Array:
        from OCP.BRep import BRep_Tool
        from OCP.TopoDS import TopoDS

        point = BRep_Tool.Pnt_s(TopoDS.Vertex_s(self.corner_map.FindKey(index)))
        return np.array([point.X(), point.Y(), point.Z()]) / MM

    def _regions(self, outline: Outline, region: list[int], face_of: list[int]) -> Iterator[Region]:
        ids = {name: k for k, name in enumerate(self.vault.components, 1)}
        for k, name in enumerate(self.names):
            rows = [
                outline.nodes[outline.row(loop)]
                for face, of in zip(outline.faces, region, strict=True)
                if of == k
                for loop in face.loops
            ]
            yield Region(ids[name], name, chart_of(part_of(self.vault, name), name, np.concatenate(rows)))


def part_of(vault: Vault, name: str) -> Part | None:
    """The part of a vault that a component of that name is of."""
    for piece in vault.pieces():
        for part in piece.parts:
            if not isinstance(part, Lid) and (
                name in part.names or (isinstance(part, BarrelPart) and name == part.below)
            ):
                return part
    return None


def _spread(edge: TopoDS_Edge) -> tuple[Array, Array]:
    """Places and unit tangents (n, 3) at about even distances along an edge, its ends included [m]."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve

    curve = BRepAdaptor_Curve(edge)
    fine = np.linspace(curve.FirstParameter(), curve.LastParameter(), STEPS)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(_along(curve, fine)[0], axis=0), axis=1))])
    count = int(np.clip(length[-1] / APART, FEWEST - 1, MOST - 1)) + 1
    return _along(curve, np.interp(np.linspace(0, length[-1], count), length, fine))


def _along(curve: BRepAdaptor_Curve, parameters: Array) -> tuple[Array, Array]:
    """Places and unit tangents (n, 3) of a curve [m]."""
    from OCP.gp import gp_Pnt, gp_Vec

    places, tangents = np.empty((len(parameters), 3)), np.empty((len(parameters), 3))
    point, vector = gp_Pnt(), gp_Vec()
    for k, parameter in enumerate(parameters.tolist()):
        curve.D1(parameter, point, vector)
        places[k] = point.X(), point.Y(), point.Z()
        tangents[k] = vector.X(), vector.Y(), vector.Z()
    size = np.linalg.norm(tangents, axis=1, keepdims=True)
    return places / MM, tangents / np.maximum(size, 1e-12)


def _normal(edge: TopoDS_Edge, face: TopoDS_Face, share: float) -> Array:
    """Unit normal of a face at a share of an edge of it."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepGProp import BRepGProp_Face
    from OCP.gp import gp_Pnt, gp_Vec

    first, last = BRep_Tool.Range_s(edge, face)
    curve: Any = BRep_Tool.CurveOnSurface_s(edge, face, first, last)
    at = curve.Value(first + share * (last - first))
    point, vector = gp_Pnt(), gp_Vec()
    BRepGProp_Face(face).Normal(at.X(), at.Y(), point, vector)
    normal = np.array([vector.X(), vector.Y(), vector.Z()])
    found: Array = normal / max(float(np.linalg.norm(normal)), 1e-12)
    return found


def _joined(count: int, pairs: list[tuple[int, ...]]) -> list[int]:
    """The group of each of `count` things, by its least member, where pairs hang together."""
    group = list(range(count))

    def root(k: int) -> int:
        while group[k] != k:
            k = group[k]
        return k

    for a, b in pairs:
        one, other = sorted((root(a), root(b)))
        group[other] = one
    return [root(k) for k in range(count)]


def _faces(edges: list[Edge], region: list[int], nodes: Array) -> tuple[Face, ...]:
    """The faces with their edges chained to loops, the longest first."""
    found = []
    for face, of in enumerate(region):
        leaving: dict[int, list[tuple[int, bool]]] = {}
        for k, edge in enumerate(edges):
            for side, forward in edge.sides:
                if side == face:
                    leaving.setdefault(edge.nodes[0 if forward else -1], []).append((k, forward))
        loops = []
        while leaving:
            start = next(iter(leaving))
            loop: list[tuple[int, bool]] = []
            at = start
            while at in leaving:
                step = leaving[at].pop()
                if not leaving[at]:
                    del leaving[at]
                loop.append(step)
                at = edges[step[0]].nodes[-1 if step[1] else 0]
            loops.append(tuple(loop))
        loops.sort(key=lambda loop: -_length(loop, edges, nodes))
        found.append(Face(of, tuple(loops)))
    return tuple(found)


def _length(loop: tuple[tuple[int, bool], ...], edges: list[Edge], nodes: Array) -> float:
    return sum(float(np.linalg.norm(np.diff(nodes[list(edges[edge].nodes)], axis=0), axis=1).sum()) for edge, _ in loop)

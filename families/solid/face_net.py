"""The net of a body's faces: they share their edges and vertices from the start, so that nothing has to be sewn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise, product
from math import floor, isfinite

import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Builder
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TopAbs import TopAbs_FORWARD, TopAbs_REVERSED
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import (
    TopoDS,
    TopoDS_Compound,
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Vertex,
    TopoDS_Wire,
)

from families.declaration.units import MM
from families.solid.boundary import Loop, Pole, Step
from families.solid.curves import Point, Simple
from families.solid.occ.shapes import together
from families.solid.surfaces import Flat, Sheet

Array = NDArray[np.float64]
ONE = 1e-3  # [mm], points nearer than that are one
EDGE, VERTEX = ONE, 2 * ONE  # [mm], tolerances of edges and of vertices, which may stand for others that near
HERE = TopLoc_Location()
BUILDER = BRep_Builder()


@dataclass
class Edge:
    """An edge between two vertices, on which faces lie on so many sides."""

    shape: TopoDS_Edge
    step: Step
    ends: tuple[int, int]
    middle: Point
    uses: int = 0


@dataclass
class Patch:
    """A face to be: a surface within loops; `flipped` if the body lies on the side to which its normal points."""

    sheet: Sheet
    loops: list[Loop]
    flipped: bool = False


@dataclass
class Net:
    """Vertices, edges and faces of one body [mm]."""

    vertices: list[TopoDS_Vertex] = field(default_factory=list)
    edges: list[Edge] = field(default_factory=list)
    faces: list[tuple[TopoDS_Face, list[int]]] = field(default_factory=list)  # with the edges of each
    _coordinates: list[Point] = field(default_factory=list)
    _known: dict[Point, int] = field(default_factory=dict)  # vertices by the points asked for
    _near: dict[tuple[int, ...], list[int]] = field(default_factory=dict)  # vertices by the cubes of 1 mm around them
    _places: Array = field(default_factory=lambda: np.empty((0, 3)))
    _between: dict[tuple[int, int], list[int]] = field(default_factory=dict)

    def vertex(self, point: Point) -> int:
        """The vertex at a point, old or new."""
        if (found := self._known.get(point)) is None:
            found = self._known[point] = self._vertex(*point)
        return found

    def _vertex(self, x: float, y: float, z: float) -> int:
        if not isfinite(x + y + z):
            raise ValueError("an edge of this vault cannot be followed to its end; change a parameter a little")
        low, high = (floor(x - ONE), floor(y - ONE), floor(z - ONE)), (floor(x + ONE), floor(y + ONE), floor(z + ONE))
        for key in (low,) if low == high else product(*map(set, zip(low, high, strict=True))):
            for k in self._near.get(key, ()):
                if near(self._coordinates[k], (x, y, z)):
                    return k
        shape = TopoDS_Vertex()
        BUILDER.MakeVertex(shape, gp_Pnt(x, y, z), VERTEX)
        self.vertices.append(shape)
        self._coordinates.append((x, y, z))
        self._near.setdefault((floor(x), floor(y), floor(z)), []).append(len(self.vertices) - 1)
        return len(self.vertices) - 1

    @property
    def places(self) -> Array:
        """The vertices (n, 3) [mm]."""
        if len(self._places) < len(self._coordinates):
            self._places = np.array(self._coordinates)
        return self._places

    def cut(self, loops: list[Loop]) -> list[Loop]:
        """Loops with their steps cut at all vertices that lie on them; splines meet others at their ends only."""
        steps = [step for loop in loops for step in loop]
        if not steps:
            return loops
        for step in steps:
            self.ends(step)
        first, middle, last = np.array([step.places for step in steps]).swapaxes(0, 1)
        # Along each axis an arc leaves the box of its ends by less than twice what its middle is off that of the chord.
        slack = np.abs(2 * middle - first - last) + ONE
        low, high = np.minimum(first, last) - slack, np.maximum(first, last) + slack
        beside = np.ones((len(steps), len(self.places)), bool)
        for axis in range(3):
            beside &= (self.places[:, axis] > low[:, axis, None]) & (self.places[:, axis] < high[:, axis, None])
        # Two of them are its ends.
        crowded = (beside.sum(axis=1) > 2).tolist()
        parts = iter(
            self._split(step, np.flatnonzero(row)) if many else [step]
            for step, row, many in zip(steps, beside, crowded, strict=True)
        )
        return [[part for _ in loop for part in next(parts)] for loop in loops]

    def _split(self, step: Step, beside: NDArray[np.intp]) -> Loop:
        if not isinstance(step.path, Simple):
            return [step]
        first, _, last = step.places
        points = self.places[beside]
        t = step.path.parameters(points)
        near = (
            (t > min(step.start, step.end))
            & (t < max(step.start, step.end))
            & (np.abs(step.path.points(t) - points).max(axis=1) < ONE)
        )
        for end in (first, last):
            near &= np.abs(points - end).max(axis=1) > ONE
        if not near.any():
            return [step]
        cuts = sorted(t[near].tolist(), reverse=bool(step.end < step.start))
        at = [step.start, *cuts, step.end]
        return [Step(step.path, a, b) for a, b in pairwise(at)]

    def _found(self, ends: tuple[int, int], middle: Point) -> int | None:
        between = self._between.get((min(ends), max(ends)), ())
        return next((k for k in between if near(self.edges[k].middle, middle)), None)

    def ends(self, step: Step) -> tuple[int, int]:
        """The vertices of a step."""
        if step.ends is None:
            first, _, last = step.places
            step.ends = self.vertex(first), self.vertex(last)
        return step.ends

    def edge(self, step: Step) -> tuple[int, bool] | None:
        """The edge of a step and whether it runs the same way; None where the step is no longer than a vertex."""
        ends = self.ends(step)
        if ends[0] == ends[1]:
            return None
        if (k := self._found(ends, step.places[1])) is not None:
            return k, self.edges[k].ends == ends
        return self._edge(step, ends)

    def _edge(self, step: Step, ends: tuple[int, int]) -> tuple[int, bool]:
        forward = step if step.end > step.start else step.reversed
        along = ends if step.end > step.start else ends[::-1]
        shape = TopoDS_Edge()
        BUILDER.MakeEdge(shape, step.path.geometry, EDGE)
        BUILDER.Add(shape, self.vertices[along[0]].Oriented(TopAbs_FORWARD))
        BUILDER.Add(shape, self.vertices[along[1]].Oriented(TopAbs_REVERSED))
        BUILDER.Range(shape, forward.start, forward.end)
        self.edges.append(Edge(shape, forward, along, step.places[1]))
        self._between.setdefault((min(ends), max(ends)), []).append(len(self.edges) - 1)
        return len(self.edges) - 1, forward is step

    def add(self, patch: Patch) -> None:
        """Make the face of a patch; it shares the edges that are there already."""
        face = TopoDS_Face()
        BUILDER.MakeFace(face, patch.sheet.geometry, EDGE)
        used: list[int] = []
        for loop in patch.loops:
            self._wire(face, patch.sheet, loop, used)
        if used:
            self.faces.append((TopoDS.Face_s(face.Reversed()) if patch.flipped else face, used))

    def _wire(self, face: TopoDS_Face, sheet: Sheet, loop: Loop, used: list[int]) -> None:
        way: list[tuple[int, bool] | Pole] = []
        for step in loop:
            if isinstance(step, Pole):
                way.append(step)
                continue
            if (here := self.edge(step)) is not None:
                # There and back again is no way: faces narrower than a vertex are none.
                back = (here[0], not here[1])
                way.remove(back) if back in way else way.append(here)
        if not way:
            return
        wire = TopoDS_Wire()
        BUILDER.MakeWire(wire)
        for item in way:
            if isinstance(item, Pole):
                BUILDER.Add(wire, self._pole(item, sheet))
                continue
            edge, forward = self.edges[item[0]], item[1]
            if not isinstance(sheet, Flat):
                curve = sheet.trace(edge.step.path, edge.step.start, edge.step.end)
                BUILDER.UpdateEdge(edge.shape, curve, sheet.geometry, HERE, sheet.tolerance)
                if sheet.tolerance > EDGE:
                    for end in edge.ends:
                        BUILDER.UpdateVertex(self.vertices[end], 2 * sheet.tolerance)
            edge.uses += 1
            used.append(item[0])
            BUILDER.Add(wire, edge.shape.Oriented(TopAbs_FORWARD if forward else TopAbs_REVERSED))
        wire.Closed(True)
        BUILDER.Add(face, wire)

    def _pole(self, step: Pole, sheet: Sheet) -> TopoDS_Edge:
        shape = TopoDS_Edge()
        BUILDER.MakeEdge(shape)
        vertex = self.vertices[self.vertex(step.places[0])]
        (u, v), way = step.first, np.subtract(step.last, step.first)
        line = Geom2d_Line(gp_Pnt2d(u, v), gp_Dir2d(*way.tolist()))
        BUILDER.UpdateEdge(shape, line, sheet.geometry, HERE, EDGE)
        BUILDER.Add(shape, vertex.Oriented(TopAbs_FORWARD))
        BUILDER.Add(shape, vertex.Oriented(TopAbs_REVERSED))
        BUILDER.Range(shape, 0.0, float(np.linalg.norm(way)))
        BUILDER.Degenerated(shape, True)
        return shape

    def solids(self) -> TopoDS_Compound:
        """A compound of one solid, or of more if they lie apart.

        Raises:
            ValueError: the faces leave a gap.
        """
        open_ = [edge.middle for edge in self.edges if edge.uses % 2]
        if open_:
            x, y, z = (round(value / MM, 3) for value in open_[0])
            raise ValueError(f"faces leave a gap at ({x:g}, {y:g}, {z:g}) m; change a parameter a little")
        found = []
        for group in _connected([used for _, used in self.faces]):
            shell, solid = TopoDS_Shell(), TopoDS_Solid()
            BUILDER.MakeShell(shell)
            for k in group:
                BUILDER.Add(shell, self.faces[k][0])
            shell.Closed(True)
            BUILDER.MakeSolid(solid)
            BUILDER.Add(solid, shell)
            found.append(solid)
        return together(found)


def near(a: Point, b: Point) -> bool:
    """Whether two points are one."""
    return abs(a[0] - b[0]) < ONE and abs(a[1] - b[1]) < ONE and abs(a[2] - b[2]) < ONE


def _connected(sets: Sequence[list[int]]) -> list[list[int]]:
    """Indices of sets that hang together by what they share, each group in rising order."""
    owner: dict[int, int] = {}
    group = list(range(len(sets)))

    def root(k: int) -> int:
        while group[k] != k:
            k = group[k]
        return k

    for k, items in enumerate(sets):
        for item in items:
            one, other = sorted((root(k), root(owner.setdefault(item, k))))
            group[other] = one
    found: dict[int, list[int]] = {}
    for k in range(len(sets)):
        found.setdefault(root(k), []).append(k)
    return list(found.values())

"""Bodies of OpenCASCADE [mm] from the parts of a vault: profiles of lines, arcs and ellipses, extruded or turned."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from math import hypot, inf, pi

from OCP.BRepAlgoAPI import BRepAlgoAPI_BooleanOperation, BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakePrism, BRepPrimAPI_MakeRevol
from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Elips, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape
from OCP.TopTools import TopTools_ListOfShape

from families.outline import Bow, Point, half_outline
from families.parts import Ball, Barrel, Ceiling, Direction, Lid, Part, Piece, Turned
from families.profiles import Arc, Curve

MM = 1000.0  # parameters are in metres, B-Rep in millimetres
TOUCH = 1e-9  # [m], two ends nearer than that are one point


@dataclass(frozen=True)
class Extent:
    """Box |x| <= half_x, |y| <= half_y, low <= z <= high in which bodies are made [m].

    Walls of a piece that stand inside it end the piece; where none does, the box ends it.
    """

    half_x: float
    half_y: float
    low: float
    high: float

    @property
    def margin(self) -> float:
        """How far [m] a body that is cut by others is made beyond the box, so that no faces coincide."""
        return 0.1 * (self.half_x + self.half_y)

    def half(self, direction: Direction) -> float:
        """Half extent [m] along a direction."""
        return self.half_x if direction == "x" else self.half_y


def union(pieces: Iterable[Piece], extent: Extent) -> TopoDS_Shape:
    """The union of pieces within the extent (`Turned` parts may stand beyond it)."""
    return fuse([_piece(piece, extent) for piece in pieces])


def fuse(shapes: Sequence[TopoDS_Shape]) -> TopoDS_Shape:
    """Union of bodies; faces on one surface stay apart."""
    return _boolean(BRepAlgoAPI_Fuse(), shapes[:1], shapes[1:]) if len(shapes) > 1 else shapes[0]


def cut(shape: TopoDS_Shape, tool: TopoDS_Shape) -> TopoDS_Shape:
    """A body without another."""
    return _boolean(BRepAlgoAPI_Cut(), [shape], [tool])


def common(shape: TopoDS_Shape, tool: TopoDS_Shape) -> TopoDS_Shape:
    """What two bodies share."""
    return _boolean(BRepAlgoAPI_Common(), [shape], [tool])


def box(extent: Extent) -> TopoDS_Shape:
    """The extent as a body."""
    low = gp_Pnt(-MM * extent.half_x, -MM * extent.half_y, MM * extent.low)
    return BRepPrimAPI_MakeBox(low, gp_Pnt(MM * extent.half_x, MM * extent.half_y, MM * extent.high)).Shape()


def _boolean(
    operation: BRepAlgoAPI_BooleanOperation, shapes: Sequence[TopoDS_Shape], tools: Sequence[TopoDS_Shape]
) -> TopoDS_Shape:
    operation.SetArguments(_listed(shapes))
    operation.SetTools(_listed(tools))
    operation.Build()
    if not operation.IsDone():
        raise ValueError(f"{type(operation).__name__} failed on this vault; change a parameter a little")
    return operation.Shape()


def _listed(shapes: Sequence[TopoDS_Shape]) -> TopTools_ListOfShape:
    listed = TopTools_ListOfShape()
    for shape in shapes:
        listed.Append(shape)
    return listed


def _piece(piece: Piece, extent: Extent) -> TopoDS_Shape:
    parts = _relevant(_paired(piece.parts))
    walled = {part.across for part in parts if isinstance(part, Barrel)}
    shapes = [_body(part, extent, walled) for part in parts]
    if any(isinstance(part, Ball) for part in parts) or any(
        isinstance(part, Barrel) and part.crown_rise for part in parts
    ):
        shapes.append(box(extent))
    return reduce(common, shapes)


def _paired(parts: tuple[Part, ...]) -> list[Part]:
    """Two opposite coves about one axis are one barrel: one body less, and no face where they would touch."""
    found: list[Part] = []
    for part in parts:
        opposite = [k for k, other in enumerate(found) if _are_opposite(part, other)]
        if opposite:
            found[opposite[0]] = _two_sided(part)
        else:
            found.append(part)
    return found


def _are_opposite(one: Part, other: Part) -> bool:
    return (
        isinstance(one, Barrel)
        and isinstance(other, Barrel)
        and one.side * other.side == -1
        and _two_sided(one) == _two_sided(other)
    )


def _two_sided(cove: Part) -> Part:
    return replace(cove, side=0, names=("", "")) if isinstance(cove, Barrel) else cove


def _relevant(parts: list[Part]) -> list[Part]:
    """Without a ceiling that does no more than touch a crown."""
    crown = min((p.base + p.curve.rise for p in parts if isinstance(p, Barrel) and not p.side), default=inf)
    return [p for p in parts if not (isinstance(p, Ceiling) and p.z > crown - 1e-9)]


def _body(part: Part, extent: Extent, walled: set[Direction]) -> TopoDS_Shape:
    match part:
        case Barrel():
            return _barrel(part, extent, walled)
        case Ball():
            ball = Curve(part.radius, part.radius, 0.0, (Arc(0.0, 0.0, part.radius),))
            return _turned(ball, part.z, extent.low, quarters=len(part.names) == 4)
        case Turned():
            return _turned(part.curve, part.base, part.foot, quarters=False)
        case Ceiling() | Lid():
            beyond = extent.margin
            return box(Extent(extent.half_x + beyond, extent.half_y + beyond, extent.low - beyond, part.z))


def _barrel(part: Barrel, extent: Extent, walled: set[Direction]) -> TopoDS_Shape:
    along: Direction = "y" if part.across == "x" else "x"
    sloping = part.crown_rise != 0.0
    half = extent.half(along) + (extent.margin if along in walled or sloping else 0.0)
    drop = part.crown_rise / part.half_length * half
    low = extent.low - part.base - (part.crown_rise + extent.margin if sloping else 0.0)
    outline = _outline(part, extent, low)

    def run(start: float, end: float, fall: float) -> TopoDS_Shape:
        face = _face(outline, _Plane(part.across, part.centre, start, part.base + part.crown_rise))
        x, y = (0.0, end - start) if part.across == "x" else (end - start, 0.0)
        return BRepPrimAPI_MakePrism(face, gp_Vec(MM * x, MM * y, -MM * fall)).Shape()

    if sloping or part.names[0] != part.names[1]:
        return fuse([run(0.0, -half, drop), run(0.0, half, drop)])
    return run(-half, half, 0.0)


def _outline(part: Barrel, extent: Extent, low: float) -> list[Point | Bow]:
    """Corners and arcs, counterclockwise from the lower left."""
    walls = {side: min(part.curve.half_span, extent.half(part.across) - side * part.centre) for side in (-1, 1)}
    beyond = 2 * extent.half(part.across) + extent.margin
    high = extent.high + extent.margin - part.base
    path: list[Point | Bow] = []
    if part.side == -1:
        path += [(beyond, low), (beyond, high), (0.0, high)]
    else:
        bows = half_outline(part.curve, walls[1], low)
        path += [(bows[0].at(bows[0].start)[0], low), *bows]
    if part.side == 1:
        path += [(0.0, high), (-beyond, high), (-beyond, low)]
    else:
        bows = half_outline(part.curve, walls[-1], low)
        path += [*(bow.mirrored() for bow in reversed(bows)), (-bows[0].at(bows[0].start)[0], low)]
    return path


def _turned(curve: Curve, base: float, foot: float, quarters: bool) -> TopoDS_Shape:
    """A curve turned about z, down to `foot`; in four quarters of which each keeps its own faces, or whole."""
    low = foot - base
    bows = half_outline(curve, curve.half_span, low)
    outline: list[Point | Bow] = [(0.0, low), (bows[0].at(bows[0].start)[0], low), *bows]
    face, axis = _face(outline, _Plane("x", 0.0, 0.0, base)), gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    if not quarters:
        return BRepPrimAPI_MakeRevol(face, axis).Shape()
    quarter, turn = BRepPrimAPI_MakeRevol(face, axis, pi / 2).Shape(), gp_Trsf()
    shapes = []
    for k in range(4):
        turn.SetRotation(axis, k * pi / 2)
        shapes.append(quarter.Moved(TopLoc_Location(turn)))
    return fuse(shapes)


@dataclass(frozen=True)
class _Plane:
    """Vertical plane in which an outline is drawn: u along `across` from `centre`, at a place along the other axis."""

    across: Direction
    centre: float
    along: float
    base: float

    def point(self, u: float, z: float) -> gp_Pnt:
        across, along = MM * (self.centre + u), MM * self.along
        x, y = (across, along) if self.across == "x" else (along, across)
        return gp_Pnt(x, y, MM * (self.base + z))

    def edge(self, bow: Bow) -> TopoDS_Edge:
        u, up = (gp_Dir(1, 0, 0) if self.across == "x" else gp_Dir(0, 1, 0)), gp_Dir(0, 0, 1)
        normal, centre = u.Crossed(up), self.point(bow.u, bow.z)
        if bow.a == bow.b:
            circle = gp_Circ(gp_Ax2(centre, normal, u), MM * bow.a)
            return BRepBuilderAPI_MakeEdge(circle, bow.start, bow.end).Edge()
        if bow.a > bow.b:
            ellipse = gp_Elips(gp_Ax2(centre, normal, u), MM * bow.a, MM * bow.b)
            return BRepBuilderAPI_MakeEdge(ellipse, bow.start, bow.end).Edge()
        # OpenCASCADE counts from the long axis, here the upright one.
        ellipse = gp_Elips(gp_Ax2(centre, normal, up), MM * bow.b, MM * bow.a)
        return BRepBuilderAPI_MakeEdge(ellipse, bow.start - pi / 2, bow.end - pi / 2).Edge()


def _face(outline: Sequence[Point | Bow], plane: _Plane) -> TopoDS_Face:
    """Planar face within corners and arcs; straight lines join what does not touch."""
    wire = BRepBuilderAPI_MakeWire()
    ends = [(step.at(step.start), step.at(step.end)) if isinstance(step, Bow) else (step, step) for step in outline]
    for k, step in enumerate(outline):
        if isinstance(step, Bow):
            wire.Add(plane.edge(step))
        here, there = ends[k][1], ends[(k + 1) % len(ends)][0]
        if hypot(there[0] - here[0], there[1] - here[1]) > TOUCH:
            wire.Add(BRepBuilderAPI_MakeEdge(plane.point(*here), plane.point(*there)).Edge())
    return BRepBuilderAPI_MakeFace(wire.Wire(), True).Face()

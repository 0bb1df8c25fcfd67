"""Bodies of OpenCASCADE [mm] from the parts of a vault: profiles of lines, arcs and ellipses, extruded or turned."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, reduce
from math import pi

from OCP.BRepAlgoAPI import BRepAlgoAPI_BooleanOperation, BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakePrism, BRepPrimAPI_MakeRevol
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.TopTools import TopTools_ListOfShape

from families.cells import BEYOND, Cell, View
from families.domical import domical
from families.outline import Bow, Point, half_outline
from families.parts import Ball, Barrel, Ceiling, Lid, Part, Piece, Turned
from families.profiles import Arc, Curve
from families.sketch import MM, TOUCH, Upright, sketch
from families.trust import has_ellipse, shows

CORNERS = [(True, True), (False, True), (False, False), (True, False)]  # x > 0 and y > 0, counterclockwise
SLACK = 1e-5  # of a volume
ACCURACY = 1e-7  # of a volume: not told it, OpenCASCADE misses 1e-5 where two arches are nearly equally high
FUZZY = (1e-3, 1e-2, 1e-4, 1e-1)  # [mm], tried in turn: surfaces tangent at a corner of a cell meet none too sharply


def union(pieces: tuple[Piece, ...], cell: Cell) -> TopoDS_Shape | None:
    """The union of pieces within a cell (`Turned` parts may stand beyond it); None if there is nothing.

    Raises:
        ValueError: OpenCASCADE cannot intersect the bodies.
    """
    shape = _union(pieces, cell)
    if shape is not None and has_ellipse(pieces) and not shows(shape, pieces, cell):
        raise ValueError("OpenCASCADE cannot intersect the ellipses of this vault; change a parameter a little")
    return shape


def _union(pieces: tuple[Piece, ...], cell: Cell) -> TopoDS_Shape | None:
    shapes = [shape for piece in pieces if (shape := _piece(piece, cell)) is not None]
    if len(shapes) > 1:
        sizes = [volume(shape) for shape in shapes]
        bounds = (1 - SLACK) * max(sizes), (1 + SLACK) * sum(sizes)
        return _boolean(BRepAlgoAPI_Fuse, shapes[:1], shapes[1:], lambda found: bounds[0] < found < bounds[1])
    return shapes[0] if shapes else None


def cut(shape: TopoDS_Shape, tool: TopoDS_Shape, left: float) -> TopoDS_Shape:
    """A body without another, of which a volume `left` [mm³] should stay."""
    size = volume(shape)
    return _boolean(BRepAlgoAPI_Cut, [shape], [tool], lambda found: abs(found - left) < SLACK * size)


def common(shape: TopoDS_Shape, tool: TopoDS_Shape) -> TopoDS_Shape:
    """What two bodies share."""
    most = min(volume(shape), volume(tool))
    return _boolean(BRepAlgoAPI_Common, [shape], [tool], lambda found: found < (1 + SLACK) * most)


@lru_cache(maxsize=32)  # each body is weighed as a result, and again as a part of the next
def volume(shape: TopoDS_Shape) -> float:
    """Volume [mm³]."""
    sums = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, sums, ACCURACY)
    return float(sums.Mass())


def _boolean(
    operation: type[BRepAlgoAPI_BooleanOperation],
    shapes: Sequence[TopoDS_Shape],
    tools: Sequence[TopoDS_Shape],
    may_be: Callable[[float], bool],
) -> TopoDS_Shape:
    """The result with the first of the tolerances that gives a sound one; some fail without saying so."""
    for tolerance in FUZZY:
        step = operation()
        step.SetArguments(_listed(shapes))
        step.SetTools(_listed(tools))
        step.SetFuzzyValue(tolerance)
        step.Build()
        if step.IsDone() and is_sound(step.Shape()) and may_be(volume(step.Shape())):
            return step.Shape()
    raise ValueError(f"OpenCASCADE cannot do {operation.__name__} on this vault; change a parameter a little")


def is_sound(shape: TopoDS_Shape) -> bool:
    """Whether a shape has a face and OpenCASCADE finds no fault in it."""
    return bool(TopExp_Explorer(shape, TopAbs_FACE).More() and BRepCheck_Analyzer(shape).IsValid())


def _listed(shapes: Sequence[TopoDS_Shape]) -> TopTools_ListOfShape:
    listed = TopTools_ListOfShape()
    for shape in shapes:
        listed.Append(shape)
    return listed


def _piece(piece: Piece, cell: Cell) -> TopoDS_Shape | None:
    views = [View(part, cell) for part in piece.parts if isinstance(part, Barrel)]
    if any(view.outside for view in views):
        return None
    views = [view for view in views if view.bounds]
    # Where walls reach the ground, nothing else needs to end there.
    reach = replace(cell, low=cell.low - BEYOND * (cell.high - cell.low)) if views else cell
    for view in views:
        reach = view.widened(reach)
    shapes = [_barrel(view, replace(reach, low=cell.low)) for view in views]
    shapes += [_body(part, reach) for part in piece.parts if not isinstance(part, Barrel)]
    if any(isinstance(part, Ball) for part in piece.parts):
        shapes.append(box(cell))
    return reduce(common, shapes)


def _barrel(view: View, reach: Cell) -> TopoDS_Shape:
    part, (start, end) = view.part, reach.side("y" if view.part.across == "x" else "x")
    low = reach.low - part.base
    bows = half_outline(part.curve, view.near, view.far, low - part.crown_rise)
    if part.crown_rise:
        drop = min(0.0, part.lift(start), part.lift(end))  # beyond the vault its axis falls below the springing
        return domical(part, view.sign, bows, view.near, reach.low + drop, (start, end))
    outline: list[Point | Bow] = [(view.near, low), (bows[0].at(bows[0].start)[0], low), *bows]
    if view.near > TOUCH:
        outline.append((view.near, bows[-1].at(bows[-1].end)[1]))
    face = sketch(outline, Upright(part.across, part.centre, start, part.base, view.sign))
    vector = (0.0, end - start, 0.0) if part.across == "x" else (end - start, 0.0, 0.0)
    return BRepPrimAPI_MakePrism(face, gp_Vec(*vector).Multiplied(MM)).Shape()


def _body(part: Part, cell: Cell) -> TopoDS_Shape:
    match part:
        case Ball():
            ball = Curve(part.radius, part.radius, 0.0, (Arc(0.0, 0.0, part.radius),))
            return _turned(ball, part.z, cell.low, cell)
        case Turned():
            return _turned(part.curve, part.base, part.foot, cell)
        case Ceiling() | Lid():
            return box(replace(cell, high=part.z))
    raise TypeError(f"{type(part).__name__} has no body of its own")


def box(cell: Cell) -> TopoDS_Shape:
    """The cell as a body."""
    corners = zip(cell.x, cell.y, (cell.low, cell.high), strict=True)
    return BRepPrimAPI_MakeBox(*(gp_Pnt(*(MM * value for value in corner)) for corner in corners)).Shape()


def _turned(curve: Curve, base: float, foot: float, cell: Cell) -> TopoDS_Shape:
    """A curve turned about z, down to `foot`: a whole turn, or the quarter in which the cell lies."""
    low = foot - base
    bows = half_outline(curve, 0.0, curve.half_span, low)
    wall = bows[0].at(bows[0].start)[0]
    springing = [(wall, 0.0)] if low < -TOUCH else []  # where the drum ends, though a stilt goes on
    outline: list[Point | Bow] = [(0.0, low), (wall, low), *springing, *bows]
    face, axis = sketch(outline, Upright("x", 0.0, 0.0, base, 1)), gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))
    corner = sum(cell.x) > 0, sum(cell.y) > 0
    if cell.x[0] < 0 < cell.x[1]:
        return BRepPrimAPI_MakeRevol(face, axis).Shape()
    quarter, turn = BRepPrimAPI_MakeRevol(face, axis, pi / 2).Shape(), gp_Trsf()
    turn.SetRotation(axis, pi / 2 * CORNERS.index(corner))
    return quarter.Moved(TopLoc_Location(turn))

"""Cells that hold the same bodies, moved along or turned half round, are made once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from math import pi

from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

from families.cells import Cell, View
from families.parts import Barrel, Ceiling, Part, Piece
from families.sketch import MM

Scene = tuple[tuple[Piece, ...], Cell]  # bodies, and the box in which they are to be made
DECIMALS = 9  # of a metre, to which alike scenes agree


def made(
    jobs: Iterable[tuple[Scene, ...]], make: Callable[[tuple[Scene, ...]], TopoDS_Shape | None]
) -> list[TopoDS_Shape]:
    """What `make` makes of each job, in its place; jobs that are alike share their shape."""
    done: dict[tuple[Scene, ...], TopoDS_Shape | None] = {}
    shapes = []
    for job in jobs:
        x, y = _middle(job)
        turned = {sign: tuple(_moved(scene, x, y, sign) for scene in job) for sign in (1, -1)}
        sign = next((s for s in turned if turned[s] in done), 1)
        if turned[sign] not in done:
            done[turned[sign]] = make(turned[sign])
        if (shape := done[turned[sign]]) is not None:
            shapes.append(_placed(shape, x, y, sign))
    return shapes


def _middle(job: tuple[Scene, ...]) -> tuple[float, float]:
    """The middle of a job's first cell [m], or of the plan where something belongs to that."""
    parts = [part for pieces, _ in job for piece in pieces for part in piece.parts]
    if all(isinstance(part, Ceiling) or (isinstance(part, Barrel) and not part.crown_rise) for part in parts):
        return sum(job[0][1].x) / 2, sum(job[0][1].y) / 2
    return 0.0, 0.0


def _moved(scene: Scene, x: float, y: float, sign: int) -> Scene:
    """A scene about another origin, turned half round if `sign` is -1, without what does not show in its cell."""
    pieces, cell = scene
    kept = []
    for piece in pieces:
        views = {part: View(part, cell) for part in piece.parts if isinstance(part, Barrel)}
        if not any(view.outside for view in views.values()):
            parts = [part for part in piece.parts if not isinstance(part, Barrel) or views[part].bounds]
            kept.append(Piece(tuple(_part(part, x, y, sign) for part in parts)))
    return tuple(kept), replace(cell, x=_range(cell.x, x, sign), y=_range(cell.y, y, sign))


def _part(part: Part, x: float, y: float, sign: int) -> Part:
    if not isinstance(part, Barrel):
        return part
    centre = _place(part.centre, x if part.across == "x" else y, sign)
    return replace(part, centre=centre, side=sign * part.side, names=("", ""))


def _range(side: tuple[float, float], middle: float, sign: int) -> tuple[float, float]:
    low, high = sorted(_place(place, middle, sign) for place in side)
    return low, high


def _place(place: float, middle: float, sign: int) -> float:
    return sign * (round(place - middle, DECIMALS) if middle else place)


def _placed(shape: TopoDS_Shape, x: float, y: float, sign: int) -> TopoDS_Shape:
    turn, shift = gp_Trsf(), gp_Trsf()
    if sign == -1:
        turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), pi)
    shift.SetTranslation(gp_Vec(MM * x, MM * y, 0))
    return shape.Moved(TopLoc_Location(shift.Multiplied(turn)))

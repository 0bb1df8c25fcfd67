"""A body [mm] between two surfaces over a region of the plan: their roofs, the walls at which they step, and its sides."""

from __future__ import annotations

from collections.abc import Iterable
from math import hypot

import numpy as np
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Shape

from families.declaration.pieces import Ball, BarrelPart, Turned
from families.solid.envelope import Skin
from families.solid.face_net import Net
from families.solid.faces import Faces
from families.solid.occ.shapes import is_sound, together
from families.solid.plan_cells import SAME_PLACE, Cell, Cut, Ground
from families.solid.roofs import Plane, Void

Array = NDArray[np.float64]
AROUND = 1.1  # of its reach, the square in which a plan with round sides is laid


def body(upper: Void, lower: Void | None) -> TopoDS_Shape:
    """The solid under the surface of `upper`, and above that of `lower` or, without one, the ground.

    Raises:
        ValueError: its faces do not close, or OpenCASCADE finds a fault in it.
    """
    found = Between(upper, lower)
    found.close()
    shape = found.net.solids()
    if not is_sound(shape):
        raise ValueError("OpenCASCADE finds a fault in the body of this vault; change a parameter a little")
    return shape


def surface(upper: Void) -> TopoDS_Shape:
    """The faces of a void but for the ground and the plan's sides: roofs, and walls that stand within or on the plan."""
    found = Between(upper, None)
    found.show()
    return together(face for face, _ in found.net.faces)


class Between:
    """A body between two surfaces, laid cell by cell."""

    def __init__(self, upper: Void, lower: Void | None) -> None:
        self.upper, self.net, self.ground = upper, Net(), _ground(upper)
        self.top, self.bottom = Skin(self.ground), Skin(self.ground)
        _cut(self.ground, upper.cuts())
        kept: list[Cell] = []
        for cell in self.ground.cells:
            if pieces := upper.over(*self.ground.inner(cell)):
                self.top.lay(cell, pieces)
                kept.append(cell)
        self.ground.cells = kept
        if lower is not None:
            _cut(self.ground, lower.cuts())
        floors: dict[float, Plane] = {}
        for cell in self.ground.cells:
            place = self.ground.inner(cell)
            foot = upper.foot(*place)
            above = [] if lower is None else lower.over(*place)
            self.bottom.lay(cell, [*above, [floors.setdefault(foot, Plane(foot))]])

    def close(self) -> None:
        """All faces."""
        Faces(self.net, self.ground, self.top, self.bottom).close()

    def show(self) -> None:
        """The roofs and inner walls alone."""
        Faces(self.net, self.ground, self.top, self.bottom, Void(self.upper.pieces, None)).show()


def _ground(upper: Void) -> Ground:
    """The plan as one cell; a square around it where it has round sides or bodies that stand free of it."""
    plan = upper.plan
    assert plan is not None
    free = [piece for piece in upper.pieces if piece.foot is not None]
    if not free and all(side.centre is None for side in plan.sides):
        return Ground.polygon([side.start for side in plan.sides])
    reach = max(float(np.abs(plan.outline()).max()), *(_reach(part) for piece in free for part in piece.parts), 0.0)
    size = AROUND * reach
    ground = Ground.polygon([(-size, -size), (size, -size), (size, size), (-size, size)])
    cuts = []
    for side in plan.sides:
        if side.centre is None:
            cuts.append(Cut(side.normal, side.offset))
        else:
            (x, y) = side.centre
            cuts += [Cut((1.0, 0.0), x), Cut((0.0, 1.0), y), Cut(side.centre, radius=side.radius)]
    rounds = [part for piece in upper.pieces for part in piece.parts if isinstance(part, Ball | Turned)]
    for side in plan.sides:
        if side.centre is None:
            a, b = side.normal
            for centre in {part.centre for part in rounds}:
                cuts.append(Cut((-b, a), -b * centre[0] + a * centre[1]))
    _cut(ground, cuts)
    return ground


def _reach(part: object) -> float:
    if isinstance(part, Turned):
        return hypot(*part.centre) + part.radius + part.curve.half_span
    if isinstance(part, BarrelPart):
        return hypot(*part.origin) + 2 * part.curve.half_span
    return 0.0


def _cut(ground: Ground, cuts: Iterable[Cut]) -> None:
    """Cut a ground by lines, then by circles, by each once."""
    known: set[tuple[int, ...]] = set()
    ordered = sorted(cuts, key=lambda cut: cut.radius > 0)
    for cut in ordered:
        if cut.radius and cut.radius < SAME_PLACE:
            continue
        a, b = cut.normal
        sign = -1 if not cut.radius and (a < -1e-9 or (abs(a) <= 1e-9 and b < 0)) else 1
        key = tuple(round(value / SAME_PLACE) for value in (sign * a, sign * b, sign * cut.offset, cut.radius))
        if key not in known:
            known.add(key)
            ground.cut(cut)

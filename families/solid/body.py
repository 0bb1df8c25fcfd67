"""A body [mm] between two surfaces over a plan: their roofs, the walls at which they step, and its sides."""

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
    net, faces = _laid(upper, lower)
    faces.close()
    shape = net.solids()
    if not is_sound(shape):
        raise ValueError("OpenCASCADE finds a fault in the body of this vault; change a parameter a little")
    return shape


def surface(upper: Void) -> TopoDS_Shape:
    """The faces of a void but for the ground and the plan's sides: roofs, and walls within or on the plan."""
    net, faces = _laid(upper, None)
    faces.show()
    return together(face for face, _ in net.faces)


def _laid(upper: Void, lower: Void | None) -> tuple[Net, Faces]:
    """The regions of both surfaces, and an empty net for their faces."""
    ground = _ground(upper)
    top, bottom = Skin(ground), Skin(ground)
    _cut(ground, upper.cuts())
    kept: list[Cell] = []
    for cell in ground.cells:
        if pieces := upper.over(*ground.inner(cell)):
            top.lay(cell, pieces)
            kept.append(cell)
    ground.cells = kept
    if lower is not None:
        _cut(ground, lower.cuts())
    floors: dict[float, Plane] = {}
    for cell in ground.cells:
        place = ground.inner(cell)
        foot = upper.foot(*place)
        above = [] if lower is None else lower.over(*place)
        if not any(all(roof.lowest >= foot for roof in piece) for piece in above):
            above.append([floors.setdefault(foot, Plane(foot))])
        bottom.lay(cell, above)
    net = Net()
    return net, Faces(net, ground, top, bottom, beyond=Void(upper.pieces, None) if lower is None else None)


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

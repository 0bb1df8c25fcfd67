"""A body [mm] between two surfaces over a plan: their roofs, the walls at which they step, and its sides."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import hypot

import numpy as np
from numpy.typing import NDArray
from OCP.TopoDS import TopoDS_Shape

from families.declaration.pieces import BarrelPart, Turned
from families.declaration.plan import Plan
from families.solid.bodies import Void
from families.solid.envelope import Skin
from families.solid.face_net import Net
from families.solid.faces import Faces
from families.solid.occ.shapes import is_sound, together
from families.solid.plan_cells import SAME_PLACE, Cell, Cut, Ground
from families.solid.roofs import Plane, Roof

Array = NDArray[np.float64]
AROUND = 1.1  # of its reach, the square in which a plan with round sides is laid


def body(upper: Void, lower: Void | None) -> TopoDS_Shape:
    """The solid under the surface of `upper`, and above that of `lower` or, without one, the ground.

    `lower` goes on beyond its plan.

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
    kept: list[tuple[Cell, bool]] = []
    floors = _Floors()
    for cell, inside in _cells(ground, upper.plan):
        if pieces := upper.over(*cell.middle, inside=inside):
            floor = floors.under(pieces, upper.foot(inside=inside))
            top.lay(cell, [*pieces, *floor])
            if floor and top.roofs[top.regions[-1].roof] is floor[0][0]:
                top.regions.pop()  # a sphere that ends above the corner of a plan
            else:
                kept.append((cell, inside))
    ground.cells = [cell for cell, _ in kept]
    if lower is not None:
        _cut(ground, lower.cuts())
        kept = list(_cells(ground, upper.plan))
    for cell, inside in kept:
        above = [] if lower is None else lower.over(*cell.middle)
        bottom.lay(cell, [*above, *floors.under(above, upper.foot(inside=inside))])
    net = Net()
    return net, Faces(net, ground, top, bottom, None if lower is not None else upper)


def _cells(ground: Ground, plan: Plan) -> Iterator[tuple[Cell, bool]]:
    """The cells, and whether they lie within a plan."""
    return zip(ground.cells, plan.holds(np.array([cell.middle for cell in ground.cells])).tolist(), strict=True)


class _Floors:
    """The floors of a body, one a height."""

    def __init__(self) -> None:
        self.known: dict[float, Plane] = {}

    def under(self, pieces: list[list[Roof]], foot: float) -> list[list[Roof]]:
        """The floor under pieces, as one more of them; nothing where one of them is never lower."""
        if any(all(roof.lowest >= foot for roof in piece) for piece in pieces):
            return []
        return [[self.known.setdefault(foot, Plane(foot))]]


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
    _cut(ground, cuts)
    if not free:
        ground.cells = [cell for cell, inside in _cells(ground, plan) if inside]
    return ground


def _reach(part: object) -> float:
    if isinstance(part, Turned):
        return hypot(*part.centre) + part.radius + part.curve.half_span
    if isinstance(part, BarrelPart):
        return hypot(*part.origin) + 2 * part.curve.half_span
    return 0.0


def _cut(ground: Ground, cuts: Iterable[Cut]) -> None:
    """Cut a ground by lines, then by circles, by each once."""
    ordered = sorted(cuts, key=lambda cut: cut.radius > 0)
    known: set[tuple[int, ...]] = set()

    def cut_once(cut: Cut) -> None:
        if (key := cut.key) not in known:
            known.add(key)
            ground.cut(cut)

    for cut in ordered:
        if not cut.radius:
            cut_once(cut)
        elif cut.radius > SAME_PLACE and cut.key not in known and ground.meets(cut):
            # A line may cross a circle twice, but not on either side of where it is nearest to its centre.
            (x, y) = cut.normal
            for line in (Cut((1.0, 0.0), x), Cut((0.0, 1.0), y), *ground.feet(cut.normal)):
                cut_once(line)
            cut_once(cut)

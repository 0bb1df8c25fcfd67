"""Upright surfaces over ways of the plan, and the steps that bound the parts of them that a body shows."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from math import pi
from typing import NamedTuple

from families.declaration.units import MM
from families.solid.boundary import Loop, Step
from families.solid.curves import Point, Straight
from families.solid.face_net import ONE
from families.solid.plan_cells import SAME_PLACE, Way
from families.solid.surfaces import Flat, Sheet
from families.solid.turned_surfaces import Drum


class Wall(NamedTuple):
    """An upright surface, whether the body lies where its normal points, and whether it is of the void's own.

    `above` if it is the part above a springing where the wall below has another name.
    """

    sheet: Sheet
    flipped: bool
    shown: bool
    above: bool = False


@dataclass
class Walls:
    """Steps around the parts of each wall, and one surface for all ways that run along it."""

    loops: dict[Wall, Loop] = field(default_factory=lambda: defaultdict(list))
    _sheets: dict[tuple[float, ...], Sheet] = field(default_factory=dict)

    def bound(self, wall: Wall, lower: Step, upper: Step, turned: bool) -> None:
        """Add the steps around a part of a wall; its normal is to the right of the way, or to the left if turned."""
        loop = [lower]
        if upper.places[2][2] - lower.places[2][2] > ONE:
            loop.append(_plumb(lower.places[2], upper.places[2]))
        loop.append(upper.reversed)
        if upper.places[0][2] - lower.places[0][2] > ONE:
            loop.append(_plumb(upper.places[0], lower.places[0]))
        self.loops[wall] += [step.reversed for step in loop[::-1]] if turned else loop

    def over(self, way: Way, t: float) -> tuple[Sheet, bool]:
        """The upright surface over a way where its parameter is t, and whether its normal points to the left."""
        if way.centre is not None:
            quarter = (way.angle + t * way.sweep) // (pi / 2)
            (x, y), radius = way.centre, way.radius
            round_key = (x, y, round(radius, 6), quarter % 4)
            about = (quarter + 0.5) * pi / 2
            sheet = self._sheets.setdefault(round_key, Drum((MM * x, MM * y), MM * radius, about))
            return sheet, way.sweep < 0
        nx, ny = way.right(*way.start)
        turned = nx < -SAME_PLACE or (abs(nx) <= SAME_PLACE and ny < 0)
        if turned:
            nx, ny = -nx, -ny
        offset = nx * way.start[0] + ny * way.start[1]
        key = (round(nx, 6), round(ny, 6), round(offset, 6))
        return self._sheets.setdefault(key, Flat.upright((nx, ny), MM * offset)), turned


def _plumb(start: Point, end: Point) -> Step:
    x, y, z = start
    return Step(Straight((0.0, 0.0, 1.0), (x, y, 0.0)), z, end[2])

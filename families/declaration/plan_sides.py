"""The sides of plans: straight ones and arcs, what they are once moved, and those of polygons and circles."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import atan2, hypot, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from families.declaration.once import Once

Array = NDArray[np.float64]
Vector = tuple[float, float]


@dataclass(frozen=True)
class Side:
    """One side of a plan from `start` to `end` [m], the plan on its left.

    Straight, or an arc about `centre`, counterclockwise where the plan is within its circle (`inside`), else clockwise.
    `on_wall`: the stone may stand on the wall beyond, as the extrados of a barrel does.
    """

    start: Vector
    end: Vector
    on_wall: bool = False
    centre: Vector | None = None
    inside: bool = True

    @property
    def radius(self) -> float:
        """Radius of an arc [m]."""
        assert self.centre is not None
        return hypot(self.start[0] - self.centre[0], self.start[1] - self.centre[1])

    @Once
    def normal(self) -> Vector:
        """Unit normal of a straight side, out of the plan."""
        x, y = self.end[0] - self.start[0], self.end[1] - self.start[1]
        size = hypot(x, y)
        return y / size, -x / size

    @Once
    def offset(self) -> float:
        """Distance [m] of a straight side from the origin, along its normal."""
        x, y = self.normal
        return x * (self.start[0] + self.end[0]) / 2 + y * (self.start[1] + self.end[1]) / 2

    @property
    def sweep(self) -> float:
        """Angle [rad] of an arc from start to end, positive counterclockwise."""
        assert self.centre is not None
        a, b = self.centre
        turn = atan2(self.end[1] - b, self.end[0] - a) - atan2(self.start[1] - b, self.start[0] - a)
        return turn % (2 * pi) if self.inside else -(-turn % (2 * pi))

    @property
    def outermost(self) -> list[Vector]:
        """Its ends, and where else it may reach farthest along x and y [m]."""
        found = [self.start, self.end]
        if self.centre is not None and self.inside:
            (a, b), r, (x, y) = self.centre, self.radius, self.start
            dx, dy = self.end[0] - x, self.end[1] - y
            axes = ((a + r, b), (a, b + r), (a - r, b), (a, b - r))
            found += [(p, q) for p, q in axes if dx * (q - y) < dy * (p - x)]  # right of the chord, as the arc is
        return found

    def points(self, count: int) -> Array:
        """`count` + 1 points (n, 2) [m] at even distances from start to end."""
        share = np.linspace(0, 1, count + 1)[:, None]
        if self.centre is None:
            return np.array(self.start) * (1 - share) + np.array(self.end) * share
        (a, b), (x, y) = self.centre, self.start
        angle = atan2(y - b, x - a) + self.sweep * share
        found: Array = np.array(self.centre) + self.radius * np.hstack([np.cos(angle), np.sin(angle)])
        found[0], found[-1] = self.start, self.end
        return found


@dataclass(frozen=True)
class MovedSide:
    """A side of a plan that was moved: a line by normal and offset, or a circle."""

    side: Side
    offset: float
    radius: float

    @staticmethod
    def of(side: Side, by: float) -> MovedSide:
        """A side, moved outwards [m]."""
        if side.centre is None:
            return MovedSide(side, side.offset + by, 0.0)
        return MovedSide(side, 0.0, side.radius + (by if side.inside else -by))

    def meets(self, other: MovedSide, near: Vector) -> Vector:
        """Where two meet, nearest to where they met before they were moved."""
        a, b = (self, other) if self.side.centre is None else (other, self)
        if a.side.centre is not None:  # two arcs of one circle
            assert b.side.centre is not None
            x, y = near[0] - b.side.centre[0], near[1] - b.side.centre[1]
            share = other.radius / hypot(x, y)
            return b.side.centre[0] + share * x, b.side.centre[1] + share * y
        (p, q) = a.side.normal
        if b.side.centre is None:
            (r, s) = b.side.normal
            det = p * s - q * r
            return (s * a.offset - q * b.offset) / det, (p * b.offset - r * a.offset) / det
        cx, cy = b.side.centre
        gap = a.offset - p * cx - q * cy
        reach = sqrt(b.radius**2 - gap**2)
        ends = [(cx + gap * p - sign * reach * q, cy + gap * q + sign * reach * p) for sign in (-1, 1)]
        return min(ends, key=lambda end: hypot(end[0] - near[0], end[1] - near[1]))


def straight_sides(corners: tuple[Vector, ...], on_wall: tuple[bool, ...]) -> tuple[Side, ...]:
    """From each corner to the next."""
    ends = (*corners[1:], corners[0])
    return tuple(Side(*side) for side in zip(corners, ends, on_wall, strict=True))


def circle_sides(radius: float, on_wall: bool, inside: bool) -> tuple[Side, ...]:
    """Four quarters."""
    ends = [(radius, 0.0), (0.0, radius), (-radius, 0.0), (0.0, -radius), (radius, 0.0)]
    if not inside:
        ends = ends[::-1]
    return tuple(Side(a, b, on_wall, (0.0, 0.0), inside) for a, b in pairwise(ends))

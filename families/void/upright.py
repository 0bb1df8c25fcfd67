"""A vault cut by any upright plane: the room's outlines, found on the numeric surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, cos, hypot, sin, sqrt
from typing import Self

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan
from families.declaration.plan_sides import Side, Vector
from families.declaration.vault import Vault
from families.void.columns import heights

Floats = NDArray[np.float64]

OUTLINE_STEPS = 241  # an odd number, so that one of them is at the crown
INSIDE = 1 - 1e-9
ON_PLAN = 1e-9  # [m]
Outline = tuple[Floats, NDArray[np.uint16]]


@dataclass(frozen=True)
class Upright:
    """An upright plane through a place in plan [m], drawn from left to right along a unit vector `direction`.

    Its points are (u, z) [m]: u from the place along the direction, z as in space.
    """

    origin: Vector
    direction: Vector

    @classmethod
    def towards(cls, x: float, y: float, azimuth: float) -> Self:
        """Through a place [m], its direction turned by an angle from the x axis, counterclockwise [rad]."""
        return cls((x, y), (cos(azimuth), sin(azimuth)))

    @classmethod
    def through(cls, start: Vector, end: Vector) -> Self:
        """From one place towards another [m]; u is 0 at the first."""
        x, y = end[0] - start[0], end[1] - start[1]
        size = hypot(x, y)
        return cls(start, (x / size, y / size))

    @classmethod
    def along_axis(cls, across: int, at: float) -> Self:
        """Drawn along an axis (0 or 1), where the other coordinate is `at` [m]; u is that axis' coordinate."""
        return cls((0.0, at), (1.0, 0.0)) if across == 0 else cls((at, 0.0), (0.0, 1.0))

    @property
    def azimuth(self) -> float:
        """Of its direction from the x axis [rad]."""
        return atan2(self.direction[1], self.direction[0])

    @property
    def normal(self) -> Vector:
        """Unit vector across it in plan, to the left of the direction."""
        return -self.direction[1], self.direction[0]

    def along(self, points: Floats) -> Floats:
        """Where points (n, 2 or 3) are along it, u (n,) [m]."""
        out: Floats = (points[:, :2] - self.origin) @ np.array(self.direction)
        return out

    def off(self, points: Floats) -> Floats:
        """Distances (n,) [m] of points (n, 2 or 3) from the plane, positive along its normal."""
        out: Floats = (points[:, :2] - self.origin) @ np.array(self.normal)
        return out

    def drawn(self, points: Floats) -> Floats:
        """Points (n, 3) as the section shows them, (n, 2)."""
        return np.column_stack([self.along(points), points[:, 2]])

    def places(self, u: Floats) -> Floats:
        """Places in plan (n, 2) of u (n,)."""
        out: Floats = np.array(self.origin) + u[:, None] * np.array(self.direction)
        return out

    def placed(self, drawn: Floats) -> Floats:
        """Points (n, 3) in space of (u, z) (n, 2)."""
        return np.column_stack([self.places(drawn[:, 0]), drawn[:, 1]])

    def directions(self, drawn: Floats) -> Floats:
        """Directions (n, 3) in space of those within the plane (n, 2)."""
        return np.column_stack([drawn[:, :1] * np.array(self.direction), drawn[:, 1]])


def chords(plan: Plan, plane: Upright) -> list[tuple[float, float]]:
    """Between which u [m] a plane lies over a plan, in their order."""
    met = sorted(value for side in plan.sides for value in _crossings(side, plane))
    found: list[tuple[float, float]] = []
    for low, high in pairwise(met):
        middle = plane.places(np.array([(low + high) / 2]))
        if high - low < ON_PLAN or plan.distance(middle)[0] > ON_PLAN:
            continue
        joins = found and low - found[-1][1] < ON_PLAN
        found.append((found.pop()[0] if joins else low, high))
    return found


def _crossings(side: Side, plane: Upright) -> Iterator[float]:
    """Where a side of a plan meets a plane: u [m]."""
    ends = np.array([side.start, side.end])
    (u0, u1), (w0, w1) = plane.along(ends).tolist(), plane.off(ends).tolist()
    if side.centre is None:
        if min(w0, w1) - ON_PLAN <= 0 <= max(w0, w1) + ON_PLAN and w0 != w1:
            yield u0 - w0 / (w1 - w0) * (u1 - u0)
        return
    centre = np.array([side.centre])
    u, gap = float(plane.along(centre)[0]), float(plane.off(centre)[0])
    if abs(gap) < side.radius:
        reach = sqrt(side.radius**2 - gap**2)
        # Also where the circle goes on beyond its arc: what lies between two of them is within the plan or it is not.
        yield from (u - reach, u + reach)


def outlines(vault: Vault, plane: Upright, steps: int = OUTLINE_STEPS) -> list[Outline]:
    """The room's outlines in a plane, one wherever that crosses the plan.

    Each from springing to springing: (n, 2) [m], `steps` of them over the plan, and the component of each stretch
    between, 0 on a wall.
    """
    return [_outline(vault, plane, chord, steps) for chord in chords(vault.plan, plane)]


def _outline(vault: Vault, plane: Upright, chord: tuple[float, float], steps: int) -> Outline:
    left, right = chord
    middle, half = (left + right) / 2, (right - left) / 2

    def placed(u: Floats) -> Floats:
        return plane.places(middle + INSIDE * (u - middle))

    # Closer where arches are steep.
    u = middle + half * np.sin(np.linspace(-np.pi / 2, np.pi / 2, steps))
    line = np.concatenate([[[left, 0.0]], np.column_stack([u, heights(vault, placed(u))]), [[right, 0.0]]])
    between, z = ((line[:-1] + line[1:]) / 2).T
    return line, vault.evaluate(np.column_stack([placed(between), z]), walls=True).component

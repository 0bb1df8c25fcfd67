"""The surfaces of a vault's parts as strips of known area, on which points are laid evenly."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Ceiling, Lid, Part, Turned
from families.declaration.plan import Plan
from families.declaration.profiles import Arc, Curve
from families.void.profile_outline import Bow, Wall, half_outline

Array = NDArray[np.float64]
TABLE_STEPS = 4096  # of the table that turns a share of a strip's area into a place on its line


class Strip(ABC):
    """A surface over the unit square: equal areas there are equal areas on it."""

    @property
    @abstractmethod
    def area(self) -> float:
        """Area [m²]."""

    @abstractmethod
    def lay(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Points (n, 3) [m] and unit normals (n, 3) away from the void at a, b (n,) in [0, 1)."""


@dataclass(frozen=True)
class FlatStrip(Strip):
    """Horizontal rectangle."""

    z: float
    half_x: float
    half_y: float

    @property
    def area(self) -> float:
        """Area [m²]."""
        return 4 * self.half_x * self.half_y

    def lay(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Points and normals."""
        xyz = np.stack([self.half_x * (2 * a - 1), self.half_y * (2 * b - 1), np.full_like(a, self.z)], axis=1)
        return xyz, np.tile([0.0, 0.0, 1.0], (len(a), 1))


@dataclass(frozen=True)
class DrawnStrip(Strip):
    """A line of a barrel's profile, on one side of its axis, drawn along it."""

    part: BarrelPart
    side: int
    line: Bow | Wall
    half: float

    @property
    def steepness(self) -> float:
        """Slope of the axis at its ends."""
        return 2 * self.part.crown_rise / self.part.half_length**2 * self.half

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        t = np.linspace(self.line.start, self.line.end, TABLE_STEPS + 1)
        _, _, _, nz = self.line.trace((t[1:] + t[:-1]) / 2)
        width = _steps(self.line, t) * _stretch(self.steepness * nz, 1.0)
        return t, np.concatenate([[0.0], np.cumsum(width)])

    @property
    def area(self) -> float:
        """Area [m²]."""
        return float(self._table[1][-1]) * 2 * self.half

    def lay(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Points and normals."""
        t, width = self._table
        u, z, nu, nz = self.line.trace(np.interp(a * width[-1], width, t))
        way = _unstretched(self.steepness * nz, 2 * b - 1) if self.steepness else 2 * b - 1
        along, na = self.half * way, self.steepness * way * nz
        across = self.part.centre + self.side * u
        height = self.part.base + self.part.crown_rise * (1 - (along / self.part.half_length) ** 2) + z
        pairs = [(across, along), (self.side * nu, na)]
        xy, nxy = pairs if self.part.across == "x" else [pair[::-1] for pair in pairs]
        normal = np.stack([*nxy, nz], axis=1)
        return np.stack([*xy, height], axis=1), normal / np.linalg.norm(normal, axis=1)[:, None]


@dataclass(frozen=True)
class RevolvedStrip(Strip):
    """A line turned about the z axis."""

    line: Bow | Wall
    base: float

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        t = np.linspace(self.line.start, self.line.end, TABLE_STEPS + 1)
        u, _, _, _ = self.line.trace((t[1:] + t[:-1]) / 2)
        return t, np.concatenate([[0.0], np.cumsum(2 * pi * u * _steps(self.line, t))])

    @property
    def area(self) -> float:
        """Area [m²]."""
        return float(self._table[1][-1])

    def lay(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Points and normals."""
        t, ring = self._table
        u, z, nu, nz = self.line.trace(np.interp(a * ring[-1], ring, t))
        c, s = np.cos(2 * pi * b), np.sin(2 * pi * b)
        return np.stack([u * c, u * s, self.base + z], axis=1), np.stack([nu * c, nu * s, nz], axis=1)


def strips(part: Part, plan: Plan) -> Iterator[Strip]:
    """All that may show of a part above the springing and within the plan."""
    match part:
        case BarrelPart():
            half = plan.half_y if part.across == "x" else plan.half_x
            for side in (part.side,) if part.side else (-1, 1):
                for line in _lines(part.curve, -part.base - part.crown_rise):
                    yield DrawnStrip(part, side, line, half)
        case Ball():
            sphere = Curve(part.radius, part.radius, 0.0, (Arc(0.0, 0.0, part.radius),))
            yield from (RevolvedStrip(line, part.z) for line in _lines(sphere, -part.z))
        case Turned():
            yield from (RevolvedStrip(line, part.base) for line in _lines(part.curve, part.foot - part.base))
        case Ceiling():
            yield FlatStrip(part.z, plan.half_x, plan.half_y)
        case Lid():
            return


def _lines(curve: Curve, low: float) -> Iterator[Bow | Wall]:
    bows = half_outline(curve, 0.0, curve.half_span, low)
    foot = bows[0].at(bows[0].start)[1]
    if foot > low:
        yield Wall(curve.half_span, low, foot)
    yield from bows


def _steps(line: Bow | Wall, t: Array) -> Array:
    """Lengths (n - 1,) along a line between neighbouring parameters."""
    if isinstance(line, Wall):
        return np.diff(t)
    middle = (t[1:] + t[:-1]) / 2
    return np.hypot(line.a * np.sin(middle), line.b * np.cos(middle)) * np.diff(t)


def _stretch(steep: Array, way: Array | float) -> Array:
    """Area from the middle of a barrel to a share of its half length, by that without a slope.

    The axis is a parabola whose slope times nz is `steep` at the end: the integral of sqrt(1 + (steep s)²) over s.
    """
    k = np.maximum(np.abs(steep), 1e-9)
    return (way * np.sqrt(1 + (k * way) ** 2) + np.arcsinh(k * way) / k) / 2


def _unstretched(steep: Array, share: Array) -> Array:
    """The place at which `_stretch` reaches a share of its whole, by Newton's method."""
    whole, way = _stretch(steep, 1.0), share.copy()
    for _ in range(5):
        way -= (_stretch(steep, way) - share * whole) / np.sqrt(1 + (steep * way) ** 2)
    return way

"""Barrels as slopes in a cell of the plan, and the line in which two of them meet: a groin or a hip.

Two barrels across each other are as high as each other where F(u) = G(v), F being the height of one less what depends
on its length, which is the other's coordinate. Both fall from crown to wall, so that the line is a curve over u and
over v alike, found from the heights s by u = F⁻¹(s), v = G⁻¹(s).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import BarrelPart
from families.declaration.units import MM
from families.solid.curves import SAMPLES, Spline
from families.solid.surfaces import Side
from families.void.profile_outline import Bow, half_outline

Array = NDArray[np.float64]
SAME_HEIGHT = 1e-8  # [m], heights nearer than that are one
FLAT = 2e-4  # [m], places on two level crowns whose heights are one may be so far apart
ROUNDING = 1e-14  # of a cosine
DENSE = 257  # places at which a curve is looked at before its samples are chosen
HALVINGS = 60  # of an interval in which a root is sought


@dataclass(frozen=True)
class Slope:
    """A barrel on one side of its axis between u = near and u = far; `cross` is the barrel that it meets, if any."""

    part: BarrelPart
    sign: int
    near: float
    far: float
    cross: BarrelPart | None

    @property
    def side(self) -> Side:
        """The barrel's side."""
        return Side(self.part, self.sign)

    @cached_property
    def bows(self) -> tuple[Bow, ...]:
        """The arcs between near and far, from the wall to the crown."""
        return half_outline(self.part.curve, self.near, self.far, -np.inf)

    @cached_property
    def whole(self) -> tuple[Bow, ...]:
        """The same arcs, each as far as it goes."""
        found = half_outline(self.part.curve, 0.0, self.part.curve.half_span, -np.inf)
        return tuple(next(b for b in found if (b.u, b.z, b.a) == (bow.u, bow.z, bow.a)) for bow in self.bows)

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Where arcs pass into each other, and both ends, from the wall to the crown."""
        return (self.far, *(bow.at(bow.end)[0] for bow in self.bows[:-1]), self.near)

    def at(self, u: float) -> float:
        """Coordinate across [m] in the frame."""
        return self.part.centre + self.sign * u

    def bow(self, u: float) -> int:
        """Index of the arc over u."""
        return next((k for k, end in enumerate(self.breaks[1:]) if u >= end), len(self.bows) - 1)

    def height(self, u: float) -> float:
        """Height of the profile above the springing at u [m]."""
        bow = self.bows[self.bow(u)]
        cosine = (u - bow.u) / bow.a
        # A root turns rounding at the widest point into a height.
        return bow.z + (0.0 if cosine > 1 - ROUNDING else bow.b * sqrt(max(1 - cosine**2, 0.0)))

    def rise(self, u: Array) -> Array:
        """The same at u (n,)."""
        z = np.empty_like(u)
        for k, bow in enumerate(self.bows):
            here = (u <= self.breaks[k]) & (u >= self.breaks[k + 1])
            cosine = (u[here] - bow.u) / bow.a
            z[here] = bow.z + bow.b * np.where(cosine > 1 - ROUNDING, 0.0, np.sqrt((1 - cosine**2).clip(min=0.0)))
        return z

    def raised(self, u: Array) -> Array:
        """By how much the other barrel is lifted along itself (n,) [m]."""
        if self.cross is None or not self.cross.crown_rise:
            return np.zeros_like(u)
        across = self.part.centre + self.sign * u
        return self.cross.crown_rise * (1 - (across / self.cross.half_length) ** 2)

    def raised_at(self, u: float) -> float:
        """The same at one place."""
        return self.cross.lift(self.at(u)) if self.cross is not None and self.cross.crown_rise else 0.0

    def level(self, u: Array) -> Array:
        """F(u): height of the barrel less the other's lift [m]."""
        u = u.clip(self.near, self.far)
        return self.part.base + self.rise(u) - self.raised(u)

    def place(self, level: Array) -> Array:
        """The u = F⁻¹ of levels (n,), each of which has to be that of some u."""
        if self.cross is not None and self.cross.crown_rise:
            return self._searched(level)
        u, z = np.full_like(level, self.far), level - self.part.base
        for k, bow in enumerate(self.bows):
            wall, crown = self.height(self.breaks[k]), self.height(self.breaks[k + 1])
            here = (z >= wall) & ((z <= crown) | (k == len(self.bows) - 1))
            reach = bow.a * np.sqrt((1 - ((z[here] - bow.z) / bow.b) ** 2).clip(min=0.0))
            u[here] = (bow.u + reach).clip(self.breaks[k + 1], self.breaks[k])
        return u

    def _searched(self, level: Array) -> Array:
        high, low = np.full_like(level, self.high), np.full_like(level, self.low)
        for _ in range(HALVINGS):
            middle = (high + low) / 2
            above = self.level(middle) > level
            high, low = np.where(above, middle, high), np.where(above, low, middle)
        return (high + low) / 2

    @cached_property
    def falls(self) -> bool:
        """Whether F falls from near to far, as it does but under crowns that are much raised."""
        return self.level_at(self.near) >= self.level_at(self.far)

    @property
    def high(self) -> float:
        """The u where F is highest."""
        return self.near if self.falls else self.far

    @property
    def low(self) -> float:
        """The u where F is lowest."""
        return self.far if self.falls else self.near

    def level_at(self, u: float) -> float:
        """F at one place."""
        u = min(max(u, self.near), self.far)
        return self.part.base + self.height(u) - self.raised_at(u)

    @property
    def bare(self) -> Slope:
        """The same with nothing that tells its place: it stands at the origin, on the positive side."""
        cross = None if self.cross is None else _bare(self.cross)
        return Slope(_bare(self.part), 1, self.near, self.far, cross)

    def place_of(self, level: float) -> float:
        """F⁻¹ of one level."""
        return float(self.place(np.array([level]))[0])


def _bare(part: BarrelPart) -> BarrelPart:
    # Lifted axes belong to the plan's middle, where such barrels have their centres.
    return replace(part, centre=0.0, side=0, names=("", ""))


def turning(slope: Slope) -> float | None:
    """Where F stops to rise from the crown on, if it does."""
    if slope.cross is None or not slope.cross.crown_rise:
        return None
    u = np.linspace(slope.near, slope.far, DENSE)
    top = int(slope.level(u).argmax())
    if top in {0, DENSE - 1}:
        return None
    low, high = float(u[top - 1]), float(u[top + 1])
    for _ in range(HALVINGS):
        a, b = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, b) if slope.level_at(a) > slope.level_at(b) else (a, high)
    return (low + high) / 2


@dataclass(frozen=True)
class GroinLine:
    """Where two slopes meet, from its highest to its lowest point.

    Knots (u, v) and their heights [m], and between them curves in (u, v, z) [mm].
    """

    knots: tuple[tuple[float, float], ...] = ()
    heights: tuple[float, ...] = ()
    curves: tuple[Spline, ...] = ()


def groin(first: Slope, second: Slope, ceiling: float) -> GroinLine:
    """The line in which two slopes meet below a level, cut where either passes from one arc to the next."""
    return _groin(first.bare, second.bare, ceiling)


def placed(line: GroinLine, first: Slope, second: Slope) -> list[Spline]:
    """The curves of a groin where they lie in the frame [mm]."""
    matrix, place = np.diag([0.0, 0.0, 1.0]), np.zeros(3)
    for k, slope in enumerate((first, second)):
        matrix[k, slope.side.axis], place[slope.side.axis] = slope.sign, MM * slope.part.centre
    return [curve.moved(matrix, place) for curve in line.curves]


def forget() -> None:
    """Forget the groins of earlier bodies: their copies differ in the last digits by which of them came first."""
    _groin.cache_clear()


@lru_cache(maxsize=64)  # cells that are alike have the same
def _groin(first: Slope, second: Slope, ceiling: float) -> GroinLine:
    pair = (first, second)
    top = min(*(slope.level_at(slope.high) for slope in pair), ceiling)
    foot = max(slope.level_at(slope.low) for slope in pair)
    if top - foot < SAME_HEIGHT:
        return GroinLine()
    levels = [top]
    for level in sorted((slope.level_at(u) for slope in pair for u in slope.breaks[1:-1]), reverse=True):
        if foot + SAME_HEIGHT < level < levels[-1] - SAME_HEIGHT:
            levels.append(level)
    levels.append(foot)
    knots = [(_snapped(first, level), _snapped(second, level)) for level in levels]
    heights = [level + first.raised_at(u) + second.raised_at(v) for level, (u, v) in zip(levels, knots, strict=True)]
    curves = [_curve(pair, *ends) for ends in zip(pairwise(levels), pairwise(knots), strict=True)]
    return GroinLine(tuple(knots), tuple(heights), tuple(curves))


def _snapped(slope: Slope, level: float) -> float:
    """F⁻¹ of a level, or an end of the slope or of an arc if that is as high."""
    u = float(slope.place(np.array([level]))[0])
    for end in slope.breaks:
        if abs(u - end) < FLAT and abs(slope.level_at(end) - level) < SAME_HEIGHT:
            return end
    return u


def _curve(
    pair: tuple[Slope, Slope], levels: tuple[float, float], ends: tuple[tuple[float, float], tuple[float, float]]
) -> Spline:
    """Through points at even distances and turns: barrels nearly as high turn their groin sharply by the crown."""

    def points(share: Array) -> Array:
        level = levels[0] + (levels[1] - levels[0]) * (1 - np.cos(np.pi * share)) / 2
        u, v = (slope.place(level) for slope in pair)
        (u[0], v[0]), (u[-1], v[-1]) = ends
        # From the level, for near an upright wall the height is lost in the place.
        return np.stack([u, v, level + pair[0].raised(u) + pair[1].raised(v)], axis=1)

    dense = np.linspace(0, 1, DENSE)
    steps = np.diff(points(dense), axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    ways = steps / lengths[:, None]
    turns = np.linalg.norm(np.diff(ways, axis=0), axis=1)
    effort = np.cumsum(lengths / lengths.sum() + (np.append(turns, 0.0) + np.append(0.0, turns)) / 2)
    # Denser towards the ends, where splines are the least accurate.
    even = np.linspace(0, 1, SAMPLES)
    share = np.interp((even + (1 - np.cos(np.pi * even)) / 2) / 2 * effort[-1], np.append(0.0, effort), dense)
    share[[0, -1]] = 0.0, 1.0
    return Spline.through(MM * points(share))

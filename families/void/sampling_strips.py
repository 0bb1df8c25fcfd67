"""The surfaces of a vault's parts as strips of known area, on which points are laid evenly."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Ceiling, Lid, Part, Piece, Turned, Web
from families.declaration.plan import Plan
from families.declaration.plan_sides import Vector
from families.declaration.profiles import Arc, Curve
from families.void.body_table import ACROSS_X, ACROSS_Y, DEPTH, HALF, MIDDLE, pack, pack_plan
from families.void.kernel import surface
from families.void.profile_distance import APEX
from families.void.profile_outline import Bow, Wall, half_outline
from families.void.webs import web_heights

Array = NDArray[np.float64]
TABLE_STEPS = 4096  # of the table that turns a share of a strip's area into a place on its line
WEB_STEPS = 192  # of that of a web, both ways
ALONG_STEPS = 64  # of the one that turns the other share into a place along it, where a barrel is not even


class Strip(ABC):
    """A surface over the unit square: equal areas there are equal areas on it.

    probe_miss: by how much a distance 1e-6 m behind it may differ from that [m].
    """

    probe_miss: ClassVar[float] = 1e-9

    @property
    @abstractmethod
    def area(self) -> float:
        """Area [m²]."""

    @abstractmethod
    def lay(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Points (n, 3) [m] and unit normals (n, 3) away from the void at a, b (n,) in [0, 1)."""


@dataclass(frozen=True)
class FlatStrip(Strip):
    """Horizontal rectangle about the origin."""

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
    """A line of a barrel's profile, on one side of its axis, drawn along it between two places [m]."""

    part: BarrelPart
    side: int
    line: Bow | Wall
    start: float
    end: float

    @property
    def even(self) -> bool:
        """Whether each step along the axis has as much area as any other."""
        return not (self.part.crown_rise or self.part.splay or self.part.flare)

    @cached_property
    def _table(self) -> tuple[Array, Array, Array, Array]:
        """Places on the line (n + 1,) and areas up to them; places along (m + 1,), and areas (n, m + 1) up to them."""
        steps = TABLE_STEPS if self.even else TABLE_STEPS // 16
        t = np.linspace(self.line.start, self.line.end, steps + 1)
        along = np.linspace(self.start, self.end, 2 if self.even else ALONG_STEPS + 1)
        u, z, nu, nz = self.line.trace((t[1:] + t[:-1]) / 2)
        length = _steps(self.line, t) * (along[1] - along[0])
        area = length[:, None] * self._stretch(u, z, nu, nz, (along[1:] + along[:-1]) / 2)
        up_to = np.cumsum(np.pad(area, ((0, 0), (1, 0))), axis=1)
        return t, np.concatenate([[0.0], np.cumsum(up_to[:, -1])]), along, up_to

    def _stretch(self, u: Array, z: Array, nu: Array, nz: Array, along: Array) -> Array:
        """Area at places (n,) on the line and (m,) along the axis, by that of a straight and level barrel (n, m)."""
        u, z, nu, nz = (column[:, None] for column in (u, z, nu, nz))
        span, size, climb = self._there(along)
        # The cross product of the steps on the line, (-nz span, nu size) across and up, and along the axis.
        across, up = u * self.part.splay, climb + z * self.part.flare
        found: Array = np.sqrt((nu * size) ** 2 + (nz * span) ** 2 + (nu * size * across + nz * span * up) ** 2)
        return found

    def _there(self, along: Array) -> tuple[Array, Array, Array]:
        """Half span and heights, by those at the origin, and slope of the axis at places along it."""
        part = self.part
        climb = part.slope - 2 * part.crown_rise * along / part.half_length**2
        return 1 + part.splay * along, 1 + part.flare * along, climb

    @property
    def area(self) -> float:
        """Area [m²]."""
        return float(self._table[1][-1])

    def lay(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Points and normals."""
        t, width, ends, up_to = self._table
        place = np.interp(a * width[-1], width, t)
        u, z, nu, nz = self.line.trace(place)
        b = b if self.part.along > (0.0, 0.0) else 1 - b  # lattices run towards the same end, whichever way a part does
        if self.even:
            middle, half = (self.start + self.end) / 2, (self.end - self.start) / 2
            along = middle + half * (2 * b - 1)
        else:
            # One look-up for all: the areas of each step on the line, as shares, follow those of the step before.
            step = np.minimum(((place - t[0]) / (t[1] - t[0])).astype(int), len(up_to) - 1)
            shares = up_to / up_to[:, -1:] + np.arange(len(up_to))[:, None]
            along = np.interp(step + np.clip(b, 1e-9, 1 - 1e-9), shares.ravel(), np.tile(ends, len(up_to)))
        (ax, ay), (lx, ly), (ox, oy) = self.part.across, self.part.along, self.part.origin
        span, size, climb = self._there(along)
        lift = self.part.slope * along + self.part.crown_rise * (1 - (along / self.part.half_length) ** 2)
        across, height = self.side * u * span, self.part.base + lift + z * size
        n_across, n_up = self.side * nu / span, nz / size
        n_along = -nu / span * u * self.part.splay - n_up * (climb + z * self.part.flare)
        normal = np.stack([ax * n_across + lx * n_along, ay * n_across + ly * n_along, n_up], axis=1)
        xyz = np.stack([ox + ax * across + lx * along, oy + ay * across + ly * along, height], axis=1)
        return xyz, normal / np.linalg.norm(normal, axis=1)[:, None]


@dataclass(frozen=True)
class RevolvedStrip(Strip):
    """A line turned about an upright axis: its own axis at `radius` from that, and the line beyond it or within."""

    line: Bow | Wall
    base: float
    centre: Vector
    radius: float = 0.0
    side: int = 1

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        t = np.linspace(self.line.start, self.line.end, TABLE_STEPS + 1)
        u, _, _, _ = self.line.trace((t[1:] + t[:-1]) / 2)
        ring = 2 * pi * np.maximum(self.radius + self.side * u, 0.0)
        return t, np.concatenate([[0.0], np.cumsum(ring * _steps(self.line, t))])

    @property
    def area(self) -> float:
        """Area [m²]."""
        return float(self._table[1][-1])

    def lay(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Points and normals."""
        t, ring = self._table
        u, z, nu, nz = self.line.trace(np.interp(a * ring[-1], ring, t))
        c, s = np.cos(2 * pi * b), np.sin(2 * pi * b)
        rho, nu, (x, y) = self.radius + self.side * u, self.side * nu, self.centre
        return np.stack([x + rho * c, y + rho * s, self.base + z], axis=1), np.stack([nu * c, nu * s, nz], axis=1)


@dataclass(frozen=True)
class WebStrip(Strip):
    """A web; steps along its ribs and arches are finer where these rise steeply. It is bent sharply in its corners."""

    probe_miss: ClassVar[float] = 1e-7

    part: Web

    @cached_property
    def _packed(self) -> Array:
        return pack((Piece((self.part,)),), self.part.names)

    @cached_property
    def _table(self) -> tuple[Array, Array, Array]:
        """Steps (n + 1,), areas (n + 1,) up to them towards the wall, and (n, n + 1) along it."""
        steps = np.linspace(0, 1, WEB_STEPS + 1)
        xyz = self._places(*(column.ravel() for column in np.meshgrid(steps, steps, indexing="ij")))
        grid = xyz.reshape(WEB_STEPS + 1, WEB_STEPS + 1, 3)
        p, q, r, s = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
        area = (np.linalg.norm(np.cross(q - p, r - p), axis=2) + np.linalg.norm(np.cross(r - p, s - p), axis=2)) / 2
        up_to = np.cumsum(np.pad(area, ((0, 0), (1, 0))), axis=1)
        return steps, np.concatenate([[0.0], np.cumsum(up_to[:, -1])]), up_to

    def _places(self, a: Array, b: Array) -> Array:
        """Points (n, 3) at shares of a quarter turn towards the wall and of half a turn along it."""
        part, (row,) = self.part, self._packed
        (x, y), tx, ty = part.centre, row[ACROSS_X], row[ACROSS_Y]
        v = np.sin(a * pi / 2)
        along, across = v * row[DEPTH], v * (row[MIDDLE] - row[HALF] * np.cos(b * pi))
        z = web_heights(along, across, self._packed)
        return np.stack([x + across * tx + along * ty, y + across * ty - along * tx, z], axis=1)

    @property
    def area(self) -> float:
        """Area [m²]."""
        return float(self._table[1][-1])

    def lay(self, a: Array, b: Array) -> tuple[Array, Array]:
        """Points and normals."""
        steps, rows, up_to = self._table
        place = np.interp(a * rows[-1], rows, steps)
        row = np.minimum((place * WEB_STEPS).astype(int), WEB_STEPS - 1)
        shares = up_to / up_to[:, -1:] + np.arange(WEB_STEPS)[:, None]
        xyz = self._places(
            place, np.interp(row + np.clip(b, 1e-9, 1 - 1e-9), shares.ravel(), np.tile(steps, WEB_STEPS))
        )
        return xyz, surface(xyz, np.eye(3, 4), self._packed, pack_plan(None))[2]


def strips(part: Part, plan: Plan, floor: float = 0.0) -> Iterator[Strip]:
    """All that may show of a part above a floor [m] and within the plan."""
    match part:
        case BarrelPart():
            start, end = _reach(part, plan)
            for side in (part.side,) if part.side else (-1, 1):
                for line in _lines(part.curve, _foot(part, start, end, floor)):
                    yield DrawnStrip(part, side, line, start, end)
        case Ball():
            sphere = Curve(part.radius, part.radius, 0.0, (Arc(0.0, 0.0, part.radius),))
            yield from (RevolvedStrip(line, part.z, part.centre) for line in _lines(sphere, floor - part.z))
        case Turned():
            for side in (-1, 1) if part.radius else (1,):
                for line in _lines(part.curve, floor - part.base):
                    yield RevolvedStrip(line, part.base, part.centre, part.radius, side)
        case Ceiling():
            yield FlatStrip(part.z, plan.half_x, plan.half_y)
        case Web():
            yield WebStrip(part)
        case Lid():
            return


def _reach(part: BarrelPart, plan: Plan) -> tuple[float, float]:
    """The places along an axis between which the plan lies, and the barrel has an arch."""
    along = []
    for side in plan.sides:
        along.append(part.local(*side.start)[1])
        if side.centre is not None and side.inside:
            middle = part.local(*side.centre)[1]
            along += [middle - side.radius, middle + side.radius]
    start, end = min(along), max(along)
    for growth in (part.splay, part.flare):
        if growth > 0:
            start = max(start, (APEX - 1) / growth)
        elif growth < 0:
            end = min(end, (APEX - 1) / growth)
    return start, end


def _foot(part: BarrelPart, start: float, end: float, floor: float) -> float:
    """As low as the line of a profile is to be drawn, so that the barrel reaches the floor everywhere."""
    lift = part.crown_rise + max(part.slope * start, part.slope * end)
    low = floor - part.base - lift
    return low / max(min(1 + part.flare * start, 1 + part.flare * end), APEX) if low < 0 else 0.0


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

"""The bodies of a vault as patches of surface, each point of which has two coordinates (a, b).

By kind of body, as `families.void.sampling_strips` tells of them, so that families need say nothing of it.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Ceiling, Part, Piece, Turned, Web
from families.declaration.plan import Plan
from families.declaration.profiles import Pointed
from families.void.body_table import ACROSS_X, ACROSS_Y, BENT, DEPTH, HALF, KIND, MIDDLE, NO_WALLS, WEB, pack
from families.void.kernel import surface
from families.void.profile_outline import Bow, Wall
from families.void.sampling_strips import DrawnStrip, RevolvedStrip, strips
from families.void.webs import FLAT, web_arch_rises, web_heights

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]  # the least and the largest a, the least and the largest b

STEPS = 2048  # of the table of a line of a profile: 2 mm on one of 4 m, whose arcs are then 1e-7 m off at most
CORNER = 1e-6  # 1 - cosine, or sine, of the angle from which on lines meet in a corner
FEET = 2  # steps to a foot on bodies whose distances are exact in the first order alone


@dataclass(frozen=True)
class Meridian:
    """Half of a profile from the crown down, by the length [m] from the crown: distance from the axis, height [m].

    springing: the length down to z = 0. breaks: the lengths at which it has a corner. slope: how much u grows with the
    length, at lengths `knots`, two of which meet where lines do.
    """

    length: Array
    u: Array
    z: Array
    springing: float
    breaks: tuple[float, ...]
    knots: Array
    slope: Array

    @staticmethod
    def of(lines: Sequence[Bow | Wall]) -> Meridian:
        """From lines in their order from the springing to the crown."""
        traced = [line.trace(np.linspace(line.start, line.end, STEPS + 1)) for line in lines][::-1]
        rows = [np.stack([u, z, nu, nz])[:, ::-1] for u, z, nu, nz in traced]  # from the crown down
        u, z = np.concatenate([rows[0][:2], *(row[:2, 1:] for row in rows[1:])], axis=1)
        u = np.maximum(u, 0.0)
        length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(u), np.diff(z)))])
        knots = [length[k * STEPS : (k + 1) * STEPS + 1] for k in range(len(rows))]
        meets = [
            (before[2:, -1] @ after[2:, 0], float(own[-1]))
            for before, after, own in zip(rows[:-1], rows[1:], knots[:-1], strict=True)
        ]
        breaks = [at for cosine, at in meets if cosine < 1 - CORNER]
        if abs(rows[0][2, 0]) > CORNER:  # pointed
            breaks = [0.0, *breaks]
        spring = float(np.interp(0.0, z[::-1], length[::-1]))
        slope = np.concatenate([row[3] for row in rows])
        return Meridian(length, u, z, spring, tuple(breaks), np.concatenate(knots), slope)

    def corners(self, low: float, high: float) -> tuple[float, ...]:
        """Its corners on either side, by their lengths between two, negative on the one [m], in their order."""
        both = {*self.breaks, *(-at for at in self.breaks)}
        return tuple(sorted(at for at in both if low < at < high))

    def at(self, length: Array) -> tuple[Array, Array]:
        """Distances from the axis and heights (n,) [m] at lengths (n,) from the crown."""
        return np.interp(length, self.length, self.u), np.interp(length, self.length, self.z)

    def widening(self, length: Array) -> Array:
        """How much the distance from the axis grows with the length (n,), at lengths from the crown."""
        found: Array = np.interp(length, self.knots, self.slope)
        return found

    def length_at(self, u: Array, z: Array) -> Array:
        """Lengths (n,) from the crown of places (n,) on it: u grows with it and z falls, so that z - u tells it."""
        found: Array = np.interp(z - u, self._key, self.length[::-1])
        return found

    @cached_property
    def _key(self) -> Array:
        key: Array = (self.z - self.u)[::-1]
        return key


class Patch(ABC):
    """A surface with coordinates a, b. part: the body. box: how far they reach. crown: places of corners along a."""

    part: Part
    box: Box

    @property
    def creases(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Values of a, and of b, at which the surface has an edge."""
        return (), ()

    @abstractmethod
    def place(self, a: Array, b: Array) -> Array:
        """Points (n, 3) [m] at coordinates (n,)."""

    @abstractmethod
    def coordinates(self, xyz: Array) -> tuple[Array, Array]:
        """Coordinates (n,), (n,) of points (n, 3) on the surface [m]."""

    @cached_property
    def table(self) -> Array:
        """The body alone, for the kernel."""
        part = self.part
        names: tuple[str, ...] = (*part.names, part.below) if isinstance(part, BarrelPart) else part.names  # type: ignore[union-attr]  # a lid has no patch
        return pack((Piece((part,)),), tuple(dict.fromkeys(name for name in names if name)))

    def feet(self, xyz: Array) -> tuple[Array, Array]:
        """The nearest points (n, 3) on the body, and its signed distances (n,); where it says nothing, the points."""
        exact = self.table[0, KIND] not in (BENT, WEB)
        foot, distance = np.ascontiguousarray(xyz), None
        for _ in range(1 if exact else FEET):
            off, _, normal = surface(foot, np.eye(3, 4), self.table, NO_WALLS)
            foot = foot - np.where(np.isfinite(off), off, 0.0)[:, None] * normal
            distance = off if distance is None else distance
        assert distance is not None
        return foot, distance


@dataclass(frozen=True, eq=False)
class DrawnPatch(Patch):
    """A barrel: a along the profile from the crown [m], negative on the side against `across`; b along the axis [m]."""

    part: BarrelPart
    meridian: Meridian
    box: Box

    @property
    def straight(self) -> bool:
        """Whether all its arches are alike and its axis is straight: a cylinder."""
        return not (self.part.crown_rise or self.part.splay or self.part.flare)

    @property
    def tapered(self) -> bool:
        """Whether all of it grows evenly from one point: a cone."""
        part = self.part
        return not part.crown_rise and bool(part.splay) and abs(part.splay - part.flare) < 1e-12

    @property
    def creases(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Corners of the profile on either side."""
        return self.meridian.corners(*self.box[:2]), ()

    def place(self, a: Array, b: Array) -> Array:
        """Points."""
        part, (u, z) = self.part, self.meridian.at(np.abs(a))
        (cx, cy), (lx, ly), (ox, oy) = part.across, part.along, part.origin
        across = np.sign(a) * u * (1 + part.splay * b)
        lift = part.slope * b + part.crown_rise * (1 - (b / part.half_length) ** 2)
        height = part.base + lift + z * (1 + part.flare * b)
        return np.stack([ox + cx * across + lx * b, oy + cy * across + ly * b, height], axis=1)

    def coordinates(self, xyz: Array) -> tuple[Array, Array]:
        """Coordinates."""
        part = self.part
        (cx, cy), (x, y) = part.across, (xyz[:, 0] - part.origin[0], xyz[:, 1] - part.origin[1])
        across, b = cx * x + cy * y, cx * y - cy * x
        lift = part.slope * b + part.crown_rise * (1 - (b / part.half_length) ** 2)
        u, z = across / (1 + part.splay * b), (xyz[:, 2] - part.base - lift) / (1 + part.flare * b)
        side = np.where(u < 0, -1.0, 1.0) if not part.side else float(part.side)
        return side * self.meridian.length_at(np.abs(u), z), b


@dataclass(frozen=True, eq=False)
class TurnedPatch(Patch):
    """What is turned: a along the profile [m], negative within the axis of a ring; b the angle from north [rad]."""

    part: Turned | Ball
    meridian: Meridian
    box: Box

    @property
    def radius(self) -> float:
        """Of the axis of a ring [m]; 0 of a dome."""
        return self.part.radius if isinstance(self.part, Turned) else 0.0

    @property
    def base(self) -> float:
        """Height of its springing [m]."""
        return self.part.base if isinstance(self.part, Turned) else self.part.z

    @property
    def creases(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Corners of the profile; the point of a dome is none."""
        return self.meridian.corners(*self.box[:2]), ()

    def place(self, a: Array, b: Array) -> Array:
        """Points."""
        u, z = self.meridian.at(np.abs(a))
        rho, (x, y) = self.radius + np.sign(a) * u, self.part.centre
        return np.stack([x - rho * np.sin(b), y + rho * np.cos(b), self.base + z], axis=1)

    def coordinates(self, xyz: Array) -> tuple[Array, Array]:
        """Coordinates."""
        x, y = xyz[:, 0] - self.part.centre[0], xyz[:, 1] - self.part.centre[1]
        u = np.hypot(x, y) - self.radius
        side = np.where(u < 0, -1.0, 1.0) if self.radius else 1.0
        return side * self.meridian.length_at(np.abs(u), xyz[:, 2] - self.base), np.arctan2(-x, y)


@dataclass(frozen=True, eq=False)
class LevelPatch(Patch):
    """A level plane: a and b are x and y [m]."""

    part: Ceiling
    box: Box

    def place(self, a: Array, b: Array) -> Array:
        """Points."""
        return np.stack([a, b, np.full(len(a), self.part.z)], axis=1)

    def coordinates(self, xyz: Array) -> tuple[Array, Array]:
        """Coordinates."""
        return xyz[:, 0], xyz[:, 1]


@dataclass(frozen=True, eq=False)
class WebPatch(Patch):
    """A web: a from its centre to its wall, slower where ribs are steep; b from rib to rib, even on the wall arch.

    Both run from 0 to 1.
    """

    part: Web
    box: Box = (0.0, 1.0, 0.0, 1.0)

    @property
    def creases(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Where its arches become level, or steeper than a semicircle, which are of another kind; a pointed ridge."""
        a = np.linspace(0, 1, STEPS + 1)[1:]
        v = np.sin(a * pi / 2)
        ratio = web_arch_rises(v, self.table) / (v * self.table[0, HALF])
        kind = np.searchsorted([(1 + CORNER) * FLAT, 1 + CORNER], ratio)
        passes = np.flatnonzero(kind[1:] != kind[:-1])
        ridge = (0.5,) if isinstance(self.part.arch, Pointed) else ()
        return tuple(((a[passes] + a[passes + 1]) / 2).tolist()), ridge

    @cached_property
    def _arch(self) -> tuple[Array, Array]:
        """Shares of the length of the wall arch, and places along it, from -1 to 1."""
        across = -np.cos(np.linspace(0, pi, STEPS + 1))
        return _even(across, self.table[0, HALF], self._heights(np.ones_like(across), across))

    def _heights(self, v: Array, across: Array) -> Array:
        row = self.table[0]
        z: Array = web_heights(v * row[DEPTH], v * (row[MIDDLE] + row[HALF] * across), self.table)
        return z

    def place(self, a: Array, b: Array) -> Array:
        """Points."""
        row, (x, y) = self.table[0], self.part.centre
        v, share = np.sin(a * pi / 2), np.interp(b, *self._arch)
        along, across, z = v * row[DEPTH], v * (row[MIDDLE] + row[HALF] * share), self._heights(v, share)
        tx, ty = row[ACROSS_X], row[ACROSS_Y]
        return np.stack([x + across * tx + along * ty, y + across * ty - along * tx, z], axis=1)

    def coordinates(self, xyz: Array) -> tuple[Array, Array]:
        """Coordinates."""
        row = self.table[0]
        x, y = xyz[:, 0] - self.part.centre[0], xyz[:, 1] - self.part.centre[1]
        tx, ty = row[ACROSS_X], row[ACROSS_Y]
        across, along = x * tx + y * ty, x * ty - y * tx
        v = np.clip(along / row[DEPTH], 1e-12, 1.0)
        share = np.clip((across / v - row[MIDDLE]) / row[HALF], -1.0, 1.0)
        return np.arcsin(v) * 2 / pi, np.interp(share, *self._arch[::-1])


def _even(places: Array, scale: float, z: Array) -> tuple[Array, Array]:
    """Shares (n,) of the length of a line up to its places (n,), of a size in metres, and these; z: its heights [m]."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(places) * scale, np.diff(z)))])
    return length / length[-1], places


def patch(part: Part, plan: Plan, floor: float) -> Patch | None:
    """All that may show of a body above a floor [m] and within the plan; None of a lid."""
    found = list(strips(part, plan, floor))
    match part:
        case BarrelPart():
            drawn = [strip for strip in found if isinstance(strip, DrawnStrip)]
            own = Meridian.of([strip.line for strip in drawn if strip.side == drawn[0].side])
            reach = float(own.length[-1])
            low, high = (-reach if part.side <= 0 else 0.0), (reach if part.side >= 0 else 0.0)
            return DrawnPatch(part, own, (low, high, drawn[0].start, drawn[0].end))
        case Ball() | Turned():
            turned = [strip for strip in found if isinstance(strip, RevolvedStrip)]
            own = Meridian.of([strip.line for strip in turned if strip.side == turned[0].side])
            ring = isinstance(part, Turned) and part.radius > 0
            reach = float(own.length[-1])
            return TurnedPatch(part, own, (-reach if ring else 0.0, reach, -pi, pi))
        case Ceiling():
            (x0, y0), (x1, y1) = plan.box[0].tolist(), plan.box[1].tolist()
            return LevelPatch(part, (x0, x1, y0, y1))
        case Web():
            return WebPatch(part)
    return None

"""Roofs: smooth surfaces over regions of the plan, and the curves over lines and circles of the plan on them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from math import acos, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import BarrelPart
from families.declaration.plan_sides import Vector
from families.declaration.units import MM
from families.solid.barrel_surfaces import BarrelSide, Drawn, Moved
from families.solid.boundary import Step
from families.solid.curves import Bezier, Conic, Point, Straight, arc_poles, arc_weight, point
from families.solid.heights import APEX, DRAWN, FLAT, TURNED, WIDTH
from families.solid.plan_cells import Way
from families.solid.surfaces import UP, Flat, Sheet
from families.solid.turned_surfaces import Revolved, Round
from families.void.profile_outline import Bow

Array = NDArray[np.float64]
FLOOR = 0.0  # height of the springing [m]
FAR = 1e3  # [m], farther than any vault reaches
WHOLE = -1.0
STRAIGHT = 1e-9  # of a metre, by which a line may miss a direction
FLARES = 4.0  # distances of a cone's apex, farther than it reaches beyond where it is as wide as its profile
REACH = 0.05  # [m] by which a surface that has ends reaches beyond the plan


class Roof(ABC):
    """A smooth piece of surface over a region of the plan; its normal looks up."""

    @property
    @abstractmethod
    def row(self) -> Array:
        """As the compiled functions take it (`families.solid.heights`)."""

    @property
    @abstractmethod
    def lowest(self) -> float:
        """A height [m] below which it never is."""

    @property
    def springing(self) -> float | None:
        """The height [m] below which walls under it have a name of their own."""
        return None

    @property
    def pole(self) -> tuple[Vector, int] | None:
        """The place where a line of its surface's parameters is one point, and along which of them that line runs."""
        return None

    @property
    @abstractmethod
    def sheet(self) -> Sheet:
        """Its surface."""

    @abstractmethod
    def exact(self, way: Way, start: float, end: float, ends: tuple[Point, Point]) -> Step | None:
        """The step over a part of a way as a line, conic or Bézier curve, if it is one; `ends` are its end points."""


@dataclass(frozen=True, eq=False)
class Plane(Roof):
    """A plane z + gradient · (x, y)."""

    z: float
    gradient: Vector = (0.0, 0.0)

    @cached_property
    def row(self) -> Array:
        """Flat."""
        found = np.zeros(WIDTH)
        found[0], found[3:5], found[5] = FLAT, self.gradient, self.z
        return found

    @property
    def lowest(self) -> float:
        """Its height where it is level."""
        return -np.inf if any(self.gradient) else self.z

    @cached_property
    def sheet(self) -> Sheet:
        """The plane."""
        return Flat.level(MM * self.z, self.gradient)

    def exact(self, way: Way, start: float, end: float, ends: tuple[Point, Point]) -> Step | None:
        """Lines, and circles where it is level."""
        if way.centre is None:
            return _line(*ends)
        return None if any(self.gradient) else _ring(way, start, end, ends)


NOTHING = Plane(np.inf)


@dataclass(frozen=True, eq=False)
class DrawnRoof(Roof):
    """One bow of one side of a barrel, on one half of its length."""

    part: BarrelPart
    sign: int
    bow: Bow
    half: int  # -1 or 1 along the barrel where its components differ, else 0

    @cached_property
    def row(self) -> Array:
        """Drawn."""
        p, bow = self.part, self.bow
        frame = (*p.origin, *p.across, p.base, p.slope, p.splay, p.flare, p.crown_rise, p.half_length)
        return np.array([DRAWN, *frame, self.sign, bow.u, bow.z, bow.a, bow.b, *[0.0] * (WIDTH - 16)])

    @property
    def lowest(self) -> float:
        """The springing of a level barrel."""
        return -np.inf if self.part.slope else self.part.base + self.bow.z + self.bow.b * sin(self.bow.start)

    @property
    def springing(self) -> float | None:
        """Where the walls below have their own name."""
        return self.part.base if self.part.below else None

    @cached_property
    def side(self) -> BarrelSide:
        """The barrel's side."""
        return BarrelSide(self.part, self.sign)

    @property
    def pole(self) -> tuple[Vector, int] | None:
        """The apex of a cone."""
        part = self.part
        if not part.splay or part.flare != part.splay:
            return None
        (x, y), (a, b) = part.origin, part.along
        return (x - a / part.splay, y - b / part.splay), 0

    @property
    def plain(self) -> bool:
        """Whether the surface is a cylinder."""
        return not (self.part.crown_rise or self.part.splay or self.part.flare)

    @cached_property
    def sheet(self) -> Sheet:
        """Cylinder or Bézier surface."""
        if self.plain:
            return Drawn(self.side, self.bow)
        part, reach = self.part, FAR
        if part.crown_rise:
            reach = part.half_length + REACH
        low, high = -reach, reach
        if part.splay:
            apex = -1 / part.splay
            reach = min(reach, FLARES * abs(apex))
            low, high = (max(-reach, apex), reach) if apex < 0 else (-reach, min(reach, apex))
        return Moved(self.side, self.bow, low, high)

    def exact(self, way: Way, start: float, end: float, ends: tuple[Point, Point]) -> Step | None:
        """Rulings and their parabolas, arches, and oblique cuts of cylinders."""
        part = self.part
        if way.centre is not None:
            return None
        (u0, l0), (u1, l1) = part.local(*way.at(start)), part.local(*way.at(end))
        wide, far = 1 + part.splay * l0, 1 + part.splay * l1
        u0, u1 = self.sign * u0 / max(wide, APEX), self.sign * u1 / max(far, APEX)
        if abs(u1 - u0) < STRAIGHT or min(wide, far) < STRAIGHT:  # from the apex all ways are rulings
            return _line(*ends) if not part.crown_rise else _parabola(part, ends, l0, l1)
        angles = [self._angle(u) for u in (u0, u1)]
        if abs(l1 - l0) < STRAIGHT and self.plain:
            sheet = self.sheet
            assert isinstance(sheet, Drawn)
            arch = sheet.arch(l0)
            return Step(arch, arch.parameter(ends[0]), arch.parameter(ends[1]))
        if abs(l1 - l0) < STRAIGHT or self.plain:
            return self._cut(angles, (l0, l1), (u0, u1), ends)
        return None

    def _angle(self, u: float) -> float:
        return acos(min(max((u - self.bow.u) / self.bow.a, -1.0), 1.0))

    def _cut(
        self, angles: list[float], along: tuple[float, float], across: tuple[float, float], ends: tuple[Point, Point]
    ) -> Step:
        """A plane cut: an affine image of the bow, so of its Bézier curve."""
        part, wide, high = self.part, 1 + self.part.splay * along[0], 1 + self.part.flare * along[0]
        low, top = sorted(angles)
        u, z = arc_poles(replace(self.bow, start=low, end=top)).T
        rate = (along[1] - along[0]) / (across[1] - across[0])
        way = along[0] + rate * (u - across[0])
        lift = part.slope * way + (part.lift(along[0]) - part.slope * along[0])
        a, b = (np.array(v) for v in (part.across, part.along))
        plan = np.array(part.origin) + np.outer(wide * self.sign * u, a) + np.outer(way, b)
        poles = MM * np.column_stack([plan, part.base + lift + high * z])
        forward = angles[0] < angles[1]
        poles[0], poles[2] = ends if forward else ends[::-1]
        curve = Bezier(poles, arc_weight(top - low))
        return Step(curve, 0.0, 1.0) if forward else Step(curve, 1.0, 0.0)


@dataclass(frozen=True, eq=False)
class TurnedRoof(Roof):
    """One bow turned about an upright axis, at a distance from it, in one quarter of the plan about that."""

    centre: Vector
    radius: float
    base: float
    bow: Bow
    sign: int
    foot: float | None  # height below which its walls have another name
    quarter: float  # from the azimuth quarter · 90° on; `WHOLE` for all of a sphere whose poles are not over the plan

    @cached_property
    def row(self) -> Array:
        """Turned."""
        bow, found = self.bow, np.zeros(WIDTH)
        found[0], found[1:3], found[5], found[10] = TURNED, self.centre, self.base, self.radius
        found[11:16] = self.sign, bow.u, bow.z, bow.a, bow.b
        return found

    @property
    def lowest(self) -> float:
        """Its foot."""
        return self.base + self.bow.z + self.bow.b * sin(self.bow.start)

    @property
    def springing(self) -> float | None:
        """Its foot, if its walls have their own name."""
        return self.foot

    @property
    def pole(self) -> tuple[Vector, int] | None:
        """On the axis."""
        return (self.centre, 0) if self.quarter != WHOLE and not self.radius else None

    @property
    def about(self) -> float:
        """Azimuth of its middle."""
        return (self.quarter + 0.5) * pi / 2

    @cached_property
    def conic(self) -> Conic:
        """The bow in the plane of x and z."""
        place = np.array([self.radius + self.sign * self.bow.u, 0.0, self.base])
        return self._conic(place, np.array([1.0, 0.0, 0.0]))

    def _conic(self, place: Array, outwards: Array) -> Conic:
        return Conic.of(replace(self.bow, u=0.0), MM * place, outwards, UP)[0]

    @property
    def spherical(self) -> bool:
        """Whether it is part of a sphere about a place on the axis."""
        return self.bow.a == self.bow.b and abs(self.bow.u) + self.radius < 1e-12

    @cached_property
    def sheet(self) -> Sheet:
        """Sphere or surface of revolution."""
        x, y = self.centre
        if self.spherical:
            centre = (MM * x, MM * y, MM * (self.base + self.bow.z))
            pole, about = (2, self.about) if self.pole else (0, pi / 2)
            return Round(centre, MM * self.bow.a, pole, about)
        return Revolved(self.conic, (MM * x, MM * y), self.about)

    def exact(self, way: Way, start: float, end: float, ends: tuple[Point, Point]) -> Step | None:
        """Rings, meridians, and plane cuts of a sphere."""
        if way.centre is not None:
            near = hypot(way.centre[0] - self.centre[0], way.centre[1] - self.centre[1]) < STRAIGHT
            return _ring(way, start, end, ends) if near else None
        (x0, y0), (x1, y1) = (np.subtract(place, self.centre).tolist() for place in (way.start, way.end))
        size = hypot(x1 - x0, y1 - y0)
        dx, dy = (x1 - x0) / size, (y1 - y0) / size
        miss = dx * y0 - dy * x0  # distance of the axis to the right of the line
        if self.spherical:
            radius = sqrt(max(self.bow.a**2 - miss**2, 0.0))
            if dx < -STRAIGHT or (dx < STRAIGHT and dy < 0):
                dx, dy, miss = -dx, -dy, -miss
            foot = np.array([self.centre[0] - dy * miss, self.centre[1] + dx * miss, self.base + self.bow.z])
            circle = Conic(point(MM * foot), (dx, dy, 0.0), point(UP), MM * radius, MM * radius)
            return Step(circle, circle.parameter(ends[0]), circle.parameter(ends[1]))
        if abs(miss) < STRAIGHT:
            (a, b), (c, d) = way.at(start), way.at(end)
            x, y = (a + c) / 2 - self.centre[0], (b + d) / 2 - self.centre[1]
            size = hypot(x, y)
            outwards = np.array([x / size, y / size, 0.0])
            place = np.array([*self.centre, self.base]) + (self.radius + self.sign * self.bow.u) * outwards
            meridian = self._conic(place, outwards)
            return Step(meridian, meridian.parameter(ends[0]), meridian.parameter(ends[1]))
        return None


def _line(start: Point, end: Point) -> Step:
    line = Straight.between(start, end)
    return Step(line, line.parameter(start), line.parameter(end))


def _ring(way: Way, start: float, end: float, ends: tuple[Point, Point]) -> Step:
    """A level circle, counterclockwise; its angle counts from the quarter in which the way lies."""
    assert way.centre is not None
    x, y = way.centre
    quarter = (way.angle + way.sweep / 2) // (pi / 2) * (pi / 2)
    c, s = (round(value, 15) for value in (cos(quarter), sin(quarter)))
    z = (ends[0][2] + ends[1][2]) / 2
    ring = Conic((MM * x, MM * y, z), (c, s, 0.0), (-s, c, 0.0), MM * way.radius, MM * way.radius)
    return Step(ring, *(way.angle + t * way.sweep - quarter for t in (start, end)))


def _parabola(part: BarrelPart, ends: tuple[Point, Point], first: float, last: float) -> Step:
    middle = (np.array(ends[0]) + np.array(ends[1])) / 2
    middle[2] += MM * part.crown_rise * (last - first) ** 2 / part.half_length**2 / 2
    return Step(Bezier(np.array([ends[0], middle, ends[1]])), 0.0, 1.0)

"""The parts of pieces as roofs: smooth surfaces over regions of the plan, and the lines at which these end."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import acos, asin, atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Ceiling, Lid, Part, Piece, Turned
from families.declaration.plan import Plan, Vector
from families.declaration.profiles import Arc, Curve
from families.declaration.units import MM
from families.solid.boundary import Step
from families.solid.curves import Bezier, Conic, Point, Straight, arc_poles, arc_weight, point
from families.solid.heights import DRAWN, FLAT, TURNED, WIDTH
from families.solid.plan_cells import SAME_PLACE, Cut, Way
from families.solid.surfaces import UP, BarrelSide, Drawn, Flat, Moved, Revolved, Round, Sheet
from families.void.profile_outline import Bow, half_outline

Array = NDArray[np.float64]
FLOOR = 0.0  # height of the springing [m]
FAR = 1e3  # [m], farther than any vault reaches
WHOLE = -1.0
STRAIGHT = 1e-9  # of a metre, by which a line may miss a direction
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
        return np.array([DRAWN, *frame, self.sign, bow.u, bow.z, bow.a, bow.b])

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
            low, high = (max(low, apex), high) if apex < 0 else (low, min(high, apex))
        return Moved(self.side, self.bow, low, high)

    def exact(self, way: Way, start: float, end: float, ends: tuple[Point, Point]) -> Step | None:
        """Rulings and their parabolas, arches, and oblique cuts of cylinders."""
        part = self.part
        if way.centre is not None:
            return None
        (u0, l0), (u1, l1) = part.local(*way.at(start)), part.local(*way.at(end))
        near, far = 1 + part.splay * l0, 1 + part.splay * l1
        if min(near, far) < STRAIGHT:  # to the apex of a cone
            return _line(*ends)
        u0, u1 = self.sign * u0 / near, self.sign * u1 / far
        if abs(u1 - u0) < STRAIGHT:
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
        found[11:] = self.sign, bow.u, bow.z, bow.a, bow.b
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
    def apex(self) -> bool:
        """Whether its surface has a pole on the axis."""
        return self.quarter != WHOLE and not self.radius

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
            pole, about = (2, self.about) if self.apex else (0, pi / 2)
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


@dataclass(frozen=True, eq=False)
class Body:
    """A part of a piece as roofs, with the cuts of the plan beyond which another of them shows, or none."""

    part: Part
    open: float | None = None  # azimuth of the middle of half a dome
    made: dict[Hashable, Roof] = field(default_factory=dict)

    @cached_property
    def bows(self) -> tuple[Bow, ...]:
        """Its profile from wall to crown."""
        curve = _curve(self.part)
        return half_outline(curve, 0.0, curve.half_span, -np.inf)

    @cached_property
    def _reaches(self) -> list[float]:
        """How far from the axis each of them ends."""
        return [bow.at(bow.end)[0] for bow in self.bows]

    @cached_property
    def _half_span(self) -> float:
        return _curve(self.part).half_span

    def cuts(self) -> Iterator[Cut]:
        """Lines and circles at which its roofs end."""
        part = self.part
        if isinstance(part, BarrelPart):
            yield from self._lines(part)
        elif isinstance(part, Ball | Turned):
            (x, y), radius = part.centre, getattr(part, "radius", 0.0) if isinstance(part, Turned) else 0.0
            if isinstance(part, Turned) or len(part.names) > 1:
                yield from (Cut((1.0, 0.0), x), Cut((0.0, 1.0), y))
            for u in (bow.at(bow.start)[0] for bow in self.bows):
                yield Cut((x, y), radius=radius + u)
                if radius - u > SAME_PLACE:
                    yield Cut((x, y), radius=radius - u)
            if radius:
                yield Cut((x, y), radius=radius)

    def _lines(self, part: BarrelPart) -> Iterator[Cut]:
        signs = (part.side,) if part.side else (-1, 1)
        if part.side or self.bows[-1].at(self.bows[-1].end)[0] < SAME_PLACE:
            yield self._line(0.0)
        for bow in self.bows:
            yield from (self._line(sign * bow.at(bow.start)[0]) for sign in signs)
        if part.crown_rise or part.names[0] != part.names[1]:
            yield self._across(0.0)
        if part.splay:
            yield self._across(-1 / part.splay)

    def level(self, z: float) -> Iterator[Cut]:
        """Where it is as high as a level plane [m] that cuts it, where that is a line or circle."""
        part = self.part
        if isinstance(part, BarrelPart):
            if part.crown_rise or part.slope or part.flare:
                return
            signs = (part.side,) if part.side else (-1, 1)
            yield from (self._line(sign * u) for u in self._places(z - part.base) for sign in signs)
        elif isinstance(part, Ball | Turned):
            base = part.z if isinstance(part, Ball) else part.base
            radius = part.radius if isinstance(part, Turned) else 0.0
            for u in self._places(z - base):
                yield Cut(part.centre, radius=radius + u)
                if radius - u > SAME_PLACE:
                    yield Cut(part.centre, radius=radius - u)

    def _places(self, z: float) -> Iterator[float]:
        for bow in self.bows:
            if bow.at(bow.start)[1] + SAME_PLACE < z < bow.at(bow.end)[1] - SAME_PLACE:
                yield bow.at(asin((z - bow.z) / bow.b))[0]

    def _line(self, u: float) -> Cut:
        """Where across = u · (1 + splay · along)."""
        part = self.part
        assert isinstance(part, BarrelPart)
        (cx, cy), (ax, ay) = part.across, part.along
        x, y = cx - u * part.splay * ax, cy - u * part.splay * ay
        size = hypot(x, y)
        x, y = x / size, y / size
        return Cut((x, y), x * part.origin[0] + y * part.origin[1] + u / size)

    def _across(self, along: float) -> Cut:
        part = self.part
        assert isinstance(part, BarrelPart)
        (ax, ay), (x, y) = part.along, part.origin
        return Cut((ax, ay), ax * x + ay * y + along)

    def roof(self, x: float, y: float) -> Roof | None:
        """What it shows over a place: `NOTHING` where it does not bound its piece, None where its wall is passed."""
        part = self.part
        if isinstance(part, Ceiling | Lid):
            return self._kept((), lambda: Plane(part.z))
        if isinstance(part, BarrelPart):
            u, along = part.local(x, y)
            wide, sign = 1 + part.splay * along, 1 if u > 0 else -1
            if part.side and sign != part.side:
                return NOTHING
            u = abs(u) / wide if wide > 0 else np.inf
            if u > self._half_span:
                return None
            half = 0 if part.names[0] == part.names[1] else (1 if along > 0 else -1)
            k = self._bow(u)
            return self._kept((sign, k, half), lambda: DrawnRoof(part, sign, self.bows[k], half))
        dx, dy = x - part.centre[0], y - part.centre[1]
        radius = part.radius if isinstance(part, Turned) else 0.0
        reach = hypot(dx, dy) - radius
        if abs(reach) > self._half_span:
            return None
        whole = isinstance(part, Ball) and len(part.names) == 1
        quarter = WHOLE if whole else atan2(dy, dx) // (pi / 2) % 4
        if self.open is not None:
            quarter = self.open / (pi / 2) % 4 - 0.5
        base, sign, k = part.z if isinstance(part, Ball) else part.base, 1 if reach > 0 else -1, self._bow(abs(reach))
        springing = base if len(set(part.names)) > 1 and isinstance(part, Turned) else None
        return self._kept(
            (quarter, sign, k), lambda: TurnedRoof(part.centre, radius, base, self.bows[k], sign, springing, quarter)
        )

    def _kept(self, key: Hashable, make: Callable[[], Roof]) -> Roof:
        if key not in self.made:
            self.made[key] = make()
        return self.made[key]

    def _bow(self, u: float) -> int:
        return next((k for k, reach in enumerate(self._reaches) if u >= reach), len(self.bows) - 1)


def _curve(part: Part) -> Curve:
    if isinstance(part, Ball):
        return Curve(part.radius, part.radius, 0.0, (Arc(0.0, 0.0, part.radius),))
    assert isinstance(part, BarrelPart | Turned)
    return part.curve


def level_cuts(piece: Piece) -> Iterator[Cut]:
    """Where the level planes of a piece cut its other parts."""
    levels = [part.z for part in piece.parts if isinstance(part, Ceiling | Lid)]
    for z in levels:
        for part in piece.parts:
            if not isinstance(part, Ceiling | Lid):
                yield from Body(part).level(z)


@dataclass(frozen=True, eq=False)
class Void:
    """Pieces within their plan, as bodies of roofs."""

    pieces: tuple[Piece, ...]
    plan: Plan

    @cached_property
    def bodies(self) -> list[list[Body]]:
        """Of each piece."""
        return [[Body(part, self._open(part)) for part in piece.parts] for piece in self.pieces]

    def _open(self, part: Part) -> float | None:
        """The azimuth to which half of a dome lies whose axis is on a straight side of the plan."""
        if isinstance(part, Turned) and not part.radius:
            for side in self.plan.sides:
                x, y = side.normal if side.centre is None else (0.0, 0.0)
                if side.centre is None and abs(x * part.centre[0] + y * part.centre[1] - side.offset) < SAME_PLACE:
                    return atan2(-y, -x)
        return None

    def cuts(self) -> list[Cut]:
        """Lines, then circles, each once."""
        found: list[Cut] = []
        for piece, bodies in zip(self.pieces, self.bodies, strict=True):
            found += [*level_cuts(piece), *(cut for body in bodies for cut in body.cuts())]
            found += [cut for body in bodies if isinstance(body.part, Ball) for cut in body.level(FLOOR)]
        return found

    def over(self, x: float, y: float, *, inside: bool = True) -> list[list[Roof]]:
        """The roofs of each piece over a place, of pieces that are there; not `inside` the plan few are."""
        found = []
        for piece, bodies in zip(self.pieces, self.bodies, strict=True):
            if not inside and piece.foot is None:
                continue
            here: list[Roof] = []
            for body in bodies:
                if (roof := body.roof(x, y)) is None:
                    break
                if roof is not NOTHING:
                    here.append(roof)
            else:
                if here:
                    found.append(here)
        return found

    def foot(self, *, inside: bool) -> float:
        """The height [m] from which the body stands, inside the plan or not."""
        return FLOOR if inside else min(piece.foot for piece in self.pieces if piece.foot is not None)

"""The parts of pieces as bodies that show a roof over each place, and the cuts of the plan at which it is another."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from math import asin, atan2, hypot, pi

import numpy as np

from families.declaration.pieces import Ball, BarrelPart, Ceiling, Lid, Part, Piece, Turned, Web
from families.declaration.plan import Plan
from families.declaration.profiles import Arc, Curve
from families.solid.plan_cells import SAME_PLACE, Cut
from families.solid.roofs import FLOOR, NOTHING, WHOLE, DrawnRoof, Plane, Roof, TurnedRoof
from families.solid.web_roofs import WebBody
from families.void.profile_outline import Bow, half_outline

QUARTERS = 4  # coves whose groins leave the crown along its other cuts


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
            yield self.across(0.0)
        if part.splay:
            yield self.across(-1 / part.splay)

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

    def across(self, along: float) -> Cut:
        """Where along is as much."""
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
        assert isinstance(part, Ball | Turned)
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


def _between_webs(bodies: list[Body | WebBody]) -> list[Cut]:
    """More cuts where webs over a polygon are not as wide: their groins leave the crown beside its other cuts."""
    coves = [body for body in bodies if isinstance(body, Body) and isinstance(body.part, BarrelPart) and body.part.side]
    if len(coves) <= QUARTERS or len({_curve(body.part) for body in coves}) == 1:
        return []
    return [body.across(0.0) for body in coves]


def level_cuts(piece: Piece) -> Iterator[Cut]:
    """Where the level planes of a piece cut its other parts."""
    levels = [part.z for part in piece.parts if isinstance(part, Ceiling | Lid)]
    for z in levels:
        for part in piece.parts:
            if not isinstance(part, Ceiling | Lid | Web):
                yield from Body(part).level(z)


@dataclass(frozen=True, eq=False)
class Void:
    """Pieces within their plan, as bodies of roofs; from the height `ground` [m] on where they do not stand free."""

    pieces: tuple[Piece, ...]
    plan: Plan
    ground: float = FLOOR

    @cached_property
    def bodies(self) -> list[list[Body | WebBody]]:
        """Of each piece."""
        return [[self._body(part) for part in piece.parts] for piece in self.pieces]

    def _body(self, part: Part) -> Body | WebBody:
        return WebBody(part) if isinstance(part, Web) else Body(part, self._open(part))

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
            found += _between_webs(bodies)
        return found

    @property
    def free(self) -> float | None:
        """The height [m] from which on one of its pieces is free of the plan."""
        return min((piece.foot for piece in self.pieces if piece.foot is not None), default=None)

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

    def goes_on(self, x: float, y: float) -> bool:
        """Whether none of the bodies of a piece bounds it over a place, as webs do not beyond their walls."""
        return any(all(body.roof(x, y) is NOTHING for body in bodies) for bodies in self.bodies)

    def foot(self, *, inside: bool) -> float:
        """The height [m] from which the body stands, inside the plan or not."""
        return self.ground if inside else min(piece.foot for piece in self.pieces if piece.foot is not None)

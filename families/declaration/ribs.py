"""Ribs: bodies of stone of one section under the lines in which webs meet, along walls and along ridges.

A rib hangs on a line that is straight in plan. Its sides are plumb, half its width beside the line; its soffit runs
flat across them, parallel to the line at the depth of the section; above it ends at the webs. Ribs do not overlap:
those that meet over the room end at a boss, level below, as wide as their sides need; in a corner they are mitred.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import hypot, inf, sqrt
from typing import Annotated

import numpy as np

from families.declaration.parameters import Parametric, Range
from families.declaration.pieces import BarrelPart, Ceiling
from families.declaration.plan import Plan
from families.declaration.plan_sides import Side, Vector
from families.declaration.profiles import Curve, Profile

DIAGONAL, WALL, RIDGE = RIB_KINDS = ("diagonal", "wall", "ridge")
BOSS = "boss"
FLAT = Curve(100.0, 0.01)
"""Half an ellipse so wide and so flat that across a rib it falls by less than 1e-6 m."""
SIDES = ("south", "east", "north", "west")  # of a rectangle, as its plan has them
CORNERS = ("south_west", "south_east", "north_east", "north_west")  # where these begin
CENTRE: Vector = (0.0, 0.0)
SAME_PLACE = 1e-9  # [m]
SLIVER = 1e-6  # m² of the plan; a rib that is less there is none


@dataclass(frozen=True)
class Ribs(Parametric):
    """The section of all ribs of a vault, and the kinds of lines under which they run: `RIB_KINDS`.

    Of one along a wall, whose line is in the wall's face, half the width shows; the rest is the next bay's or none.
    """

    width: Annotated[float, Range(0.05, 2, "m", "width of the ribs")] = 0.25
    depth: Annotated[float, Range(0.03, 2, "m", "depth of the ribs below the lines of the vault")] = 0.2
    kinds: tuple[str, ...] = RIB_KINDS

    def __post_init__(self) -> None:
        """Refuse values outside their ranges, and kinds that there are not."""
        super().__post_init__()
        if not self.kinds or any(kind not in RIB_KINDS for kind in self.kinds):
            raise ValueError(f"kinds = {', '.join(self.kinds)!r}: choose of {', '.join(RIB_KINDS)}")


@dataclass(frozen=True)
class RibLine:
    """A line under which a rib may run, from `start` to `end` in plan [m].

    `part`: flat across the line, as high as the vault along it. `level`: whether a rib is that much lower all along,
    and not smaller in all radii, as it is under an arch.
    """

    name: str
    kind: str
    start: Vector
    end: Vector
    part: BarrelPart
    level: bool = False

    @property
    def length(self) -> float:
        """In plan [m]."""
        return hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    @property
    def direction(self) -> Vector:
        """Unit vector from start to end."""
        return _towards(self.start, self.end)

    @property
    def across(self) -> Vector:
        """Unit vector to the left of that."""
        x, y = self.direction
        return -y, x

    def away(self, node: Vector) -> Vector:
        """Unit vector along it from one of its ends."""
        return self.direction if node == self.start else _back(self.direction)

    def height(self, share: float) -> float:
        """At a share of the way from its start to its end [m]."""
        (x, y), (a, b) = self.start, self.end
        return _height(self.part, x + share * (a - x), y + share * (b - y))

    def soffit(self, depth: float) -> BarrelPart:
        """The underside of a rib of that depth [m].

        Raises:
            ValueError: an arc of the line is smaller than that.
        """
        if self.level:
            return replace(self.part, base=self.part.base - depth)
        curve = self.part.curve
        least = min([arc.radius for arc in curve.arcs] or [curve.half_span, curve.rise])
        if depth >= least:
            raise ValueError(f"depth = {depth:g} m: {self.name} has an arc of {least:.3g} m; ribs must be less deep")
        return self.part.grown(-depth)


@dataclass(frozen=True)
class RibPlan:
    """A rib or boss from below: the part of the vault's plan under which it hangs, and its soffit."""

    name: str
    kind: str
    plan: Plan
    soffit: BarrelPart | Ceiling

    def height(self, x: float, y: float) -> float:
        """Of its soffit over a place [m]; -inf where that is below the springing of its arch."""
        return self.soffit.z if isinstance(self.soffit, Ceiling) else _height(self.soffit, x, y)


def diagonals(sides: Sequence[Side], names: Sequence[str], curve: Curve) -> Iterator[RibLine]:
    """The lines from the corners where sides begin, each with its name, to the crown over the origin."""
    for side, name in zip(sides, names, strict=True):
        yield _arched(f"diagonal_{name}", DIAGONAL, side.start, CENTRE, curve, CENTRE)


def wall_arches(sides: Sequence[Side], names: Sequence[str], arches: Sequence[Profile]) -> Iterator[RibLine]:
    """The lines along straight sides, each with its name, on arches as wide as these."""
    for side, name, arch in zip(sides, names, arches, strict=True):
        half = hypot(side.end[0] - side.start[0], side.end[1] - side.start[1]) / 2
        yield _arched(f"wall_{name}", WALL, side.start, side.end, arch.curve(half), _middle(side))


def ridges(
    sides: Sequence[Side], names: Sequence[str], crown: float, rises: Sequence[float], bow: float = 0.0
) -> Iterator[RibLine]:
    """The lines from the crown to those of wall arches [m], straight or, the more `bow` is than 0, as a parabola."""
    for side, name, rise in zip(sides, names, rises, strict=True):
        end, bend = _middle(side), bow * (crown - rise) / 4
        (x, y), size = _towards(CENTRE, end), hypot(*end)
        part = BarrelPart(
            (y, -x),
            FLAT,
            (name, name),
            (end[0] / 2, end[1] / 2),
            (crown + rise) / 2 - FLAT.rise,
            crown_rise=bend,
            half_length=size / 2,
            slope=(rise - crown) / size,
        )
        yield RibLine(f"ridge_{name}", RIDGE, CENTRE, end, part, level=True)


def _arched(name: str, kind: str, start: Vector, end: Vector, curve: Curve, crown: Vector) -> RibLine:
    """A line on an arch whose crown is over a place in plan."""
    return RibLine(name, kind, start, end, BarrelPart(_towards(start, end), curve, (name, name), crown))


def _middle(side: Side) -> Vector:
    return (side.start[0] + side.end[0]) / 2, (side.start[1] + side.end[1]) / 2


def rib_plans(lines: Sequence[RibLine], plan: Plan, ribs: Ribs) -> Iterator[RibPlan]:
    """The ribs of a section over a convex plan with straight sides, then their bosses.

    Raises:
        ValueError: they are too deep for an arc, or so wide that a boss is longer than a rib.
    """
    half, whole = ribs.width / 2, [side.start for side in plan.sides]
    chosen = [line for line in lines if line.kind in ribs.kinds]
    bosses = {node: _around(node, chosen) for node in _nodes(chosen) if plan.holds(np.array([node]))[0]}
    reaches = {node: _reach(node, around, half) for node, around in bosses.items()}
    for line in chosen:
        cuts = [(normal, _dot(normal, line.start) + half) for normal in (line.across, _back(line.across))]
        for node in (line.start, line.end):
            if node in bosses:
                normal = _back(line.away(node))
                cuts.append((normal, _dot(normal, node) - reaches[node]))
            else:
                cuts += [cut for other in chosen if other is not line for cut in _joints(line, node, other, half)]
        corners = _within(whole, cuts)
        if len(corners) > 2 and (own := Plan.polygon(tuple(corners))).area > SLIVER:
            yield RibPlan(line.name, line.kind, own, line.soffit(ribs.depth))
    for node, around in bosses.items():
        reach = reaches[node]
        corners = _within(whole, [(line.away(node), _dot(line.away(node), node) + reach) for line in around])
        ends = [(node[0] + reach * x, node[1] + reach * y) for x, y in (line.away(node) for line in around)]
        lowest = min(_height(line.soffit(ribs.depth), *end) for line, end in zip(around, ends, strict=True))
        yield RibPlan(BOSS, BOSS, Plan.polygon(tuple(corners)), Ceiling(lowest, (BOSS,)))


def _nodes(lines: Sequence[RibLine]) -> list[Vector]:
    """The places where lines end, each once."""
    return list(dict.fromkeys(end for line in lines for end in (line.start, line.end)))


def _around(node: Vector, lines: Sequence[RibLine]) -> list[RibLine]:
    """The lines that end at a place."""
    return [line for line in lines if node in (line.start, line.end)]


def _reach(node: Vector, around: Sequence[RibLine], half: float) -> float:
    """How far from a node ribs of half a width no longer overlap, and no less than that [m].

    Raises:
        ValueError: that is farther than one of them is long.
    """
    ways = [line.away(node) for line in around]
    # Two at an angle θ overlap as far as (w/2) / tan(θ/2); of unit vectors, tan² (θ/2) = (1 - cos θ) / (1 + cos θ).
    cosines = [_dot(one, other) for k, one in enumerate(ways) for other in ways[:k]]
    reach = half * max([1.0, *(sqrt(max(1 + c, 0.0) / (1 - c)) for c in cosines)])
    least = min(line.length for line in around)
    if reach >= least:
        raise ValueError(
            f"width = {2 * half:g} m: ribs overlap as far as {reach:.3g} m from their boss, but are {least:.3g} m long"
        )
    return reach


def _joints(line: RibLine, node: Vector, other: RibLine, half: float) -> Iterator[tuple[Vector, float]]:
    """Where a rib gives way to another at one of its ends, as a normal and its offset.

    If both end there it is the line between them that is as near to either, else the other's side.
    """
    away = line.away(node)
    if node in (other.start, other.end):
        normal = _towards(away, other.away(node))
        yield normal, _dot(normal, node)
        return
    along, off = (_dot(way, node) - _dot(way, other.start) for way in (other.direction, other.across))
    if abs(off) < SAME_PLACE and 0 < along < other.length:
        normal = _back(other.across) if _dot(other.across, away) > 0 else other.across
        yield normal, _dot(normal, node) - half


def _within(corners: Sequence[Vector], cuts: Sequence[tuple[Vector, float]]) -> list[Vector]:
    """What of a convex polygon is on the near sides of lines (Sutherland and Hodgman 1974)."""
    left = list(corners)
    for normal, offset in cuts:
        before, left = left, []
        beyond = [_dot(normal, corner) - offset for corner in before]
        for k, (here, far) in enumerate(zip(before, beyond, strict=True)):
            (x, y), near = before[k - 1], beyond[k - 1]
            if min(far, near) < -SAME_PLACE and max(far, near) > SAME_PLACE:
                share = near / (near - far)
                left.append((x + share * (here[0] - x), y + share * (here[1] - y)))
            if far <= SAME_PLACE:
                left.append(here)
    return left


def _height(part: BarrelPart, x: float, y: float) -> float:
    """Of its roof over a place [m]; -inf beyond its springings."""
    across, along = part.local(x, y)
    if abs(across) >= part.curve.half_span:
        return -inf
    return part.base + part.lift(along) + part.curve.height(abs(across))


def _towards(start: Vector, end: Vector) -> Vector:
    """Unit vector from one place to another."""
    x, y = end[0] - start[0], end[1] - start[1]
    size = hypot(x, y)
    return x / size, y / size


def _back(way: Vector) -> Vector:
    return -way[0], -way[1]


def _dot(one: Vector, other: Vector) -> float:
    return one[0] * other[0] + one[1] * other[1]

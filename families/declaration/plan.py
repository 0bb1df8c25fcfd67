"""The plan of a vault: a region within straight and round sides, in which its void stands."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from math import cos, hypot, pi, sin

import numpy as np
from numpy.typing import NDArray

from families.declaration.once import Once
from families.declaration.plan_sides import MovedSide, Side, Vector, circle_sides, straight_sides

Array = NDArray[np.float64]
# Columns of a plan's table, one row a side; a straight one has its normal at CENTRE and its offset as REACH.
CENTRE_X, CENTRE_Y, REACH, SHAPE, OTHER = range(5)  # OTHER: the row of a notch's other side
# SHAPE: WITHIN and BEYOND a circle is where the plan lies. BOX: a side of a rectangle about the origin along x and y,
# which most plans are; two absolute values instead of four products make a million distances up to a third quicker.
STRAIGHT, WITHIN, BEYOND, NOTCH, BOX = 0.0, 1.0, -1.0, 2.0, 3.0
BOX_TABLE = np.array([[x, y, 0.0, BOX, 0.0] for x, y in ((0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0))])
X: Vector = (1.0, 0.0)
Y: Vector = (0.0, 1.0)


@dataclass(frozen=True)
class Axis:
    """Of a barrel between two walls: it halves their angle, and ends at the walls that its barrel is open to.

    `origin` is its middle, `across` the unit vector towards the second of the walls, `half_span` half the clear width
    there, which 1 + `splay` · along times as much is elsewhere; it runs from -`half_length` to `half_length` [m].
    """

    origin: Vector
    across: Vector
    half_span: float
    splay: float
    half_length: float


@dataclass(frozen=True)
class Plan:
    """Sides counterclockwise about the plan; those of a hole, as inside a ring, clockwise and after the others.

    The region is convex but for what lies within arcs that bound it from inside, and for sectors of more than half a
    turn (`reflex`), whose two straight sides bound a notch.
    """

    sides: tuple[Side, ...]
    reflex: bool = False

    @staticmethod
    @lru_cache(maxsize=64)  # an optimiser asks for the same again and again
    def rectangle(half_x: float, half_y: float, on_wall_x: bool = False, on_wall_y: bool = False) -> Plan:
        """By half extents [m]: sides south, east, north, west; `on_wall_x` speaks of those at the ends of x."""
        corners = ((-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y))
        plan = Plan(straight_sides(corners, (on_wall_y, on_wall_x, on_wall_y, on_wall_x)))
        # What follows from the sides is known beforehand: an optimiser waits for thousands of them.
        table = BOX_TABLE.copy()
        table[:, REACH] = half_y, half_x, half_y, half_x
        axes = Axis((0.0, 0.0), X, half_x, 0.0, half_y), Axis((0.0, 0.0), Y, half_y, 0.0, half_x)
        vars(plan).update(table=table, axes=axes)
        return plan

    @staticmethod
    @lru_cache(maxsize=64)
    def polygon(corners: tuple[Vector, ...], on_wall: tuple[bool, ...] | bool = False) -> Plan:
        """By its corners [m], counterclockwise; a flag for the side from each corner to the next, or one for all."""
        flags = on_wall if isinstance(on_wall, tuple) else (on_wall,) * len(corners)
        return Plan(straight_sides(corners, flags))

    @staticmethod
    def disc(radius: float, on_wall: bool = False) -> Plan:
        """A circle about the origin [m]."""
        return Plan(circle_sides(radius, on_wall, inside=True))

    @staticmethod
    def half_disc(radius: float, on_wall: bool = False) -> Plan:
        """The half of a disc where y > 0 [m]; its straight side is open and never on a wall."""
        east, north, west = (radius, 0.0), (0.0, radius), (-radius, 0.0)
        return Plan(
            (
                Side(west, east),
                Side(east, north, on_wall, (0.0, 0.0)),
                Side(north, west, on_wall, (0.0, 0.0)),
            )
        )

    @staticmethod
    def sector(inner: float, outer: float, angle: float, on_wall: bool = False) -> Plan:
        """A sector of a ring about the origin between two radii [m], over an angle [rad] about the y axis."""
        if angle >= 2 * pi - 1e-9:
            return Plan((*circle_sides(outer, on_wall, inside=True), *circle_sides(inner, on_wall, inside=False)))
        steps = max(1, round(angle / (pi / 2) + 0.499999))
        turns = [pi / 2 + angle * (k / steps - 0.5) for k in range(steps + 1)]
        rim, hub = ([(r * cos(a), r * sin(a)) for a in turns] for r in (outer, inner))
        outside = [Side(a, b, on_wall, (0.0, 0.0)) for a, b in pairwise(rim)]
        within = [Side(b, a, on_wall, (0.0, 0.0), False) for a, b in pairwise(hub)][::-1]
        return Plan((*outside, Side(rim[-1], hub[-1]), *within, Side(hub[0], rim[0])), reflex=angle > pi)

    @property
    def corners(self) -> Array:
        """Where sides begin (n, 2) [m]."""
        return np.array([side.start for side in self.sides])

    @Once
    def half(self) -> Array:
        """(2,) half extents [m] of the rectangle about the origin, along x and y, that holds the plan."""
        ends = [point for side in self.sides for point in side.outermost]
        return np.array([max(abs(x) for x, _ in ends), max(abs(y) for _, y in ends)])

    @property
    def half_x(self) -> float:
        """The first of them."""
        return float(self.half[0])

    @property
    def half_y(self) -> float:
        """The second."""
        return float(self.half[1])

    @property
    def width(self) -> float:
        """How wide it is where people would measure [m]: along its shorter side, or across a ring."""
        within = [side.radius for side in self.sides if side.centre is not None and not side.inside]
        around = [side.radius for side in self.sides if side.centre is not None and side.inside]
        across = max(around) - min(within) if within else 2 * self.half.max()
        return float(min(across, 2 * self.half.min()))

    @property
    def centre(self) -> Vector:
        """Of its round sides [m]; the origin if there are none."""
        return next((side.centre for side in self.sides if side.centre is not None), (0.0, 0.0))

    @property
    def turns(self) -> bool:
        """Whether it is the same whichever way it is turned about its centre."""
        return all(side.centre is not None for side in self.sides)

    @property
    def on_wall_x(self) -> bool:
        """Whether the stone may stand on a wall at the ends of x."""
        return any(side.on_wall and (side.centre is not None or abs(side.normal[0]) > 0.5) for side in self.sides)

    @property
    def on_wall_y(self) -> bool:
        """Whether the stone may stand on a wall at the ends of y."""
        return any(side.on_wall and (side.centre is not None or abs(side.normal[1]) > 0.5) for side in self.sides)

    @Once
    def table(self) -> Array:
        """Its sides as numbers (n, 5), for compiled code."""
        rows: list[tuple[float, ...]] = []
        for side in self.sides:
            if side.centre is None:
                rows.append((*side.normal, side.offset, STRAIGHT, 0.0))
            else:
                rows.append((*side.centre, side.radius, WITHIN if side.inside else BEYOND, 0.0))
        table = np.array(rows)
        if _is_box(rows):
            table[:, SHAPE] = BOX
        if self.reflex:
            pair = np.flatnonzero(table[:, SHAPE] == STRAIGHT)
            table[pair, SHAPE], table[pair, OTHER] = NOTCH, pair[::-1]
        return table

    def moved(self, x: float, y: float) -> Plan:
        """The same elsewhere, by x and y [m]."""

        def there(point: Vector) -> Vector:
            return point[0] + x, point[1] + y

        sides = (
            replace(s, start=there(s.start), end=there(s.end), centre=None if s.centre is None else there(s.centre))
            for s in self.sides
        )
        return replace(self, sides=tuple(sides))

    @Once
    def axes(self) -> tuple[Axis, Axis]:
        """Those of the barrels over four walls: between west and east, and between south and north."""
        return self._axis(1), self._axis(2)

    def _axis(self, k: int) -> Axis:
        """Towards side k from the one opposite to it; along it the sides before and after k follow."""
        ahead, behind, before, after = (self.sides[j % 4] for j in (k, k + 2, k - 1, k + 1))
        (ax, ay), (bx, by) = ahead.normal, behind.normal
        size = hypot(ax - bx, ay - by)
        cx, cy = (ax - bx) / size, (ay - by) / size
        shift = (ahead.offset - behind.offset) / size
        x, y = cx * shift, cy * shift  # where the axis is nearest to the plan's origin
        ends = [(w.offset - (nx * x + ny * y)) / (ny * cx - nx * cy) for w in (before, after) for nx, ny in (w.normal,)]
        middle = (ends[0] + ends[1]) / 2
        x, y = x - cy * middle, y + cx * middle
        half = (ahead.offset - (ax * x + ay * y)) / (ax * cx + ay * cy)
        splay = (ax * cy - ay * cx) / (ax * cx + ay * cy) / half
        return Axis((x, y), (cx, cy), half, splay + 0.0, (ends[1] - ends[0]) / 2)

    @Once
    def box(self) -> tuple[Array, Array]:
        """The lower and the upper corner (2,) [m] of what it covers."""
        ends = np.array([point for side in self.sides for point in side.outermost])
        return ends.min(axis=0), ends.max(axis=0)

    @property
    def loops(self) -> list[tuple[Side, ...]]:
        """Its sides in closed rows: the outer boundary, and that of a hole."""
        found, first = [], 0
        for last, side in enumerate(self.sides):
            if side.end == self.sides[first].start:
                found.append(self.sides[first : last + 1])
                first = last + 1
        return found

    def outlines(self, per_arc: int = 32) -> list[Array]:
        """The boundaries as points (n, 2) [m], one for each of `loops`, arcs in so many steps."""
        return [
            np.concatenate([side.points(1 if side.centre is None else per_arc)[:-1] for side in loop])
            for loop in self.loops
        ]

    def outline(self, per_arc: int = 32) -> Array:
        """The boundary as points (n, 2) [m], arcs in so many steps; a hole's follow those of the outer boundary."""
        return np.concatenate(self.outlines(per_arc))

    def distance(self, xy: Array) -> Array:
        """Signed distances (n,) [m] of points (n, 2) to the nearest boundary, negative within the plan.

        Beyond corners it is the largest of the distances to the sides.
        """
        straight, round_ = [], []
        for side in self.sides:
            if side.centre is None:
                straight.append(xy @ np.array(side.normal) - side.offset)
            else:
                reach = np.hypot(xy[:, 0] - side.centre[0], xy[:, 1] - side.centre[1]) - side.radius
                round_.append(reach if side.inside else -reach)
        if self.reflex:
            straight = [np.minimum(*straight)]
        found: Array = np.max([*straight, *round_], axis=0)
        return found

    def holds(self, xy: Array) -> NDArray[np.bool_]:
        """Whether points (n, 2) [m] lie within the plan."""
        return self.distance(xy) < 0

    def grown(self, thickness: float) -> Plan:
        """With the sides that stand on a wall moved outwards by `thickness` [m]."""
        if not any(side.on_wall for side in self.sides):
            return self
        found = []
        for loop in self.loops:
            moved = [MovedSide.of(side, thickness if side.on_wall else 0.0) for side in loop]
            starts = [moved[k - 1].meets(moved[k], side.start) for k, side in enumerate(loop)]
            ends = [*starts[1:], starts[0]]
            found += [replace(side, start=a, end=b) for side, a, b in zip(loop, starts, ends, strict=True)]
        return Plan(tuple(found), self.reflex)

    @property
    def area(self) -> float:
        """Area [m²], by Green's theorem with arcs taken exactly."""
        found = 0.0
        for side in self.sides:
            (x0, y0), (x1, y1) = side.start, side.end
            if side.centre is None:
                found += (x0 * y1 - x1 * y0) / 2
                continue
            (a, b), r = side.centre, side.radius
            found += (r * r * side.sweep + a * (y1 - y0) - b * (x1 - x0)) / 2
        return found


def _is_box(rows: list[tuple[float, ...]]) -> bool:
    """Whether the sides are those of `Plan.rectangle`, in its order."""
    if len(rows) != 4 or rows[0][:2] != (0.0, -1.0) or rows[1][:2] != (1.0, 0.0):
        return False
    return rows[2][:3] == (0.0, 1.0, rows[0][REACH]) and rows[3][:3] == (-1.0, 0.0, rows[1][REACH])

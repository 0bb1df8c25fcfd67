"""The plan cut into cells by lines and circles, so that in each of them every body shows one smooth piece of surface.

What bounds cells are parts of ways: lines and arcs, each known by its number. A cell's boundary is a loop of parts of
them, counterclockwise; neighbours share the way, and may part it at other places.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from families.declaration.plan_sides import Vector
from families.solid.cell_loops import middle, outline, within

Array = NDArray[np.float64]
SAME_PLACE = 1e-6  # [m], places nearer than that are one
EIGHTHS = np.linspace(0, 1, 9)[:-1]


@dataclass(frozen=True)
class Cut:
    """A line `normal` · p = `offset`, or with a radius the circle about `normal`."""

    normal: Vector
    offset: float = 0.0
    radius: float = 0.0

    @property
    def key(self) -> tuple[int, ...]:
        """The same for cuts that are."""
        a, b = self.normal
        sign = -1 if not self.radius and (a < -SAME_PLACE or (abs(a) <= SAME_PLACE and b < 0)) else 1
        return tuple(round(value / SAME_PLACE) for value in (sign * a, sign * b, sign * self.offset, self.radius))

    def sides(self, places: Iterable[Vector]) -> list[float]:
        """Signed distances [m] of places; 0 where they lie on the cut."""
        (a, b), offset, radius = self.normal, self.offset, self.radius
        if radius:
            found = [hypot(x - a, y - b) - radius for x, y in places]
        else:
            found = [a * x + b * y - offset for x, y in places]
        return [0.0 if -SAME_PLACE < side < SAME_PLACE else side for side in found]


@dataclass(frozen=True)
class Way:
    """A line from `start` to `end`, or an arc about `centre`; its parameter runs from 0 to 1."""

    start: Vector
    end: Vector
    centre: Vector | None = None
    angle: float = 0.0
    sweep: float = 0.0

    @cached_property
    def radius(self) -> float:
        """Radius of an arc [m]."""
        assert self.centre is not None
        return hypot(self.start[0] - self.centre[0], self.start[1] - self.centre[1])

    @cached_property
    def numbers(self) -> tuple[float, ...]:
        """As the compiled functions take it."""
        arc = (0.0,) * 5 if self.centre is None else (*self.centre, self.radius, self.angle, self.sweep)
        return *self.start, *self.end, *arc

    @cached_property
    def row(self) -> Array:
        """The same as an array."""
        return np.array(self.numbers)

    def at(self, t: float) -> Vector:
        """Place at a parameter."""
        if t in (0.0, 1.0):
            return self.end if t else self.start
        if self.centre is None:
            (a, b), (c, d) = self.start, self.end
            return a + t * (c - a), b + t * (d - b)
        angle = self.angle + t * self.sweep
        return self.centre[0] + self.radius * cos(angle), self.centre[1] + self.radius * sin(angle)

    def places(self, t: Array) -> tuple[Array, Array]:
        """Places, x and y (n,), at parameters (n,)."""
        if self.centre is None:
            (a, b), (c, d) = self.start, self.end
            return a + t * (c - a), b + t * (d - b)
        angle, radius = self.angle + t * self.sweep, self.radius
        return self.centre[0] + radius * np.cos(angle), self.centre[1] + radius * np.sin(angle)

    def right(self, x: float, y: float) -> Vector:
        """Unit vector to its right at a place on it."""
        if self.centre is None:
            dx, dy = self.end[0] - self.start[0], self.end[1] - self.start[1]
            size = hypot(dx, dy)
            return dy / size, -dx / size
        turn = 1 if self.sweep > 0 else -1
        return turn * (x - self.centre[0]) / self.radius, turn * (y - self.centre[1]) / self.radius

    def crossing(self, cut: Cut, low: float, high: float) -> float:
        """Parameter between two, on either side of a cut, where the way crosses it."""
        if self.centre is None and not cut.radius:
            first, last = self._raw(cut, low), self._raw(cut, high)
            return low + (high - low) * first / (first - last)
        if self.centre is None:
            # The root between them of |start + t way - centre|² = radius².
            (x, y), (a, b), (c, d) = cut.normal, self.start, self.end
            square, half = (c - a) ** 2 + (d - b) ** 2, (a - x) * (c - a) + (b - y) * (d - b)
            root = sqrt(max(half**2 - square * ((a - x) ** 2 + (b - y) ** 2 - cut.radius**2), 0.0))
            found = [(-half - root) / square, (-half + root) / square]
            middle = (low + high) / 2
            return min(found, key=lambda t: abs(t - middle))
        return float(brentq(lambda t: self._raw(cut, t), low, high, xtol=1e-15))

    def _raw(self, cut: Cut, t: float) -> float:
        (x, y), (a, b) = self.at(t), cut.normal
        return hypot(x - a, y - b) - cut.radius if cut.radius else a * x + b * y - cut.offset


@dataclass(frozen=True)
class Part:
    """The part of way number `way` from one parameter to another, which may run backwards."""

    way: int
    start: float
    end: float


@dataclass
class Cell:
    """A loop of parts of ways, counterclockwise."""

    loop: list[Part]
    ways: list[Way]

    @cached_property
    def table(self) -> Array:
        """A row a part: its way as numbers, its start and its end."""
        return np.array([(*self.ways[part.way].numbers, part.start, part.end) for part in self.loop])

    @cached_property
    def corners(self) -> list[Vector]:
        """Where its parts start."""
        return [self.ways[part.way].at(part.start) for part in self.loop]

    @cached_property
    def middle(self) -> Vector:
        """A place well within."""
        x, y = middle(self.table)
        return x, y

    def outline(self, shares: Array) -> tuple[Array, Array]:
        """Places x, y (n,) along the boundary at shares (k,) of each part."""
        x, y = outline(self.table, shares)
        return x, y

    def within(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Whether places (n,) are in the cell, which is what lies on the inner side of all its lines and circles."""
        found: NDArray[np.bool_] = within(self.table, x, y)
        return found


@dataclass
class Ground:
    """Ways, and the cells between them."""

    ways: list[Way] = field(default_factory=list)
    cells: list[Cell] = field(default_factory=list)

    @staticmethod
    def polygon(corners: Iterable[Vector]) -> Ground:
        """One cell."""
        places = list(corners)
        ways = [Way(a, b) for a, b in zip(places, [*places[1:], places[0]], strict=True)]
        return Ground(ways, [Cell([Part(k, 0.0, 1.0) for k in range(len(ways))], ways)])

    def meets(self, circle: Cut) -> bool:
        """Whether a circle may leave a cell: one of them reaches beyond it, and one comes within."""
        sides = circle.sides(place for cell in self.cells for place in cell.corners)
        return max(sides) > 0 and (min(sides) < 0 or any(self._foot(w, circle) is not None for w in self._lines()))

    def feet(self, centre: Vector) -> list[Cut]:
        """The lines through a place square to the straight ways of cells, where those come nearest to it."""
        found = (self._foot(way, Cut(centre, radius=np.inf)) for way in self._lines())
        return [foot for foot in found if foot is not None]

    def _lines(self) -> Iterator[Way]:
        numbers = {part.way for cell in self.cells for part in cell.loop}
        return (way for way in (self.ways[k] for k in sorted(numbers)) if way.centre is None)

    @staticmethod
    def _foot(way: Way, circle: Cut) -> Cut | None:
        """The line square to a way through a circle's centre, where it meets the way within the circle."""
        (x, y), (a, b), (c, d) = circle.normal, way.start, way.end
        size = hypot(c - a, d - b)
        dx, dy = (c - a) / size, (d - b) / size
        along, aside = dx * (x - a) + dy * (y - b), dx * (y - b) - dy * (x - a)
        if not SAME_PLACE < along < size - SAME_PLACE or abs(aside) > circle.radius - SAME_PLACE:
            return None
        return Cut((dx, dy), dx * x + dy * y)

    def cut(self, cut: Cut) -> None:
        """Cut all cells."""
        self.cells = [piece for cell in self.cells for piece in self.parted(cell, cut)]

    def parted(self, cell: Cell, cut: Cut) -> list[Cell]:
        """A cell, or the two in which a cut parts it."""
        sides = cut.sides(cell.corners)
        if not (min(sides) < 0 < max(sides)):
            return [cell]
        loop: list[tuple[Part, float]] = []  # parts, each with the side of its start
        count = len(sides)
        for k, part in enumerate(cell.loop):
            side, after = sides[k], sides[(k + 1) % count]
            if side * after < 0:
                t = self.ways[part.way].crossing(cut, part.start, part.end)
                loop += [(Part(part.way, part.start, t), side), (Part(part.way, t, part.end), 0.0)]
            else:
                loop.append((part, side))
        on = [k for k, (_, side) in enumerate(loop) if side == 0.0]
        # The way in: on the cut, and then on its positive side; the way out likewise.
        size = len(loop)
        ins = [k for k in on if loop[(k + 1) % size][1] > 0]
        outs = [k for k in on if loop[(k + 1) % size][1] < 0]
        if len(ins) != 1 or len(outs) != 1:
            raise ValueError("a line of the plan meets the edge of a cell more than twice; change a parameter a little")
        first, last = ins[0], outs[0]
        above = [loop[(first + k) % size][0] for k in range((last - first) % size)]
        below = [loop[(last + k) % size][0] for k in range((first - last) % size)]
        way = self._between(cut, *(self.ways[loop[k][0].way].at(loop[k][0].start) for k in (last, first)))
        return [Cell([*above, Part(way, 0.0, 1.0)], self.ways), Cell([*below, Part(way, 1.0, 0.0)], self.ways)]

    def _between(self, cut: Cut, start: Vector, end: Vector) -> int:
        if cut.radius:
            (a, b) = cut.normal
            angle = atan2(start[1] - b, start[0] - a)
            sweep = (atan2(end[1] - b, end[0] - a) - angle + pi) % (2 * pi) - pi
            self.ways.append(Way(start, end, (a, b), angle, sweep))
        else:
            self.ways.append(Way(start, end))
        return len(self.ways) - 1

    def inwards(self, cell: Cell, shares: Array) -> tuple[Array, Array]:
        """Unit vectors, x and y (n,), square to a cell's boundary and into it, at the places of `outline`."""
        xs, ys = [], []
        for part in cell.loop:
            way, turn = self.ways[part.way], 1.0 if part.end > part.start else -1.0
            if way.centre is None:
                dx, dy = turn * (way.end[0] - way.start[0]), turn * (way.end[1] - way.start[1])
                size = hypot(dx, dy)
                xs.append(np.full(len(shares), -dy / size))
                ys.append(np.full(len(shares), dx / size))
            else:
                angle = way.angle + (part.start + shares * (part.end - part.start)) * way.sweep
                outside = -turn if way.sweep > 0 else turn
                xs.append(outside * np.cos(angle))
                ys.append(outside * np.sin(angle))
        return np.concatenate(xs), np.concatenate(ys)

"""Which roof shows where: each cell of the plan parted into regions by the lines in which two roofs are as high.

Within a cell all heights are smooth, so that the order of roofs along its boundary tells which lines cross it: none,
one from side to side, or three from a point inside. Any other cell is halved first.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan_sides import Vector
from families.solid.curves import Spline
from families.solid.heights import WIDTH, change, height_at, heights, shown, shown_at, sole, trace
from families.solid.laid_curves import laid
from families.solid.plan_cells import EIGHTHS, SAME_PLACE, Cell, Cut, Ground, Part
from families.solid.roofs import Roof

Array = NDArray[np.float64]
SAME_HEIGHT = 1e-7  # [m], heights nearer than that are one
INWARDS = 1e-3  # [m] beside an edge on which two roofs are as high all along, where it is looked which shows
HALVED = 14  # times that a cell may be halved
EDGE_SHARES = (1 - np.cos(np.pi * (np.arange(24) + 0.5) / 24)) / 2
MIDST = slice(6, 18)  # of these
THIRDS = np.array([0.0, 0.35, 0.65])
RAYS = np.array([0.15, 0.4, 0.7, 0.9])  # of the way from the middle of a cell to its boundary


@dataclass(frozen=True, eq=False)
class Line:
    """The curve in which two roofs meet, from one place to another, and its spline [mm]."""

    start: Vector
    end: Vector
    spline: Spline


@dataclass(frozen=True)
class Along:
    """The way along a line, or back."""

    line: Line
    forward: bool


Bound = Part | Along


@dataclass(frozen=True)
class Region:
    """Where one roof shows, in a loop counterclockwise."""

    roof: int
    loop: list[Bound]


@dataclass
class Skin:
    """The roofs of a surface, and what they show in the cells of a ground."""

    ground: Ground
    roofs: list[Roof] = field(default_factory=list)
    regions: list[Region] = field(default_factory=list)
    _numbers: dict[int, int] = field(default_factory=dict)
    _table: Array = field(default_factory=lambda: np.empty((0, WIDTH)))

    def number(self, roof: Roof) -> int:
        """The number of a roof."""
        key = id(roof)
        if key not in self._numbers:
            self._numbers[key] = len(self.roofs)
            self.roofs.append(roof)
        return self._numbers[key]

    @property
    def table(self) -> Array:
        """The rows of all roofs."""
        if len(self._table) < len(self.roofs):
            self._table = np.array([roof.row for roof in self.roofs])
        return self._table

    def height(self, roof: int, x: float, y: float) -> float:
        """Height of a roof over a place."""
        return float(height_at(x, y, self.table, roof))

    def heights(self, roof: int, x: Array, y: Array) -> Array:
        """Heights (n,) of a roof over places."""
        found: Array = heights(x, y, self.table, roof)
        return found

    def lay(self, cell: Cell, pieces: list[list[Roof]]) -> None:
        """The regions of a cell over which pieces show these roofs."""
        rows, owners = [], []
        for k, piece in enumerate(pieces):
            rows += [self.number(roof) for roof in piece]
            owners += [k] * len(piece)
        if len(rows) == 1:
            self.regions.append(Region(rows[0], list(cell.loop)))
            return
        self.regions += self._parted(cell, np.array(rows), np.array(owners), HALVED)

    def _parted(self, cell: Cell, rows: NDArray[np.int64], owners: NDArray[np.int64], depth: int) -> Iterator[Region]:
        if (only := sole(cell.table, EDGE_SHARES, (THIRDS, RAYS), self.table, rows, owners)) >= 0:
            yield Region(int(rows[only]), list(cell.loop))
            return
        found = _Outline(self, cell, rows, owners)
        changes = found.changes()
        regions = found.regions(changes)
        if regions is not None:
            yield from regions
            return
        if not depth:
            x, y = cell.middle
            raise ValueError(f"surfaces meet in too many lines at ({x:.3f}, {y:.3f}) m; change a parameter a little")
        for half in self._halves(cell):
            yield from self._parted(half, rows, owners, depth - 1)

    def _halves(self, cell: Cell) -> list[Cell]:
        x, y = cell.outline(EIGHTHS)
        wide = np.ptp(x) > np.ptp(y)
        place = float((x.min() + x.max()) / 2 if wide else (y.min() + y.max()) / 2)
        return self.ground.parted(cell, Cut((1.0, 0.0) if wide else (0.0, 1.0), place))


@dataclass
class _Change:
    """Where on a cell's boundary one roof gives way to another: at a parameter of a part, whose own end it may be."""

    part: int
    at: float
    place: Vector
    before: int
    after: int


@dataclass
class _Outline:
    """A cell's boundary, seen from the roofs over it."""

    skin: Skin
    cell: Cell
    rows: NDArray[np.int64]
    owners: NDArray[np.int64]
    tangled: bool = False  # whether what shows changes along an edge on which two roofs are as high

    def changes(self) -> list[_Change]:
        """In order; empty where one roof shows all around."""
        ground = self.skin.ground
        x, y = self.cell.outline(EDGE_SHARES)
        parts = np.repeat(np.arange(len(self.cell.loop)), len(EDGE_SHARES))
        at = np.concatenate([part.start + EDGE_SHARES * (part.end - part.start) for part in self.cell.loop])
        label, sure = shown(x, y, self.skin.table, self.rows, self.owners)
        unsure = [k for k in range(len(self.cell.loop)) if not sure[parts == k].any()]
        if unsure:
            dx, dy = ground.inwards(self.cell, EDGE_SHARES)
            for k in unsure:
                edge = np.flatnonzero(parts == k)[MIDST]  # at its ends the next edge is as near
                a, b = x[edge] + INWARDS * dx[edge], y[edge] + INWARDS * dy[edge]
                label[edge], sure[edge] = self._shown(a, b)
                self.tangled |= len(set(label[edge][sure[edge]].tolist())) > 1
        if not sure.any():  # all of them are as high everywhere
            sure[:], label[:] = True, label[0]
        self.labels = label[sure]
        x, y, parts, at, label = x[sure], y[sure], parts[sure], at[sure], label[sure]
        found: list[_Change] = []
        turns = np.flatnonzero(label[1:] != label[:-1]).tolist()
        for i in [*turns, len(label) - 1] if label[0] != label[-1] else turns:
            j = (i + 1) % len(label)
            if parts[i] == parts[j]:
                found += self._between(int(parts[i]), at[i], at[j], int(label[i]), int(label[j]))
            else:
                found += self._around(i, j, parts, at, label)
        return found

    def _between(self, part: int, start: float, end: float, first: int, last: int) -> Iterator[_Change]:
        """Changes along one part."""
        way = self.skin.ground.ways[self.cell.loop[part].way]
        row, before = way.row, first
        for _ in range(4):
            t, after = change(row, start, end, self.skin.table, self.rows, self.owners)
            yield self._snapped(part, t, before, after)
            if after == last:
                return
            start, before = t, after

    def _around(
        self, i: int, j: int, parts: NDArray[np.int64], at: Array, label: NDArray[np.int64]
    ) -> Iterator[_Change]:
        """Changes about the vertex between two parts."""
        loop, first, last = self.cell.loop, int(label[i]), int(label[j])
        k, following = int(parts[i]), int(parts[j])
        place = self.cell.corners[following]
        if (
            abs(self._height(first, place) - self._height(last, place)) < SAME_HEIGHT
            or (k + 1) % len(loop) != following
        ):
            yield _Change(following, loop[following].start, place, first, last)
            return
        here = shown_at(*place, self.skin.table, self.rows, self.owners)
        if here != first:
            yield from self._between(k, float(at[i]), loop[k].end, first, here)
        if here != last:
            yield from self._between(following, loop[following].start, float(at[j]), here, last)

    def _snapped(self, part: int, t: float, before: int, after: int) -> _Change:
        """A change, at the end of its part if that is as near as cannot be told."""
        ground, loop = self.skin.ground, self.cell.loop
        way = ground.ways[loop[part].way]
        place = way.at(t)
        z = self._height(before, place)
        for k, end in ((part, loop[part].start), ((part + 1) % len(loop), loop[part].end)):
            corner = way.at(end)
            if (
                max(abs(corner[0] - place[0]), abs(corner[1] - place[1])) < SAME_PLACE
                and max(abs(self._height(label, corner) - z) for label in (before, after)) < SAME_PLACE
            ):
                return _Change(k, loop[k].start, corner, before, after)
        return _Change(part, t, place, before, after)

    def _height(self, label: int, place: Vector) -> float:
        return self.skin.height(int(self.rows[label]), *place)

    def regions(self, changes: list[_Change]) -> list[Region] | None:
        """The regions of the cell, None where it must be halved first."""
        if self.tangled:
            return None
        inside = self._inside()
        if not changes:
            label = int(self.labels[0])
            return [Region(int(self.rows[label]), list(self.cell.loop))] if set(inside) <= {label} else None
        labels = [c.after for c in changes]
        if len(changes) > 3 or len(set(labels)) < len(labels) or not set(inside) <= set(labels):
            return None
        if len(changes) == 2:
            line = self._line(changes[0].place, changes[1].place, changes[0].before, changes[0].after)
            if line is None:
                return None
            ways: list[list[Bound]] = [[Along(line, forward=False)], [Along(line, forward=True)]]
        elif len(changes) == 3:
            middle = self._meeting(labels, np.mean([c.place for c in changes], axis=0))
            if middle is None:
                return None
            lines = [self._line(c.place, middle, c.before, c.after) for c in changes]
            if any(line is None for line in lines):
                return None
            ways = []
            for k in range(3):
                out, back = lines[(k + 1) % 3], lines[k]
                assert out is not None
                assert back is not None
                ways.append([Along(out, forward=True), Along(back, forward=False)])
        else:
            return None
        found = []
        for k, (c, way) in enumerate(zip(changes, ways, strict=True)):
            along = self._along(c, changes[(k + 1) % len(changes)])
            found.append(Region(int(self.rows[c.after]), [*along, *way]))
        return found

    def _shown(self, x: Array, y: Array) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
        """What shows over places, and where they are in the cell and no other roof is as high."""
        label, sure = shown(x, y, self.skin.table, self.rows, self.owners)
        return label, sure & self.cell.within(x, y)

    def _inside(self) -> list[int]:
        x, y = self.cell.outline(THIRDS)
        mx, my = self.cell.middle
        xs = (mx + np.outer(RAYS, x - mx)).ravel()
        ys = (my + np.outer(RAYS, y - my)).ravel()
        label, sure = self._shown(xs, ys)
        return sorted(set(label[sure].tolist()))

    def _along(self, start: _Change, end: _Change) -> list[Bound]:
        """The boundary from one change to the next."""
        loop, count = self.cell.loop, len(self.cell.loop)
        if start.part == end.part and _ahead(loop[start.part], start.at, end.at):
            return [Part(loop[start.part].way, start.at, end.at)]
        found: list[Bound] = []
        k, part = start.part, loop[start.part]
        if start.at != part.end:
            found.append(Part(part.way, start.at, part.end))
        k = (k + 1) % count
        while k != end.part:
            found.append(loop[k])
            k = (k + 1) % count
        if end.at != loop[k].start:
            found.append(Part(loop[k].way, loop[k].start, end.at))
        return found

    def _line(self, start: Vector, end: Vector, a: int, b: int) -> Line | None:
        """The curve in which two roofs meet between two places, None where it cannot be followed."""
        first, last = np.array(start), np.array(end)
        parts, rows = self.cell.table, (int(self.rows[a]), int(self.rows[b]))

        def points(share: Array) -> Array:
            found: Array = trace(first, last, (1 - np.cos(np.pi * share)) / 2, parts, self.skin.table, *rows)
            return found

        spline = laid(points, self.skin.table, rows[0])
        return None if spline is None else Line(start, end, spline)

    def _meeting(self, labels: list[int], place: Array) -> Vector | None:
        """Where three roofs are as high, by Newton's method from a place."""
        x, y = self.cell.outline(EIGHTHS)
        size = max(np.ptp(x), np.ptp(y))
        step = 1e-6 * size

        def miss(at: Array) -> Array:
            z = [self._height(k, (float(at[0]), float(at[1]))) for k in labels]
            return np.array([z[0] - z[1], z[1] - z[2]])

        for _ in range(40):
            here = miss(place)
            slopes = np.stack([(miss(place + d) - miss(place - d)) / (2 * step) for d in step * np.eye(2)], axis=1)
            det = np.linalg.det(slopes)
            if abs(det) < 1e-14:
                return None
            way = np.linalg.solve(slopes, here)
            way *= min(1.0, 0.3 * size / max(np.hypot(*way), 1e-300))
            place = place - way
            if np.abs(way).max() < 1e-13:
                break
        if np.abs(miss(place)).max() > 1e-9:
            return None
        found = float(place[0]), float(place[1])
        return found if self.cell.within(place[:1], place[1:])[0] else None


def _ahead(part: Part, start: float, end: float) -> bool:
    return (end - start) * (part.end - part.start) > 0

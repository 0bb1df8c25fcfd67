"""Necks: whether two regions of one primitive that meet hang together by a strip, or touch in a point or a line.

Cells are too coarse to tell: two of them on either side of a neck are all of it. So the points of the full cloud decide
around each contact, those that are clear of every other primitive's intersection curve with theirs: in a strip they
lead from one region to the other, in a point they do not.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from segmentation.primitives.numeric import gradients
from segmentation.ransac.hypotheses import Floats, Ints, Shapes
from segmentation.ransac.point_labels import BITS, CHUNK, index_keys, neighbours, slot_of
from segmentation.ransac.working_cloud import WorkingCloud
from segmentation.threads import threads

Mask = NDArray[np.bool_]

CLEAR = 0.010  # [m] from a curve to the points that may lead through a neck: 0.03 m of one of 0.05 m
CLEAR_SPACINGS = 1.2  # the same in spacings of the points: a neck of fewer than about five is not seen
NECK_STEP = 2.2  # clearances between points. Across a right-angled crossing they are 2.8 apart, 2.3 in a web of 120°
CELLS_A_SQUARE = 1.5  # that a slanting surface meets
HOPS = 48  # cells from where two regions meet to the core of either: half of the longest strip


@dataclass(frozen=True, eq=False)
class Necks:
    """What tells strips from points: shapes, labels (m,) of the cells, regions (m,) of each primitive and their cores.

    `cores` (m,) are the cells further than `reach` cells from other primitives. What lies within `noise` [m] of two
    primitives is on neither.
    """

    xyz: NDArray[np.floating]
    cloud: WorkingCloud
    shapes: Shapes
    labels: Ints
    cores: Ints
    regions: Ints
    reach: int
    noise: float

    def strips(self) -> Ints:
        """Pairs (p, 2) of regions that a strip joins: 0.05 m wide, or five spacings where the points are sparse."""
        contacts = list(self._contacts())
        if not contacts:
            return np.empty((0, 2), dtype=np.int64)
        zone = np.unique(np.concatenate([cells for _, cells in contacts]))
        owner = np.full(len(self.cloud), -1, dtype=np.int64)
        owner[zone] = np.arange(len(zone))
        point, cell = self._points(zone)
        order = np.argsort(cell, kind="stable")
        point, ends = point[order], np.searchsorted(cell[order], np.arange(len(zone) + 1))
        found = []
        for pair, cells in contacts:
            runs = [point[ends[z] : ends[z + 1]] for z in owner[cells]]
            where = np.repeat(cells, [len(run) for run in runs])
            if self._passable(np.asarray(self.xyz[np.concatenate(runs)], dtype=np.float64), where, pair):
                found.append(pair)
        return np.array(found, dtype=np.int64).reshape(-1, 2)

    def _contacts(self) -> Iterator[tuple[tuple[int, int], Ints]]:
        """Each place where two regions of a primitive meet: the two, and the cells around up to their cores."""
        tail, head, regions = self.cloud.tail, self.cloud.head, self.regions
        met = np.flatnonzero((regions[tail] < regions[head]) & (regions[tail] > 0))
        met = met[self.labels[tail[met]] == self.labels[head[met]]]
        one, other = regions[tail[met]], regions[head[met]]
        for pair in np.unique(np.stack((one, other), axis=1), axis=0).tolist():
            mine = met[(one == pair[0]) & (other == pair[1])]
            left = np.unique(np.concatenate((tail[mine], head[mine])))
            while len(left):
                place = left[:1]
                while len(more := np.intersect1d(self._next_to(place), left)) > len(place):
                    place = more
                left = np.setdiff1d(left, place)
                around = self._around(place, pair)
                if around is not None:
                    yield (pair[0], pair[1]), around

    def _around(self, cells: Ints, pair: list[int]) -> Ints | None:
        """The cells around, of the two regions out to a little of either's core, and those next to them; None where one
        has no core near.
        """
        for _ in range(HOPS):
            core = self.regions[cells[self.cores[cells] > 0]]
            if all((core == region).any() for region in pair):
                return self._next_to(cells)
            grown = self._next_to(cells)
            grown = grown[np.isin(self.regions[grown], pair)]
            if len(grown) == len(cells):
                return None
            cells = grown
        return None

    def _next_to(self, cells: Ints) -> Ints:
        """The cells (z,), ascending, and those that touch them."""
        return np.union1d(cells, neighbours(self.cloud, cells, cells)[0])

    def _points(self, zone: Ints) -> tuple[Ints, Ints]:
        """The points (p,) of the cloud that lie in cells of the zone (z,), and the cell (p,) in the zone of each."""
        size, cell = self.cloud.size, self.cloud.cell[zone]
        low = cell.min(axis=0)
        cell = cell - low
        span = cell.max(axis=0) + 1
        keys = (cell[:, 0] << 2 * BITS) | (cell[:, 1] << BITS) | cell[:, 2]
        table = np.full(1 << (2 * len(keys)).bit_length(), -1, dtype=np.int32)
        index_keys(keys, table)
        base = np.floor(self.cloud.raw[zone[0]] * (1 / size)) - cell[0]
        place = np.empty(len(self.xyz), dtype=np.int32)
        starts = range(0, len(self.xyz), CHUNK)

        def work(start: int) -> None:
            part = slice(start, start + CHUNK)
            _find_points(self.xyz[part], 1 / size, base, span, keys, table, place[part])

        with threads() as pool:
            list(pool.map(work, starts))
        point = np.flatnonzero(place >= 0)
        return point, place[point].astype(np.int64)

    def _passable(self, xyz: Floats, cell: Ints, pair: tuple[int, int]) -> bool:
        """Whether points (p, 3) in cells (p,) lead from core to core, clear of other primitives' curves by `CLEAR`."""
        cells = np.unique(cell)
        k = int(self.labels[cells[self.regions[cells] == pair[0]][0]])
        spacing = self.cloud.size / math.sqrt(CELLS_A_SQUARE * float(np.median(self.cloud.count[cells])))
        clear = max(CLEAR, CLEAR_SPACINGS * spacing)
        gap, normal = self._gradients(k, xyz)
        free = np.abs(gap) <= self.cloud.epsilon
        around = cells
        for _ in range(self.reach):
            around = self._next_to(around)
        for other in np.setdiff1d(self.labels[around], [-1, k]):
            distance, direction = self._gradients(other, xyz)
            away = np.abs(distance) - np.abs(gap)
            sine = np.sqrt(np.maximum(1.0 - np.einsum("ij,ij->i", normal, direction) ** 2, 1e-12))
            close = np.flatnonzero(free & (away <= np.maximum(clear * sine, self.noise)))
            theirs = (away < -self.noise) & (np.abs(distance) <= self.cloud.epsilon)
            held = around[self.labels[around] == other]
            far = 2.0 * np.maximum(clear, self.noise / sine[close]) + 2.0 * spacing
            free[close] = ~self._beside(xyz[close], cell[close], far, xyz[theirs], held)
        passing = np.flatnonzero(free)
        if len(passing) == 0:
            return False
        passing = passing[np.argsort(xyz[passing, axis := int(np.argmax(np.ptp(xyz, axis=0)))], kind="stable")]
        root = _linked(xyz[passing], axis, NECK_STEP * clear)
        core = self.cores[cell[passing]] > 0
        region = self.regions[cell[passing]]
        ends = (root[core & (region == side)] for side in pair)
        return bool(np.intersect1d(*ends).size)

    def _beside(self, xyz: Floats, cell: Ints, far: Floats, theirs: Floats, held: Ints) -> Mask:
        """Which points (c, 3) on another primitive's surface have points (t, 3) of its own within `far` (c,) [m].

        Elsewhere its surface goes on without it. Where `far` is out of reach, its cells `held` tell.
        """
        for _ in range(self.reach):
            held = self._next_to(held)
        beside: Mask = np.isin(cell, held)
        told = beside & (far < self.reach * self.cloud.size)
        if told.any():
            beside[told] = False
            if len(theirs):
                beside[told] = (
                    cKDTree(theirs).query(xyz[told], distance_upper_bound=float(far[told].max()))[0] < far[told]
                )
        return beside

    def _gradients(self, k: int, xyz: Floats) -> tuple[Floats, Floats]:
        """Signed distances (p,) [m] of points (p, 3) from a primitive, and its normals there (p, 3)."""
        distance, normal = np.empty(len(xyz)), np.empty((len(xyz), 3))
        gradients(int(self.shapes.kinds[k]), self.shapes.rows[k], xyz, distance, normal)
        return distance, normal


@njit(cache=True, nogil=True)
def _find_points(
    xyz: NDArray[np.floating],
    scale: float,
    base: Floats,
    span: Ints,
    keys: Ints,
    table: NDArray[np.int32],
    place: NDArray[np.int32],
) -> None:
    """Where the cell of each point (n, 3) stands among the keys, -1 for none, into `place` (n,)."""
    for i in range(len(xyz)):
        place[i] = -1
        x = math.floor(xyz[i, 0] * scale) - base[0]
        if not 0 <= x < span[0]:
            continue
        y, z = math.floor(xyz[i, 1] * scale) - base[1], math.floor(xyz[i, 2] * scale) - base[2]
        if not (0 <= y < span[1] and 0 <= z < span[2]):
            continue
        key = (np.int64(x) << (2 * BITS)) | (np.int64(y) << BITS) | np.int64(z)
        place[i] = table[slot_of(table, keys, key)]


@njit(cache=True, nogil=True)
def _linked(xyz: Floats, axis: int, step: float) -> Ints:
    """The cluster of each point (p, 3), ascending along an axis, where points nearer than `step` [m] are linked."""
    root = np.arange(len(xyz))
    for i in range(len(xyz)):
        j = i - 1
        while j >= 0 and xyz[i, axis] - xyz[j, axis] < step:
            dx, dy, dz = xyz[i, 0] - xyz[j, 0], xyz[i, 1] - xyz[j, 1], xyz[i, 2] - xyz[j, 2]
            if dx * dx + dy * dy + dz * dz < step * step:
                a, b = i, j
                while root[a] != a:
                    a = root[a]
                while root[b] != b:
                    b = root[b]
                root[max(a, b)] = min(a, b)
                root[i] = min(a, b)
            j -= 1
    for i in range(len(xyz)):
        root[i] = root[root[i]]
    return root

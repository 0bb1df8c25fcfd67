"""Thinning: the mean of the points in each cell of a cubic grid."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segmentation.cloud import Floats
from segmentation.threads import threads

BLOCKS = 8
"""Runs of points that are summed apart. Fixed, so that the sums round alike on any number of cores."""
START = 1 << 12
"""Cells that a run has room for at first; a power of two."""
BITS = 21
REACH = 2**BITS - 1
"""Bits of a cell's number along one axis, three of which make the cell's key; and the largest such number."""
GOLDEN, HIGH = np.uint64(0x9E3779B97F4A7C15), np.uint64(32)
"""2^64 over the golden ratio spreads keys over the table: multiplicative hashing (Knuth, vol. 3, 6.4)."""


@dataclass(frozen=True, eq=False)
class Thinned:
    """The occupied cells of a grid, in the order in which the points first reach them.

    xyz: (m, 3) mean of a cell's points, of the input's dtype. count: (m,) how many they are.
    first: (m,) index of a cell's first point, for attributes that have no mean, such as a class.
    inverse: (n,) int32 cell of each point, -1 for a point that is not finite; None unless asked for.
    """

    xyz: Floats
    count: NDArray[np.int64]
    first: NDArray[np.int64]
    inverse: NDArray[np.int32] | None = None

    def __len__(self) -> int:
        return len(self.xyz)

    def mean(self, values: NDArray[Any]) -> NDArray[np.float64]:
        """Means (m,) or (m, k) by cell of an attribute (n,) or (n, k). Raises ValueError without `inverse`."""
        if self.inverse is None:
            raise ValueError("inverse is None: thin with inverse=True to take means of attributes")
        if len(values) != len(self.inverse):
            raise ValueError(f"values has {len(values)} rows, the thinned cloud had {len(self.inverse)} points")
        inside = self.inverse >= 0
        cells, columns = self.inverse[inside], np.asarray(values, np.float64)[inside].reshape(inside.sum(), -1)
        sums = [np.bincount(cells, column, minlength=len(self)) for column in columns.T]
        return (np.stack(sums, axis=1) / self.count[:, None]).reshape(len(self), *values.shape[1:])


def thin(xyz: Floats, size: float, *, inverse: bool = False) -> Thinned:
    """The mean of the points (n, 3) [m] in each occupied cell of edge `size` [m]; points not finite are passed over.

    Cells lie at whole multiples of `size`, so that a crop of a cloud falls into the same cells. The result is the same
    to the byte for the same input on any machine. Takes about 80 bytes a cell, and 4 a point for the inverse.
    Raises ValueError if size is not positive or the cloud is over 2 million cells long.

    >>> thinned = thin(np.array([[0.1, 0.1, 0.1], [0.3, 0.1, 0.1], [1.5, 0.5, 0.5]]), 1.0)
    >>> thinned.xyz.round(3).tolist(), thinned.count.tolist()
    ([[0.2, 0.1, 0.1], [1.5, 0.5, 0.5]], [2, 1])
    """
    if not (np.isfinite(size) and size > 0):
        raise ValueError(f"size = {size:g} m is not positive: give the edge of a cell")
    if xyz.ndim != 2 or xyz.shape[1] != 3:
        raise ValueError(f"xyz has the shape {xyz.shape}, expected is (n, 3)")
    xyz = np.ascontiguousarray(xyz)
    edges = np.linspace(0, len(xyz), BLOCKS + 1).astype(np.int64)
    cells = np.empty(len(xyz) if inverse else 0, np.int32)
    scale = 1 / size
    with threads() as pool:

        def in_blocks(work: Callable[[int], Any]) -> list[Any]:
            return list(pool.map(work, range(BLOCKS)))

        bounds = np.array(in_blocks(lambda k: _bounds(xyz, edges[k], edges[k + 1])))
        low, high = np.floor(bounds[:, 0].min(axis=0) * scale), np.floor(bounds[:, 1].max(axis=0) * scale)
        if (high - low >= REACH).any():
            raise ValueError(f"size = {size:g} m is too small: the cloud is over {REACH} cells long")
        blocks = in_blocks(lambda k: _sum_block(xyz, edges[k], edges[k + 1], low, scale, cells))
        keys, sums, first = (np.concatenate(part) for part in zip(*blocks, strict=True))
        m, merged = _merge(keys, sums, first, *_table(_room(len(keys))))
        if inverse:
            starts = np.cumsum([0, *(len(block[0]) for block in blocks)])
            in_blocks(lambda k: _renumber(cells[edges[k] : edges[k + 1]], merged[starts[k] : starts[k + 1]]))
    count = sums[:m, 3].astype(np.int64)
    means: Floats = (sums[:m, :3] / sums[:m, 3:]).astype(xyz.dtype)
    return Thinned(means, count, first[:m].copy(), cells if inverse else None)


def _sum_block(
    xyz: Floats, start: int, stop: int, low: NDArray[np.float64], scale: float, cells: NDArray[np.int32]
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]]:
    """Keys (m,), sums and counts (m, 4), first points (m,) of the cells that the run of points occupies."""
    keys, sums, first = np.zeros(START, np.int64), np.zeros((START, 4)), np.zeros(START, np.int64)
    at, m = start, 0
    while True:
        table = _table(len(keys))
        _enter(keys[:m], *table)
        at, m = _sum(xyz, at, stop, low, scale, *table, keys, sums, first, m, cells)
        if at == stop:
            return keys[:m], sums[:m], first[:m]
        keys, sums, first = (np.concatenate([a, np.zeros_like(a)]) for a in (keys, sums, first))


def _room(n: int) -> int:
    return 1 << max(n - 1, 1).bit_length()


def _table(room: int) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """An empty table, keys and cells, for so many cells (a power of two): open addressing, at most half full."""
    return np.full(2 * room, -1, np.int64), np.empty(2 * room, np.int32)


@njit(nogil=True, cache=True)
def _bounds(xyz: Floats, start: int, stop: int) -> NDArray[np.float64]:
    """Lowest and highest corner (2, 3) of the finite points in the run; inf and -inf if there are none."""
    bounds = np.empty((2, 3))
    bounds[0], bounds[1] = np.inf, -np.inf
    for i in range(start, stop):
        if np.isfinite(xyz[i, 0]) and np.isfinite(xyz[i, 1]) and np.isfinite(xyz[i, 2]):
            for k in range(3):
                bounds[0, k] = min(bounds[0, k], xyz[i, k])
                bounds[1, k] = max(bounds[1, k], xyz[i, k])
    return bounds


@njit(nogil=True, cache=True)
def _sum(
    xyz: Floats,
    start: int,
    stop: int,
    low: NDArray[np.float64],
    scale: float,
    table_keys: NDArray[np.int64],
    table_cells: NDArray[np.int32],
    keys: NDArray[np.int64],
    sums: NDArray[np.float64],
    first: NDArray[np.int64],
    m: int,
    cells: NDArray[np.int32],
) -> tuple[int, int]:
    """Adds points to their cells until all are in or there is no room for a new cell: (point to go on with, cells)."""
    mask = len(table_keys) - 1
    for i in range(start, stop):
        x, y, z = float(xyz[i, 0]), float(xyz[i, 1]), float(xyz[i, 2])
        kx, ky, kz = np.floor(x * scale) - low[0], np.floor(y * scale) - low[1], np.floor(z * scale) - low[2]
        if not (0 <= kx <= REACH and 0 <= ky <= REACH and 0 <= kz <= REACH):  # not finite
            if len(cells):
                cells[i] = -1
            continue
        key = (int(kx) << 2 * BITS) | (int(ky) << BITS) | int(kz)
        slot = np.int64((np.uint64(key) * GOLDEN) >> HIGH) & mask
        while table_keys[slot] != key:
            if table_keys[slot] < 0:
                if m == len(keys):
                    return i, m
                table_keys[slot], table_cells[slot] = key, m
                keys[m], first[m] = key, i
                m += 1
                break
            slot = (slot + 1) & mask
        cell = table_cells[slot]
        sums[cell, 0] += x
        sums[cell, 1] += y
        sums[cell, 2] += z
        sums[cell, 3] += 1
        if len(cells):
            cells[i] = cell
    return stop, m


@njit(nogil=True, cache=True)
def _enter(keys: NDArray[np.int64], table_keys: NDArray[np.int64], table_cells: NDArray[np.int32]) -> None:
    """Puts keys that differ into an empty table."""
    mask = len(table_keys) - 1
    for cell in range(len(keys)):
        slot = np.int64((np.uint64(keys[cell]) * GOLDEN) >> HIGH) & mask
        while table_keys[slot] >= 0:
            slot = (slot + 1) & mask
        table_keys[slot], table_cells[slot] = keys[cell], cell


@njit(nogil=True, cache=True)
def _merge(
    keys: NDArray[np.int64],
    sums: NDArray[np.float64],
    first: NDArray[np.int64],
    table_keys: NDArray[np.int64],
    table_cells: NDArray[np.int32],
) -> tuple[int, NDArray[np.int32]]:
    """Sums rows of the same key, in place and in order of first appearance: how many are left, where each row went."""
    mask = len(table_keys) - 1
    merged = np.empty(len(keys), np.int32)
    m = 0
    for i in range(len(keys)):
        slot = np.int64((np.uint64(keys[i]) * GOLDEN) >> HIGH) & mask
        while table_keys[slot] >= 0 and table_keys[slot] != keys[i]:
            slot = (slot + 1) & mask
        if table_keys[slot] < 0:
            table_keys[slot], table_cells[slot] = keys[i], m
            first[m] = first[i]
            for k in range(4):
                sums[m, k] = sums[i, k]
            m += 1
        else:
            for k in range(4):
                sums[table_cells[slot], k] += sums[i, k]
        merged[i] = table_cells[slot]
    return m, merged


@njit(nogil=True, cache=True)
def _renumber(cells: NDArray[np.int32], numbers: NDArray[np.int32]) -> None:
    for i in range(len(cells)):
        if cells[i] >= 0:
            cells[i] = numbers[cells[i]]

"""Passes over all points of a bay or a scan in plan, compiled: each looks at a point once or twice, and makes no copy.

Places are turned in numbers such as points have, of four bytes or eight, as `vaultcad.survey.thinned_scan.turned` does.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]
Points = NDArray[np.floating]

compiled = njit(cache=True, nogil=True, error_model="numpy")


@compiled
def cells(points: Points, low: Array, cell: float, nx: int, ny: int) -> Ints:
    """Number (n,) of the cell that each of the points (n, 2 or 3) lies over, of nx by ny from `low` (2,) on; or -1."""
    found = np.empty(len(points), np.int64)
    for n in range(len(points)):
        i = np.int64(np.floor((np.float64(points[n, 0]) - low[0]) / cell))
        j = np.int64(np.floor((np.float64(points[n, 1]) - low[1]) / cell))
        found[n] = i * ny + j if 0 <= i < nx and 0 <= j < ny else -1
    return found


@compiled
def within(points: Points, c: float, s: float, low: Array, high: Array) -> Mask:
    """Which points (n, 2 or 3) lie between two corners (2,) of the plan turned by an angle of cosine c and sine s."""
    found = np.empty(len(points), np.bool_)
    for n in range(len(points)):
        x, y = c * points[n, 0] + s * points[n, 1], c * points[n, 1] - s * points[n, 0]
        found[n] = x > low[0] and x < high[0] and y > low[1] and y < high[1]
    return found


@compiled
def places_within(points: Points, c: float, s: float, low: Array, high: Array, lowest: float) -> Array:
    """Where those of points (n, 3) that lie so, and above the lowest, are in the turned plan (m, 2)."""
    mine = within(points, c, s, low, high)
    for n in range(len(points)):
        mine[n] &= points[n, 2] > lowest
    found, count = np.empty((mine.sum(), 2)), 0
    for n in range(len(points)):
        if mine[n]:
            found[count, 0] = c * points[n, 0] + s * points[n, 1]
            found[count, 1] = c * points[n, 1] - s * points[n, 0]
            count += 1
    return found


@compiled
def beside(
    places: Array, axis: int, sign: float, edge: float, middle: float, start: float, slant: float, rim: Array
) -> Array:
    """Those of places (n, 2) near a side: how far inside its edge, and how far along it from its middle (m, 2).

    Near is between the two of `rim` inside the line that lies `start` inside the edge, and `slant` more for each metre.
    """
    found, count = np.empty((len(places), 2)), 0
    for n in range(len(places)):
        depth, along = sign * (edge - places[n, axis]), places[n, 1 - axis] - middle
        inside = depth - start - slant * along
        if inside < rim[1] and inside > rim[0]:
            found[count, 0], found[count, 1] = depth, along
            count += 1
    return found[:count].copy()


@compiled
def outermost(strip: Ints, reach: Array, few: int) -> tuple[Ints, Ints]:
    """How many of points (n,) are in each strip, these numbered from 0 on, and the few that reach farthest, in order.

    The numbers of those are (strips, few), -1 where there are fewer.
    """
    size = strip.max() + 1 if len(strip) else 0
    count, outer = np.zeros(size, np.int64), np.full((size, few), -1)
    for n in range(len(strip)):
        mine = outer[strip[n]]
        count[strip[n]] += 1
        k = few
        while k > 0 and (mine[k - 1] < 0 or reach[mine[k - 1]] < reach[n]):
            k -= 1
            if k + 1 < few:
                mine[k + 1] = mine[k]
        if k < few:
            mine[k] = n
    return count, outer


@compiled
def highest(
    points: Points,
    c: float,
    s: float,
    axis: int,
    sign: float,
    edge: float,
    middle: float,
    half: float,
    steps: Array,
    shape: tuple[int, int],
) -> Array:
    """Height of the highest of points (n, 3) in each strip and bin of depth inside an edge, -inf where none is.

    steps: (2,) width of a strip, and of a bin. shape: their numbers. half: of the length about the middle that they
    lie on.
    """
    found = np.full(shape, -np.inf)
    for n in range(len(points)):
        px, py = np.float64(points[n, 0]), np.float64(points[n, 1])
        x, y = c * px + s * py, c * py - s * px
        depth, along = (x, y) if axis == 0 else (y, x)
        depth, along = sign * (depth - edge), along - middle
        if depth >= 0 and depth < shape[1] * steps[1] and abs(along) < half:
            i, j = int((along + half) / steps[0]), min(int(depth / steps[1]), shape[1] - 1)
            found[i, j] = max(found[i, j], points[n, 2])
    return found

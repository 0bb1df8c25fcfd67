"""Which points are a part's own, compiled: a building has many parts, and each is asked for the points all about it."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@njit(cache=True, nogil=True, error_model="numpy")
def own(
    points: NDArray[np.floating], low: Array, cell: float, held: Mask, bottom: Array, top: Array, strips: Array
) -> Mask:
    """Which points (n, 3) lie over cells that are held, between their heights and beside all strips.

    low: (2,) the corner of the cells, of an edge `cell`. held, bottom, top: (nx, ny) of the cells.
    strips: (k, 6), of each the middle, cosine and sine of its direction, half its length, and half its width.
    """
    found = np.zeros(len(points), np.bool_)
    for n in range(len(points)):
        x, y, z = np.float64(points[n, 0]), np.float64(points[n, 1]), np.float64(points[n, 2])
        i, j = int(np.floor((x - low[0]) / cell)), int(np.floor((y - low[1]) / cell))
        if i < 0 or j < 0 or i >= held.shape[0] or j >= held.shape[1] or not held[i, j]:
            continue
        if not (bottom[i, j] < z < top[i, j]):
            continue
        beside = True
        for k in range(len(strips)):
            dx, dy, c, s = x - strips[k, 0], y - strips[k, 1], strips[k, 2], strips[k, 3]
            if abs(c * dx + s * dy) < strips[k, 4] and abs(c * dy - s * dx) < strips[k, 5]:
                beside = False
                break
        found[n] = beside
    return found

"""Places on a sheet between the nodes of a net, by cubics in both directions (de Boor 1978, not-a-knot)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GridSpline:
    """A spline through nodes at even steps. cells: (n, m, 2, 4, 4) coefficients by powers of a and b from a corner."""

    low: tuple[float, float]
    step: tuple[float, float]
    cells: Array

    @staticmethod
    def through(a: Array, b: Array, nodes: Array) -> GridSpline:
        """Through nodes (n, m, 2) at a (n,) and b (m,)."""
        from scipy.interpolate import CubicSpline

        along = CubicSpline(np.arange(len(a)), nodes).c  # (4, n - 1, m, 2), the highest power first
        cells = CubicSpline(np.arange(len(b)), along, axis=2).c  # (4, m - 1, 4, n - 1, 2)
        ordered = np.ascontiguousarray(cells[::-1, :, ::-1].transpose(3, 1, 4, 2, 0))
        return GridSpline((float(a[0]), float(b[0])), (float(a[1] - a[0]), float(b[1] - b[0])), ordered)

    def __call__(self, a: Array, b: Array) -> Array:
        """Places (n, 2) at coordinates (n,); beyond the net the outermost cubics go on."""
        low, step = np.array(self.low), np.array(self.step)
        places: Array = _evaluated(np.ascontiguousarray(a), np.ascontiguousarray(b), low, step, self.cells)
        return places


@njit(cache=True, nogil=True, error_model="numpy")
def _evaluated(a: Array, b: Array, low: Array, step: Array, cells: Array) -> Array:
    out = np.empty((len(a), 2))
    for k in range(len(a)):
        x, y = (a[k] - low[0]) / step[0], (b[k] - low[1]) / step[1]
        i = min(max(int(np.floor(x)), 0), cells.shape[0] - 1)
        j = min(max(int(np.floor(y)), 0), cells.shape[1] - 1)
        x, y = x - i, y - j
        for c in range(2):
            total = 0.0
            for p in range(3, -1, -1):
                row = cells[i, j, c, p]
                total = total * x + ((row[3] * y + row[2]) * y + row[1]) * y + row[0]
            out[k, c] = total
    return out

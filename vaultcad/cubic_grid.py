"""Uniform cubic B-splines over a grid in space, compiled (de Boor 1978)."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

REACH = 64  # coefficients that a place depends on

compiled = njit(cache=True, nogil=True, error_model="numpy")


@compiled
def values(points: Array, low: Array, step: Array, coefficients: Array) -> Array:
    """Of points (n, 3) values (n, 3); coefficients: (nx, ny, nz, 3), the first of them at `low`."""
    out = np.empty((len(points), 3))
    index, weight, slope = np.empty((3, 4), np.int64), np.empty((3, 4)), np.empty((3, 4))
    for n in range(len(points)):
        _along(points[n], low, step, coefficients.shape, index, weight, slope)
        x, y, z = _sum(coefficients, index, weight[0], weight[1], weight[2])
        out[n, 0], out[n, 1], out[n, 2] = x, y, z
    return out


@compiled
def slopes(points: Array, low: Array, step: Array, coefficients: Array) -> Array:
    """Of points (n, 3) the derivatives (n, 3, 3) of the values: [:, i, j] is that of the i-th by coordinate j."""
    out = np.empty((len(points), 3, 3))
    index, weight, slope = np.empty((3, 4), np.int64), np.empty((3, 4)), np.empty((3, 4))
    for n in range(len(points)):
        _along(points[n], low, step, coefficients.shape, index, weight, slope)
        for axis in range(3):
            by = slope if axis == 0 else weight, slope if axis == 1 else weight, slope if axis == 2 else weight
            x, y, z = _sum(coefficients, index, by[0][0], by[1][1], by[2][2])
            out[n, 0, axis], out[n, 1, axis], out[n, 2, axis] = x, y, z
    return out


@compiled
def _sum(
    coefficients: Array, index: NDArray[np.int64], along_x: Array, along_y: Array, along_z: Array
) -> tuple[float, float, float]:
    """Of the coefficients that reach a place, weighted along each axis."""
    x, y, z = 0.0, 0.0, 0.0
    for i in range(4):
        for j in range(4):
            for k in range(4):
                w = along_x[i] * along_y[j] * along_z[k]
                a, b, c = index[0, i], index[1, j], index[2, k]
                x += w * coefficients[a, b, c, 0]
                y += w * coefficients[a, b, c, 1]
                z += w * coefficients[a, b, c, 2]
    return x, y, z


@compiled
def basis(points: Array, low: Array, step: Array, shape: tuple[int, int, int]) -> tuple[NDArray[np.int64], Array]:
    """Of each point (n, 3) the coefficients (n, 64) that it depends on, by their number, and their weights (n, 64)."""
    numbers, weights = np.empty((len(points), REACH), np.int64), np.empty((len(points), REACH))
    index, weight, slope = np.empty((3, 4), np.int64), np.empty((3, 4)), np.empty((3, 4))
    for n in range(len(points)):
        _along(points[n], low, step, shape, index, weight, slope)
        for i in range(4):
            for j in range(4):
                for k in range(4):
                    at = 16 * i + 4 * j + k
                    numbers[n, at] = (index[0, i] * shape[1] + index[1, j]) * shape[2] + index[2, k]
                    weights[n, at] = weight[0, i] * weight[1, j] * weight[2, k]
    return numbers, weights


@compiled
def add_to_bands(bands: Array, columns: NDArray[np.int64], products: Array) -> None:
    """Add a symmetric matrix (k, k) of rising columns (k,) to the lower bands (band + 1, n) of a larger one."""
    for i in range(len(columns)):
        for j in range(i + 1):
            bands[columns[i] - columns[j], columns[j]] += products[i, j]


@compiled
def _along(
    point: Array, low: Array, step: Array, shape: tuple[int, ...], index: NDArray[np.int64], weight: Array, slope: Array
) -> None:
    """Along each axis the four coefficients that reach a point, their weights and the slopes of these."""
    for axis in range(3):
        # Far off all four are the border's, whatever they weigh.
        t = min(max((point[axis] - low[axis]) / step[axis], -3.0), shape[axis] + 2.0)
        first = int(np.floor(t)) - 1
        f = t - first - 1
        g = 1 - f
        for k in range(4):
            index[axis, k] = min(max(first + k, 0), shape[axis] - 1)
        weight[axis, 0] = g**3 / 6
        weight[axis, 1] = (3 * f**3 - 6 * f**2 + 4) / 6
        weight[axis, 2] = (3 * g**3 - 6 * g**2 + 4) / 6
        weight[axis, 3] = f**3 / 6
        slope[axis, 0] = -(g**2) / (2 * step[axis])
        slope[axis, 1] = (3 * f**2 - 4 * f) / (2 * step[axis])
        slope[axis, 2] = -(3 * g**2 - 4 * g) / (2 * step[axis])
        slope[axis, 3] = f**2 / (2 * step[axis])

"""Interpolating splines of degree 5, compiled (de Boor 1978, A practical guide to splines, X and XIII)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.void.compiled import compiled, inner

Array = NDArray[np.float64]
DEGREE = 5
TINY = 1e-300
HALF = DEGREE // 2 + 1  # places at either end that are no knots, so that there are as many poles as places


@inner
def _basis(knots: Array, span: int, t: float, out: Array) -> None:
    """Values (6,) of the B-splines that are not 0 between the knots `span` and `span` + 1."""
    out[0] = 1.0
    for degree in range(1, DEGREE + 1):
        carried = 0.0
        for j in range(degree):
            right, left = knots[span + j + 1] - t, t - knots[span + j + 1 - degree]
            share = out[j] / (right + left)
            out[j] = carried + right * share
            carried = left * share
        out[degree] = carried


@compiled
def interpolated(at: Array, values: Array) -> tuple[Array, Array]:
    """Knots (n + 6,) and poles (n, k) of the spline with values (n, k) at rising parameters (n,).

    Elimination needs no pivots: the matrix is totally positive.
    """
    n, width = values.shape
    knots = np.empty(n + DEGREE + 1)
    knots[: DEGREE + 1], knots[n:], knots[DEGREE + 1 : n] = at[0], at[n - 1], at[HALF : n - HALF]
    band, poles = np.zeros((n, 2 * DEGREE + 1)), values.copy()  # band[i, DEGREE + j] stands in column i + j
    basis, span = np.empty(DEGREE + 1), DEGREE
    for i in range(n):
        while span < n - 1 and at[i] >= knots[span + 1]:
            span += 1
        _basis(knots, span, at[i], basis)
        for j in range(DEGREE + 1):
            band[i, span + j - i] = basis[j]
    for i in range(n):
        for row in range(i + 1, min(i + DEGREE + 1, n)):
            share = band[row, DEGREE + i - row] / band[i, DEGREE]
            if share != 0.0:
                for j in range(1, DEGREE + 1):
                    band[row, DEGREE + i - row + j] -= share * band[i, DEGREE + j]
                for j in range(width):
                    poles[row, j] -= share * poles[i, j]
    for i in range(n - 1, -1, -1):
        for j in range(width):
            for column in range(i + 1, min(i + DEGREE + 1, n)):
                poles[i, j] -= band[i, DEGREE + column - i] * poles[column, j]
            poles[i, j] /= band[i, DEGREE]
    return knots, poles


@compiled
def evaluated(knots: Array, poles: Array, t: Array) -> Array:
    """Values (m, k) of a spline at parameters (m,)."""
    n, width = poles.shape
    out, basis = np.zeros((len(t), width)), np.empty(DEGREE + 1)
    for i in range(len(t)):
        span = min(max(np.searchsorted(knots, t[i], "right") - 1, DEGREE), n - 1)
        _basis(knots, span, t[i], basis)
        for j in range(width):
            for k in range(DEGREE + 1):
                out[i, j] += basis[k] * poles[span - DEGREE + k, j]
    return out


@compiled
def spread(points: Array, shares: Array, count: int) -> Array:
    """Shares (`count`,) at even lengths and turns of a curve through points (n, 3) at shares (n,).

    Roofs nearly as high turn their line sharply by the crown. Denser towards the ends, where splines are the least
    accurate.
    """
    n = len(points)
    lengths, turns, ways = np.empty(n - 1), np.zeros(n), np.empty((n - 1, 3))
    for i in range(n - 1):
        ways[i] = points[i + 1] - points[i]
        lengths[i] = np.sqrt((ways[i] ** 2).sum())
        ways[i] /= max(lengths[i], TINY)
        if i:
            turns[i] = np.sqrt(((ways[i] - ways[i - 1]) ** 2).sum())
    effort = np.zeros(n)
    effort[1:] = np.cumsum(lengths / lengths.sum() + (turns[1:] + turns[:-1]) / 2)
    even = np.linspace(0, 1, count)
    found: Array = np.interp((even + (1 - np.cos(np.pi * even)) / 2) / 2 * effort[-1], effort, shares)
    found[0], found[-1] = 0.0, 1.0
    return found

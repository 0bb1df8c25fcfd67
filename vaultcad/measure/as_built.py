"""The stone as it stands: one smooth displacement of space that carries the ideal vault onto the scan.

It is the same for all components, so that edges they share stay shared.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.cubic_grid import basis
from vaultcad.displacement import RESOLUTION, Displacement

Array = NDArray[np.float64]

KNOTS = 0.9  # m, least distance of the knots: a settlement is smoother, a stone or a joint is not the vault's shape
MOST_SPANS = 9  # spans of knots along an axis at the most
SMOOTH = 0.02  # weight of the second differences of the coefficients against one point a knot


def displacement(points: Array, normals: Array, distances: Array) -> Displacement:
    """The field whose part along the model's normals explains the signed distances (n,) of points (n, 3) [m].

    Penalised least squares (P-splines, Eilers and Marx 1996): where the scan says nothing the field runs on straight.

    Raises:
        ValueError: there are no points.
    """
    if len(points) == 0:
        raise ValueError("no points to take a displacement from")
    low, high = points.min(axis=0), points.max(axis=0)
    spans = np.clip(np.floor((high - low) / KNOTS), 1, MOST_SPANS).astype(int)
    step = np.maximum((high - low) / spans, 1e-6)
    low = low - step  # a coefficient more on each side than there are knots within
    nx, ny, nz = shape = tuple((spans + 3).tolist())
    index, weight = basis(np.ascontiguousarray(points), low, step, (nx, ny, nz))
    count = int(np.prod(shape))
    normal_matrix, right = np.zeros((3 * count, 3 * count)), np.zeros(3 * count)
    _accumulate(index, weight, normals, distances, count, normal_matrix, right)
    density = len(points) / count
    penalty = _roughness(shape) * SMOOTH * density + np.eye(count) * 1e-4 * density
    for c in range(3):
        block = slice(c * count, (c + 1) * count)
        normal_matrix[block, block] += penalty
    from scipy.linalg import solve

    flat = solve(normal_matrix, right, assume_a="pos")
    kept = np.rint(flat / RESOLUTION) * RESOLUTION + 0.0  # as files keep it, so that it is the same when it is read
    return Displacement(low, step, kept.reshape(3, *shape).transpose(1, 2, 3, 0))


def _accumulate(
    index: NDArray[np.int64], weight: Array, normals: Array, d: Array, count: int, matrix: Array, right: Array
) -> None:
    """Adds the normal equations of n·u(p) = d over all points, those of a cell, which share their columns, together."""
    _, cell = np.unique(index[:, 0], return_inverse=True)
    order = np.argsort(cell, kind="stable")
    for mine in np.split(order, np.cumsum(np.bincount(cell))[:-1]):
        columns = np.concatenate([index[mine[0]] + c * count for c in range(3)])
        rows = np.concatenate([weight[mine] * normals[mine, c, None] for c in range(3)], axis=1)
        matrix[np.ix_(columns, columns)] += rows.T @ rows
        right[columns] += rows.T @ d[mine]


def _roughness(shape: tuple[int, ...]) -> Array:
    """Sum over the axes of squared second differences, (count, count)."""
    eyes = [np.eye(n) for n in shape]
    second = [np.diff(eye, 2, axis=0) for eye in eyes]
    total = np.zeros((int(np.prod(shape)),) * 2)
    for axis in range(3):
        factors = [second[a].T @ second[a] if a == axis else eyes[a] for a in range(3)]
        total += np.kron(np.kron(factors[0], factors[1]), factors[2])
    return total

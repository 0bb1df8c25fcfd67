"""The stone as it stands: one smooth displacement of space that carries the ideal vault onto the scan.

It is the same for all components, so that edges they share stay shared.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

KNOTS = 0.9  # m, least distance of the knots: a settlement is smoother, a stone or a joint is not the vault's shape
MOST_SPANS = 9  # spans of knots along an axis at the most
SMOOTH = 0.02  # weight of the second differences of the coefficients against one point a knot


@dataclass(frozen=True)
class Displacement:
    """Vector field u [m] as a tensor product of uniform cubic B-splines (de Boor 1978).

    low: (3,) corner of the first span [m]. step: (3,) of the knots [m]. coefficients: (nx, ny, nz, 3) [m].
    """

    low: Array
    step: Array
    coefficients: Array

    def __call__(self, points: Array) -> Array:
        """Displacements (n, 3) [m] of points (n, 3); constant beyond the box."""
        index, weight = _basis(points, self.low, self.step, self.coefficients.shape[:3])
        flat = self.coefficients.reshape(-1, 3)
        out: Array = np.einsum("nk,nkc->nc", weight, flat[index])
        return out


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
    shape = tuple((spans + 3).tolist())
    index, weight = _basis(points, low, step, shape)
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
    return Displacement(low, step, flat.reshape(3, *shape).transpose(1, 2, 3, 0))


def _basis(points: Array, low: Array, step: Array, shape: tuple[int, ...]) -> tuple[NDArray[np.int64], Array]:
    """Of each point the 64 coefficients (n, 64) that reach it, and their weights (n, 64)."""
    t = (points - low) / step
    cell = np.clip(np.floor(t).astype(np.int64), 0, np.array(shape) - 4)
    f = np.clip(t - cell, 0.0, 1.0)
    w = np.stack([(1 - f) ** 3, 3 * f**3 - 6 * f**2 + 4, -3 * f**3 + 3 * f**2 + 3 * f + 1, f**3], axis=-1) / 6
    k = np.arange(4)
    x, y, z = (cell[:, axis, None] + k for axis in range(3))
    index = (x[:, :, None, None] * shape[1] + y[:, None, :, None]) * shape[2] + z[:, None, None, :]
    weight = w[:, 0, :, None, None] * w[:, 1, None, :, None] * w[:, 2, None, None, :]
    n = len(points)
    return index.reshape(n, 64), weight.reshape(n, 64)


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

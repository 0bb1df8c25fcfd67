"""Normals by the principal axes of each point's neighbours. Thin first: on raw scans noise tilts them by 20 degrees."""

import os

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segmentation.cloud import Floats

BATCH = 100_000
"""Points whose neighbours are held at once, 16 bytes a neighbour."""
FLAT = 1e-6
"""Neighbours are a line, or one point, if their second largest variance is below this share of the largest."""
SWEEPS = 12
"""More than Jacobi's method ever needs for 3 x 3: it converges quadratically."""


def estimate(xyz: Floats, neighbours: int = 20, *, at: NDArray[np.int64] | None = None) -> NDArray[np.float32]:
    """Unit normals (n, 3) of points (n, 3) [m], unoriented; NaN where a point is not finite or its neighbours line up.

    neighbours: how many nearest points, the point itself among them, make a normal; all points if there are fewer.
    at: (k,) indices of the points to take normals at, whose (k, 3) they are then; all points must be finite.
    Raises ValueError if neighbours is below 3.
    Source: Hoppe et al., Surface reconstruction from unorganized points, 1992; neighbours by small_gicp's k-d tree.

    >>> level = np.random.default_rng(1).uniform(0, 1, (100, 3)) * [1, 1, 0]
    >>> np.abs(estimate(level)).mean(axis=0).round(3).tolist()
    [0.0, 0.0, 1.0]
    """
    import small_gicp

    if neighbours < 3:
        raise ValueError(f"neighbours = {neighbours} is below 3: a plane needs three points")
    normals = np.full(xyz.shape, np.nan, np.float32)
    finite = np.isfinite(xyz).all(axis=1)
    points = np.ascontiguousarray(xyz[finite], np.float64)
    if len(points) < 3:
        return normals
    cores = os.cpu_count() or 1
    tree = small_gicp.KdTree(points, num_threads=cores)
    queries = points if at is None else points[at]
    found = np.empty((len(queries), 3), np.float32)
    for k in range(0, len(queries), BATCH):
        query = queries[k : k + BATCH]
        nearest, _ = tree.batch_knn_search(query, min(neighbours, len(points)), num_threads=cores)
        found[k : k + BATCH] = _axes(points, nearest.astype(np.int64))
    if at is not None:
        return found
    normals[finite] = found
    return normals


@njit(nogil=True, cache=True)
def _axes(points: NDArray[np.float64], nearest: NDArray[np.int64]) -> NDArray[np.float32]:
    """Direction of least variance (k, 3) among the points in each row of `nearest`."""
    normals = np.empty((len(nearest), 3), np.float32)
    a, v, mean = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    for i in range(len(nearest)):
        mean[:] = 0
        for j in nearest[i]:
            mean += points[j]
        mean /= nearest.shape[1]
        a[:] = 0
        for j in nearest[i]:
            for p in range(3):
                for q in range(3):
                    a[p, q] += (points[j, p] - mean[p]) * (points[j, q] - mean[q])
        _diagonalise(a, v)
        low = 0 if a[0, 0] <= a[1, 1] and a[0, 0] <= a[2, 2] else 1 if a[1, 1] <= a[2, 2] else 2
        high = max(a[0, 0], a[1, 1], a[2, 2])
        middle = a[0, 0] + a[1, 1] + a[2, 2] - a[low, low] - high
        for k in range(3):
            normals[i, k] = v[k, low] if middle > FLAT * high else np.nan
    return normals


@njit(nogil=True, cache=True)
def _diagonalise(a: NDArray[np.float64], v: NDArray[np.float64]) -> None:
    """Eigenvalues onto the diagonal of the symmetric a, in place, eigenvectors into the columns of v.

    Cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, 8.5).
    """
    v[:] = 0
    v[0, 0] = v[1, 1] = v[2, 2] = 1
    for _ in range(SWEEPS):
        if abs(a[0, 1]) + abs(a[0, 2]) + abs(a[1, 2]) <= 1e-15 * (a[0, 0] + a[1, 1] + a[2, 2]):
            return
        for p, q in ((0, 1), (0, 2), (1, 2)):
            if a[p, q] == 0:
                continue
            tau = (a[q, q] - a[p, p]) / (2 * a[p, q])
            t = (1.0 if tau >= 0 else -1.0) / (abs(tau) + np.sqrt(1 + tau * tau))
            c = 1 / np.sqrt(1 + t * t)
            s = t * c
            for k in range(3):
                a[k, p], a[k, q] = c * a[k, p] - s * a[k, q], s * a[k, p] + c * a[k, q]
            for k in range(3):
                a[p, k], a[q, k] = c * a[p, k] - s * a[q, k], s * a[p, k] + c * a[q, k]
            for k in range(3):
                v[k, p], v[k, q] = c * v[k, p] - s * v[k, q], s * v[k, p] + c * v[k, q]

"""Weighted least squares on the geometric distance, for every primitive by the same normal equations, many primitives
at a time.

A primitive moves by a translation, a rotation and its two sizes; the derivative of the distance with respect to each
follows from the unit normal alone. Motions that leave the primitive as it is (a cylinder along its axis) are singular
directions, which the damping of Levenberg and Marquardt leaves at rest. Minimising distances, no algebraic form, is
what keeps radii unbiased. Source: Lukács, Martin and Marshall 1998, "Faithful Least-Squares Fitting of Spheres,
Cylinders, Cones and Tori".
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segmentation.primitives.minimal_sets import cross
from segmentation.primitives.numeric import CONE, CYLINDER, PLANE, TORUS, Floats, gradient

_UNKNOWNS = 8  # translation, rotation, first size, second size
Ints = NDArray[np.int64]


class Samples(NamedTuple):
    """Points (t, 3) [m] with the primitive that each is for (t,) and its weight there (t,)."""

    xyz: Floats
    owner: Ints
    weights: Floats

    def sums(self, values: Floats, count: int) -> Floats:
        """Weighted sums by primitive, (count,) or (count, 3), of values (t,) or (t, 3)."""
        if values.ndim == 1:
            return np.asarray(np.bincount(self.owner, self.weights * values, count), dtype=np.float64)
        return np.stack([self.sums(column, count) for column in values.T], axis=1)


@njit(cache=True, nogil=True)
def _normal_equations(
    kinds: Ints,
    rows: Floats,
    xyz: Floats,
    owner: Ints,
    weights: Floats,
    active: NDArray[np.bool_],
    pivots: Floats,
    scales: Floats,
    matrix: Floats,
    vector: Floats,
    cost: Floats,
) -> None:
    """Lower triangles (k, 8, 8), right sides (k, 8) and weighted sums of squares (k,) [m²], at the active rows.

    Rotation is about the pivots (k, 3), and angles are in units of 1 / scale (k,), so that every unknown is a length.
    """
    jac = np.zeros(_UNKNOWNS)
    for i in range(len(owner)):
        w, k = weights[i], owner[i]
        if w > 0.0 and active[k]:
            kind, row, scale = kinds[k], rows[k], scales[k]
            d, a, b, c = gradient(kind, row, xyz[i, 0], xyz[i, 1], xyz[i, 2])
            x, y, z = xyz[i, 0] - pivots[k, 0], xyz[i, 1] - pivots[k, 1], xyz[i, 2] - pivots[k, 2]
            jac[0], jac[1], jac[2] = -a, -b, -c
            jac[3], jac[4], jac[5] = (b * z - c * y) / scale, (c * x - a * z) / scale, (a * y - b * x) / scale
            jac[6] = 0.0 if kind == PLANE else -1.0
            jac[7] = 0.0
            if kind in (CONE, TORUS):
                x, y, z = xyz[i, 0] - row[0], xyz[i, 1] - row[1], xyz[i, 2] - row[2]
                square = x * x + y * y + z * z
                if kind == CONE:
                    jac[6] = -math.sqrt(max(square - d * d, 0.0)) / scale
                else:
                    height = x * row[3] + y * row[4] + z * row[5]
                    jac[6] = -(math.sqrt(max(square - height * height, 0.0)) - row[6]) / max(d + row[7], 1e-12)
                    jac[7] = -1.0
            cost[k] += w * d * d
            for j in range(_UNKNOWNS):
                wj = w * jac[j]
                vector[k, j] -= wj * d
                for m in range(j + 1):
                    matrix[k, j, m] += wj * jac[m]


def _assemble(
    kinds: Ints, rows: Floats, samples: Samples, active: NDArray[np.bool_], pivots: Floats, scales: Floats
) -> tuple[Floats, Floats, Floats]:
    matrix, vector, cost = (
        np.zeros((len(kinds), _UNKNOWNS, _UNKNOWNS)),
        np.zeros((len(kinds), _UNKNOWNS)),
        np.zeros(len(kinds)),
    )
    _normal_equations(kinds, rows, *samples, active, pivots, scales, matrix, vector, cost)
    return matrix + np.tril(matrix, -1).transpose(0, 2, 1), vector, cost


def _solve(matrix: Floats, vector: Floats, damping: Floats, frozen: NDArray[np.bool_]) -> Floats:
    """Damped steps (k, 8); where frozen (k,), the first size stays."""
    trace = np.trace(matrix, axis1=1, axis2=2)
    damped, right = matrix.copy(), vector.copy()
    damped[frozen, 6, :], damped[frozen, :, 6], right[frozen, 6] = 0.0, 0.0, 0.0
    damped[:, range(_UNKNOWNS), range(_UNKNOWNS)] += np.maximum(damping * trace, 1e-300)[:, None]
    return np.asarray(np.linalg.solve(damped, right[..., None])[..., 0], dtype=np.float64)


def _move(kinds: Ints, rows: Floats, steps: Floats, pivots: Floats, scales: Floats, sizes: Floats) -> Floats:
    """The rows after steps (k, 8); the first sizes stay within `sizes` (k, 2)."""
    turn = steps[:, 3:6] / scales[:, None]
    angle = np.sqrt((turn**2).sum(axis=1))[:, None]
    axis = turn / np.where(angle > 0.0, angle, 1.0)

    def rotated(v: Floats) -> Floats:  # Rodrigues' formula
        along = (axis * v).sum(axis=1)[:, None] * axis
        turned: Floats = along + np.cos(angle) * (v - along) + np.sin(angle) * cross(axis, v)
        return turned

    out = rows.copy()
    out[:, :3] = pivots + rotated(rows[:, :3] - pivots) + steps[:, :3]
    out[:, 3:6] = rotated(rows[:, 3:6])
    length = np.sqrt((out[:, 3:6] ** 2).sum(axis=1))[:, None]
    out[:, 3:6] /= np.where(length > 0.0, length, 1.0)
    out[:, 6] = rows[:, 6] + steps[:, 6] / np.where(kinds == CONE, scales, 1.0)
    sized = kinds != PLANE
    out[sized, 6] = np.clip(out[sized, 6], sizes[sized, 0], sizes[sized, 1])
    out[:, 7] = np.abs(rows[:, 7] + steps[:, 7])
    return out


def least_squares(kinds: Ints, rows: Floats, samples: Samples, sizes: Floats, iterations: int = 10) -> Floats:
    """Rows (k, 8) of the k primitives that fit their samples best, from starting rows.

    `sizes` (k, 2) bounds each first size (radius [m], cone's half angle [rad]), ends included; it holds for the result.
    A start comes back (within its bounds) where no weight is positive or no step lowers its sum of squares.
    """
    count = len(kinds)
    mass = np.bincount(samples.owner, samples.weights, count)
    safe = np.where(mass > 0.0, mass, 1.0)
    pivots = samples.sums(samples.xyz, count) / safe[:, None]
    spread = samples.sums((samples.xyz**2).sum(axis=1), count) / safe - (pivots**2).sum(axis=1)
    scales = np.sqrt(np.maximum(spread, 1e-12))
    active = mass > 0.0
    rows = _slid(kinds, rows, pivots, active)
    sized = kinds != PLANE
    rows[sized, 6] = np.clip(rows[sized, 6], sizes[sized, 0], sizes[sized, 1])
    matrix, vector, cost = _assemble(kinds, rows, samples, active, pivots, scales)
    damping = np.full(count, 1e-9)
    for _ in range(iterations):
        a = np.flatnonzero(active)
        if len(a) == 0:
            break
        step = _solve(matrix[a], vector[a], damping[a], np.zeros(len(a), dtype=np.bool_))
        frozen = (rows[a, 6] <= sizes[a, 0]) & (step[:, 6] < 0.0) | (rows[a, 6] >= sizes[a, 1]) & (step[:, 6] > 0.0)
        if frozen.any():
            step = _solve(matrix[a], vector[a], damping[a], frozen)
        trial = rows.copy()
        trial[a] = _move(kinds[a], rows[a], step, pivots[a], scales[a], sizes[a])
        trial_matrix, trial_vector, trial_cost = _assemble(kinds, trial, samples, active, pivots, scales)
        better = trial_cost[a] < cost[a]
        gain = cost[a] - trial_cost[a]
        b = a[better]
        rows[b], matrix[b], vector[b], cost[b] = trial[b], trial_matrix[b], trial_vector[b], trial_cost[b]
        damping[a] = np.where(better, np.maximum(damping[a] * 0.1, 1e-12), damping[a] * 100.0)
        still = np.where(better, gain <= 1e-9 * cost[a], damping[a] > 1e3) | (cost[a] <= 1e-24 * mass[a])
        active[a[still]] = False
    return rows


def _slid(kinds: Ints, rows: Floats, pivots: Floats, present: NDArray[np.bool_]) -> Floats:
    """Rows with the free point of planes and cylinders brought next to the points, where the rotation is well
    conditioned.
    """
    along = ((pivots - rows[:, :3]) * rows[:, 3:6]).sum(axis=1)[:, None] * rows[:, 3:6]
    out = rows.copy()
    planes, cylinders = present & (kinds == PLANE), present & (kinds == CYLINDER)
    out[planes, :3] = pivots[planes] - along[planes]
    out[cylinders, :3] += along[cylinders]
    return out

"""A smooth curve through scattered values, as smooth as they ask for, and how sure it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

KNOTS = 0.15  # m, distance of the spline's knots: what is shorter is a joint or a crack, not the profile
STIFFNESSES = np.geomspace(1e-4, 1e6, 41)  # weights of the roughness among which cross validation chooses
OUTLIER = 4.0  # scatters beyond which a value has no weight
ROUNDS = 3  # of fits with fewer outliers
RIDGE = 1e-9  # so that a knot without values is where its neighbours lead


@dataclass(frozen=True, eq=False)
class Smooth:
    """A cubic spline by its knots (k + 4,) and coefficients (k,), the covariance (k, k) of these, and the scatter of
    the values about it [m].
    """

    knots: Floats
    coefficients: Floats
    covariance: Floats
    scatter: float

    def __call__(self, s: Floats) -> tuple[Floats, Floats]:
        """Values (n,) and their standard deviations (n,) at places (n,)."""
        rows = _basis(s, self.knots)
        return rows @ self.coefficients, np.sqrt(np.maximum(np.einsum("nk,kl,nl->n", rows, self.covariance, rows), 0))


def smooth(s: Floats, values: Floats, weights: Floats, reach: tuple[float, float]) -> Smooth:
    """The penalised spline over `reach` through values (n,) at places s (n,) with weights (n,), inverse variances up to
    a factor.

    P-splines (Eilers and Marx 1996), the roughness weighed by generalised cross validation (Craven and Wahba 1979).

    Raises:
        ValueError: there are no values.
    """
    if not len(s):
        raise ValueError("no values to draw a curve through")
    low, high = reach
    spans = max(1, int((high - low) / KNOTS))
    step = max((high - low) / spans, 1e-6)
    knots = np.asarray(low + step * np.arange(-3, spans + 4), np.float64)
    rows, second = _basis(s, knots), np.diff(np.eye(spans + 3), 2, axis=0)
    kept = np.asarray(weights, np.float64)
    for _ in range(ROUNDS):
        found = _fit(rows, values, kept, second.T @ second, knots)
        off = np.abs(values - rows @ found.coefficients) * np.sqrt(weights / weights.mean())
        kept = np.where(off < OUTLIER * found.scatter, weights, 0.0)
    return found


def _fit(rows: Floats, values: Floats, weights: Floats, roughness: Floats, knots: Floats) -> Smooth:
    from scipy.linalg import eigh

    normal = (rows.T * weights) @ rows
    normal += RIDGE * (np.trace(normal) / len(normal) + 1e-30) * np.eye(len(normal))
    right = rows.T @ (weights * values)
    # With V' N V = 1 and V' P V = diag(rough) every stiffness costs one product.
    rough, vectors = eigh(roughness, normal)
    rough, turned = np.maximum(rough, 0.0), vectors.T @ right
    unit = normal.trace() / roughness.trace()
    n, total = int((weights > 0).sum()), float(weights @ values**2)
    kept = 1 / (1 + STIFFNESSES[:, None] * unit * rough)
    freedom = kept.sum(axis=1)
    rest = np.maximum(total - ((2 * kept - kept**2) * turned**2).sum(axis=1), 0.0)
    best = int(np.argmin(rest / np.maximum(n - freedom, 0.5) ** 2))
    variance = rest[best] / max(n - freedom[best], 1.0)
    scale = float(weights[weights > 0].mean()) if n else 1.0
    return Smooth(
        knots,
        vectors @ (kept[best] * turned),
        (vectors * kept[best]) @ vectors.T * variance,
        float(np.sqrt(variance / scale)),
    )


def _basis(s: Floats, knots: Floats) -> Floats:
    """Of each place the cubic B-splines there, (n, k); beyond the knots as at their ends."""
    from scipy.interpolate import BSpline

    within = np.clip(s, knots[3], knots[-4])
    rows: Floats = BSpline.design_matrix(within, knots, 3).toarray()
    return rows

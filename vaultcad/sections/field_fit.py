"""A curve fitted to stone that has moved: parameters, how sure they are, and how likely the curve is at all.

What is left of the points is a smooth random motion, as `vaultcad.fit.settlement` has it, with a roughness of its own;
its strength, length and roughness are summed over. The curve is linear about where it fits (Laplace's method), so that
its marginal likelihood is known in closed form (Rasmussen and Williams 2006, 2.7), and kinds of curves can be compared.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan
from vaultcad.fit.settlement import PRIOR, ROUGHNESSES, STRENGTHS, smooth_fields

Floats = NDArray[np.float64]
Residuals = Callable[[Floats], Floats]  # of parameters (k,): distances (n,) [m]
Slopes = Callable[[Floats, Floats], Floats]  # of parameters (k,), and the distances there: derivatives (n, k)

COARSER = slice(None, None, 4)  # of strengths and roughnesses, to be quick
STEPS = 10  # of Gauss and Newton at most
STILL = 1e-3  # standard deviations beforehand, of the largest step, at which the fit has come to rest
FIRST_STRENGTH, FIRST_ROUGHNESS = 0.005, 0.002  # m, of the motion by which the curve is first fitted
SHARES = (1.0, 0.5, 0.25, 0.1)  # of a step that are tried
NOISE = 0.01  # m, by which points are weighed against what is known beforehand


@dataclass(frozen=True, eq=False)
class MovedPoints:
    """Points (n, 2) [m] of a curve with its normals (n, 2), and in which shapes they may have moved.

    values, vectors: of the covariance of unit strength, for waves of each length.
    """

    at: Floats
    values: tuple[Floats, ...]
    vectors: tuple[Floats, ...]

    @classmethod
    def of(cls, at: Floats, normal: Floats, half_span: float, rise: float, width: float) -> MovedPoints:
        """By the size of the arch that they are part of [m]; it springs at z = 0 and has its middle at u = 0.

        width: of the vault's plan, by which the waves of its motion are as long as they are [m].
        """
        place, facing = (np.column_stack([v[:, 0], np.zeros(len(v)), v[:, 1]]) for v in (at, normal))
        found = [
            np.linalg.eigh(shape)
            for shape in smooth_fields(place, facing, Plan.rectangle(max(half_span, width / 2), width / 2), rise)
        ]
        return cls(at, tuple(np.maximum(v, 0.0) for v, _ in found), tuple(q for _, q in found))


@dataclass(frozen=True, eq=False)
class CurveFit:
    """Parameters (k,), their covariance (k, k), residuals (n,) [m]; the logarithm of the marginal likelihood, and the
    standard deviation of the motion [m]; variances of the motion along the `vectors` of the points, for each length.
    """

    values: Floats
    covariance: Floats
    residuals: Floats
    likelihood: float
    settlement: float
    variances: tuple[Floats, ...]

    @property
    def rms(self) -> float:
        """Of the residuals [m]."""
        return float(np.sqrt((self.residuals**2).mean()))


def fit_curve(
    points: MovedPoints, residuals: Residuals, slopes: Slopes, start: Floats, mean: Floats, std: Floats
) -> CurveFit:
    """Fit parameters from `start` (k,), of which `mean` and `std` (k,) are known beforehand: the likeliest as built."""
    precision = std**-2.0
    values = _at_rest(points, residuals, slopes, start, mean, precision)
    for _ in range(2):  # once more where the sum over all motions leads
        here, off = residuals(values), values - mean
        likelihood, variances, settlement, step, spread = _summed(points, here, slopes(values, here), off, precision)
        values = values + step
    return CurveFit(values, spread, residuals(values), likelihood, settlement, variances)


def as_it_stands(
    fit: CurveFit, points: MovedPoints, residuals: Residuals, slopes: Slopes, mean: Floats, std: Floats
) -> CurveFit:
    """The same curve as near to the points as it can be; its covariance says how far that is from what was built."""
    precision = std**-2.0
    values = _nearest(residuals, slopes, fit.values, mean, precision)
    here = residuals(values)
    lean = slopes(values, here)
    gain = np.linalg.inv(lean.T @ lean / NOISE**2 + np.diag(precision))
    carried = gain @ lean.T / NOISE**2
    spread = (gain * precision) @ gain
    for variance, vectors in zip(fit.variances, points.vectors, strict=True):
        turned = carried @ vectors
        spread = spread + (turned * variance) @ turned.T
    return replace(fit, values=values, covariance=spread, residuals=here)


def _at_rest(
    points: MovedPoints, residuals: Residuals, slopes: Slopes, start: Floats, mean: Floats, precision: Floats
) -> Floats:
    """Where Gauss and Newton's steps come to rest for a usual motion."""
    middle = len(points.values) // 2
    vectors, root = (
        points.vectors[middle].T,
        1 / np.sqrt(FIRST_STRENGTH**2 * points.values[middle] + FIRST_ROUGHNESS**2),
    )

    def system(values: Floats, here: Floats) -> tuple[Floats, Floats]:
        lean, white = root[:, None] * (vectors @ slopes(values, here)), root * (vectors @ here)
        return lean.T @ lean, lean.T @ white

    def cost(left: Floats, off: Floats) -> float:
        return float(((root * (vectors @ left)) ** 2).sum() + (precision * off**2).sum())

    return _rested(residuals, system, cost, start, mean, precision)


def _nearest(residuals: Residuals, slopes: Slopes, start: Floats, mean: Floats, precision: Floats) -> Floats:
    """Where Gauss and Newton's steps come to rest."""

    def system(values: Floats, here: Floats) -> tuple[Floats, Floats]:
        lean = slopes(values, here) / NOISE
        return lean.T @ lean, lean.T @ here / NOISE

    def cost(left: Floats, off: Floats) -> float:
        return float((left**2).sum()) / NOISE**2 + float(precision @ off**2)

    return _rested(residuals, system, cost, start, mean, precision)


def _rested(
    residuals: Residuals,
    system: Callable[[Floats, Floats], tuple[Floats, Floats]],
    cost: Callable[[Floats, Floats], float],
    start: Floats,
    mean: Floats,
    precision: Floats,
) -> Floats:
    """Where Gauss and Newton's steps from a start (n,) come to rest, shortened as long as they cost more.

    system: of values and their residuals the normal matrix (n, n) and its right side (n,), without what is known
    before. cost: of residuals, and of how far the values are off their mean.
    """
    values, here, least = start, residuals(start), np.inf
    for _ in range(STEPS):
        normal, right = system(values, here)
        step = np.linalg.solve(normal + np.diag(precision), right + precision * (values - mean))
        for share in SHARES:
            tried = values - share * step
            left = residuals(tried)
            new = cost(left, tried - mean)
            if new < least:
                break
        else:
            break
        done = (np.abs(tried - values) * np.sqrt(precision)).max() < STILL
        values, here, least = tried, left, new
        if done:
            break
    return values


def _summed(
    points: MovedPoints, here: Floats, slopes: Floats, off: Floats, precision: Floats
) -> tuple[float, tuple[Floats, ...], float, Floats, Floats]:
    """Summed over all motions: log likelihood, variances (n,) along `vectors` for each length, strength; mean step of
    the parameters, and their covariance.
    """
    strengths, rough = STRENGTHS[COARSER], ROUGHNESSES[COARSER]
    found = []
    for values, vectors in zip(points.values, points.vectors, strict=True):
        variance = (strengths[:, None, None] ** 2 * values + rough[:, None] ** 2).reshape(-1, len(values))
        left, lean = vectors.T @ here, vectors.T @ slopes
        count = len(precision)
        products = (lean[:, :, None] * lean[:, None, :]).reshape(len(lean), -1)
        normal = ((1 / variance) @ products).reshape(-1, count, count) + np.diag(precision)
        right = (1 / variance) @ (lean * left[:, None]) + precision * off
        inverse = np.linalg.inv(normal)
        step = -(inverse @ right[..., None])[..., 0]
        cost = (left**2 / variance).sum(axis=1) + float(precision @ off**2) + (right * step).sum(axis=1)
        size = np.linalg.slogdet(normal)[1] - np.log(precision).sum()
        found.append((-0.5 * (np.log(variance).sum(axis=1) + cost + size), variance, step, inverse))
    likely = np.stack([one[0] for one in found]).reshape(len(found), len(strengths), len(rough))
    likely = likely + PRIOR[:, COARSER, None]
    top = float(likely.max())
    share = np.exp(likely - top)
    total = float(share.sum())
    share /= total
    flat = share.reshape(len(found), -1)
    variances = tuple(weights @ one[1] for weights, one in zip(flat, found, strict=True))
    steps, spreads = (np.stack([one[k] for one in found]) for k in (2, 3))
    mean = np.einsum("lc,lck->k", flat, steps)
    apart = steps - mean
    spread = np.einsum("lc,lckm->km", flat, spreads) + np.einsum("lc,lck,lcm->km", flat, apart, apart)
    strength = float((share.sum(axis=(0, 2)) * strengths).sum())
    return top + float(np.log(total / likely.size)), variances, strength, mean, spread

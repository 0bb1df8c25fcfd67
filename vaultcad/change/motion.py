"""How stone has moved, estimated from how far it lies off a reference: figures as linear functionals of a field.

Universal kriging (Cressie 1993, 3.4; Rasmussen and Williams 2006, 2.7): the deviations of blocks of stone are what the
reference may be wrong by, plus the shapes of known mechanisms, plus waves as smooth as `vaultcad.fit.settlement` has
them, plus what is rough from block to block. Strength and length of the waves and the roughness are averaged over by
their likelihood, so that limits hold whatever the stone is like: a block counts once, however many points it has.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vaultcad.find.likelihood import DOUBT
from vaultcad.fit.settlement import LENGTHS, PRIOR, ROUGHNESSES, STRENGTHS
from vaultcad.mechanisms import LARGE

Array = NDArray[np.float64]

EVERY = 3  # of strengths and roughnesses which one is taken, to be quick
ROUGHLY = 5  # the same where mechanisms are told apart
STRANGER = (
    1.5  # standard deviations are wider by this, as no movement is quite such a field; see `bench/deformation.py`
)
LEFT = 1e-6  # squares that are always left, as many standard deviations, so that rounding leaves no fewer than none
USUAL_ROUGHNESS = 0.002  # m, standard deviation of a block from a smooth field
SHARE = 1e-3  # of the likelihood, below which a field is forgotten


@dataclass(frozen=True)
class Places:
    """Where figures are read: each is a sum over places, one row a place.

    figure: (p,) which figure it is of. place, way: (p, 3) where, and along which direction times its weight.
    """

    figure: NDArray[np.int64]
    place: Array
    way: Array

    @property
    def count(self) -> int:
        """Of figures."""
        return int(self.figure.max(initial=-1)) + 1

    def sums(self, rows: Array) -> Array:
        """Rows (p, k) of places added up to those of figures (f, k)."""
        out = np.zeros((self.count, rows.shape[1]))
        np.add.at(out, self.figure, rows)
        return out


@dataclass(frozen=True)
class Waves:
    """Covariances of unit waves, for each of `LENGTHS`, of blocks in the basis of their own eigenvectors.

    values: (m,), vectors: (m, m) a length. cross: (f, m) of figures with blocks, in that basis. own: (f,) of figures.
    """

    values: tuple[Array, ...]
    vectors: tuple[Array, ...]
    cross: tuple[Array, ...]
    own: tuple[Array, ...]

    @classmethod
    def of(cls, place: Array, normal: Array, figures: Places, width: float) -> Waves:
        """Of blocks at (m, 3) [m] with normals (m, 3), over a plan of that width [m]."""
        found = []
        for length in LENGTHS:
            values, vectors = np.linalg.eigh(_covariance(place, normal, place, normal, length * width))
            cross = figures.sums(_covariance(figures.place, figures.way, place, normal, length * width)) @ vectors
            within = _covariance(figures.place, figures.way, figures.place, figures.way, length * width)
            own = np.diag(figures.sums(figures.sums(within).T)).copy()
            found.append((np.maximum(values, 0.0), vectors, cross, own))
        values_, vectors_, cross_, own_ = zip(*found, strict=True)
        return cls(values_, vectors_, cross_, own_)


@dataclass(frozen=True)
class Estimated:
    """Means (f,) and standard deviations (f,) of figures [m]."""

    mean: Array
    std: Array


@dataclass(frozen=True)
class Trend:
    """What may be there beside waves: derivatives (m, u) of deviations by unknowns, and what is known of these.

    precision, mean: (u,) beforehand. figures: (f, u) what unknowns add to figures.
    """

    slopes: Array
    precision: Array
    mean: Array
    figures: Array

    @classmethod
    def of_shapes(cls, blocks: Array, figures: Array, parts: NDArray[np.str_]) -> Trend:
        """Of the shapes of mechanisms: (m, k) along the normals of blocks, and (f, k) in figures; (k,) whose each is.

        All shapes of a part together are `LARGE`: else it could move by more the more shapes it is given.
        """
        _, part, count = np.unique(parts, return_inverse=True, return_counts=True)
        return cls(blocks, count[part] / LARGE**2, np.zeros(len(parts)), figures)

    def beside(self, jacobian: Array, precision: Array, mean: Array) -> Trend:
        """And a reference whose unknowns (v,) move deviations by (m, v), and no stone."""
        none = np.zeros((len(self.figures), len(mean)))
        return Trend(
            np.hstack([-jacobian, self.slopes]),
            np.concatenate([precision, self.precision]),
            np.concatenate([mean, self.mean]),
            np.hstack([none, self.figures]),
        )

    def only(self, part: NDArray[np.bool_]) -> Trend:
        """With a part (u,) of the unknowns alone."""
        return Trend(self.slopes[:, part], self.precision[part], self.mean[part], self.figures[:, part])

    def likeliest(self, deviation: Array, near: NDArray[np.bool_]) -> Array:
        """The unknowns (u,) by those of the deviations (m,) [m] that are `near`, as if there were no waves."""
        slopes, rough = self.slopes[near], USUAL_ROUGHNESS**-2
        inverse = rough * slopes.T @ slopes + np.diag(self.precision)
        told = rough * slopes.T @ deviation[near] + self.precision * self.mean
        return np.asarray(np.linalg.solve(inverse, told), np.float64)


def estimated(deviation: Array, trend: Trend, waves: Waves) -> Estimated:
    """Figures from the deviations of blocks (m,) [m], averaged over all fields that are likely."""
    fields = [_Fields.of(k, deviation, trend, waves, EVERY) for k in range(len(LENGTHS))]
    likelihood = np.concatenate([one.likelihood for one in fields])
    odds = np.exp((likelihood - likelihood.max()) / DOUBT)
    kept = odds > SHARE * odds.max()
    share = odds[kept] / odds[kept].sum()
    masks = np.split(kept, len(LENGTHS))
    moments = [one.moments(mask, trend, waves) for one, mask in zip(fields, masks, strict=True)]
    means, variances = (np.concatenate(part) for part in zip(*moments, strict=True))
    mean = share @ means
    variance = share @ (variances + (means - mean) ** 2)
    return Estimated(mean, np.sqrt(np.maximum(variance, 0.0)))


def likelihoods(deviation: Array, trend: Trend, waves: Waves, parts: Sequence[NDArray[np.bool_]]) -> Array:
    """Logarithms (p,) of how likely deviations (m,) [m] are, all fields together, by each part of the unknowns alone.

    parts: of each the unknowns (u,) that it has.
    """
    fields = [_Fields.of(k, deviation, trend, waves, ROUGHLY) for k in range(len(LENGTHS))]
    found = [np.concatenate([one.likelihood_of(part) for one in fields]) for part in parts]
    return np.array([one.max() + np.log(np.exp(one - one.max()).sum()) for one in found])


def mixed(parts: list[tuple[float, Estimated]]) -> tuple[Array, Array]:
    """Means (f,) and standard deviations (f,) over references, each with its chance."""
    chance = np.array([chance for chance, _ in parts])
    chance = chance / chance.sum()
    mean = chance @ np.stack([one.mean for _, one in parts])
    apart = np.stack([one.std**2 + (one.mean - mean) ** 2 for _, one in parts])
    return mean, np.sqrt(chance @ apart)


@dataclass(frozen=True)
class _Fields:
    """Waves of one of `LENGTHS`, of all strengths and roughnesses, and what each says of the unknowns.

    slopes: (m, u) and rest: (m,), of blocks in the basis of the waves' eigenvectors. strength: (f,) variances of waves.
    variance: (f, m) of blocks. told: (f, u + 1, u + 1) normal equations of the unknowns, with their right side and the
    squares of what is to be told as the last row and column. prior: (f,) logarithms.
    """

    length: int
    slopes: Array
    rest: Array
    precision: Array
    strength: Array
    variance: Array
    told: Array
    prior: Array

    @classmethod
    def of(cls, k: int, deviation: Array, trend: Trend, waves: Waves, every: int) -> _Fields:
        """Of the k-th length; `every`: of strengths and roughnesses, which one is taken."""
        slopes, rest = waves.vectors[k].T @ trend.slopes, waves.vectors[k].T @ deviation
        rough, strength = (part.ravel() for part in np.meshgrid(ROUGHNESSES[::every] ** 2, STRENGTHS[::every] ** 2))
        variance = strength[:, None] * waves.values[k] + rough[:, None]
        # Products of any two columns, each with weights of all fields at once: one product of matrices.
        columns = np.vstack([slopes.T, rest])
        low, high = np.tril_indices(len(columns))
        pair = np.empty((len(columns), len(columns)), np.int64)
        pair[low, high] = pair[high, low] = np.arange(len(low))
        told = ((1 / variance) @ (columns[low] * columns[high]).T).take(pair, axis=1)
        known = np.append(trend.precision, trend.precision @ trend.mean**2 + LEFT)
        told[:, range(len(known)), range(len(known))] += known
        told[:, :-1, -1] += trend.precision * trend.mean
        told[:, -1, :-1] += trend.precision * trend.mean
        prior = np.repeat(PRIOR[k, ::every], len(ROUGHNESSES[::every]))
        return cls(k, slopes, rest, trend.precision, strength, variance, told, prior)

    @cached_property
    def likelihood(self) -> Array:
        """Logarithm (f,) of how likely each makes the deviations."""
        return self.likelihood_of(np.ones(len(self.precision), np.bool_))

    def likelihood_of(self, part: NDArray[np.bool_]) -> Array:
        """The same with a part (u,) of the unknowns alone."""
        mine = np.flatnonzero(np.append(part, True))
        told = self.told if part.all() else self.told.take(mine, axis=1).take(mine, axis=2)
        # Of such equations the last place of the root is what the unknowns leave.
        root = np.diagonal(np.linalg.cholesky(told), axis1=1, axis2=2)
        volume = 2 * np.log(root[:, :-1]).sum(axis=1) - np.log(self.precision[part]).sum()
        out: Array = self.prior - 0.5 * (np.log(self.variance).sum(axis=1) + volume + root[:, -1] ** 2)
        return out

    def moments(self, kept: NDArray[np.bool_], trend: Trend, waves: Waves) -> tuple[Array, Array]:
        """Means and variances (k, n) of the n figures, in those of the fields (f,) that are kept."""
        inverse = self.told[kept, :-1, :-1]
        gain = self.strength[kept, None, None] * waves.cross[self.length] / self.variance[kept, None, :]
        sight = trend.figures - gain @ self.slopes
        right = np.concatenate([sight.swapaxes(1, 2), self.told[kept, :-1, -1:]], axis=2)
        solved = np.linalg.solve(inverse, right)
        unknown = solved[:, :, -1]
        mean = unknown @ trend.figures.T + ((self.rest - unknown @ self.slopes.T)[:, None, :] * gain).sum(axis=2)
        spread = np.einsum("kfu,kuf->kf", sight, solved[:, :, :-1])
        own = waves.own[self.length] - (gain * waves.cross[self.length]).sum(axis=2)
        return mean, spread + np.maximum(self.strength[kept, None] * own, 0.0)


def _covariance(place: Array, way: Array, other: Array, along: Array, length: float) -> Array:
    """Of motions at (p, 3) along (p, 3) with those at (q, 3) along (q, 3): (p, q), unit strength, that length [m]."""
    apart = ((place[:, None] - other[None]) ** 2).sum(axis=2)
    out: Array = np.exp(-0.5 * apart / length**2) * (way @ along.T)
    return out


def honest(std: Array, registration: float) -> Array:
    """Standard deviations (f,) [m] as they are told, with the registration of the scan's stations [m]."""
    out: Array = np.sqrt((STRANGER * std) ** 2 + 2 * registration**2)
    return out

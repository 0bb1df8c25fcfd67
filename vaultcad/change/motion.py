"""How stone has moved, estimated from how far it lies off a reference: figures as linear functionals of a field.

Universal kriging (Cressie 1993, 3.4; Rasmussen and Williams 2006, 2.7): the deviations of blocks of stone are what the
reference may be wrong by, plus the shapes of known mechanisms, plus waves as smooth as `vaultcad.fit.settlement` has
them, plus what is rough from block to block. Strength and length of the waves and the roughness are averaged over by
their likelihood, so that limits hold whatever the stone is like: a block counts once, however many points it has.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.change.mechanisms import LARGE
from vaultcad.find.likelihood import DOUBT
from vaultcad.fit.settlement import LENGTHS, PRIOR, ROUGHNESSES, STRENGTHS

Array = NDArray[np.float64]

EVERY = 3  # of strengths and roughnesses which one is taken, to be quick
STRANGER = (
    1.5  # standard deviations are wider by this, as no movement is quite such a field; see `bench/deformation.py`
)
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
    """Means (f,) and standard deviations (f,) of figures [m], and the logarithm of how likely all this is."""

    mean: Array
    std: Array
    likelihood: float


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

    def likeliest(self, deviation: Array, near: NDArray[np.bool_]) -> Array:
        """The unknowns (u,) by those of the deviations (m,) [m] that are `near`, as if there were no waves."""
        slopes, rough = self.slopes[near], USUAL_ROUGHNESS**-2
        inverse = rough * slopes.T @ slopes + np.diag(self.precision)
        told = rough * slopes.T @ deviation[near] + self.precision * self.mean
        return np.asarray(np.linalg.solve(inverse, told), np.float64)


def estimated(deviation: Array, trend: Trend, waves: Waves, every: int = EVERY) -> Estimated:
    """Figures from the deviations of blocks (m,) [m], averaged over all fields that are likely."""
    fields = [one for k in range(len(LENGTHS)) for one in _of_length(k, deviation, trend, waves, every)]
    likelihood = np.array([one[0] for one in fields])
    odds = np.exp((likelihood - likelihood.max()) / DOUBT)
    kept = np.flatnonzero(odds > SHARE * odds.max())
    share = odds[kept] / odds[kept].sum()
    moments = [_moments(fields[k], trend, waves) for k in kept]
    means, variances = np.stack([m for m, _ in moments]), np.stack([v for _, v in moments])
    mean = share @ means
    variance = share @ (variances + (means - mean) ** 2)
    top = float(likelihood.max())
    total = top + float(np.log(np.exp(likelihood - top).sum()))
    return Estimated(mean, np.sqrt(np.maximum(variance, 0.0)), total)


def mixed(parts: list[tuple[float, Estimated]]) -> tuple[Array, Array]:
    """Means (f,) and standard deviations (f,) over references, each with its chance."""
    chance = np.array([chance for chance, _ in parts])
    chance = chance / chance.sum()
    mean = chance @ np.stack([one.mean for _, one in parts])
    apart = np.stack([one.std**2 + (one.mean - mean) ** 2 for _, one in parts])
    return mean, np.sqrt(chance @ apart)


_Field = tuple[float, int, float, Array, Array, Array, Array]
"""Log likelihood, index of the length, variance of the waves, and of blocks in the eigenbasis (m,), unknowns (u,),
the inverse of their covariance (u, u), and what they leave of the deviations (m,)."""


def _of_length(k: int, deviation: Array, trend: Trend, waves: Waves, every: int) -> list[_Field]:
    values, vectors = waves.values[k], waves.vectors[k]
    slopes, rest = vectors.T @ trend.slopes, vectors.T @ deviation
    found: list[_Field] = []
    for i in range(0, len(STRENGTHS), every):
        strength = float(STRENGTHS[i] ** 2)
        for rough in ROUGHNESSES[::every] ** 2:
            variance = strength * values + rough
            weighted = slopes / variance[:, None]
            inverse = weighted.T @ slopes + np.diag(trend.precision)
            pull = weighted.T @ rest + trend.precision * trend.mean
            unknown = np.linalg.solve(inverse, pull)
            misfit = float(rest @ (rest / variance) + trend.precision @ trend.mean**2 - pull @ unknown)
            volume = float(np.linalg.slogdet(inverse)[1] - np.log(trend.precision).sum())
            likelihood = -0.5 * (float(np.log(variance).sum()) + volume + misfit) + float(PRIOR[k, i])
            found.append((likelihood, k, strength, variance, unknown, inverse, rest - slopes @ unknown))
    return found


def _moments(field: _Field, trend: Trend, waves: Waves) -> tuple[Array, Array]:
    """Means (f,) and variances (f,) of figures in one field."""
    _, k, strength, variance, unknown, inverse, left = field
    gain = strength * waves.cross[k] / variance
    mean = trend.figures @ unknown + gain @ left
    sight = trend.figures - gain @ (waves.vectors[k].T @ trend.slopes)
    spread = np.einsum("fu,uf->f", sight, np.linalg.solve(inverse, sight.T))
    own = strength * (waves.own[k] - (gain * waves.cross[k]).sum(axis=1))
    return mean, spread + np.maximum(own, 0.0)


def _covariance(place: Array, way: Array, other: Array, along: Array, length: float) -> Array:
    """Of motions at (p, 3) along (p, 3) with those at (q, 3) along (q, 3): (p, q), unit strength, that length [m]."""
    apart = ((place[:, None] - other[None]) ** 2).sum(axis=2)
    out: Array = np.exp(-0.5 * apart / length**2) * (way @ along.T)
    return out


def honest(std: Array, registration: float) -> Array:
    """Standard deviations (f,) [m] as they are told, with the registration of the scan's stations [m]."""
    out: Array = np.sqrt((STRANGER * std) ** 2 + 2 * registration**2)
    return out

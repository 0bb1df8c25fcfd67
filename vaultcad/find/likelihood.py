"""How likely the motion is that would have brought a vault, as built, to where the stone stands today.

The marginal likelihood of a linear model (Rasmussen and Williams 2006, 2.7): the residuals are a random field of
`vaultcad.fit.settlement`, over its strength, length and roughness, and what pose and parameters can take of them, of
which builders' practice says something beforehand.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, log, sqrt
from typing import Self

import numpy as np
from numpy.typing import NDArray

from vaultcad.find.marks import Marks
from vaultcad.find.practice import arch_of, beforehand
from vaultcad.find.refine import WIDEST, Refined
from vaultcad.fit.evidence import Evidence
from vaultcad.fit.settlement import (
    OUTLIER,
    PRIOR,
    ROUGHNESSES,
    STRENGTHS,
    Partition,
    faces,
    scatter_of,
    smooth_fields,
)
from vaultcad.fit.solve import POSE, Placed, Solution
from vaultcad.fit.uncertainty import slopes_of_sizes
from vaultcad.survey.springings import Springing

Array = NDArray[np.float64]

CHOICE_POINTS = 3_000  # points that choices are fitted to
FIT_STEPS, GAIN = 12, 1e-4  # of their fits at most, and the share of the cost that one must still gain
NARROWEST = 0.02  # m, scale of their loss
EDGE, EDGE_SHARE = 0.15, 0.08  # m, and share of the shorter side, near an edge where stone is rounded and hidden
LOST, LOST_POINTS = 0.1, 2  # share of a component's stone, and points, that a fit may lose where no block speaks of it
SMALL_SAYS = 4  # residuals that say something new, of a component of which blocks say nothing
FAR, FEW_FAR = 0.06, 0.02  # m off a fit that is far, and the share of the blocks that may be
RATIO_STEP = 0.015  # of a ratio, to either side, over which distances are compared
DOUBT = 1.4  # log likelihoods are divided by this, as no settlement is quite such a field
ENOUGH = 40  # blocks without which nothing is said
NEVER = 1e-3  # chance that a parameter is within its range at the least
COARSE = slice(None, None, 2)  # of the field's strengths and roughnesses, to be quick


@dataclass(frozen=True)
class Marginal:
    """What a fit says with each of h fields, of other lengths, strengths and roughnesses.

    likelihood: (h,) logarithms. shift: (h, u) means of the unknowns, from where the solution is. covariance: (h, u, u).
    case: (h,) number of what marks are taken for.
    """

    likelihood: Array
    shift: Array
    covariance: Array
    case: NDArray[np.int64]

    def moments(self, means: Array, variances: Array) -> tuple[Array, Array]:
        """Means (s,) and variances (s,) over all fields, from those (h, s) with each; means in the likeliest case.

        Where the others would put them widens the variance alone: between two places there is nothing.
        """
        share = np.exp((self.likelihood - self.likelihood.max()) / DOUBT)
        share /= share.sum()
        likeliest = self.case == np.bincount(self.case, share).argmax()
        mean = share[likeliest] @ means[likeliest] / share[likeliest].sum()
        return mean, share @ (variances + (means - mean) ** 2)


@dataclass(frozen=True)
class Field:
    """The points of a fit, their blocks, and the random field in which these may have moved.

    scale: of the loss of fits [m]. usable: (m,) blocks. values, vectors: of the covariances of the field, for each of
    `LENGTHS`. unheard: (n,) component that a point is of, if blocks say nothing of most of that, else 0. tolerance: of
    the band in which a component's points lie, to either side [m]. scatter: that the fit left [m].
    """

    evidence: Evidence
    scale: float
    blocks: Partition
    usable: NDArray[np.bool_]
    values: tuple[Array, ...]
    vectors: tuple[Array, ...]
    unheard: NDArray[np.int64]
    tolerance: float
    scatter: float
    marks: Marks

    @classmethod
    def of(cls, refined: Refined, rng: np.random.Generator, springings: Sequence[Springing] = ()) -> Self | None:
        """With the points that a fit rests on and that lie near it, but for those near edges; None if few are left."""
        placed, whole = refined.placed, refined.evidence
        some = np.sort(rng.permutation(len(whole.points))[:CHOICE_POINTS])
        evidence = replace(whole, points=whole.points[some], weights=whole.weights[some])
        scale = float(np.clip(4 * refined.scatter, NARROWEST, WIDEST))
        residuals = placed.distance(evidence.points)
        weights = evidence.weights / (1 + (residuals / WIDEST) ** 2) ** 2
        edge = near_edges(placed, evidence.points)
        blocks = Partition.of(placed, evidence.points, weights * ~edge)
        mean = blocks.means(residuals[:, None])[:, 0]
        filled = blocks.weight > 0
        usable = filled & (np.abs(mean) < OUTLIER * scatter_of(mean[filled]))
        if usable.sum() < ENOUGH:
            return None
        plan, rise = placed.vault.plan, placed.vault.derived_values()["rise"]
        place, normal = blocks.place[usable], blocks.normal[usable]
        fields = smooth_fields(place, normal, plan, rise)
        pairs = [np.linalg.eigh(field) for field in fields]
        values = tuple(np.maximum(pair[0], 0.0) for pair in pairs)
        vectors = tuple(pair[1] for pair in pairs)
        unheard = _mostly(components_at(placed, evidence.points, refined.tolerance), edge)
        marks = Marks.of(springings, placed, place, normal, vectors, rise)
        return cls(evidence, scale, blocks, usable, values, vectors, unheard, refined.tolerance, refined.scatter, marks)

    def near(self, solution: Solution) -> bool:
        """Whether a fit comes near all stone: what is far from it, no small change of its parameters would reach.

        Nor may it lose that of a component of which blocks say nothing, as of small lunettes: all of it is near edges.
        """
        residual = self.blocks.means(solution.residuals[:, None])[self.usable, 0]
        lost = np.abs(solution.residuals) > self.tolerance
        whole, gone = np.bincount(self.unheard), np.bincount(self.unheard[lost], minlength=self.unheard.max() + 1)
        keeps = gone[1:] <= np.maximum(LOST * whole[1:], LOST_POINTS)
        return float((np.abs(residual) > FAR).mean()) < FEW_FAR and bool(keeps.all())

    def log_likelihood(self, solution: Solution, told: Marginal) -> float:
        """Of a fit to this evidence, with its parameters within their ranges, up to a constant that all fits share."""
        spread = np.asarray(told.covariance.diagonal(axis1=1, axis2=2), np.float64)
        mean, variance = told.moments(told.shift, spread)
        values, ranges = solution.placed.vault.values(), {p.name: p.range for p in solution.placed.vault.parameters()}
        precision, before = beforehand(solution)
        within = 0.0
        for k, name in enumerate(solution.names[len(POSE) :], len(POSE)):
            ends = np.array([ranges[name].low, ranges[name].high]) - values[name]
            within += _log_within(ends, mean[k], variance[k]) - _log_within(ends, before[k], 1 / precision[k])
        return (_log_sum(told.likelihood) + self._of_small_components(solution)) / DOUBT + within

    def _of_small_components(self, solution: Solution) -> float:
        """Logarithm of the likelihood of the stone of components of which blocks say nothing, up to a constant.

        What it is off the model by is as good a guess of its spread as any, and at least what the whole leaves.
        """
        (mine,) = np.nonzero(self.unheard)
        if not len(mine):
            return 0.0
        off = np.minimum(np.abs(solution.residuals[mine]), self.tolerance)
        said = np.minimum(np.bincount(self.unheard[mine])[1:], SMALL_SAYS).sum()
        return float(-0.5 * said * np.log(np.mean(off**2) + self.scatter**2))

    def sizes(self, solution: Solution, told: Marginal) -> dict[str, tuple[float, float]]:
        """Mean and standard deviation of each size and of the pose, by name, before the settlement [m, rad, 1]."""
        vault, pose = solution.placed.vault, solution.placed.pose
        here = {**vault.values(), **vault.derived_values(), **{name: getattr(pose, name) for name in POSE}}
        slopes = slopes_of_sizes(solution) | dict(zip(POSE, np.eye(len(POSE), len(solution.names)), strict=True))
        rows = np.stack(list(slopes.values()))
        spread = ((rows @ told.covariance) * rows).sum(axis=2)
        mean, variance = told.moments(told.shift @ rows.T, spread)
        return {
            name: (here[name] + float(mean[k]), sqrt(max(float(variance[k]), 0.0))) for k, name in enumerate(slopes)
        }

    def marginal(self, solution: Solution) -> Marginal:
        """Of a fit to this evidence, over lengths, strengths and roughnesses of the field."""
        residual = self.blocks.means(solution.residuals[:, None])[self.usable, 0]
        jacobian = self.blocks.means(secants(solution, self.evidence.points))[self.usable]
        precision, mean = beforehand(solution)
        strengths, roughnesses = STRENGTHS[COARSE] ** 2, ROUGHNESSES[COARSE] ** 2
        found = []
        for k, (values, vectors, prior) in enumerate(zip(self.values, self.vectors, PRIOR[:, COARSE], strict=True)):
            slopes, rest = vectors.T @ jacobian, vectors.T @ residual
            variance = (strengths[:, None, None] * values + roughnesses[:, None]).reshape(-1, len(rest))
            weight = 1 / variance
            squares = (slopes[:, :, None] * slopes[:, None, :]).reshape(len(rest), -1)
            inverse = (weight @ squares).reshape(len(weight), len(mean), len(mean)) + np.diag(precision)
            pull = precision * mean - weight @ (slopes * rest[:, None])
            misfit = weight @ rest**2 + precision @ mean**2 + np.log(variance).sum(axis=1)
            strength = np.repeat(strengths, len(roughnesses))
            off, moved, own = self.marks.left(k, solution, strength, weight, slopes, rest)
            before = np.repeat(prior, len(roughnesses)) + 0.5 * np.log(precision).sum()
            for case, (chance, apart) in enumerate(self.marks.cases()):
                told = own + apart
                informed = np.linalg.solve(told, np.concatenate([moved, off[:, :, None]], axis=2))
                across = np.swapaxes(moved, 1, 2) @ informed
                known, pulled = inverse + across[:, :, :-1], pull - across[:, :, -1]
                covariance = np.linalg.inv(known)
                shift = (covariance @ pulled[:, :, None])[:, :, 0]
                volume = np.linalg.slogdet(known)[1] + np.linalg.slogdet(told)[1]
                cost = misfit + (off * informed[:, :, -1]).sum(axis=1) - (pulled * shift).sum(axis=1)
                likelihood = before + chance - 0.5 * (volume + cost)
                found.append((likelihood, shift, covariance, np.full(len(shift), case)))
        return Marginal(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def secants(solution: Solution, points: Array) -> Array:
    """Derivatives (n, k) of the distances of the points (n, 3) [m] of a solution; by the rise, the crown stays there.

    These are taken over wide steps, where the springing may move.

    A segment that is all but a semicircle can lose its foot to the wall without a change of first order. Below a
    raised arch, as a dome's, there is more of the vault: a step that leaves the crown would move all that.
    """
    out, vault, pose = solution.jacobian.copy(), solution.placed.vault, solution.placed.pose
    values, parameters = vault.values(), {p.name: p for p in vault.parameters()}
    for k, name in enumerate(solution.names[len(POSE) :], len(POSE)):
        if arch_of(vault, name) in {None, *vault.raised}:
            continue
        low, high = parameters[name].range.low, parameters[name].range.high
        ends = [min(max(values[name] + side * RATIO_STEP, low), high) for side in (-1, 1)]
        vaults = [solution.free.settled(vault, {name: end}) for end in ends]
        rises = [end.derived_values()["rise"] - vault.derived_values()["rise"] for end in vaults]
        if rises[0] == rises[1]:
            continue
        if "z" in solution.free.pose:  # the springing stays, and the crown moves
            rises = [0.0, 0.0]
        less, more = (
            Placed(end, replace(pose, z=pose.z - rise)).distance(points)
            for end, rise in zip(vaults, rises, strict=True)
        )
        out[:, k] = (more - less + (rises[1] - rises[0]) * solution.jacobian[:, 2]) / (ends[1] - ends[0])
    return out


def _log_within(ends: Array, mean: float, variance: float) -> float:
    """Logarithm of the chance that a normal variable lies between two ends (2,)."""
    from scipy.special import ndtr

    below = ndtr((ends - mean) / sqrt(max(variance, 1e-12)))
    return log(max(float(below[1] - below[0]), NEVER))


def near_edges(placed: Placed, points: Array, reach: float = EDGE) -> NDArray[np.bool_]:
    """Which points (n, 3) lie so near to an edge, of two components or of a wall, that they may be of either.

    reach: how near [m], but at most a share of the plan's shorter side.
    """
    reach = min(reach, EDGE_SHARE * placed.vault.plan.width)
    frame = placed.pose.frame()
    local = points @ frame[:, :3].T + frame[:, 3]
    surface = placed.vault.evaluate(local, walls=True)
    own, foot = faces(surface), local - surface.distance[:, None] * surface.normal
    level = np.where(np.abs(surface.normal[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    along = np.cross(surface.normal, level)
    along /= np.linalg.norm(along, axis=1)[:, None]
    across = np.cross(surface.normal, along)
    near = np.zeros(len(points), np.bool_)
    for way in (along, -along, across, -across):
        near |= faces(placed.vault.evaluate(foot + reach * way, walls=True)) != own
    return near


def components_at(placed: Placed, points: Array, tolerance: float) -> NDArray[np.int64]:
    """Component (n,) within whose band of that half width [m] points (n, 3) [m] lie; 0 off the vault."""
    surface = placed.vault.evaluate(points, frame=placed.pose.frame(), walls=True)
    return np.where(np.abs(surface.distance) <= tolerance, surface.component, 0).astype(np.int64)


def _mostly(component: NDArray[np.int64], mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Components (n,) of points, those of which less than half are in a mask (n,) set to 0."""
    whole = np.bincount(component)
    within = np.bincount(component[mask], minlength=len(whole))
    return np.where((2 * within > whole)[component], component, 0)


def _log_sum(values: Array) -> float:
    """Logarithm of the sum of exponentials."""
    top = float(values.max())
    return top + log(float(np.exp(values - top).sum())) if top > -inf else -inf

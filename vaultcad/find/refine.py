"""The last fit: the winning family on many points, its constraints kept where that costs little."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np
from numpy.typing import NDArray

from families.declaration.constraints import Constraint
from families.declaration.corners import Skew
from families.declaration.profiles import as_kind
from vaultcad.find.identity import is_its_family
from vaultcad.find.recognise import CLOSE, PAYS, Hypothesis, turned_over
from vaultcad.fit.evidence import INDEPENDENT, NEAR_HYPOTHESES, Evidence
from vaultcad.fit.freedom import NONE, RECTANGLE, Demands, Freedom
from vaultcad.fit.solve import Placed, Solution
from vaultcad.fit.uncertainty import loosened
from vaultcad.survey.thinned_scan import Site

Array = NDArray[np.float64]
FREEDOM_POINTS, FIT_POINTS = 5_000, 20_000  # to choose what is free, and to fit that
FROM_AFAR = (0.3, 0.1)  # m, scales of the loss where corners begin at those of a rectangle
LAST = 1e-9  # share of the cost that a step of the last fit must still gain
TIGHTEST, WIDEST = 0.004, 0.05  # m, limits of the last loss
FAINT = 1e-4  # of the cost
LEFT = 0.2  # share of the stone near a component that is off it, from which on the fit is begun again
BAND, TOLERANCE = 4.0, (0.03, 0.12)  # scatters, and m: limits of the band that a vault's points lie in
WALLS = 0.03  # weight of a wall's point in the last fit


@dataclass(frozen=True)
class Refined:
    """The final solution with the evidence it rests on and the scatter (robust standard deviation) that it leaves [m].

    kept: the constraints that hold in it. loosest: what may move if only those are kept that seldom fail.
    """

    solution: Solution
    evidence: Evidence
    scatter: float
    kept: tuple[Constraint, ...]
    loosest: Freedom

    @property
    def placed(self) -> Placed:
        """The vault where it stands."""
        return self.solution.placed

    @property
    def points(self) -> Array:
        """That the solution rests on (n, 3) [m]."""
        return self.evidence.points

    @property
    def tolerance(self) -> float:
        """Half of the band that the points of the vault lie in [m]."""
        return float(np.clip(BAND * self.scatter, *TOLERANCE))

    @property
    def loose(self) -> Solution:
        """The solution with all unknowns that it may be wrong in."""
        return loosened(self.solution, self.loosest, self.points)


def refine(
    winner: Hypothesis,
    site: Site,
    rng: np.random.Generator,
    *,
    demands: Demands = NONE,
    known: Sequence[Constraint] | None = None,
) -> Refined:
    """Fit the winner to up to `POINTS` points of the site, narrowing the loss to the scatter that is left.

    Constraints that seldom fail are let go where that pays, the others are kept where that costs nothing; the price of
    a parameter is Schwarz's. `known` are the constraints of a vault that looks like this one: then only free corners,
    which each bay has of its own, are weighed.
    """
    start = winner.solution.placed
    if RECTANGLE.name in demands.freed and start.vault.four_corners:
        start = replace(start, vault=replace(start.vault, skew=Skew()))
    fit = _Fit(Evidence.draw(site, FREEDOM_POINTS, rng, demands, about=[start]), demands)
    kept, weighed = winner.kept, demands.keepable(start.vault)
    if known is not None:
        kept = tuple(c for c in weighed if c in (winner.kept if c is RECTANGLE else known))
        weighed = tuple(c for c in weighed if c is RECTANGLE)
    best = fit(start, kept, wide=FROM_AFAR if start.vault.skew else ())
    if known is None and _leaves_stone(best):
        best = _begun_again(best, site, rng, demands)
        fit = _Fit(best.evidence, demands)
    for constraint in weighed:
        trial = fit(*turned_over(best.placed, best.kept, constraint), wide=FROM_AFAR if constraint is RECTANGLE else ())
        more, less = (best, trial) if constraint in best.kept else (trial, best)  # constrained
        saved = len(less.solution.names) - len(more.solution.names)
        if saved:
            price = PAYS if constraint.rare else saved * log(INDEPENDENT)
            best = less if gain(fit.evidence, more, less) > price else more
    # What is reported are the deviations of the vault's points: walls only help, and what is seen well counts more.
    weights = np.where(site.weights < 1, WALLS, 1.0) * np.sqrt(site.counts)
    evidence = Evidence.draw(site, FIT_POINTS, rng, demands, weights=weights)
    return settled(best.placed, best.kept, evidence, best.scatter, demands)


def settled(
    start: Placed, kept: Sequence[Constraint], evidence: Evidence, scatter: float, demands: Demands = NONE
) -> Refined:
    """The last fit to all evidence, from near by, under these constraints; `scatter`: what is known of it [m]."""
    return _Fit(evidence, demands, LAST, 60)(start, kept, scatter)


def _leaves_stone(one: Refined) -> bool:
    """Whether much of what is near to one of its components is not of it, as where a lunette is another than fitted."""
    surface = one.placed.vault.evaluate(one.points, frame=one.placed.pose.frame(), walls=True)
    near, off = surface.component, np.abs(surface.distance)
    most = len(one.placed.vault.components) + 1
    near = np.where(off < NEAR_HYPOTHESES, near, 0)
    whole, left = np.bincount(near, minlength=most)[1:], np.bincount(near[off > one.tolerance], minlength=most)[1:]
    return bool((left > LEFT * whole).any())


def _begun_again(one: Refined, site: Site, rng: np.random.Generator, demands: Demands) -> Refined:
    """The same from afar with none of the family's own constraints, or with another kind of one arch, if that pays."""
    vault, kept = one.placed.vault, tuple(c for c in one.kept if c is RECTANGLE)
    arches = [(name, as_kind(kind, arch)) for name, arch in vault.profiles.items() for kind in vault.kinds_for(name)]
    others = [vault, *(vault.with_arches({name: arch}) for name, arch in arches if arch is not None)]
    begun = [replace(one.placed, vault=demands.begun(other)) for other in others if demands.suits(other)]
    every = Evidence.draw(site, FREEDOM_POINTS, rng, demands)
    begun = [every.solve(start, demands.freedom(start.vault, kept), FROM_AFAR).placed for start in begun]
    fit = _Fit(Evidence.draw(site, FREEDOM_POINTS, rng, demands, about=[one.placed, *begun]), demands)
    best = fit(one.placed, one.kept)
    for start in begun:
        trial = fit(start, kept)
        price = (len(trial.solution.names) - len(best.solution.names)) * log(INDEPENDENT)
        if (
            is_its_family(trial.placed.vault)
            and demands.met(trial.placed.vault)
            and gain(fit.evidence, best, trial) > price
        ):
            best = trial
    return best


@dataclass(frozen=True)
class _Fit:
    """Fits to one evidence, the loss narrowed to the scatter that is left."""

    evidence: Evidence
    demands: Demands
    close: float = CLOSE
    most: int = 15

    def __call__(
        self, start: Placed, kept: Sequence[Constraint], scatter: float = WIDEST, wide: tuple[float, ...] = ()
    ) -> Refined:
        """`scatter`: what is known of it [m]; a start that is good is not to be left for the sake of far points.

        wide: scales of the loss with which to begin if it is not.
        """
        free = self.demands.freedom(start.vault, kept)
        for k in range(4):
            scale = float(np.clip(4 * scatter, TIGHTEST, WIDEST))
            scales = (scale,) if k else (*wide, scale)
            solution = self.evidence.solve(start, free, scales, most=self.most, gain=self.close)
            start, scatter = solution.placed, _scatter(solution, self.evidence.weights)
        loosest = self.demands.freedom(solution.placed.vault, [c for c in kept if c.rare])
        return Refined(solution, self.evidence, scatter, tuple(kept), loosest)


def gain(evidence: Evidence, worse: Refined, better: Refined) -> float:
    """How much more likely the second is, in the units of a score."""
    scale = float(np.clip(4 * better.scatter, TIGHTEST, WIDEST))
    costs = [evidence.cost(one.placed, scale) + FAINT for one in (worse, better)]  # no scan is exact
    return INDEPENDENT * log(costs[0] / costs[1])


def _scatter(solution: Solution, weights: Array) -> float:
    """Standard deviation of the residuals, from the weighted median of those that are no outliers [m]."""
    size = np.abs(solution.residuals)
    near = np.flatnonzero(size < 3 * WIDEST)
    if len(near) == 0:
        return WIDEST
    order = near[np.argsort(size[near])]
    share = np.cumsum(weights[order])
    return float(1.4826 * size[order[np.searchsorted(share, share[-1] / 2)]])

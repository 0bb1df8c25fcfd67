"""The last fit: the winning family on many points, with what was held at zero freed where it pays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log

import numpy as np
from numpy.typing import NDArray

from vaultcad.recognise import EXTRAS, Evidence, Hypothesis, free_parameters
from vaultcad.site import Site
from vaultcad.solve import Placed, Solution, solve

Array = NDArray[np.float64]
POINTS = 20_000
TIGHTEST, WIDEST = 0.004, 0.05  # m, limits of the last loss
PAYS = 10.0  # what an extra parameter must lower the score by


@dataclass(frozen=True)
class Refined:
    """The final solution with the points it rests on and the scatter (robust standard deviation) they leave [m]."""

    solution: Solution
    points: Array
    scatter: float

    @property
    def placed(self) -> Placed:
        """The vault where it stands."""
        return self.solution.placed


def refine(winner: Hypothesis, site: Site, blocks: int, rng: np.random.Generator) -> Refined:
    """Fit the winner to up to `POINTS` points of the site, narrowing the loss to the scatter that is left."""
    evidence = Evidence.draw(site, POINTS, rng)
    best = _fit(winner.solution.placed, (), evidence)
    held = [p.name for p in best.placed.vault.parameters() if p.name in EXTRAS]
    freed: tuple[str, ...] = ()
    for name in held:
        range_ = next(p.range for p in best.placed.vault.parameters() if p.name == name)
        start = best.placed.vault.replaced({name: 0.02 * (range_.high - max(range_.low, 0.0))})
        trial = _fit(replace(best.placed, vault=start), (*freed, name), evidence)
        if blocks * log(_cost(best, evidence) / _cost(trial, evidence, best.scatter)) > PAYS:
            best, freed = trial, (*freed, name)
    return best


def _fit(start: Placed, extras: tuple[str, ...], evidence: Evidence) -> Refined:
    free = free_parameters(start.vault, extras=extras)
    solution = solve(start, evidence.points, evidence.weights, free, (WIDEST,))
    for _ in range(3):
        scatter = _scatter(solution)
        scale = float(np.clip(4 * scatter, TIGHTEST, WIDEST))
        solution = solve(solution.placed, evidence.points, evidence.weights, free, (scale,))
    return Refined(solution, evidence.points, _scatter(solution))


def _scatter(solution: Solution) -> float:
    near = np.abs(solution.residuals) < 3 * WIDEST
    return float(1.4826 * np.median(np.abs(solution.residuals[near])))


def _cost(refined: Refined, evidence: Evidence, scatter: float | None = None) -> float:
    scale = float(np.clip(4 * (refined.scatter if scatter is None else scatter), TIGHTEST, WIDEST))
    return evidence.cost(refined.placed, scale) + 1e-4

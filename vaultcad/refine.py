"""The last fit: the winning family on many points, with what was held at zero freed where it pays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import log

import numpy as np
from numpy.typing import NDArray

from vaultcad.recognise import CLOSE, EXTRAS, FIRST, PAYS, Evidence, Hypothesis
from vaultcad.site import Site
from vaultcad.solve import POSE, Placed, Solution

Array = NDArray[np.float64]
FEW, POINTS = 5_000, 20_000  # to choose what is free, and to fit that
LAST = 1e-9  # share of the cost that a step of the last fit must still gain
TIGHTEST, WIDEST = 0.004, 0.05  # m, limits of the last loss
FAINT = 1e-4  # of the cost
PLAIN: tuple[Mapping[str, float], ...] = (  # what a vault is taken for unless the scan says otherwise
    {"plane_ratio": 1.0},
    {"pendentive_ratio": 0.0},
    {"drum_ratio": 0.0},
    {"south_ratio": 1.0, "north_ratio": 1.0},
    {"width_ratio": 1.0},
    {"springing_ratio": 0.0},
)


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
    """Fit the winner to up to `POINTS` points of the site, narrowing the loss to the scatter that is left.

    What is mostly zero is freed where that pays, what is nearly plain is made plain where that costs nothing; the
    price of a parameter is Schwarz's.
    """
    evidence = Evidence.draw(site, FEW, rng)
    best = _fit(winner.solution.placed, winner.free, evidence)
    for name in [p.name for p in best.placed.vault.parameters() if p.name in EXTRAS and p.name not in winner.free]:
        start = replace(best.placed, vault=best.placed.vault.replaced({name: FIRST}))
        trial = _fit(start, (*_freed(best), name), evidence)
        if blocks * log(_cost(best, evidence, best) / _cost(trial, evidence, best)) > PAYS:
            best = trial
    for values in PLAIN:
        free = _freed(best)
        if set(values) <= set(free):
            start = replace(best.placed, vault=best.placed.vault.replaced(values))
            trial = _fit(start, tuple(name for name in free if name not in values), evidence)
            if blocks * log(_cost(trial, evidence, best) / _cost(best, evidence, best)) < len(values) * log(blocks):
                best = trial
    return _fit(best.placed, _freed(best), Evidence.draw(site, POINTS, rng), gain=LAST)


def _freed(refined: Refined) -> tuple[str, ...]:
    return refined.solution.names[len(POSE) :]


def _fit(start: Placed, free: tuple[str, ...], evidence: Evidence, *, gain: float = CLOSE) -> Refined:
    solution = evidence.solve(start, free, (WIDEST,), gain=gain)
    for _ in range(3):
        scale = float(np.clip(4 * _scatter(solution), TIGHTEST, WIDEST))
        solution = evidence.solve(solution.placed, free, (scale,), gain=gain)
    return Refined(solution, evidence.points, _scatter(solution))


def _scatter(solution: Solution) -> float:
    near = np.abs(solution.residuals) < 3 * WIDEST
    return float(1.4826 * np.median(np.abs(solution.residuals[near])))


def _cost(refined: Refined, evidence: Evidence, measure: Refined) -> float:
    """Cost with the loss that suits the scatter of `measure`; never zero, as no scan is exact."""
    scale = float(np.clip(4 * measure.scatter, TIGHTEST, WIDEST))
    return evidence.cost(refined.placed, scale) + FAINT

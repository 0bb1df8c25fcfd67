"""The points that hypotheses are fitted to and judged by: as many as a stage needs, and only those that can tell."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.fit.freedom import SPRINGING, Demands, Freedom
from vaultcad.fit.solve import Placed, Solution, robust_cost, solve
from vaultcad.survey.thinned_scan import Site

Array = NDArray[np.float64]

ENDS = 0.06  # share of the evidence that the ends of the stone have where there are no walls
BELOW = 0.1  # m; a springing lower than this and two points under the lowest point is a guess
NEAR_HYPOTHESES = 0.15  # m; what is farther from every hypothesis is clutter, and says nothing for or against one
INDEPENDENT = 100
"""Residuals of a vault that say something new. Settlement comes in waves as long as the vault is wide, so their number
hangs neither on its size nor on how many points were scanned; found with virtual scans, see `bench/rooms.py`."""


@dataclass(frozen=True)
class Evidence:
    """Points of a site (n, 3) [m], weights (n,), and the lowest springing [m]."""

    points: Array
    weights: Array
    lowest: float

    @classmethod
    def draw(
        cls,
        site: Site,
        count: int,
        rng: np.random.Generator,
        demands: Demands,
        *,
        about: Iterable[Placed] = (),
        weights: Array | None = None,
    ) -> Evidence:
        """`count` of the site's points, or all if they are fewer, and the ends of the stone where no walls are.

        Args:
            site: where to draw from.
            count: how many points.
            rng: the choice.
            demands: may let the springing go below the stone.
            about: hypotheses; only points near to one of them are drawn.
            weights: (n,) of the site's points, in place of its own.
        """
        weights = site.weights if weights is None else weights
        distances = [np.abs(placed.distance(site.points)) for placed in about]
        kept = np.flatnonzero(np.min(distances, axis=0) < NEAR_HYPOTHESES) if distances else np.arange(len(site.points))
        k = np.sort(rng.permutation(kept)[:count])
        points, weights = site.points[k], weights[k]
        if len(site.ends):  # they tie the plan to where the stone ends, as walls would
            ties = np.ones(len(site.ends)) if site.ties is None else site.ties
            tie = ENDS * weights.sum() / len(site.ends) * ties
            points, weights = np.concatenate([points, site.ends]), np.concatenate([weights, tie])
        lowest = -np.inf if SPRINGING.name in demands.freed else site.bottom - BELOW - 2 * site.spacing
        return cls(points, weights, lowest)

    def cost(self, placed: Placed, scale: float) -> float:
        """Weighted mean of the robust cost, 0 to 1."""
        return float(self.weights @ robust_cost(placed.distance(self.points), scale) / self.weights.sum())

    def solve(
        self, start: Placed, free: Freedom, scales: tuple[float, ...], *, most: int = 15, gain: float = 1e-7
    ) -> Solution:
        """Fit what is free, see `vaultcad.fit.solve.solve`."""
        return solve(start, self.points, self.weights, free, scales, lowest=self.lowest, most=most, gain=gain)

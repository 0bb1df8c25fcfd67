"""What of a vault the scan really saw, and what it could not tell because of what it did not see."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.fit.solve import Solution
from vaultcad.fit.uncertainty import slopes_of_distances

Array = NDArray[np.float64]
SAMPLES = 8000  # of the whole intrados; a share is then known to about 1 %
FAINT = 1e-9  # of the best known unknown; what is known less is not known


@dataclass(frozen=True)
class Sight:
    """Places (k, 3) spread evenly over the intrados, in the vault's frame [m], their components and which were seen."""

    places: Array
    component: NDArray[np.uint16]
    seen: NDArray[np.bool_]

    @property
    def whole(self) -> float:
        """Share of the intrados that was seen."""
        return float(self.seen.mean())

    def of(self, component: int) -> float:
        """Share of a component that was seen; 0 if the vault has no such component."""
        mine = self.component == component
        return float(self.seen[mine].mean()) if mine.any() else 0.0


def look(vault: Vault, points: Array, reach: float, rng: np.random.Generator) -> Sight:
    """Which places of the intrados have a point of the scan within `reach` [m].

    Args:
        vault: the vault.
        points: (n, 3) of the scan on it, in the vault's frame [m].
        reach: a little more than the points' spacing and their distance from the model [m].
        rng: shifts the places that are asked.
    """
    from scipy.spatial import cKDTree

    asked = vault.sample(SAMPLES, rng)
    if len(points) == 0:
        return Sight(asked.xyz, asked.component, np.zeros(len(asked), np.bool_))
    distance, _ = cKDTree(points).query(asked.xyz, distance_upper_bound=reach)
    return Sight(asked.xyz, asked.component, np.isfinite(distance))


@dataclass(frozen=True)
class Information:
    """What the points of a scan tell of the unknowns (k, k), and what those of a scan of the whole vault would."""

    present: Array
    possible: Array

    def share(self, slopes: Array) -> float:
        """Of a size with these derivatives (k,) by the unknowns: how much of what could be told is told, 0 to 1.

        It is the ratio of the variances that even noise on the points would cause; 0 if nothing is told.
        """
        present, possible = _variance(self.present, slopes), _variance(self.possible, slopes)
        return min(possible / present, 1.0) if 0 < present < np.inf else 0.0


def information(solution: Solution, points: Array, sight: Sight) -> Information:
    """Of the points (n, 3) that a solution rests on; the places not seen count as much as those that were seen."""
    placed = solution.placed
    present = (solution.jacobian.T * solution.weights) @ solution.jacobian
    on_vault = placed.vault.evaluate(points, frame=placed.pose.frame(), walls=True).component > 0
    density = float(solution.weights[on_vault].sum()) / max(1, int(sight.seen.sum()))
    turn = placed.pose.placement()
    slopes = slopes_of_distances(solution, sight.places[~sight.seen] @ turn[:3, :3].T + turn[:3, 3])
    return Information(present, present + density * slopes.T @ slopes)


def _variance(information: Array, slopes: Array) -> float:
    """Of a size with derivatives (k,), up to a factor; infinite if it cannot be told."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    values, vectors = np.linalg.eigh(information / np.outer(scale, scale))
    along = (vectors.T @ (slopes / scale)) ** 2
    known = values > FAINT
    # What touches a direction that is not known, beyond rounding, is not known either.
    if along[~known].sum() > 1e-6 * along.sum():
        return np.inf
    return float((along[known] / values[known]).sum())

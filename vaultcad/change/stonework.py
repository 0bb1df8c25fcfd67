"""What all points of a site say of places on a vault, of which a fit rests on some.

Each has all the noise of the scan. How far stone is off a vault that fits it changes little within a decimetre, so that
the median of all points about a place tells it with a fraction of that noise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.fit.solve import Placed
from vaultcad.group_medians import group_medians

Array = NDArray[np.float64]

NEAR = 0.1  # m off the vault, beyond which a point is none of its stone
CELL = 0.1  # m, edge of the cells in which points are taken together: a block has ten


@dataclass(frozen=True)
class Stonework:
    """Points (n, 3) [m] near a vault, the component (n,) that each is of, and how far it is off that (n,) [m]."""

    points: Array
    component: NDArray[np.integer]
    deviation: Array

    @classmethod
    def about(cls, placed: Placed, points: Array) -> Stonework:
        """Those of the points (n, 3) of a site [m] that are near to a vault."""
        shown = placed.vault.evaluate(points, frame=placed.pose.frame(), walls=True)
        near = (shown.component > 0) & (np.abs(shown.distance) < NEAR)
        return cls(points[near], shown.component[near], shown.distance[near])

    def told(self, points: Array, component: NDArray[np.integer], deviation: Array) -> Array:
        """How far the stone about points (m, 3) [m] is off their components (m,): (m,) [m].

        Where nothing was seen of that component in their cell, it is what the points are off themselves.
        """
        low = points.min(axis=0)
        size = np.floor((points.max(axis=0) - low) / CELL).astype(np.int64) + 1

        def keys(at: Array, of: NDArray[np.integer]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
            cell = np.floor((at - low) / CELL).astype(np.int64)
            inside: NDArray[np.bool_] = ((cell >= 0) & (cell < size)).all(axis=1)
            return ((of.astype(np.int64) * size[0] + cell[:, 0]) * size[1] + cell[:, 1]) * size[2] + cell[:, 2], inside

        mine, _ = keys(points, component)
        every, inside = keys(self.points, self.component)
        cells, of = np.unique(mine, return_inverse=True)
        place = np.minimum(np.searchsorted(cells, every), len(cells) - 1)
        on = inside & (cells[place] == every)
        medians = group_medians(place[on], self.deviation[on], len(cells))[of]
        return np.where(np.isfinite(medians) & (component > 0), medians, deviation)

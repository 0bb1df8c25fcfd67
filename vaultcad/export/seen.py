"""A fitted vault with what the scan shows around it: what its drawings are drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.drawing.deviation_colours import limit_of
from vaultcad.model import FittedVault, Model

Floats = NDArray[np.float64]

WALL_HEIGHTS = (-0.4, 0.1)  # [m] above the springing: the points of walls that a plan shows
WALL_REACH = 0.1  # of the larger side of the plan, so far around it
CELLS = (90, 75, 60, 50, 40, 30, 20)  # of the map along the longer side of the plan; the first in which
PER_CELL = 4  # points lie in most cells that have any

SHADES = 20  # from no deviation to the limit


@dataclass(frozen=True)
class Seen:
    """Points (n, 3) [m] in a vault's frame, their component (n,), 0 off this vault, and signed deviation (n,) [m]."""

    fitted: FittedVault
    thickness: float
    points: Floats
    component: NDArray[np.integer]
    deviation: Floats

    @property
    def vault(self) -> Vault:
        """The ideal vault."""
        return self.fitted.vault

    @cached_property
    def on(self) -> NDArray[np.bool_]:
        """Which points (n,) are the vault's."""
        return (self.component > 0) & np.isfinite(self.deviation)

    @cached_property
    def box(self) -> tuple[Floats, Floats]:
        """The lower and the upper corner (2,) [m] of what is around the plan."""
        return self.vault.plan.box

    @cached_property
    def limit(self) -> float:
        """Deviation [m] at the ends of the scale."""
        return limit_of(self.deviation[self.on])

    @cached_property
    def walls(self) -> Floats:
        """Points (m, 3) of the walls under this vault, at its springing."""
        (low, high), (bottom, top), (x, y, z) = self.box, WALL_HEIGHTS, self.points.T
        around = WALL_REACH * (high - low).max()
        beside = (x > low[0] - around) & (x < high[0] + around) & (y > low[1] - around) & (y < high[1] + around)
        walls: Floats = self.points.compress(beside & (z > bottom) & (z < top) & ~self.on, axis=0)
        return walls

    def stepped(self, deviation: Floats) -> Floats:
        """Deviations [m] in as many steps as drawings have shades, so that files stay small."""
        step = self.limit / SHADES
        return step * np.round(deviation / step)

    def map(self) -> Floats:
        """Mean deviation [m] a cell of the box (nx, ny), NaN where the scan saw nothing of the vault."""
        (low, high), (x, y) = self.box, self.points[self.on, :2].T
        ends = np.column_stack([low, high])
        for along in CELLS:
            cells = [ceil(along * side) for side in (high - low) / (high - low).max()]
            counts, *_ = np.histogram2d(x, y, cells, ends)
            if (counts >= PER_CELL).sum() > 0.5 * (counts > 0).sum():
                break
        sums, *_ = np.histogram2d(x, y, cells, ends, weights=self.deviation[self.on])
        mean: Floats = np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0)
        return mean


def seen(
    model: Model,
    points: NDArray[np.floating] | None = None,
    component: NDArray[np.integer] | None = None,
    deviation: NDArray[np.floating] | None = None,
    vault: NDArray[np.integer] | None = None,
) -> list[Seen]:
    """Each vault of a model with the scan around it.

    Args:
        model: what was found.
        points: (n, 3) thinned points of the scan in its local frame [m], walls and floor included. Without
            them the rest goes unseen.
        component: (n,) their components, 0 off the vault; else all that have a deviation are on it.
        deviation: (n,) their signed distances to the model [m], positive into the stone, NaN off the vault.
        vault: (n,) number of the vault that each belongs to, 0 for none; without it all belong to the first.
    """
    if points is None:
        points, component, deviation, vault = np.zeros((0, 3)), None, None, None
    xyz = np.asarray(points, dtype=np.float64)
    off = np.full(len(xyz), np.nan) if deviation is None else np.asarray(deviation, dtype=np.float64)
    part = np.isfinite(off).astype(int) if component is None else component
    owner = np.ones(len(xyz)) if vault is None else vault
    found = []
    for k, fitted in enumerate(model.vaults, 1):
        frame = fitted.pose.frame()
        local = xyz @ frame[:, :3].T + frame[:, 3]
        found.append(Seen(fitted, model.thickness_of(fitted), local, np.where(owner == k, part, 0), off))
    return found

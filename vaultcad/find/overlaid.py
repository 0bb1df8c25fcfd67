"""Two vaults cannot hang in one place: what of a vault's plan another one's stone hangs over, as high as its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vaultcad.fit.label import label
from vaultcad.fit.solve import Placed

Array = NDArray[np.float64]

COLUMN = 0.25  # m, edge of the cells of a plan, each of which is the vault's that most of its stone is nearest to
AS_HIGH = 0.3  # m off a vault up to which another's stone hangs in its place; farther off is a storey, or a step


def overlaid(vaults: Sequence[tuple[Placed, float]], points: Array) -> list[float]:
    """For each vault, with its tolerance [m], the share of its plan that is another's, by points (n, 3) [m]."""
    nearest = label(points, vaults).vault
    return [_others(placed, points, nearest == number, nearest > 0) for number, (placed, _) in enumerate(vaults, 1)]


def _others(placed: Placed, points: Array, own: NDArray[np.bool_], some: NDArray[np.bool_]) -> float:
    """Share of the columns of a vault's plan with stone of any vault, most of which is not its own (n,)."""
    frame, reach = placed.pose.frame(), float(np.linalg.norm(placed.vault.plan.half)) + COLUMN
    middle = frame[:2, :2].T @ placed.vault.plan.centre + [placed.pose.x, placed.pose.y]
    (near,) = np.nonzero(some & (np.abs(points[:, :2] - middle) < reach).all(axis=1))
    local = points[near] @ frame[:, :3].T + frame[:, 3]
    over = placed.vault.plan.holds(local[:, :2]) & (local[:, 2] > 0)
    near, local = near[over], local[over]
    here = np.abs(placed.vault.distance(local)) < AS_HIGH
    if not here.any():
        return 0.0
    column = np.unique(np.floor(local[here, :2] / COLUMN), axis=0, return_inverse=True)[1].ravel()
    return float((np.bincount(column, own[near[here]]) < np.bincount(column) / 2).mean())

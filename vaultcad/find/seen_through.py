"""Where a scan shows other stone through a vault: there the vault is not, whatever fits the rest of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.fit.solve import Placed

Array = NDArray[np.float64]

COLUMN = 0.25  # m, edge of the cells of the plan in which a vault is seen, or seen through
NEAR, BEYOND = 0.1, 0.2  # m off its surface: up to where it is seen, and from where on behind it stone is another's
SEVERAL = 2  # thinned points in a column that are no strays


def seen_through(placed: Placed, points: Array) -> float:
    """Share of the columns of a vault in which points (n, 3) [m] of a whole scan are behind it, and none on it.

    Of the columns that show either: what is in the shadow says nothing. A storey above, or an attic, is behind a vault
    that is seen from below; behind one half of a barrel that is only a quarter round, the vault hangs that is there.
    """
    plan = placed.vault.plan
    frame = placed.pose.frame()
    middle = np.array([placed.pose.x, placed.pose.y])
    reach = float(np.linalg.norm(np.abs(plan.centre) + plan.half))
    near = (np.abs(points[:, :2] - middle) <= reach).all(axis=1) & (points[:, 2] > placed.pose.z)
    local = points[near] @ frame[:, :3].T + frame[:, 3]
    local = local[plan.holds(local[:, :2]) & (local[:, 2] > 0)]
    if not len(local):
        return 0.0
    distance = placed.vault.evaluate(local).distance
    column = np.unique(np.floor(local[:, :2] / COLUMN).astype(np.int64), axis=0, return_inverse=True)[1].ravel()
    shown = np.bincount(column, np.abs(distance) < NEAR) >= 1
    through = (np.bincount(column, distance > BEYOND) >= SEVERAL) & ~shown
    return float(through.sum() / max(int((shown | through).sum()), 1))

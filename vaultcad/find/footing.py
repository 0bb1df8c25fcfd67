"""On what a vault stands: not on the crown of another ceiling, as the middle lobe of a trefoil seems to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan_sides import Side
from families.void.columns import heights
from vaultcad.fit.solve import Placed
from vaultcad.survey.thinned_scan import STEEP, Thin

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

STEP = 0.25  # m along a side, in which it is looked at what is under it
WITHIN = 0.005  # m within a side, where the vault is all but down at its springing
BESIDE = 0.2, 0.6  # m beyond a side, between which a ceiling is looked at; a beam or an architrave is narrower
BELOW, ABOVE = 1.0, 0.1  # m under the springing and over it, between which that is, or a wall
WALL = (-0.15, 0.4), 0.4  # m beyond a side between which a wall stands, and how high it is at the least
HANGING = 0.5  # |nz| of a ceiling at least
FALLING = 0.06  # m for each metre away from the vault, that a ceiling on which it would stand falls at least
SEVERAL = 2  # thinned points that are no strays


def on_ceilings(placed: Placed, thin: Thin) -> float:
    """Share of the sides with springings, at which a ceiling ends under a vault, and no wall is.

    Such a ceiling falls away from the vault. One that springs beside it rises from there, and a beam between is level.
    """
    sides = [side for side in placed.vault.plan.sides if side.on_wall and side.centre is None]
    if not sides:
        return 0.0
    frame = placed.pose.frame()
    middle, reach = np.array([placed.pose.x, placed.pose.y]), float(np.linalg.norm(placed.vault.plan.half)) + BESIDE[1]
    near = (np.abs(thin.points[:, :2] - middle - frame[:2, :2].T @ placed.vault.plan.centre) < reach).all(axis=1)
    local = thin.points[near] @ frame[:, :3].T + frame[:, 3]
    normals = thin.normals[near] @ frame[:, :3].T
    found = np.concatenate([_ceiling_under(side, placed, local, normals) for side in sides])
    return float(found.mean())


def _ceiling_under(side: Side, placed: Placed, local: Array, normals: Array) -> Mask:
    """In which steps (k,) along a straight side a ceiling ends under it, without a wall.

    local, normals: (n, 3) of the stone, in the vault's frame [m].
    """
    start, out = np.array(side.start), np.array(side.normal)
    length = float(np.linalg.norm(np.array(side.end) - start))
    along = (np.array(side.end) - start) / length
    count = max(round(length / STEP), 1)
    places = start + np.outer((np.arange(count) + 0.5) * length / count, along)
    springing = heights(placed.vault, places - WITHIN * out)
    step = np.floor((local[:, :2] - start) @ along * count / length)
    beyond = (local[:, :2] - start) @ out
    mine = np.flatnonzero((step >= 0) & (step < count) & (beyond > WALL[0][0]) & (beyond < BESIDE[1]))
    step, beyond, normals = step[mine].astype(np.int64), beyond[mine], normals[mine]
    below = springing[step] - local[mine, 2]
    band = (below > -ABOVE) & (below < BELOW)
    upwards = np.abs(normals[:, 2])
    upright = band & (below > 0) & (upwards < STEEP) & (beyond < WALL[0][1])
    (ceiling,) = np.nonzero(band & (upwards > HANGING) & (beyond > BESIDE[0]))
    many = np.bincount(step[ceiling], minlength=count)
    rise = np.bincount(step[ceiling], -(normals[ceiling, :2] @ out) / normals[ceiling, 2], count)
    found: Mask = (many >= SEVERAL) & (rise < -FALLING * many)
    for k in np.flatnonzero(found):
        wall = below[upright & (step == k)]
        found[k] = len(wall) < SEVERAL or np.ptp(wall) < WALL[1]
    return found

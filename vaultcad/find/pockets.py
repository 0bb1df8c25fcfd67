"""Where stone goes back behind a vault, as the lunettes do that it lacks: compact places over its plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.fit.solve import Placed
from vaultcad.survey.parting import LEVEL_NORMAL
from vaultcad.survey.thinned_scan import STEEP, Site, inside, turned

Array = NDArray[np.float64]

DEEP = 0.1  # m behind the model
SMALLEST = 0.1  # m² in plan; settlement, lost plaster and stray points leave 0.05 m² together at most
CELL = 0.1, 1.5  # m and spacings; edge of the plan's cells, at least
AT_AN_END = 0.5  # m from the ends of the stone where it is not looked for
BENT = 0.5  # share of a place's stone that is not level, as heads of niches are
OF_A_DRUM = 0.2  # |nz| of the model below which it is a drum, behind which there are windows


def pockets_behind(placed: Placed, site: Site) -> list[Array]:
    """The compact places over a vault's plan in which bent stone is well behind its surface: points (n, 3) of each.

    The points are in the vault's own frame [m], the largest place first.

    Where the vault is seen, too, that is its own back, or a storey above.
    Five uneven lunettes were five such places of 0.15 to 0.5 m²; a door's head in the haunch of a barrel was one.
    """
    from scipy.ndimage import label

    frame = placed.pose.frame()
    local = site.points @ frame[:, :3].T + frame[:, 3]
    over = (local[:, 2] > 0) & placed.vault.plan.holds(local[:, :2])
    local, upwards, within = local[over], np.abs(site.normals[over, 2]), _within(site)[over]
    surface = placed.vault.evaluate(local)
    behind = within & (upwards > STEEP) & (surface.distance > DEEP) & (np.abs(surface.normal[:, 2]) > OF_A_DRUM)
    if not behind.any():
        return []
    cell = max(CELL[0], CELL[1] * site.spacing)
    at: NDArray[np.int64] = np.floor((local[:, :2] - local[:, :2].min(axis=0)) / cell).astype(np.int64)
    shown = np.zeros(at.max(axis=0) + 1, np.bool_)
    shown[tuple(at[np.abs(surface.distance) < DEEP].T)] = True
    behind &= ~shown[tuple(at.T)]
    at, bent, local = at[behind], upwards[behind] < LEVEL_NORMAL, local[behind]
    held = np.zeros_like(shown)
    held[tuple(at.T)] = True
    number, count = label(held, np.ones((3, 3)))
    area = np.bincount(number[held], minlength=count + 1) * cell**2
    own = number[tuple(at.T)]
    share = np.bincount(own, bent, count + 1) / np.maximum(np.bincount(own, minlength=count + 1), 1)
    kept = np.flatnonzero((area >= SMALLEST) & (share > BENT))
    return [local[own == k] for k in kept[np.argsort(-area[kept], kind="stable")]]


def _within(site: Site) -> NDArray[np.bool_]:
    """Which points of a site are not near a side without a wall, beyond which another vault may go on."""
    xy = turned(site.points[:, :2], site.yaw)
    low = np.where(site.walled[:, 0], -np.inf, site.low + AT_AN_END)
    high = np.where(site.walled[:, 1], np.inf, site.high - AT_AN_END)
    return inside(xy, low, high)

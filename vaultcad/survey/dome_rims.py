"""Whether stone above other vaults is a dome on its drum: as long as wide, or round, and it ends at one height."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

RIM, LEVEL_RIM = 0.35, 0.7  # of its mean radius, by which the rim of a dome rises at most, and over that share of it
COMPACT = 0.5  # area of a dome in plan / that of a circle about all of it, at least
CREASE = 4  # cells, of creases and oculi that are no rim
SECTORS = 32  # of a circle
ROUND, ARC = 0.06, 0.62  # of its radius, by which a rim is off a circle; share of that which it goes round, at least


def is_dome(cells: Ints, heights: Array, cell: float) -> bool:
    """Whether stone over cells (n, 2) of a plan, of that edge [m], at heights (n,) [m], is about as domes are.

    The bays of a nave are not, which has windows below its barrel, and under these the vaults of its aisles; heads of
    windows are long. A dome that is seen in part is round along its rim.
    """
    from scipy.ndimage import binary_closing, binary_erosion, binary_fill_holes

    at = cells + 1 + CREASE - cells.min(axis=0)
    held = np.zeros(at.max(axis=0) + 2 + CREASE, np.bool_)
    held[tuple(at.T)] = True
    held = binary_fill_holes(binary_closing(held, iterations=CREASE))  # no patch lies over a crease between webs
    edge = ~binary_erosion(held)[tuple(at.T)]
    radius, rim = np.sqrt(held.sum() / np.pi), heights[edge]
    low = rim - np.quantile(rim, 0.02) < RIM * radius * cell
    compact = radius**2 > COMPACT * ((at - at.mean(axis=0)) ** 2).sum(axis=1).max()
    return bool(low.mean() > LEVEL_RIM and (compact or _is_round(at[edge][low])))


def _is_round(cells: Ints) -> bool:
    """Whether cells (n, 2) lie on one circle (Kåsa 1976), and go round more of it than those of an apse do."""
    if len(cells) < SECTORS:
        return False
    (*centre, rest), *_ = np.linalg.lstsq(
        np.column_stack([2.0 * cells, np.ones(len(cells))]), (cells**2).sum(axis=1), rcond=None
    )
    away = cells - centre
    radius, angle = np.sqrt(max(rest + np.dot(centre, centre), 0.0)), np.arctan2(away[:, 1], away[:, 0])
    off = np.hypot(*away.T) - radius
    sectors = np.unique(((angle / np.pi + 1) / 2 * SECTORS).astype(np.int64) % SECTORS)
    return bool(np.sqrt(np.mean(off**2)) < ROUND * radius and len(sectors) >= ARC * SECTORS)

"""Which side of a crease shows where a plane runs along it, as along a groin.

Stone that has moved sideways has taken the crease out of the plane, in which one of the two surfaces is left: under a
groin the one that lies deeper in the stone there, under a hip the other. The points beside the plane on that side alone
tell where it is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.group_medians import group_medians
from vaultcad.sections.smooth import smooth

Floats = NDArray[np.float64]

UNSURE = (
    0.3  # of how far both surfaces are apart in the plane, there and on the mean, by which the one that shows is unsure
)
CREASED = 0.02  # half of what normals on both sides differ by across the plane, from which on there is a crease
FEWEST = 5  # cells along a crease, with points on both of its sides


def showing(
    piece: NDArray[np.int64], cell: NDArray[np.int64], s: Floats, offset: Floats, across: Floats, tilt: Floats
) -> tuple[NDArray[np.bool_], Floats]:
    """Which points (n,) are on the side that shows in the plane, and how unsure it is there (n,) [m].

    All and nothing where there is no crease along it.

    Args:
        piece: (n,) of the line, over which what shows is smooth.
        cell: (n,) along the line.
        s: (n,) along its piece [m].
        offset: (n,) of the stone there from the ideal line [m], positive into the stone.
        across: (n,) from the plane [m].
        tilt: (n,) part of the surface's normal across the plane.
    """
    if not len(cell):
        return np.ones(0, np.bool_), np.zeros(0)
    keys, group = np.unique(cell, return_inverse=True)
    side = (across > 0).astype(np.int64)
    half = 2 * group + side
    beside = np.bincount(half, minlength=2 * len(keys)).reshape(-1, 2)
    tilts = np.bincount(half, tilt, 2 * len(keys)).reshape(-1, 2) / np.maximum(beside, 1)
    edge = np.where((beside > 0).all(axis=1), tilts[:, 1] - tilts[:, 0], 0.0) / 2
    medians = group_medians(half, offset, 2 * len(keys)).reshape(-1, 2)
    at = np.bincount(group, s) / np.bincount(group)
    of = np.zeros(len(keys), np.int64)
    of[group] = piece
    shows, unsure = np.full(len(keys), -1), np.zeros(len(keys))
    for k in np.unique(of[np.abs(edge) > CREASED]).tolist():
        mine = np.flatnonzero((np.abs(edge) > CREASED) & (of == k))
        reach = float(at[mine].min()), float(at[mine].max())
        if len(mine) < FEWEST:
            continue
        left, right = (smooth(at[mine], medians[mine, j], beside[mine, j] * 1.0, reach)(at[mine])[0] for j in (0, 1))
        shows[mine] = np.where(edge[mine] < 0, right > left, right < left)
        apart = right - left
        unsure[of == k] = np.sqrt(np.mean(apart**2) / 2)
        unsure[mine] = np.hypot(unsure[mine], np.abs(apart) / 2**0.5)
    return (shows[group] < 0) | (side == shows[group]), UNSURE * unsure[group]

"""The back of a vault, seen from the storey or attic above: it hangs over no room, but over the face of the vault."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.patches import Patches
from vaultcad.survey.plan_grid import PlanGrid

Array = NDArray[np.float64]

SHELL = 0.05, 0.7  # m, between a vault and its back in height, where haunches are steep and filled
SHARE = 0.5  # of a patch in plan that must lie so far over a ceiling to be its back
SMALLEST = 0.5  # m², of a back
CREASE = 3  # cells beside one that is known, where patches end at creases


def below_backs(faces: Array, backs: Patches, grid: PlanGrid) -> Array:
    """Heights (nx, ny) half way from a ceiling to its back over the cells of a grid [m]; infinite where none is seen.

    faces: (nx, ny) heights of the ceiling [m], NaN beside it. backs: what hangs over no room.
    """
    from scipy.ndimage import distance_transform_edt

    middle = np.full(grid.shape, np.inf)
    if backs.count == 0:
        return middle
    cell, patch, height = backs.over(grid)
    within = cell >= 0
    cell, patch, height = cell[within], patch[within], height[within]
    face = faces.ravel()[cell]
    over = (height - face > SHELL[0]) & (height - face < SHELL[1])
    count = backs.count
    share = np.bincount(patch, over, count) / np.maximum(np.bincount(patch, minlength=count), 1)
    over &= ((share > SHARE) & (backs.areas > SMALLEST))[patch]
    np.minimum.at(middle.reshape(-1), cell[over], (height[over] + face[over]) / 2)
    if not over.any():
        return middle
    away, nearest = distance_transform_edt(np.isinf(middle), return_indices=True)
    return np.where(away <= CREASE, middle[tuple(nearest)], np.inf)

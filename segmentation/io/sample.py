"""A few points of many, evenly spread, to judge them all by."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Floats
from segmentation.io.chunk import Mask

SAMPLE_SIZE = 20_000
"""Points that tell sizes, steps and spacings well enough, in milliseconds."""


def corners_of(points: Floats) -> NDArray[np.float64]:
    """Lowest and highest corner (2, 3) of points (n, 3): NaN where one is, infinite and turned round if there are none.

    Column by column, which is many times as fast as along the rows.
    """
    if len(points) == 0:
        return np.array([[np.inf] * 3, [-np.inf] * 3])
    return np.array([[points[:, k].min() for k in range(3)], [points[:, k].max() for k in range(3)]], np.float64)


def box_of(corners: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Corners (2, 3) around all corners."""
    ends = np.array(corners).reshape(-1, 2, 3)
    return np.stack([ends[:, 0].min(axis=0, initial=np.inf), ends[:, 1].max(axis=0, initial=-np.inf)])


def sample(parts: Sequence[Floats], taken: Sequence[Mask], most: int = SAMPLE_SIZE) -> NDArray[np.float64]:
    """Every so-manieth of the points (n, 3) that take part, at most about `most` (k, 3)."""
    every = max(1, sum(map(len, parts)) // most)
    few = [part[::every][used[::every]] for part, used in zip(parts, taken, strict=True)]
    found = np.concatenate([np.zeros((0, 3)), *few])
    if len(found) or not any(used.any() for used in taken):
        return found.astype(np.float64)
    return np.concatenate([part[used] for part, used in zip(parts, taken, strict=True)])[:most].astype(np.float64)

"""A few points of many, evenly spread, to judge them all by."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Floats
from segmentation.io.chunk import Mask

MOST = 20_000
"""Points that tell sizes, steps and spacings well enough, in milliseconds."""


def sample(parts: Sequence[Floats], taken: Sequence[Mask], most: int = MOST) -> NDArray[np.float64]:
    """Every so-manieth of the points (n, 3) that take part, at most about `most` (k, 3)."""
    every = max(1, sum(map(len, parts)) // most)
    few = [part[::every][used[::every]] for part, used in zip(parts, taken, strict=True)]
    found = np.concatenate([np.zeros((0, 3)), *few])
    if len(found) or not any(used.any() for used in taken):
        return found.astype(np.float64)
    return np.concatenate([part[used] for part, used in zip(parts, taken, strict=True)])[:most].astype(np.float64)

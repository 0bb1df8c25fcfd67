"""Medians of many groups at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def group_medians(group: NDArray[np.integer], values: Array, count: int) -> Array:
    """Medians (`count`,) of values (n,) by the number of their group (n,) from 0; NaN where a group is empty.

    >>> group_medians(np.array([2, 0, 2, 2, 0]), np.array([9.0, 1.0, 4.0, 5.0, 2.0]), 3).tolist()
    [1.5, nan, 5.0]
    """
    size = np.bincount(group, minlength=count)
    first, full = np.cumsum(size) - size, size > 0
    by_value = np.argsort(values)
    # Small numbers are sorted by their digits.
    by_group = np.argsort(group[by_value].astype(np.min_scalar_type(count)), kind="stable")
    ordered = values[by_value[by_group]]
    low, high = first[full] + (size[full] - 1) // 2, first[full] + size[full] // 2
    found = np.full(count, np.nan)
    found[full] = (ordered[low] + ordered[high]) / 2
    return found

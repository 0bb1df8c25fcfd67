"""Points that lie off the stone about them: what hangs before it, edges that mix near and far, furniture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vaultcad.fit.settlement import Partition
from vaultcad.group_medians import group_medians

Array = NDArray[np.float64]

STRAYING = 2.5  # robust scatters of a block off its median, beyond which a point is a stray
EXACT = 0.0005  # m, that scatter at the least: no scanner is so exact
ROUGHEST = 3.0  # times the usual scatter, that of a block at the most: where half is something else, less is believed
ROUNDS = 2
FEWEST = 4  # points of a block, below which it is a corner of something; of sparse scans half of the usual number


def without_strays(blocks: Partition, residuals: Array) -> Partition:
    """The blocks with no weight on points whose residuals (n,) [m] are not those of most in their block, or are few.

    A few centimetres of a lamp's cord move the mean of a block by millimetres, and several such blocks a wall.
    """
    blocks = with_most(blocks, residuals)
    left = np.bincount(blocks.block[blocks.weights > 0], minlength=len(blocks.weight))
    enough = left >= min(FEWEST, 0.5 * float(np.median(left[left > 0])))
    return replace(blocks, weights=np.where(enough[blocks.block], blocks.weights, 0.0))


def with_most(blocks: Partition, residuals: Array) -> Partition:
    """The blocks with no weight on points whose residuals (n,) [m] are not those of most in their block."""
    count, on = len(blocks.weight), blocks.weights > 0
    for _ in range(ROUNDS):
        block, mine = blocks.block[on], residuals[on]
        off = np.abs(residuals - group_medians(block, mine, count)[blocks.block])
        scatter = np.maximum(1.4826 * group_medians(block, off[on], count), EXACT)
        scatter = np.minimum(scatter, ROUGHEST * np.nanmedian(scatter))
        on = on & (off <= STRAYING * scatter[blocks.block])
    return replace(blocks, weights=np.where(on, blocks.weights, 0.0))

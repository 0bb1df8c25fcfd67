"""Pixels between points get what is around them, as far as points lie apart there; real holes stay open."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segmentation.threads import threads

BAND = 128  # rows that a thread takes at once
BLOCK = 16  # pixels of the blocks by which it is told how far apart points lie, with those around each
FEWEST = 9  # points in a block and those around it, below which nothing is filled
REACH = 2.2  # of the distance between points, as far as a pixel may be from one: few quarters are then without any
FARTHEST = 8  # pixels at the most
SIDES = 3  # of the four quarters around a pixel in which there have to be points: rims of holes do not grow


def fill(channels: NDArray[np.float32], counts: NDArray[np.uint32]) -> None:
    """Close the gaps of channels (k, n, m), NaN where there are no points, by the mean of the pixels around.

    These are weighed by their distances; what is far from points stays NaN.

    counts: of the points in each pixel (n, m).
    """
    n, m = counts.shape
    tall, wide = -(-n // BLOCK), -(-m // BLOCK)
    blocks = np.zeros((tall + 2, wide + 2), np.int64)
    rows = np.add.reduceat(counts, np.arange(0, n, BLOCK), axis=0, dtype=np.int64)
    blocks[1:-1, 1:-1] = np.add.reduceat(rows, np.arange(0, m, BLOCK), axis=1)
    around = sum(blocks[i : i + tall, j : j + wide] for i in range(3) for j in range(3))
    with threads() as pool:
        # Reads pixels with points and writes those without, so that no thread sees what another one does.
        list(pool.map(lambda row: _fill(channels, counts, np.asarray(around), row, row + BAND), range(0, n, BAND)))


@njit(cache=True, nogil=True)
def _fill(
    channels: NDArray[np.float32],
    counts: NDArray[np.uint32],
    around: NDArray[np.int64],
    first: int,
    last: int,
) -> None:
    k, n, m = channels.shape
    total = np.zeros(k)
    for i in range(first, min(last, n)):
        for j in range(m):
            near = around[i // BLOCK, j // BLOCK]
            if counts[i, j] > 0 or near < FEWEST:
                continue
            far = REACH * sqrt(9.0 * BLOCK * BLOCK / near)
            reach = min(max(int(far), 1), FARTHEST)
            quarters, weight = 0, 0.0
            total[:] = 0.0
            for y in range(max(i - reach, 0), min(i + reach + 1, n)):
                for x in range(max(j - reach, 0), min(j + reach + 1, m)):
                    off = (y - i) * (y - i) + (x - j) * (x - j)
                    if counts[y, x] == 0 or off > reach * reach:
                        continue
                    # Each axis belongs to the quarter that follows it, so that four neighbours are in four quarters.
                    if y > i:
                        quarters |= 1 if x >= j else 2
                    elif y < i:
                        quarters |= 4 if x <= j else 8
                    else:
                        quarters |= 8 if x > j else 2
                    share = 1.0 / off
                    weight += share
                    for c in range(k):
                        total[c] += share * channels[c, y, x]
            sides = (quarters & 1) + (quarters >> 1 & 1) + (quarters >> 2 & 1) + (quarters >> 3 & 1)
            if sides >= SIDES:
                for c in range(k):
                    channels[c, i, j] = total[c] / weight

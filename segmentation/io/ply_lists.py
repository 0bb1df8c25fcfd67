"""Records of a binary PLY that hold lists, and so differ in length."""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(nogil=True, cache=True)
def walk(
    content: NDArray[np.uint8],
    at: int,
    count: int,
    sizes: NDArray[np.int64],
    lengths: NDArray[np.int64],
    big: bool,
    offsets: NDArray[np.int64],
) -> int:
    """Byte after `count` records from byte `at` on; -1 if they run over the end of the content.

    sizes: (p,) bytes of a value of each property. lengths: (p,) bytes of the number of values before it, 0 for one
    value alone. big: whether the highest byte comes first. offsets: (count, p), filled with where each value or list
    begins, unless it is empty.
    """
    end = len(content)
    for i in range(count):
        for p in range(len(sizes)):
            values = np.int64(1)
            if lengths[p]:
                if at + lengths[p] > end:
                    return -1
                values = np.int64(0)
                for k in range(lengths[p]):
                    byte = np.int64(content[at + (k if big else lengths[p] - 1 - k)])
                    values = (values << 8) | byte
                at += lengths[p]
            if len(offsets):
                offsets[i, p] = at
            if values < 0 or values > (end - at) // sizes[p]:
                return -1
            at += values * sizes[p]
    return at

"""Decompression of LZF, the format of M. Lehmann's LibLZF that binary_compressed PCD files use."""

import numpy as np
from numba import njit
from numpy.typing import NDArray


@njit(nogil=True, cache=True)
def unpack(packed: NDArray[np.uint8], plain: NDArray[np.uint8]) -> int:
    """Fills `plain` from `packed`: how many bytes were written, or -1 if the data is damaged or does not fit.

    A control byte below 32 is followed by so many bytes and one more, as they are. Any other holds a length in its
    upper three bits (seven: the next byte is added) and, with one more byte, how far back to copy length + 2 from.
    """
    i, o = np.int64(0), np.int64(0)
    while i < len(packed):
        control = np.int64(packed[i])
        i += np.int64(1)
        if control < 32:
            length = control + np.int64(1)
            if i + length > len(packed) or o + length > len(plain):
                return -1
            for k in range(length):
                plain[o + k] = packed[i + k]
            i += length
        else:
            length = control >> 5
            if length == 7 and i < len(packed):
                length += np.int64(packed[i])
                i += 1
            if i >= len(packed):
                return -1
            back = ((control & 31) << 8) + np.int64(packed[i]) + 1
            i += 1
            length += 2
            if back > o or o + length > len(plain):
                return -1
            for k in range(length):  # byte by byte: what is copied may overlap with what it makes
                plain[o + k] = plain[o + k - back]
        o += length
    return int(o)

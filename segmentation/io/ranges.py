"""Colours and intensities of any range, as formats and scanners have them, to 16 bits."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

TOP = 65535
BYTE = 257
"""255 * 257 = 65535: eight bits over the full range of sixteen."""


def color16(color: NDArray[Any], like: NDArray[Any] | None = None) -> NDArray[np.uint16]:
    """Colours (n, 3) as uint16 over 0..65535; `like`: others, (m, 3), by which their range is told.

    Taken for 0..1 are real numbers up to 1, for 0..255 bytes and what stays within 255 (LAS files that hold eight
    bits in sixteen are common), for 0..65535 all else. What lies outside is clipped, NaN is black.
    """
    real = np.issubdtype(color.dtype, np.floating)
    top = np.nanmax(color if like is None else like, initial=0)
    scale = TOP if real and top <= 1 else BYTE if top <= 255 else 1
    full: NDArray[np.uint16]
    if real:
        full = np.round(np.clip(np.nan_to_num(color) * scale, 0, TOP)).astype(np.uint16)
    else:
        full = np.clip(color, 0, min(TOP, np.iinfo(color.dtype).max)).astype(np.uint16, copy=False)
        full = full * np.uint16(scale)
    return full


def intensity16(intensity: NDArray[Any], like: NDArray[Any] | None = None) -> NDArray[np.uint16]:
    """Intensities (n,) as uint16; `like`: others, (m,), by which their range is told.

    Whole numbers within 0..65535 stay as they are; real numbers within 0..1 are scaled by 65535; any other range (as
    -2048..2047 of PTS) is stretched over 0..65535. NaN becomes 0.
    """
    if intensity.dtype in (np.uint16, np.uint8):
        return intensity.astype(np.uint16, copy=False)
    finite = np.isfinite(intensity)
    values = np.where(finite, intensity, 0).astype(np.float64)
    told = intensity if like is None else like
    told = told[np.isfinite(told)]
    low, high = float(told.min(initial=0)), float(told.max(initial=0))
    if low >= 0 and high <= 1 and np.issubdtype(intensity.dtype, np.floating):
        values *= TOP
    elif low < 0 or high > TOP or not np.array_equal(told, np.round(told)):
        values = np.where(finite, (values - low) * (TOP / (high - low)), 0)
    return np.round(np.clip(values, 0, TOP)).astype(np.uint16)


def class8(classes: NDArray[Any]) -> NDArray[np.uint8]:
    """Classes (n,) as uint8; what is none, NaN or outside 0..255, becomes 0, which is "never classified"."""
    if classes.dtype == np.uint8:
        return classes
    fits = (classes >= 0) & (classes <= 255)  # never true of NaN
    return np.where(fits, classes, 0).astype(np.uint8)

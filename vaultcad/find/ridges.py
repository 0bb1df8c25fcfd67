"""Ridges at even distances all over a surface, as of corrugated sheet: such a roof is bent as a barrel, but no masonry.

The periodogram of the residuals at uneven places, along both axes of the plan (Lomb 1976).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

APART = 0.06, 0.35  # m; no sheet is folded wider, and coffers and bands of masonry are farther apart
DEEP = 0.016  # m; courses of brick and the boards of a centring leave less
SHARE = 0.4  # of the variance of the residuals, in one wave
OVERSAMPLED, TOGETHER = 3, 128  # frequencies for each that a length tells; and how many are looked at together


@dataclass(frozen=True)
class Ridges:
    """How far apart they are, and how deep from crest to trough [m]."""

    apart: float
    deep: float

    @classmethod
    def of(cls, places: Array, residual: Array) -> Ridges | None:
        """Of residuals (n,) at places (n, 2) of the plan [m]; None where most of what they vary by is no one wave."""
        left = residual - residual.mean()
        variance = float(np.mean(left**2))
        found = [wave for along in places.T if (wave := _strongest(along, left))]
        if not found:
            return None
        amplitude, apart = max(found)
        if 2 * amplitude < DEEP or amplitude**2 / 2 < SHARE * variance:
            return None
        return cls(apart, 2 * amplitude)


def _strongest(along: Array, residual: Array) -> tuple[float, float] | None:
    """Amplitude and length [m] of the strongest wave along an axis, of residuals (n,) at (n,) [m]."""
    size = float(np.ptp(along))
    if size < 2 * APART[1]:
        return None
    frequencies = np.arange(1 / APART[1], 1 / APART[0], 1 / (OVERSAMPLED * size))
    parts = np.array_split(frequencies, -(-len(frequencies) // TOGETHER))
    waves = [residual @ np.exp(2j * np.pi * np.outer(along, part)) for part in parts]
    amplitude = 2 * np.abs(np.concatenate(waves)) / len(along)
    k = int(np.argmax(amplitude))
    return float(amplitude[k]), float(1 / frequencies[k])

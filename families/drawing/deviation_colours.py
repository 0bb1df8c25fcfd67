"""One colour for each deviation, the same in every picture and program: positive is into the stone, and red.

Blue and red are told apart by the colour-blind too (RdBu of C. Brewer's palettes, turned round).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.declaration.palette import Colour

ROOM, STONE = "room", "stone"  # what the ends of a scale are called
CONVENTION = f"blue into the {ROOM}, red into the {STONE}"
# Deviation as a share of the limit -> colour; straight lines in sRGB between.
STOPS = (
    (-1.0, Colour(33, 102, 172)),
    (-0.5, Colour(146, 197, 222)),
    (0.0, Colour(247, 247, 247)),
    (0.5, Colour(244, 165, 130)),
    (1.0, Colour(178, 24, 43)),
)
UNKNOWN = Colour(191, 191, 191)  # where there is no deviation
LIMITS = (0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.5)  # [m] that a scale may end at
USUAL_LIMIT = 0.03  # [m], where the points are not known yet
WITHIN = 0.98  # share of the points that lie within the limit


def limit_of(deviation: NDArray[np.floating]) -> float:
    """The deviation [m] at which the scale of signed deviations (n,) [m] ends."""
    known = np.abs(deviation[np.isfinite(deviation)])
    most = float(np.quantile(known, WITHIN)) if len(known) else 0.0
    return next((limit for limit in LIMITS if limit >= most), LIMITS[-1])


def shades(deviation: NDArray[np.floating], limit: float) -> NDArray[np.uint8]:
    """Red, green, blue (..., 3) of deviations (...) [m]; those beyond the limit as at it, NaN as `UNKNOWN`."""
    at, colours = [share for share, _ in STOPS], [(c.red, c.green, c.blue) for _, c in STOPS]
    share = np.asarray(deviation, dtype=np.float64) / limit
    known = np.isfinite(share)
    channels = zip(np.array(colours, dtype=np.float64).T, (UNKNOWN.red, UNKNOWN.green, UNKNOWN.blue), strict=True)
    found = [np.where(known, np.interp(np.where(known, share, 0.0), at, channel), off) for channel, off in channels]
    rounded: NDArray[np.uint8] = np.rint(np.stack(found, axis=-1)).astype(np.uint8)
    return rounded


def shade(deviation: float, limit: float) -> Colour:
    """The colour of one deviation [m]."""
    return Colour(*shades(np.array(deviation), limit).tolist())


def signed_mm(deviation: float) -> str:
    """A deviation [m] as scales write it: −20 mm, 0, +20 mm."""
    return f"{1000 * deviation:+.0f} mm".replace("-", "−") if round(1000 * deviation) else "0"

"""Lines of one deviation or height on a sheet, of what its pixels show, smoothed over more than the scanner's noise."""

from __future__ import annotations

from math import ceil, floor, log10
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vaultcad.unrolled.raster import Raster

CELL = 0.05  # [m] over which lines are smoothed
FEWEST = 3  # cells that a sheet with lines has
SHORTEST = 0.2  # [m] of a line that is kept
SIMPLE = 0.005  # [m] by which a line may be off
SPREAD = 1.0  # cells of the smoothing's standard deviation
COVERED = 0.3  # weight of a cell with what is around it from which on it is known
MOST_LINES = 12  # levels between the least and the largest
STEPS = (1.0, 2.0, 2.5, 5.0)


class Contour(NamedTuple):
    """A line (n, 2) [m] on the sheet at a level [m]."""

    what: str
    level: float
    line: NDArray[np.float64]


def contours(found: Raster, what: str, raised: float = 0.0) -> list[Contour]:
    """The lines of a channel at round levels, `raised` added to its values [m]."""
    import shapely
    from contourpy import contour_generator

    values, corner, cell = _smoothed(found, what)
    known = np.isfinite(values)
    if known.sum() < FEWEST:
        return []
    low, high = np.quantile(values[known], (0.01, 0.99)) + raised
    step = round_step((high - low) / MOST_LINES)
    s = corner[0] + cell * (np.arange(values.shape[1]) + 0.5)
    t = corner[1] - cell * (np.arange(values.shape[0]) + 0.5)
    lines = contour_generator(s, t, np.ma.masked_invalid(values + raised))
    kept = []
    for k in range(ceil(low / step), floor(high / step) + 1):
        for line in lines.lines(k * step):
            simple = shapely.simplify(shapely.LineString(line), SIMPLE)
            if shapely.length(simple) >= SHORTEST:
                kept.append(Contour(what, k * step, shapely.get_coordinates(simple)))
    return kept


def round_step(least: float) -> float:
    """The next round number: 1, 2, 2.5 or 5 times a power of ten.

    >>> round_step(0.0013), round_step(0.3)
    (0.002, 0.5)
    """
    power = 10.0 ** floor(log10(max(least, 1e-4)))
    return round(next((k * power for k in STEPS if k * power >= least * (1 - 1e-9)), 10 * power), 12)


def _smoothed(found: Raster, what: str) -> tuple[NDArray[np.float64], tuple[float, float], float]:
    """A channel in cells (n, m), where they begin on the sheet, and their side [m]."""
    from scipy.ndimage import gaussian_filter

    step = max(1, round(CELL / found.pixel))
    values = found.channels[what]
    n, m = (-(-side // step) for side in values.shape)
    known = np.isfinite(values)
    rows, columns = np.arange(0, values.shape[0], step), np.arange(0, values.shape[1], step)

    def blocks(pixels: NDArray[Any]) -> NDArray[np.float64]:
        found: NDArray[np.float64] = np.add.reduceat(
            np.add.reduceat(pixels, rows, axis=0, dtype=np.float64), columns, axis=1
        )
        return found

    weight = gaussian_filter(blocks(known), SPREAD, mode="constant") / step**2
    total = gaussian_filter(blocks(np.where(known, values, 0)), SPREAD, mode="constant") / step**2
    out = np.full((n, m), np.nan)
    np.divide(total, weight, out=out, where=weight > COVERED)
    return out, (found.left, found.top), step * found.pixel

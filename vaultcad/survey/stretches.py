"""Where a ceiling of one section ends and goes on in another, though no valley parts them: a nave and its apse.

Over a nave and an apse of one radius the mean height falls from one to the other without a step. But along a barrel its
section does not change, and beyond its end it does, as the square of the distance: that tells where the end is.
"""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.bays import BESIDE, NARROWEST, CeilingGrid, Region, between

Array = NDArray[np.float64]

ALIKE = 0.06  # m, median off the section of a stretch, up to which a column is of it
SHORTEST = 0.3  # of a stretch / how wide it is: under a dome as much is nearly alike
WIDTH, STEP = 1.2, 0.3  # m, of the strips whose section is tried, and how far apart they are
SEEN = 0.5  # share of the widest section that a column must have to tell
BENT = 0.15  # of a section's height / its width, at least: a level ceiling has no section
GOES = 0.4  # m off the section, up to which the change tells where it began
FARTHEST = 1.0  # m before the end, where it may have begun


def along_and_beyond(ceiling: CeilingGrid, region: Region) -> list[Region]:
    """A region cut into its longest stretch of one section, and what of it lies before and beyond that.

    The region alone where there is no such stretch, or less than a vault's ceiling on both of its sides.
    """
    longest, along = (0.0, 0.0), 0
    for axis in range(2):
        start, end = _stretch(ceiling.within(region) if axis == 0 else ceiling.within(region).T, ceiling.cell)
        if end - start > longest[1] - longest[0]:
            longest, along = (start, end), axis
    if longest[1] - longest[0] < max(NARROWEST, SHORTEST * float(region.high[1 - along] - region.low[1 - along])):
        return [region]
    low, high = (float(region.low[along]) + place for place in longest)
    core, others = region, []
    for side, (start, end) in enumerate(((float(region.low[along]), low), (high, float(region.high[along])))):
        if end - start < NARROWEST:
            continue
        part = ceiling.roofed(_cut(region, along, start, end, 1 - side))
        if part is not None and np.isfinite(ceiling.within(part)).sum() * ceiling.cell**2 > BESIDE:
            others.append(part)
            ends = (end, float(core.high[along])) if side == 0 else (float(core.low[along]), start)
            core = _cut(core, along, *ends, side)
    return [core, *others]


def _cut(region: Region, axis: int, start: float, end: float, side: int) -> Region:
    """The part of a region between two places along an axis [m], of which that side is cut by guess."""
    return replace(between(region, axis, start, end), valleys=(*region.valleys, (axis, side)))


def _stretch(heights: Array, cell: float) -> tuple[float, float]:
    """From where to where [m] along its first axis a ceiling (n, m) [m] has one section the longest; 0, 0 if none."""
    width, step = max(int(WIDTH / cell), 1), max(int(STEP / cell), 1)
    seen = np.isfinite(heights)
    enough = SEEN * seen.sum(axis=1).max(initial=0)
    best, found = 0, (0.0, 0.0)
    for start in range(0, len(heights) - width + 1, step):
        section = _median(heights[start : start + width], axis=0)
        known = np.isfinite(section)
        if known.sum() < max(enough, 1) or np.ptp(section[known]) < BENT * known.sum() * cell:
            continue
        off = _median(np.abs(heights - section), axis=1)
        told = (np.isfinite(heights) & known).sum(axis=1) >= enough
        same = told & (off < ALIKE)
        first, last = _run(same, start + width // 2)
        if last - first > best:
            best = last - first
            ends = (_begun(off[:first][::-1], told[:first][::-1], cell), _begun(off[last:], told[last:], cell))
            found = (first * cell + ends[0], last * cell - ends[1])
    return found


def _run(same: NDArray[np.bool_], middle: int) -> tuple[int, int]:
    """Start and end of the run of true values about the middle; both 0 where it is false there."""
    if not same[middle]:
        return 0, 0
    before, after = np.flatnonzero(~same[:middle]), np.flatnonzero(~same[middle:])
    return (int(before[-1]) + 1 if len(before) else 0), (middle + int(after[0]) if len(after) else len(same))


def _begun(off: Array, told: NDArray[np.bool_], cell: float) -> float:
    """How far before its end [m] a section began to change, by how far columns beyond are off it, the nearest first."""
    rising = np.flatnonzero(~(told & (off < GOES)))
    off = off[: rising[0]] if len(rising) else off
    root = np.sqrt(off)
    if len(off) < 3 or root[-1] <= root[0]:
        return 0.0
    slope, start = np.polyfit((np.arange(len(off)) + 0.5) * cell, root, 1)
    return float(np.clip(start / max(slope, 1e-9), 0.0, FARTHEST))


def _median(values: Array, axis: int) -> Array:
    """Without what is missing; NaN where all is."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanmedian(values, axis=axis))

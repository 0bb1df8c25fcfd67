"""The stone's line in a section without a model: the ridge of the points round a place in the room, smoothed.

The room is seen from one place, as from an upright axis in its middle: the line is its distance over the angle. In a
grid of both the way that passes most points without leaps is found by dynamic programming (as in seam carving, Avidan
and Shamir 2007); clutter within the room and what is behind the intrados lie off it. A surface that climbs within the
slab is taken off as a slope across it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.sections.smooth import smooth

Floats = NDArray[np.float64]

BAND = 2.0  # cells to either side of the ridge, from which points are taken
LEAP = 1.5  # that a cell's step along the distance costs, in logarithms of counts
MOST_STEP = 3  # cells of distance from one angle to the next
NEAREST = 0.2  # m from the place, nearer than which there is no stone


def free_profile(points: Floats, off: Floats, room: Floats, grid: float) -> Floats:
    """The line (n, 2) [m] through points (n, 2) of a slab, from left over the crown to right.

    Args:
        points: (n, 2) [m].
        off: (n,) [m] of these across the slab.
        room: (2,) a place in the room from which all of the line is seen.
        grid: of its cells [m].

    Raises:
        ValueError: there are too few points.
    """
    away = points - room
    reach, angle = np.hypot(*away.T), np.arctan2(away[:, 1], -away[:, 0])  # from the left, clockwise
    angle = (angle + np.pi / 2) % (2 * np.pi) - np.pi / 2  # nothing is right below
    kept = reach > NEAREST
    reach, angle, off = reach[kept], angle[kept], off[kept]
    if len(reach) < 10:
        raise ValueError(f"{len(reach)} points show no line; give a section with more")
    step = grid / float(np.median(reach))
    row, column = ((angle - angle.min()) / step).astype(int), (reach / grid).astype(int)
    counts = np.zeros((row.max() + 1, column.max() + 1))
    np.add.at(counts, (row, column), 1.0)
    ridge = _ridge(np.log1p(counts))
    near = np.abs(reach / grid - 0.5 - ridge[row]) <= BAND
    row, reach, angle, off = row[near], reach[near], angle[near], off[near]
    reach = reach - _climb(angle, reach, off, float(step)) * off
    group = np.unique(row, return_inverse=True)[1]
    count = np.bincount(group)
    means = [np.bincount(group, values) / count for values in (angle, reach)]
    length = float(np.median(reach))
    curve = smooth(means[0] * length, means[1], count / (1 + count / 4), (means[0][0] * length, means[0][-1] * length))
    places = np.arange(means[0][0], means[0][-1], step)
    far = curve(places * length)[0]
    return np.column_stack([room[0] - far * np.cos(places), room[1] + far * np.sin(places)])


def _ridge(gain: Floats) -> Floats:
    """Of each row the column by which the way of most gain passes."""
    rows, columns = gain.shape
    best, came = gain[0].copy(), np.zeros((rows, columns), np.int64)
    moves = np.arange(-MOST_STEP, MOST_STEP + 1)
    for k in range(1, rows):
        padded = np.pad(best, MOST_STEP, constant_values=-np.inf)
        tried = np.stack([padded[MOST_STEP + m : MOST_STEP + m + columns] - LEAP * abs(m) for m in moves])
        chosen = tried.argmax(axis=0)
        came[k] = np.arange(columns) + moves[chosen]
        best = tried[chosen, np.arange(columns)] + gain[k]
    way = np.empty(rows, np.int64)
    way[-1] = int(best.argmax())
    for k in range(rows - 1, 0, -1):
        way[k - 1] = came[k, way[k]]
    return way.astype(np.float64)


def _climb(angle: Floats, reach: Floats, off: Floats, step: float) -> Floats:
    """How much farther (n,) the stone is for each metre across the slab, by the points of ten cells together."""
    group = ((angle - angle.min()) / (10 * step)).astype(int)
    count = np.maximum(np.bincount(group), 1)

    def mean(values: Floats) -> Floats:
        return np.asarray((np.bincount(group, values) / count)[group], np.float64)

    a, w, r = angle - mean(angle), off - mean(off), reach - mean(reach)
    aa, aw, ww, ar, wr = mean(a * a), mean(a * w), mean(w * w), mean(a * r), mean(w * r)
    det = aa * ww - aw**2
    sure = det > 1e-3 * aa * ww
    return np.where(sure, (aa * wr - aw * ar) / np.where(sure, det, 1.0), 0.0)

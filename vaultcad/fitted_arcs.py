"""A row of points as few straight lines and circular arcs, as a draughtsman would draw it and CAD likes it."""

from __future__ import annotations

from math import hypot

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

OFF = 0.0005  # m by which points may be off the line that is drawn for them
CORNER = 0.3  # rad by which the way turns at a point where one line ends and another begins
MOST_BULGE = 1.2  # a little more than half a circle, which CAD still draws well


def fitted_arcs(row: Floats, off: float = OFF) -> tuple[Floats, tuple[float, ...]]:
    """Corners (m, 2), bulges (m,) of arcs and straight lines that pass within `off` [m] of all points of a row (n, 2).

    Greedy: each goes as far as it can. Ends of the row are kept, and so is a corner of it, where a new piece begins.
    """
    row = np.ascontiguousarray(row, np.float64)
    corners, bulges, k = [row[0]], [], 0
    sharp = _sharp(row)
    while k < len(row) - 1:
        end = int(sharp[np.searchsorted(sharp, k, side="right")])
        k, bulge = _longest(row, k, end, off)
        corners.append(row[k])
        bulges.append(bulge)
    return np.array(corners), (*bulges, 0.0)


def _sharp(row: Floats) -> NDArray[np.intp]:
    """Where a row has a corner, and its last point."""
    step = np.diff(row, axis=0)
    turn = np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(step[:, 1], step[:, 0])))))
    return np.append(np.flatnonzero(turn > CORNER) + 1, len(row) - 1)


@njit(cache=True)
def _longest(row: Floats, start: int, end: int, off: float) -> tuple[int, float]:
    """How far one piece from a point of the row can go, at most to `end`, and its bulge: doubled, then halved."""
    found, bulge, step = start + 1, 0.0, 2
    while start + step <= end:
        fits, bent = _piece(row, start, start + step, off)
        if not fits:
            break
        found, bulge, step = start + step, bent, 2 * step
    low, high = found, min(start + step, end + 1)
    while high - low > 1:
        middle = (low + high) // 2
        fits, bent = _piece(row, start, middle, off)
        if fits:
            bulge, low = bent, middle
        else:
            high = middle
    return low, bulge


@njit(cache=True)
def _piece(row: Floats, first: int, last: int, off: float) -> tuple[bool, float]:
    """Whether a line or an arc between two points of a row (n, 2) is near all others between, and its bulge.

    The centre of the arc is on the middle of the chord's normal, where least squares puts it (Kasa 1976).
    """
    ax, ay = row[first, 0], row[first, 1]
    cx, cy = row[last, 0] - ax, row[last, 1] - ay
    length = hypot(cx, cy)
    if length == 0.0:
        return False, 0.0
    cx, cy = cx / length, cy / length
    farthest, forwards, before, side, squares, pull = 0.0, True, 0.0, 0.0, 0.0, 0.0
    for k in range(first + 1, last):
        x, y = row[k, 0] - ax, row[k, 1] - ay
        t, s = cx * x + cy * y, cx * y - cy * x
        farthest, forwards, before = max(farthest, abs(s)), forwards and t >= before, t
        side += s
        squares += s * s
        pull += s * ((t - length / 2) ** 2 + s * s - length * length / 4)
    if farthest <= off and forwards and before <= length:
        return True, 0.0
    if squares == 0.0:
        return False, 0.0
    centre = pull / (2 * squares)
    radius = hypot(length / 2, centre)
    bulge = -2 * (centre + np.sign(side) * radius) / length
    if abs(bulge) > MOST_BULGE:
        return False, 0.0
    u, v = -length / 2, -centre  # the point before, from the centre
    for k in range(first + 1, last + 1):
        x, y = row[k, 0] - ax, row[k, 1] - ay
        to_u, to_v = cx * x + cy * y - length / 2, cx * y - cy * x - centre
        if abs(hypot(to_u, to_v) - radius) > off or (u * to_v - v * to_u) * bulge < 0.0:
            return False, 0.0
        u, v = to_u, to_v
    return True, bulge

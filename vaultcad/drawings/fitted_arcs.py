"""A row of points as few straight lines and circular arcs, as a draughtsman would draw it and CAD likes it."""

from __future__ import annotations

from math import hypot

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

OFF = 0.0005  # m by which points may be off the line that is drawn for them
CORNER = 0.3  # rad by which the way turns at a point where one line ends and another begins
MOST_BULGE = 1.2  # a little more than half a circle, which CAD still draws well


def fitted_arcs(row: Floats, off: float = OFF) -> tuple[Floats, tuple[float, ...]]:
    """Corners (m, 2), bulges (m,) of arcs and straight lines that pass within `off` [m] of all points of a row (n, 2).

    Greedy: each goes as far as it can. Ends of the row are kept, and so is a corner of it, where a new piece begins.
    """
    corners, bulges, k = [row[0]], [], 0
    sharp = _sharp(row)
    while k < len(row) - 1:
        end = int(sharp[np.searchsorted(sharp, k, side="right")])
        k, bulge = _longest(row[: end + 1], k, off)
        corners.append(row[k])
        bulges.append(bulge)
    return np.array(corners), (*bulges, 0.0)


def _sharp(row: Floats) -> NDArray[np.intp]:
    """Where a row has a corner, and its last point."""
    step = np.diff(row, axis=0)
    turn = np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(step[:, 1], step[:, 0])))))
    return np.append(np.flatnonzero(turn > CORNER) + 1, len(row) - 1)


def _longest(row: Floats, start: int, off: float) -> tuple[int, float]:
    """How far one piece from a point of the row can go, and its bulge: doubled, then halved."""
    found, step = (start + 1, 0.0), 2
    while start + step < len(row) and (bulge := _piece(row[start : start + step + 1], off)) is not None:
        found, step = (start + step, bulge), 2 * step
    low, high = found[0], min(start + step, len(row))
    while high - low > 1:
        middle = (low + high) // 2
        bulge = _piece(row[start : middle + 1], off)
        if bulge is None:
            high = middle
        else:
            found, low = (middle, bulge), middle
    return found


def _piece(part: Floats, off: float) -> float | None:
    """The bulge of a line or an arc from the first to the last of points (n, 2) that is near all others, or None.

    The centre of the arc is on the middle of the chord's normal, where least squares puts it (Kasa 1976).
    """
    a, b = part[0], part[-1]
    chord = b - a
    length = float(np.hypot(*chord))
    if length == 0:
        return None
    t, s = np.array([chord, [-chord[1], chord[0]]]) @ (part[1:-1] - a).T / length
    if not len(t) or (np.abs(s).max() <= off and (np.diff(t, prepend=0.0, append=length) >= 0).all()):
        return 0.0
    side = float(np.sign(s.sum()))
    power = (t - length / 2) ** 2 + s**2 - length**2 / 4
    centre = float(2 * s @ power / (4 * s @ s))
    radius = hypot(length / 2, centre)
    turns = np.unwrap(np.arctan2(np.array([0.0, *s, 0.0]) - centre, np.array([0.0, *t, length]) - length / 2))
    bulge = -2 * (centre + side * radius) / length
    on = np.abs(np.hypot(t - length / 2, s - centre) - radius).max() <= off
    return bulge if on and (np.diff(turns) * bulge >= 0).all() and abs(bulge) <= MOST_BULGE else None

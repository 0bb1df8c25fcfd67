"""Regions of a plane within steps that have them on their left."""

from __future__ import annotations

from math import atan2, pi

import numpy as np
from numpy.typing import NDArray

from families.declaration.units import MM
from families.solid.boundary import Loop
from families.solid.face_net import ONE
from families.solid.surfaces import Flat

Array = NDArray[np.float64]
BENT = 0.02  # of an edge's length, at which its direction at an end is taken: tangent edges have parted there
OUTLINE = tuple(np.linspace(0, 1, 16, endpoint=False).tolist())


def regions(plane: Flat, steps: Loop) -> list[list[Loop]]:
    """For each region the loop that bounds it from outside, followed by those of the holes in it.

    Raises:
        ValueError: the steps do not close.
    """
    loops = _loops(plane, steps)
    outlines = [np.concatenate([plane.parameters(step.points(*OUTLINE)) for step in loop]) for loop in loops]
    areas = [area(outline) for outline in outlines]
    outer = [k for k, size in enumerate(areas) if size > 0]
    found = {k: [loops[k]] for k in outer}
    for hole in (k for k, size in enumerate(areas) if size < 0):
        around = [k for k in outer if _contains(outlines[k], outlines[hole][0])]
        if not around:
            raise ValueError("a plane end of this vault has a hole and no bounds; change a parameter a little")
        found[min(around, key=lambda k: areas[k])].append(loops[hole])
    return list(found.values())


def area(outline: Array) -> float:
    """Area of a polygon (n, 2), below 0 if it runs clockwise."""
    x, y = (outline - outline[0]).T
    return float(x[:-1] @ y[1:] - x[1:] @ y[:-1]) / 2  # the last step leads back to the origin


def _loops(plane: Flat, steps: Loop) -> list[Loop]:
    """Closed ways along steps; where several go on, the sharpest turn to the left, which leaves no other face there."""
    flat = [plane.parameters(step.points(0.0, BENT, 1 - BENT, 1.0)) for step in steps]
    starts = np.array([points[0] for points in flat])
    left = np.ones(len(steps), bool)
    found: list[Loop] = []
    for first in range(len(steps)):
        if not left[first]:
            continue
        way = [first]
        while True:
            last = way[-1]
            nexts = np.flatnonzero(left & (np.abs(starts - flat[last][3]).max(axis=1) < 2 * ONE))
            if not len(nexts):
                x, y, z = (steps[last].places[2] / MM).round(3).tolist()
                raise ValueError(f"edges do not close at ({x:g}, {y:g}, {z:g}) m; change a parameter a little")
            back = flat[last][2] - flat[last][3]
            turns = [_clockwise(back, flat[k][1] - flat[k][0]) for k in nexts]
            chosen = int(nexts[int(np.argmin(turns))])
            left[chosen] = False
            if chosen == first:
                break
            way.append(chosen)
        found.append([steps[k] for k in way])
    return found


def _clockwise(start: Array, end: Array) -> float:
    """Angle from one direction clockwise to another, in (0, 2 pi]."""
    turn = (atan2(end[1], end[0]) - atan2(start[1], start[0])) % (2 * pi)
    return 2 * pi - turn


def _contains(outline: Array, point: Array) -> bool:
    """Whether a point lies in a polygon: by the sides that a ray from it crosses (Shimrat 1962)."""
    (x0, y0), (x1, y1) = outline.T, np.roll(outline, -1, axis=0).T
    across = (y0 > point[1]) != (y1 > point[1])
    place = x0[across] + (point[1] - y0[across]) / (y1 - y0)[across] * (x1 - x0)[across]
    return bool((place > point[0]).sum() % 2)

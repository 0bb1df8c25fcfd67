"""Regions of a plane, or of a surface seen from one side, within steps that have them on their left."""

from __future__ import annotations

from collections.abc import Callable
from math import atan2, pi

import numpy as np
from numpy.typing import NDArray

from families.declaration.units import MM
from families.solid.boundary import Loop, Step
from families.solid.curves import Straight

Array = NDArray[np.float64]
Map = Callable[[Array], Array]
BENT = 0.02  # of an edge's length, at which its direction at an end is taken: tangent edges have parted there
OUTLINE = tuple(np.linspace(0, 1, 16, endpoint=False).tolist())


def regions(parameters: Map, steps: Loop, ends: list[tuple[int, int]]) -> list[list[Loop]]:
    """For each region the loop that bounds it from outside, followed by those of the holes in it.

    Args:
        parameters: places (n, 2) of points (n, 3) on a plane, or on a surface that one sees whole.
        steps: with a region on their left.
        ends: the vertices at which they start and end.

    Raises:
        ValueError: the steps do not close.
    """
    loops = _loops(parameters, steps, ends)
    if len(loops) == 1:
        return [loops]
    outlines = [parameters(np.concatenate([_outline(step) for step in loop])) for loop in loops]
    areas = [area(outline) for outline in outlines]
    outer = [k for k, size in enumerate(areas) if size > 0]
    found = {k: [loops[k]] for k in outer}
    for hole in (k for k, size in enumerate(areas) if size < 0):
        around = [k for k in outer if _contains(outlines[k], outlines[hole][0])]
        if not around:
            raise ValueError("a plane end of this vault has a hole and no bounds; change a parameter a little")
        found[min(around, key=lambda k: areas[k])].append(loops[hole])
    return list(found.values())


def _outline(step: Step) -> Array:
    """Points of a step but its last, which is the next one's first."""
    return np.array(step.places[:1]) if isinstance(step.path, Straight) else step.points(*OUTLINE)


def area(outline: Array) -> float:
    """Area of a polygon (n, 2), below 0 if it runs clockwise."""
    x, y = (outline - outline[0]).T
    return float(x[:-1] @ y[1:] - x[1:] @ y[:-1]) / 2  # the last step leads back to the origin


def _loops(parameters: Map, steps: Loop, ends: list[tuple[int, int]]) -> list[Loop]:
    """Closed ways along steps; where several go on, the sharpest turn to the left, which leaves no other face there."""
    left = [True] * len(steps)
    starts: dict[int, list[int]] = {}
    for k, (start, _) in enumerate(ends):
        starts.setdefault(start, []).append(k)
    flat: dict[int, Array] = {}

    def directions(k: int) -> Array:
        if k not in flat:
            flat[k] = parameters(steps[k].points(0.0, BENT, 1 - BENT, 1.0))
        return flat[k]

    found: list[Loop] = []
    for first in range(len(steps)):
        if not left[first]:
            continue
        way = [first]
        while True:
            last = way[-1]
            nexts = [k for k in starts.get(ends[last][1], ()) if left[k]]
            if not nexts:
                x, y, z = (round(value / MM, 3) for value in steps[last].places[2])
                raise ValueError(f"edges do not close at ({x:g}, {y:g}, {z:g}) m; change a parameter a little")
            chosen = nexts[0]
            if len(nexts) > 1:
                back = directions(last)[2] - directions(last)[3]
                turns = [_clockwise(back, directions(k)[1] - directions(k)[0]) for k in nexts]
                chosen = nexts[int(np.argmin(turns))]
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

"""Where in a plan scanners stand and lamps hang: about its middle, or along the middle of a ring."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from families.declaration.plan import Plan

Array = NDArray[np.float64]

FROM_WALLS = 0.5  # m that a place keeps from them where it can
ACROSS = 0.5  # of a ring's width that places across it may differ by


def middle_line(plan: Plan, shares: ArrayLike) -> Array:
    """Places (n, 2) [m] after shares of the way round a ring, midway between its walls; else the origin for each."""
    inner = [side for side in plan.sides if side.centre is not None and not side.inside]
    shares = np.asarray(shares, np.float64)
    if not inner:
        return np.zeros((len(shares), 2))
    centre, radius = np.array(inner[0].centre), inner[0].radius
    way = np.concatenate([side.points(64)[:-1] for side in inner] + [[inner[-1].end]]) - centre
    found: Array = centre + way[np.round(shares * (len(way) - 1)).astype(int)] * (1 + plan.width / 2 / radius)
    return found


def about(plan: Plan, offsets: Array) -> Array:
    """Places (n, 2) [m] off the middle by offsets (n, 2), shares of the half extents; around a ring one after another.

    Where a wall is near, nearer to the middle.
    """
    count = len(offsets)
    middle = middle_line(plan, (np.arange(count) + 0.5) / count)
    reach = plan.half if not middle.any() else np.full(2, ACROSS * plan.width)
    places: Array = middle + offsets * reach
    for _ in range(4):
        near = plan.distance(places) > -FROM_WALLS
        places[near] = (places[near] + middle[near]) / 2
    return places


def needed(plan: Plan) -> int:
    """How many places it takes to see all of a plan: one each quarter of a ring."""
    return max(1, sum(side.centre is not None and not side.inside for side in plan.sides))

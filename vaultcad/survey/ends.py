"""Where the stone ends in plan over footprints other than a rectangle, if no walls stand there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan, Side
from vaultcad.survey.footprints import Ground

Array = NDArray[np.float64]

RIM, STRIP, STRIP_POINTS = 0.3, 0.1, 12  # m, depth and width of the strips where it is looked for; points
OUTERMOST = 4  # points of a strip that tell its end
WALLED = 0.4  # m, mean height of upright stone along the outline that makes it walls


def ends_over(shape: str, ground: Ground, xyz: NDArray[np.floating], upright: Array, spacing: float) -> Array:
    """Ends (k, 2) [m] of the stone, one of each strip across the outline; none where there are walls.

    Args:
        shape: of the footprint.
        ground: where it lies.
        xyz: (n, 3) all points [m].
        upright: (m, 3) of a thinned scan whose normals are level [m].
        spacing: of these [m].
    """
    plan = ground.footprint.plan(shape)
    c, s = np.cos(ground.yaw), np.sin(ground.yaw)
    turn = np.array([[c, -s], [s, c]])

    def seen(points: NDArray[np.floating]) -> Array:
        return np.asarray((points[:, :2] - [ground.x, ground.y]) @ turn, np.float64)

    near = np.abs(plan.distance(seen(upright))) < RIM
    if near.sum() * spacing**2 > WALLED * sum(_length(side) for side in plan.sides):
        return np.empty((0, 2))
    xy = seen(xyz)
    xy = xy[np.abs(plan.distance(xy)) < RIM]
    own = np.argmax([Plan((side,)).distance(xy) for side in plan.sides], axis=0)
    found = [end for k, side in enumerate(plan.sides) for end in _along(side, xy[own == k])]
    ends: Array = np.array(found).reshape(-1, 2) @ turn.T + [ground.x, ground.y]
    return ends


def _length(side: Side) -> float:
    return float(np.linalg.norm(np.diff(side.points(32), axis=0), axis=1).sum())


def _along(side: Side, xy: Array) -> list[Array]:
    """The ends of the strips across a side, from the places (n, 2) near it.

    The end of evenly spread points lies beyond the outermost by their mean distance, which the outermost few tell.
    """
    beyond = Plan((side,)).distance(xy)
    if side.centre is None:
        out = np.tile(side.normal, (len(xy), 1))
        along = xy @ np.array([-side.normal[1], side.normal[0]])
    else:
        away = xy - side.centre
        out = away / np.linalg.norm(away, axis=1)[:, None] * (1 if side.inside else -1)
        along = np.arctan2(away[:, 1], away[:, 0]) * side.radius
    strip = np.floor(along / STRIP).astype(np.int64)
    order = np.lexsort((-beyond, strip))
    _, first, count = np.unique(strip[order], return_index=True, return_counts=True)
    found = []
    for k in first[count >= STRIP_POINTS]:
        outer = order[k : k + OUTERMOST]
        reach = beyond[outer]
        end = reach[0] + (reach[0] - reach[-1]) / (OUTERMOST - 1)
        found.append(np.asarray((xy[outer] + (end - reach)[:, None] * out[outer]).mean(axis=0)))
    return found

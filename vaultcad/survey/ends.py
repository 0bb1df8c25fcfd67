"""Where the stone ends in plan, if no walls stand there: beside a rectangle, or over another footprint."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import atan

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan
from families.declaration.plan_sides import Side
from vaultcad.survey.footprints import Ground
from vaultcad.survey.plan_kernel import beside, outermost

Array = NDArray[np.float64]

RIM, STRIP, STRIP_POINTS = 0.3, 0.1, 12  # m, depth and width of the strips where it is looked for; points
OUTERMOST = 4  # points of a strip that tell its end
WALLED = 0.4  # m, mean height of upright stone along the outline that makes it walls
ON_LINE, MOSTLY = 0.04, 0.6  # m off a slanted end that is still on it, and the share of a side's strips that must be
BEYOND = 0.1  # m outside a slanted end from which on stone is no part of it
APART = 1 / 3  # of the side: how far two strips must be apart to say how it slants
LEAST_WIDENING = 0.05  # of a splay, metres for each metre along it
LEAST_SLANT = 0.15  # m from one end of a side to the other; what is less, the strips beside a straight one show as well


@dataclass(frozen=True)
class OpenSide:
    """A side of a rectangle without a wall: where the stone ends there.

    axis, side: 0 or 1 each. middle: where along the axis its middle is [m]. slant: metres along the axis for each along
    the side. ends: (k, 2) [m].
    """

    axis: int
    side: int
    middle: float
    slant: float
    ends: Array


def open_sides(
    xy: NDArray[np.floating], thinned: Array, low: Array, high: Array, walled: NDArray[np.bool_]
) -> list[OpenSide]:
    """The sides without a wall, in the rectangle's axes.

    Args:
        xy: (n, 2) all points [m].
        thinned: (m, 2) some of them, evenly spread, which tell how sides slant [m].
        low: (2,) south western corner of the rectangle [m].
        high: (2,) north eastern.
        walled: (2, 2) whether a wall stands there, by axis and side.
    """
    found = []
    for axis, side in zip(*np.nonzero(~walled), strict=True):
        sign, edge = (-1.0, low[axis]) if side == 0 else (1.0, high[axis])
        middle, half = (low + high)[1 - axis] / 2, (high - low) / 2

        depth, along = sign * (edge - thinned[:, axis]), thinned[:, 1 - axis] - middle
        start, slant = _slant(depth, along, half[axis], half[1 - axis])
        rim = np.array([-BEYOND if slant else -RIM, RIM])
        (depth, along), ends = beside(xy, axis, sign, edge, middle, start, slant, rim).T, []
        for outer, reach in _strips(along, slant * along - depth):
            end, mean = np.empty(2), along[outer].mean()
            end[1 - axis], end[axis] = middle + mean, edge + sign * (reach - slant * mean)
            ends.append(end)
        at = edge - sign * start if slant else edge
        found.append(OpenSide(int(axis), int(side), float(at), -sign * slant, np.array(ends).reshape(-1, 2)))
    return found


def turn_of(sides: Sequence[OpenSide]) -> float:
    """By how much the rectangle is to be turned [rad] to lie evenly in a splay; 0 if there is none."""
    if not any(_widening(sides)):
        return 0.0
    return sum((1 if side.axis else -1) * atan(side.slant) for side in sides) / 4


def splay_of(sides: Sequence[OpenSide], spans: Array) -> tuple[float, float]:
    """By which share the stone is wider at the east than in the middle, and at the north; spans: (2,) there [m]."""
    in_x, in_y = _widening(sides)
    return in_y * float(spans[0] / spans[1]) / 2, in_x * float(spans[1] / spans[0]) / 2


def _widening(sides: Sequence[OpenSide]) -> tuple[float, float]:
    """By how much stone widens along x for each metre along y, and along y for each along x; walls are level."""
    wide = [sum((1 if side.side else -1) * side.slant for side in sides if side.axis == axis) for axis in (0, 1)]
    x, y = (value if abs(value) > LEAST_WIDENING else 0.0 for value in wide)
    return x, y


def _slant(depth: Array, along: Array, deepest: float, half: float) -> tuple[float, float]:
    """Depth in the middle, and its growth along a side, of the line on which most strips end; 0 and 0 if that is level.

    Args:
        depth: (n,) of points inside an edge [m].
        along: (n,) that, from its middle [m].
        deepest: where to look [m].
        half: of the side [m].
    """
    inside = np.flatnonzero((depth < deepest) & (depth > -RIM) & (np.abs(along) < half))
    ends = np.array([[along[inside][outer].mean(), -reach] for outer, reach in _strips(along[inside], -depth[inside])])
    if len(ends) < STRIP_POINTS:
        return 0.0, 0.0
    i, j = np.triu_indices(len(ends), 1)
    far = np.abs(ends[j, 0] - ends[i, 0]) > 2 * half * APART
    i, j = i[far], j[far]
    slant = (ends[j, 1] - ends[i, 1]) / (ends[j, 0] - ends[i, 0])
    start = ends[i, 1] - slant * ends[i, 0]
    on = np.abs(ends[None, :, 1] - start[:, None] - slant[:, None] * ends[None, :, 0]) < ON_LINE
    if not len(on) or on.sum(axis=1).max() < MOSTLY * len(ends):
        return 0.0, 0.0
    best = on[int(on.sum(axis=1).argmax())]
    slant, start = np.polyfit(ends[best, 0], ends[best, 1], 1)
    return (float(start), float(slant)) if 2 * half * abs(slant) > LEAST_SLANT else (0.0, 0.0)


def _strips(along: Array, reach: Array) -> Iterator[tuple[NDArray[np.intp], float]]:
    """The outermost points of each strip across a side, by their numbers, and how far the stone reaches there [m].

    The end of evenly spread points lies beyond the outermost by their mean distance, which the outermost few tell.
    """
    strip = np.floor(along / STRIP).astype(np.int64)
    count, farthest = outermost(strip - strip.min(initial=0), np.ascontiguousarray(reach), OUTERMOST)
    for outer in farthest[count >= STRIP_POINTS]:
        far = reach[outer]
        yield outer, float(far[0] + (far[0] - far[-1]) / (OUTERMOST - 1))


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
    """The ends of the strips across a side, from the places (n, 2) near it."""
    beyond = Plan((side,)).distance(xy)
    if side.centre is None:
        out = np.tile(side.normal, (len(xy), 1))
        along = xy @ np.array([-side.normal[1], side.normal[0]])
    else:
        away = xy - side.centre
        out = away / np.linalg.norm(away, axis=1)[:, None] * (1 if side.inside else -1)
        along = np.arctan2(away[:, 1], away[:, 0]) * side.radius
    return [
        np.asarray((xy[outer] + (end - beyond[outer])[:, None] * out[outer]).mean(axis=0))
        for outer, end in _strips(along, beyond)
    ]

"""The arches between a bay and the next: where they end, so that a bay keeps what is its own."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.bays import Region
from vaultcad.survey.plan_kernel import highest
from vaultcad.survey.thinned_scan import UPRIGHT, Thin, rectangle, turned

Array = NDArray[np.float64]

FRONT = 1.2  # m; how far from the valley between two bays the front of the arch between them may stand
DEPTH_STEP, STRIP = 0.03, 0.2  # m; bins of depth and along the edge where it is looked for
SOFFIT, LEVEL_SOFFIT = 0.12, 0.025  # m; depth of its soffit that must be so level
RISE, JUMP = 0.06, 0.05  # m; the ceiling must rise by so much so near behind it
FACE = 0.04  # m; how far from its front the points of an arch lie


def bay_of(thin: Thin, xyz: NDArray[np.floating], region: Region) -> tuple[Thin, NDArray[np.floating]]:
    """The points of a region, thinned, and all of them (n, 3) [m] where a side has no wall."""
    mine = region.holds(thin.points)
    own = thin.only(mine)
    return own, xyz if _walled(own, region).all() else xyz.compress(region.holds(xyz), axis=0)


def without_arches(thin: Thin, xyz: NDArray[np.floating], region: Region) -> tuple[Thin, Region]:
    """Thinned points and region of a bay, less the arches to the next bays and the piers under these.

    Args:
        thin: the points of the bay, thinned.
        xyz: all of them (n, 3) [m].
        region: of the bay.
    """
    xy, upright = turned(thin.points[:, :2], region.yaw), np.abs(thin.normals[:, 2]) < UPRIGHT
    low, high = region.low.copy(), region.high.copy()
    keep = np.ones(len(xy), np.bool_)
    open_sides = np.argwhere(~_walled(thin, region)).tolist()
    xyz = np.ascontiguousarray(xyz)
    for axis, side in open_sides:
        front = _front(xyz, region, axis, side)
        if front > 0.0:
            sign, edge = (1.0, low) if side == 0 else (-1.0, high)
            depth = sign * (xy[:, axis] - edge[axis])
            keep &= (depth >= front) & ~(upright & (depth > front + FACE) & (depth < FRONT))
            edge[axis] += sign * front
    return thin.only(keep), replace(region, low=low, high=high)


def _walled(thin: Thin, region: Region) -> NDArray[np.bool_]:
    """(2, 2) whether a wall stands at a region's sides."""
    xy, facing = turned(thin.points[:, :2], region.yaw), turned(thin.normals[:, :2], region.yaw)
    return rectangle(xy, facing, np.abs(thin.normals[:, 2]) < UPRIGHT, thin.spacing)[2]


def _front(xyz: NDArray[np.floating], region: Region, axis: int, side: int) -> float:
    """How far inside a region's edge [m] the arch to the next bay ends: where the ceiling rises; 0 if nowhere."""
    edge, sign = (region.low, region.high)[side][axis], (1.0, -1.0)[side]
    # About the middle of the edge, where the crown of an arch is level.
    middle, length = (region.low + region.high)[1 - axis] / 2, (region.high - region.low)[1 - axis]
    shape = int(length / 2 / STRIP) + 1, round(FRONT / DEPTH_STEP)
    turn, steps = (float(np.cos(region.yaw)), float(np.sin(region.yaw))), np.array([STRIP, DEPTH_STEP])
    height = highest(xyz, *turn, axis, sign, edge, middle, length / 4, steps, shape)
    # Where nothing of the ceiling was seen, the highest point is the floor's.
    height[height < height.max(axis=1, keepdims=True) - FRONT] = np.nan
    bins = shape[1]
    run, rise = round(SOFFIT / DEPTH_STEP), round(RISE / DEPTH_STEP)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of strips and bins without points
        level = np.nanmedian(height - np.nanmedian(height, axis=1)[:, None], axis=0)
    front = 0.0
    for k in range(run, bins - rise):
        soffit = level[k - run : k]
        if (
            np.ptp(soffit) < LEVEL_SOFFIT and level[k + rise] - soffit.mean() > JUMP
        ):  # never true of bins without points
            front = k * DEPTH_STEP
    return front

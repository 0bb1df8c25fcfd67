"""What may be a pier under the end of an arch or the corner of a vault: stone that stands free from the floor up."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.plan_grid import PlanGrid
from vaultcad.survey.thinned_scan import FLOOR_NORMAL, STEEP, Thin

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

NEAR = 0.6  # m in plan between two supports of one pier, and between a support and its pier
WINDOW = 3.0  # m about a support in which its pier is looked for; what goes on beyond is a wall
WIDEST = 2.5  # m, of a pier
LOWEST = 0.6  # m; a pier is higher than this
STOREY = 1.5  # m in height between supports of one pier at most
LEVEL, FLOOR = 0.05, 0.3  # m, height of a layer of points that are a floor, and their share of the fullest layer's
BODY, UPPER = (0.15, 0.85), 0.5  # shares of a pier's height between which it is neither base nor capital; no furniture
CELL = 0.1, 2.0  # m and spacings, edge of the plan's cells, at least
BIN, TALL = 0.2, 0.5  # m of height; share of such bins of the upper body in which stone stands over a cell
REACHED = 0.95, 0.65  # quantile of a pier's upright stone, and the share of its height where it is at least
FEWEST = 40  # points of a pier


@dataclass(frozen=True)
class Shaft:
    """Stone that stands free under supports.

    supports: (s,) their numbers. points, normals: (n, 3) of its upright stone between base and capital [m]. counts:
    (n,) points of the scan that each stands for. floor: (m,) heights of the floor about it [m].
    """

    supports: NDArray[np.int64]
    points: Array
    normals: Array
    counts: Array
    floor: Array


def shafts_under(supports: Array, thin: Thin) -> Iterator[Shaft]:
    """What stands free under supports (s, 3) [m]: the places in plan and the heights at which arches or vaults spring.

    Supports near each other stand on one pier, which ends at the lowest of them.
    """
    upright = thin.only(np.abs(thin.normals[:, 2]) < STEEP)
    level = thin.points[np.abs(thin.normals[:, 2]) > FLOOR_NORMAL]
    if not len(upright.points) or not len(level):
        return
    for group in _groups(supports):
        lowest = supports[group[supports[group, 2].argmin()]]
        floor = _floor(level[_about(level, lowest), 2], lowest[2])
        if floor is None:
            continue
        height = lowest[2] - floor.mean()
        low, upper, reached, high = floor.mean() + height * np.array([BODY[0], UPPER, REACHED[1], BODY[1]])
        (body,) = np.nonzero(_about(upright.points, lowest))
        body = body[(upright.points[body, 2] > low) & (upright.points[body, 2] < high)]
        body = body[_free(upright.points[body], lowest[:2], (upper, high), thin.spacing)]
        if len(body) >= FEWEST and np.quantile(upright.points[body, 2], REACHED[0]) > reached:
            yield Shaft(group, upright.points[body], upright.normals[body], upright.counts[body], floor)


def _about(points: Array, place: Array) -> Mask:
    """Which points (n, 3) are within the window about a place (3,) [m]."""
    found: Mask = (np.abs(points[:, 0] - place[0]) < WINDOW) & (np.abs(points[:, 1] - place[1]) < WINDOW)
    return found


def _groups(supports: Array) -> list[NDArray[np.int64]]:
    """Numbers of supports (s, 3) that are near each other, in plan and in storey."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    size = len(supports)
    if size == 0:
        return []
    a, b = cKDTree(supports * [1, 1, NEAR / STOREY]).query_pairs(NEAR, output_type="ndarray").T
    _, group = connected_components(coo_array((np.ones(len(a)), (a, b)), shape=(size, size)), directed=False)
    return [np.flatnonzero(group == k) for k in range(group.max() + 1)]


def _floor(heights: Array, springing: float) -> Array | None:
    """The heights (m,) [m] of the floor among those of level stone (n,); None if there is none below a springing.

    The highest that is full enough: floors of other storeys are below it.
    """
    below = heights[heights < springing - LOWEST]
    layers, counts = np.unique(np.floor(below / LEVEL), return_counts=True)
    if len(layers) == 0:
        return None
    layer = layers[counts >= FLOOR * counts.max()].max()
    middle = np.median(below[np.abs(below / LEVEL - layer - 0.5) < 1])
    found: Array = below[np.abs(below - middle) < LEVEL]
    return found


def _free(points: Array, place: Array, body: tuple[float, float], spacing: float) -> Mask:
    """Which upright points (n, 3) [m] belong to what stands free next to a place; none if that is a wall.

    Only where stone stands over much of the upper `body` [m], so that pews and screens tie no pier to a wall.
    """
    from scipy.ndimage import binary_closing, label

    none = np.zeros(len(points), np.bool_)
    grid = PlanGrid.over(place - WINDOW, place + WINDOW, max(CELL[0], CELL[1] * spacing))
    high, bins = points[points[:, 2] > body[0]], int(np.ceil((body[1] - body[0]) / BIN))
    stood = np.unique(grid.numbers(high) * bins + np.floor((high[:, 2] - body[0]) / BIN).astype(np.int64)) // bins
    tall = (np.bincount(stood, minlength=grid.shape[0] * grid.shape[1]) >= TALL * bins).reshape(grid.shape)
    if not tall.any():
        return none
    around = np.ones((3, 3), np.bool_)
    part, _ = label(binary_closing(np.pad(tall, 1), around)[1:-1, 1:-1], around)
    away = np.linalg.norm(grid.middles - place, axis=1).reshape(grid.shape)
    nearest = np.unravel_index(np.where(tall, away, np.inf).argmin(), grid.shape)
    mine = tall & (part == part[nearest])
    wide = max(int(np.ptp(axis)) for axis in np.nonzero(mine)) * grid.cell > WIDEST
    if wide or away[nearest] > NEAR or away[mine].max() > WINDOW - 2 * grid.cell:
        return none
    return grid.holds(mine, points)

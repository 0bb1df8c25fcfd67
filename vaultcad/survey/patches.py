"""A ceiling in patches: stone that goes on without a crease, a step or a gap.

Regions grow over neighbours whose normals agree and that lie in each other's planes (smoothness constraint: Rabbani,
van den Heuvel and Vosselman 2006). Groins, the edges of arches and springings end a patch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.plan_grid import PlanGrid
from vaultcad.survey.thinned_scan import STEEP, Thin

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

AROUND, DISAGREE = 9, 2  # a point and its neighbours; how many of these may face elsewhere
SMOOTH = np.cos(np.radians(15.0))  # between the normals of neighbours on one patch
REACH, STEP = 2.0, 0.5  # spacings; how far neighbours are, and how far off each other's planes they may lie
SPACING = 0.05  # m; finer points say no more of where stone goes on
SMALLEST = 0.05  # m², of a patch
CELL = 0.15  # m; of the columns in which patches hang over each other
CLEAR = 1.3  # m; a ceiling has a room below it
SLENDER = 0.3  # m, width in plan of what ends no room above it: tie rods, cables, beams
DOORSTEP = np.array([2.0, 2.0, 0.1])  # m in plan and in height, within which the floor of the next room goes on
PLANE, LEVEL = 0.98, 0.9  # mean of the normals of a floor: their length at least, and its upward part
BUMPY = 0.85, 0.6  # that length of an earth floor with heaps; share of it under a ceiling, where nothing is below it


@dataclass(frozen=True)
class Patches:
    """What hangs in a scan, by patches, the largest first.

    points: (n, 3) of the ceilings [m]. normals: (n, 3), unit. patch: (n,) number of the patch, from 0. spacing: [m].
    """

    points: Array
    normals: Array
    patch: Ints
    spacing: float

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.patch.max(initial=-1)) + 1

    @property
    def areas(self) -> Array:
        """(count,) [m²] of each, seen along its normals."""
        return np.asarray(np.bincount(self.patch, minlength=self.count) * self.spacing**2, np.float64)

    @property
    def widths(self) -> Array:
        """(count,) [m] of rectangles in plan that are spread as each is, across their longer sides."""
        size = np.bincount(self.patch, minlength=self.count)
        x, y = (axis - (np.bincount(self.patch, axis) / size)[self.patch] for axis in self.points.T[:2])
        xx, xy, yy = (np.bincount(self.patch, product) / size for product in (x * x, x * y, y * y))
        least = (xx + yy) / 2 - np.hypot((xx - yy) / 2, xy)
        return np.asarray(np.sqrt(12 * np.maximum(least, 0.0)), np.float64)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Its corners in plan, (2,) each [m]."""
        return self.points[:, :2].min(axis=0), self.points[:, :2].max(axis=0)

    def over(self, grid: PlanGrid) -> tuple[Ints, Ints, Array]:
        """Cells of a grid, patches over them, and the mean height of the one over the other [m]; each (k,)."""
        key, where, counts = np.unique(
            grid.numbers(self.points) * self.count + self.patch, return_inverse=True, return_counts=True
        )
        return key // self.count, key % self.count, np.bincount(where, self.points[:, 2]) / counts

    def only(self, kept: NDArray[np.bool_]) -> Patches:
        """The patches of a mask (count,), the largest first."""
        mine = kept[self.patch]
        return _by_size(self.points[mine], self.normals[mine], self.patch[mine], self.spacing)


def hung_and_other(thin: Thin) -> tuple[Patches, Patches]:
    """The patches of a scan that have a room below them, and those that have none: floors and backs of vaults."""
    patches = patches_of(thin)
    hung = _has_room_below(patches)
    return patches.only(hung), patches.only(~hung)


def patches_of(thin: Thin) -> Patches:
    """What is no wall in patches, floors and furniture too."""
    import small_gicp
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    points, normals, spacing = _spread(thin)
    tree = small_gicp.KdTree(points)
    hung = np.flatnonzero(np.abs(normals[:, 2]) > STEEP)
    if len(points) < AROUND or len(hung) == 0:
        return Patches(points[:0], normals[:0], np.empty(0, np.int64), spacing)
    nearest, _ = tree.batch_knn_search(points[hung], AROUND)
    alike = np.abs(np.einsum("nc,nkc->nk", normals[hung], normals[nearest[:, 1:].astype(np.int64)]))
    core = hung[(alike > SMOOTH).sum(axis=1) >= AROUND - 1 - DISAGREE]
    points, normals = points[core], normals[core]
    a, b = cKDTree(points).query_pairs(REACH * spacing, output_type="ndarray").T
    apart = points[b] - points[a]
    off = np.maximum(*(np.abs(np.einsum("nc,nc->n", apart, normals[k])) for k in (a, b)))
    near = (off < STEP * spacing) & (np.abs(np.einsum("nc,nc->n", normals[a], normals[b])) > SMOOTH)
    graph = coo_array((np.ones(near.sum(), np.bool_), (a[near], b[near])), shape=(len(points), len(points)))
    _, patch = connected_components(graph, directed=False)
    large = np.bincount(patch)[patch] * spacing**2 > SMALLEST
    return _by_size(points[large], normals[large], patch[large].astype(np.int64), spacing)


def _spread(thin: Thin) -> tuple[Array, Array, float]:
    """Points (n, 3) and normals (n, 3) of a scan, no closer than `SPACING`, and how close they are [m]."""
    from segmentation.voxel import thin as thinned

    if thin.spacing >= SPACING:
        return thin.points, thin.normals, thin.spacing
    kept = thinned(thin.points, SPACING).first
    return thin.points[kept], thin.normals[kept], SPACING


def _by_size(points: Array, normals: Array, patch: Ints, spacing: float) -> Patches:
    _, patch, sizes = np.unique(patch, return_inverse=True, return_counts=True)
    rank = np.empty(len(sizes), np.int64)
    rank[np.argsort(-sizes, kind="stable")] = np.arange(len(sizes))
    return Patches(points, normals, rank[patch], spacing)


def _has_room_below(patches: Patches) -> NDArray[np.bool_]:
    """Which patches hang over a room: what is below most of a patch is well below it, or it is no floor."""
    count = patches.count
    if count == 0:
        return np.zeros(0, np.bool_)
    cell, patch, height = _columns(patches)
    same = cell[1:] == cell[:-1]
    clear = np.where(same, np.diff(height), np.inf)
    columns = np.bincount(patch, minlength=count)
    low = np.bincount(patch[_is_close_above(cell, height, (patches.widths >= SLENDER)[patch])], minlength=count)
    lowest = np.bincount(patch[np.concatenate([[True], ~same])], minlength=count)
    under = np.bincount(patch[:-1][same & (clear >= CLEAR)], minlength=count)
    facing = patches.normals * np.sign(patches.normals[:, 2:])
    sums = np.column_stack([np.bincount(patches.patch, axis, count) for axis in facing.T])
    mean = sums / np.bincount(patches.patch, minlength=count)[:, None]
    plane = np.linalg.norm(mean, axis=1)
    level = (lowest > columns / 2) & (plane > PLANE) & (mean[:, 2] > LEVEL)
    floor = level & (under > columns / 4)
    floor |= (lowest > LEVEL * columns) & (plane > BUMPY[0]) & (under > BUMPY[1] * columns)
    floor |= level & _is_level_with(patches, floor)
    room: NDArray[np.bool_] = (low < columns / 2) & ~floor
    return room


def _is_level_with(patches: Patches, floor: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which patches lie as high as floors near by, as what is seen of a floor through a door does."""
    from scipy.spatial import cKDTree

    mine = floor[patches.patch]
    if not mine.any():
        return np.zeros(patches.count, np.bool_)
    size = np.bincount(patches.patch)
    middle = np.column_stack([np.bincount(patches.patch, axis) / size for axis in patches.points.T])
    reach, _ = cKDTree(patches.points[mine] / DOORSTEP).query(middle / DOORSTEP)
    found: NDArray[np.bool_] = np.asarray(reach) < 1
    return found


def _is_close_above(cell: Ints, height: Array, broad: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which of patches in columns (k,), from below, have a broad one close below them."""
    last = np.maximum.accumulate(np.where(broad, np.arange(len(cell)), -1))
    below = np.concatenate([[-1], last[:-1]])
    found: NDArray[np.bool_] = (below >= 0) & (cell[below] == cell) & (height - height[below] < CLEAR)
    return found


def _columns(patches: Patches) -> tuple[Ints, Ints, Array]:
    """By columns of the plan from below: the column, the patch, and its mean height there [m]; each (k,)."""
    column, patch, height = patches.over(PlanGrid.over(*patches.bounds, CELL))
    order = np.lexsort((height, column))
    return column[order], patch[order], height[order]

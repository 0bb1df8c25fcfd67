"""Where one bay may end and the next begin: gaps and valleys of the ceiling, seen from below."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vaultcad.errors import NoVaultError
from vaultcad.survey.plan_kernel import within
from vaultcad.survey.thinned_scan import STEEP, Thin, above_floor, direction, support, turned, yaw_of

Array = NDArray[np.float64]
CELL = 0.12, 2.5  # m and spacings; edge of the ceiling's cells, at least
SEEN = 0.25  # share of the widest column that a column must have, else there is a gap in the ceiling
STRAYS = 0.12  # support of a cell, as of `support`, below which nothing but strays may hang there
VALLEY = 0.05  # m; a bay's mean height falls by this on either side, at least
SLOPE, NEIGHBOURS = 3.5, 3  # steepest ceiling; neighbours that a cell must go on into
NARROWEST, NARROW_ARM = 1.0, 0.8  # m, of a bay; of what is left beside vaults and may be one
LEAST = 1.5  # m², of the ceiling over a bay
BESIDE = 2.0  # m², of the ceiling beside a vault that may be another
GAP = 10.0  # m; how deep a gap counts
WALL_CELLS = 2  # cells beyond what hangs over a room that belong to it
ROOMY = 200, 1 << 20  # cells of the grid that a point may have, and that any scan may have
FULL = 0.4  # share of a bay's rectangle that has a ceiling, at least


@dataclass(frozen=True)
class Region:
    """A rectangle of the plan turned by `yaw` [rad]: its corners `low` and `high` (2,) [m].

    valleys: (axis, side) of the sides that were cut in a valley of one ceiling, the place of which is a guess.
    """

    yaw: float
    low: Array
    high: Array
    valleys: tuple[tuple[int, int], ...] = ()

    def holds(self, points: NDArray[np.floating]) -> NDArray[np.bool_]:
        """Which points (n, 2 or 3) of the local frame [m] lie in it."""
        points = np.ascontiguousarray(points)
        found: NDArray[np.bool_] = within(points, *direction(self.yaw, points), self.low, self.high)
        return found


@dataclass(frozen=True)
class CeilingGrid:
    """Height of what hangs over each cell of the turned plan.

    height: (nx, ny) [m], NaN where nothing does. highest: (nx, ny, 3) the point there [m]. low: (2,) corner of the
    grid [m]. cell: edge of a cell [m]. yaw: of the grid's x axis [rad].
    """

    height: Array
    highest: Array
    low: Array
    cell: float
    yaw: float

    @classmethod
    def of(cls, thin: Thin) -> CeilingGrid:
        """The highest points of each cell, where they are no wall; of a scan's points above the floor.

        Raises:
            NoVaultError: nothing is above the floor.
        """
        above = above_floor(thin)
        points, normals = above.points, above.normals
        yaw = yaw_of(points, normals)
        cell = max(CELL[0], CELL[1] * thin.spacing)
        xy, z = turned(points[:, :2], yaw), points[:, 2]
        low = xy.min(axis=0)
        index = np.floor((xy - low) / cell).astype(np.int64)
        shape = index.max(axis=0) + 1
        check_grid(shape, len(points), cell)
        flat = index[:, 0] * shape[1] + index[:, 1]
        size = int(shape.prod())
        order = np.argsort(z, kind="stable")
        highest = np.full(size, -1)
        highest[flat[order]] = order  # of several the last is kept
        top = np.where(highest < 0, np.nan, z[highest])
        near = z > top[flat] - 1.5 * cell
        count = np.bincount(flat[near], minlength=size)
        level = np.bincount(flat[near], np.abs(normals[near, 2]), minlength=size) / np.maximum(count, 1)
        told = np.bincount(flat[near], support(above.counts[near]), minlength=size)
        top[(level < STEEP) | (told < STRAYS)] = np.nan
        height = _without_specks(top.reshape(shape), cell)
        return cls(height, points[highest].reshape(*shape, 3), low, cell, yaw)

    @property
    def room(self) -> Region:
        """All of it, less the margins that nothing hangs over."""
        return self.roofed(self.whole) or self.whole

    @property
    def whole(self) -> Region:
        """All of it."""
        return Region(self.yaw, self.low, self.low + np.array(self.height.shape) * self.cell)

    def within(self, region: Region) -> Array:
        """The heights (nx, ny) of the cells in a region, a view."""
        view: Array = self.height[self._cells(region)]
        return view

    def points(self, region: Region) -> Array:
        """The highest points (n, 3) [m] of the cells of a region that something hangs over."""
        cells = self._cells(region)
        found: Array = self.highest[cells][np.isfinite(self.height[cells])]
        return found

    def _cells(self, region: Region) -> tuple[slice, slice]:
        first = np.clip(np.round((region.low - self.low) / self.cell).astype(int), 0, self.height.shape)
        last = np.clip(np.round((region.high - self.low) / self.cell).astype(int), first, self.height.shape)
        return slice(first[0], last[0]), slice(first[1], last[1])

    def parts(self, region: Region) -> list[Region]:
        """A region cut up along one axis, at every gap and valley: of the two axes the one with the deepest.

        Parts with too little overhead for a vault are left out. The region alone where there is nothing to cut.
        """
        cuts = [self._cuts(region, axis) for axis in range(2)]
        axis = int(np.argmax([max((cut.depth for cut in found), default=0.0) for found in cuts]))
        if not cuts[axis]:
            return [region]
        deepest = max(cut.depth for cut in cuts[axis])
        # Where walls stand between rooms, the valleys of each room are looked at when that is its own region.
        chosen = [cut.place for cut in cuts[axis] if cut.depth >= GAP or deepest < GAP]
        ends = [region.low[axis], *chosen, region.high[axis]]
        pieces = [between(region, axis, a, b) for a, b in pairwise(ends)]
        if deepest < GAP:
            first, last = ((axis, 1),), ((axis, 0),)
            sides = [first, *[first + last] * (len(pieces) - 2), last]
            pieces = [replace(piece, valleys=region.valleys + new) for piece, new in zip(pieces, sides, strict=True)]
        return [trimmed for piece in pieces if (trimmed := self.roofed(piece)) is not None]

    def cut(self, region: Region, explained: NDArray[np.floating]) -> list[Region]:
        """A region cut where points (n, 3) [m] end: that about them, then what lies beyond, as an apse behind a choir.

        Parts beyond with less than `BESIDE` overhead are left out; the region alone where there is none.
        """
        if not len(explained):
            return [region]
        xy = turned(explained[:, :2], self.yaw)
        low, high = np.maximum(xy.min(axis=0), region.low), np.minimum(xy.max(axis=0), region.high)
        core, found = region, []
        for axis in range(2):
            for a, b, end in ((region.low[axis], low[axis], "low"), (high[axis], region.high[axis], "high")):
                part = self.roofed(between(core, axis, a, b)) if b - a > NARROWEST else None
                if part is not None and np.isfinite(self.within(part)).sum() * self.cell**2 > BESIDE:
                    found.append(part)
                    ends = (b, core.high[axis]) if end == "low" else (core.low[axis], a)
                    core = between(core, axis, *ends)
        return [core, *found]

    def beside(self, own: NDArray[np.bool_]) -> Iterator[tuple[Region, NDArray[np.bool_]]]:
        """Rectangles about what hangs beside vaults, as the arms of a crossing, and which of all points that is.

        own: (n,) of all points, which are the vaults'. What is narrow, small or a ring is their edges.
        """
        from scipy.ndimage import binary_opening, label

        (places,) = np.nonzero(np.isfinite(self.height).ravel())
        left = np.zeros(self.height.size, np.bool_)
        left[places[~own]] = True
        wide = max(3, int(NARROW_ARM / self.cell))
        number, count = label(binary_opening(left.reshape(self.height.shape), np.ones((wide, wide), np.bool_)))
        for k in range(1, count + 1):
            mine = number == k
            at = np.argwhere(mine)
            low, high = at.min(axis=0), at.max(axis=0) + 1
            region = Region(self.yaw, self.low + low * self.cell, self.low + high * self.cell)
            if len(at) * self.cell**2 >= BESIDE and len(at) >= FULL * (high - low).prod():
                yield region, mine.ravel()[places]

    def roofed(self, region: Region) -> Region | None:
        """A region less the margins that nothing hangs over; None where too little does for a vault."""
        seen = np.isfinite(self.within(region))
        if seen.sum() * self.cell**2 < LEAST:
            return None
        low, high = region.low.copy(), region.high.copy()
        for axis in range(2):
            share = seen.mean(axis=1 - axis)
            (columns,) = np.nonzero(share > SEEN * share.max())
            # Walls stand a little beyond what hangs over the room.
            for side, bare in ((0, columns[0]), (1, len(share) - 1 - columns[-1])):
                if bare > WALL_CELLS:
                    (low, high)[side][axis] += (1, -1)[side] * (bare - WALL_CELLS) * self.cell
        trimmed = replace(region, low=low, high=high)
        if (high - low).min() < NARROWEST or np.isfinite(self.within(trimmed)).mean() < FULL:
            return None
        return trimmed

    def _cuts(self, region: Region, axis: int) -> list[_Cut]:
        """Where along an axis a bay may end."""
        seen = np.isfinite(heights := self.within(region))
        share = seen.mean(axis=1 - axis)
        bare = share <= SEEN * share.max(initial=0.0)
        if bare.all():
            return []
        total = np.where(seen, heights, 0.0).sum(axis=1 - axis)
        mean = total / np.maximum(seen.sum(axis=1 - axis), 1)
        profile = np.where(bare, mean[~bare].min() - GAP, mean)
        (roofed,) = np.nonzero(~bare)
        first, last = region.low[axis] + roofed[[0, -1]] * self.cell + [0, self.cell]
        out: list[_Cut] = []
        for start, end, depth in _valleys(profile):
            new = _Cut(region.low[axis] + (start + end) / 2 * self.cell, depth)
            if min(new.place - first, last - new.place) < NARROWEST:
                continue
            if out and new.place - out[-1].place < NARROWEST:
                out[-1] = max(out[-1], new, key=lambda cut: cut.depth)
            else:
                out.append(new)
        return out


def check_grid(shape: NDArray[np.int64] | tuple[int, int], points: int, cell: float) -> None:
    """See that a grid of that shape is no larger than so many points deserve.

    Raises:
        NoVaultError: it is; rooms far from each other are in one scan.
    """
    if float(shape[0]) * float(shape[1]) > max(ROOMY[0] * points, ROOMY[1]):
        x, y = shape[0] * cell, shape[1] * cell
        raise NoVaultError(
            f"no vault found: {points:,} places are scattered over {x:,.0f} × {y:,.0f} m; crop the scan to one building"
        )


def _valleys(profile: Array) -> Iterator[tuple[int, int, float]]:
    """Runs start:end of equal heights that are lower than what is beside them, and how deep they are [m].

    The depth is the lesser of the heights that must be climbed on either side before it goes down lower, or to the
    end of the profile. Those less deep than `VALLEY` are left out.
    """
    (steps,) = np.nonzero(np.diff(profile))
    for start, end in pairwise([0, *(steps + 1), len(profile)]):
        height = profile[start]
        left, right = profile[:start][::-1], profile[end:]
        if (len(left) and left[0] < height) or (len(right) and right[0] < height):
            continue
        if len(left) and len(right):
            depth = min(_climb(left, height), _climb(right, height))
            if depth >= VALLEY:
                yield start, end, depth


def _climb(heights: Array, height: float) -> float:
    """How far it goes up above a height before it goes down below it."""
    (lower,) = np.nonzero(heights < height)
    return float(heights[: lower[0] if len(lower) else None].max() - height)


def _without_specks(height: Array, cell: float) -> Array:
    """Heights (nx, ny) without cells that do not go on into their neighbours, and without what is small.

    Cells whose heights are far apart do not belong together, as the head of a door and the vault beside it.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    number = np.arange(height.size).reshape(height.shape)
    pairs = []
    for i, j in ((0, 1), (1, 0), (1, 1), (1, -1)):
        here = np.s_[: len(height) - i, max(0, -j) : height.shape[1] - max(0, j)]
        there = np.s_[i:, max(0, j) : height.shape[1] - max(0, -j)]
        alike = np.abs(height[here] - height[there]) < SLOPE * cell
        pairs.append(np.stack([number[here][alike], number[there][alike]]))
    a, b = np.concatenate(pairs, axis=1)
    kept = np.bincount(np.concatenate([a, b]), minlength=height.size) >= NEIGHBOURS
    both = kept[a] & kept[b]
    graph = coo_array((np.ones(both.sum(), np.bool_), (a[both], b[both])), shape=(height.size, height.size))
    _, part = connected_components(graph, directed=False)
    size = np.bincount(part)[part] * cell**2
    return np.where((kept & (size >= LEAST)).reshape(height.shape), height, np.nan)


@dataclass(frozen=True)
class _Cut:
    """A place along an axis [m], and how deep the valley is there [m]."""

    place: float
    depth: float


def between(region: Region, axis: int, start: float, end: float) -> Region:
    """The part of a region between two places along an axis [m]."""
    low, high = region.low.copy(), region.high.copy()
    low[axis], high[axis] = start, end
    return replace(region, low=low, high=high)

"""Soffits of arches among the patches of a ceiling: strips between two vaults, and lower than both."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from math import nan, sqrt

import numpy as np
from numpy.typing import NDArray

from segmentation.threads import threads
from vaultcad.processes import spread
from vaultcad.survey.patches import Patches
from vaultcad.survey.plan_grid import PlanGrid
from vaultcad.survey.thinned_scan import CHUNK

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

# |cosine| between normals of a soffit and its generatrices: rms; that of strays; their share
ACROSS, OFF, STRAY = 0.12, 0.25, 0.15
WIDTH = 0.12, 1.6  # m, of a soffit
SLENDER = 0.75  # width / length at most
WITHIN = 0.015, 0.985  # quantiles between which a patch lies
GAP, TURN, WIDER = 0.5, 0.15, 1.3  # m between two parts of one soffit; sine between them; how much wider both are
MOST, LEVEL = (0.1, 0.9), 0.03  # most of a soffit, and the share of its length in whose height a lintel's lies
UNDER, OVER = 0.5, 1.0  # m under its ends and over its crown where the vaults beside a soffit are
BIN = 0.1  # m along the span, in which a soffit's height is taken
BESIDE = 0.6  # m beyond the edges of a soffit where the ceilings beside it are looked for
BEYOND = 2.0  # m, likewise of a soffit as those of arches in its row, where little of them need be seen
HIGHER, ALONG = 0.04, 0.3  # m that a ceiling is above the soffit beside it; share of its length along which it must be
ALIKE = 0.08, 0.06, 0.1  # m, and share of a size, by which arches of one row differ; m in the height of their crowns
SOFFIT = 0.03  # m; points so near a soffit's curve are its own
EDGE = 0.01, 0.08  # share of its points beyond its edge; m that this is beyond the edge before it at most
STRIP, ENOUGH, FEWEST = 0.25, 30, 3  # m along a soffit in which its edges are measured, points there, and how often
SEEN = 0.1, 0.9  # quantiles of those edges
SIGMA = 1.4826  # standard deviation of what is spread normally / median of the distances from its median
OF_QUANTILE = 1.71  # standard deviation of a tenth quantile of n / theirs / √n, likewise
NEAR = 0.2  # m, cells of the plan in which its points are looked up


@dataclass(frozen=True)
class Soffit:
    """Where the soffit of an arch lies.

    place: (2,) its middle in plan [m]. yaw: of the span [rad]. length, width: of its rectangle in plan [m].
    curve: (k, 2) places along the span [m] and heights [m], in order. width_std: standard deviation of the width [m],
    NaN where its edges were not measured.
    """

    place: Array
    yaw: float
    length: float
    width: float
    curve: Array
    width_std: float = nan

    def local(self, xy: NDArray[np.floating]) -> tuple[Array, Array]:
        """How far points (n, 2 or 3) are along the span and across it from the middle [m]."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        x, y = xy[:, 0] - self.place[0], xy[:, 1] - self.place[1]
        return c * x + s * y, c * y - s * x

    def holds(self, xy: NDArray[np.floating], across: float = 0.0, along: float = 0.0) -> Mask:
        """Which points (n, 2 or 3) lie over its rectangle, grown by so much across its span and along it [m]."""
        u, v = self.local(xy)
        found: Mask = (np.abs(u) < self.length / 2 + along) & (np.abs(v) < self.width / 2 + across)
        return found

    def strip(self, across: float, along: float) -> Array:
        """That rectangle (6,) as `vaultcad.survey.part_kernel.own` takes it."""
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        return np.array([*self.place, c, s, self.length / 2 + along, self.width / 2 + across])

    def reaches(self, low: Array, high: Array, margin: float) -> bool:
        """Whether its rectangle, grown by a margin [m], may lie over some of that between two corners (2,)."""
        away = np.maximum(np.maximum(low - self.place, self.place - high), 0.0)
        return bool(np.hypot(*away) < np.hypot(self.length / 2 + margin, self.width / 2 + margin))

    def parts(self, points: Array) -> Mask:
        """Which points (n, 3) [m] are as high as the vaults that it parts, and not of a storey above or below."""
        found: Mask = (points[:, 2] > self.curve[:, 1].min() - UNDER) & (points[:, 2] < self.curve[:, 1].max() + OVER)
        return found

    def is_like(self, other: Soffit) -> bool:
        """Whether it is as long, as wide and as high as another."""
        one, two = (np.array([soffit.length, soffit.width]) for soffit in (self, other))
        equal = np.abs(one - two) < ALIKE[0] + ALIKE[1] * two
        crowns = [soffit.curve[:, 1].max() for soffit in (self, other)]
        return bool(equal.all() and abs(np.subtract(*crowns)) < ALIKE[2])

    @property
    def is_level(self) -> bool:
        """Whether it is a lintel's, as over doors, and no arch's."""
        low, high = np.quantile(self.curve[:, 1], MOST)
        return bool(high - low < LEVEL * self.length)

    def height(self, along: Array) -> Array:
        """Of the soffit (n,) [m], that far along the span; of its ends beyond them."""
        return np.interp(along, self.curve[:, 0], self.curve[:, 1])

    def whole_curve(self) -> Array:
        """Its curve (k + 2, 2) [m] on to where the stone ends: patches end before, and a bin's place is its middle."""
        first, last = (end + (end - b) * BIN / abs(end[0] - b[0]) for end, b in (self.curve[:2], self.curve[:-3:-1]))
        return np.array([first, *self.curve, last])


Strips = dict[tuple[int, ...], Soffit]  # by the numbers of their patches


def soffits_of(patches: Patches, xyz: NDArray[np.floating]) -> tuple[tuple[Soffit, ...], Mask]:
    """The soffits between vaults, and which patches they are (count,); `xyz` (n, 3) [m] tell their edges."""
    strips = _joined(patches, {(k,): strip for k in range(patches.count) if (strip := _strip(patches, (k,)))})
    rest = ~np.isin(patches.patch, [k for parts in strips for k in parts])
    ceiling = patches.points[rest]
    found = {parts: strip for parts, strip in strips.items() if _beside(strip, ceiling).min() >= ALONG}
    # Of a walk the scanner may see too little through the last arches of an arcade.
    others = {parts: strip for parts, strip in strips.items() if parts not in found and not strip.is_level}
    row = {parts: strip for parts, strip in others.items() if any(strip.is_like(one) for one in found.values())}
    found |= {parts: strip for parts, strip in row.items() if _is_seen_through(strip, ceiling)}
    found = {parts: strip for parts, strip in found.items() if not any(_is_under(strip, o) for o in found.values())}
    chosen = np.zeros(patches.count, np.bool_)
    chosen[[k for parts in found for k in parts]] = True
    return tuple(_edged(list(found.values()), xyz)), chosen


def _joined(patches: Patches, strips: Strips) -> Strips:
    """Strips that go on in line are one: a sharp crown parts the soffit of a pointed arch, a tie rod's shadow any."""
    for (one, a), (two, b) in combinations(strips.items(), 2):
        whole = _strip(patches, (*one, *two)) if _goes_on(a, b) and _goes_on(b, a) else None
        if whole is not None and whole.width < WIDER * max(a.width, b.width):
            rest = {parts: strip for parts, strip in strips.items() if parts not in (one, two)}
            return _joined(patches, {**rest, (*one, *two): whole})
    return strips


def _goes_on(one: Soffit, other: Soffit) -> bool:
    """Whether a strip lies in line with another and ends where that begins, in plan and in height."""
    along, across = other.local(one.place[None])
    gap = abs(along[0]) - (one.length + other.length) / 2
    if abs(across[0]) > one.width / 3 or abs(gap) > GAP or abs(np.sin(one.yaw - other.yaw)) > TURN:
        return False
    ends = one.curve[[0, -1], 1], other.curve[[0, -1], 1]
    return bool(np.abs(np.subtract.outer(*ends)).min() < GAP)


def _strip(patches: Patches, parts: tuple[int, ...]) -> Soffit | None:
    """Patches as one strip, if normals are at right angles to one level direction, along which it is narrow."""
    mine = np.isin(patches.patch, parts)
    points, normals = patches.points[mine], patches.normals[mine]
    level = normals[:, :2]
    _, vectors = np.linalg.eigh(level.T @ level)
    own = np.abs(level @ vectors[:, 0]) < OFF
    if own.mean() < 1 - STRAY:
        return None
    points, level = points[own], level[own]
    values, vectors = np.linalg.eigh(level.T @ level / len(level))
    if values[0] > ACROSS**2:
        return None
    if values[1] < ACROSS**2:  # a level one: its own outline tells
        _, vectors = np.linalg.eigh(np.cov(points[:, :2].T))
    across = vectors[:, 0]
    yaw = float(np.arctan2(-across[0], across[1]))
    c, s = np.cos(yaw), np.sin(yaw)
    frame = points[:, :2] @ np.array([[c, -s], [s, c]])
    low, high = np.quantile(frame, WITHIN, axis=0)
    length, width = (high - low + patches.spacing).tolist()
    if not WIDTH[0] < width < min(WIDTH[1], SLENDER * length):
        return None
    middle = (low + high) / 2
    place = np.array([c * middle[0] - s * middle[1], s * middle[0] + c * middle[1]])
    bins = np.floor((frame[:, 0] - middle[0]) / BIN).astype(np.int64)
    order = np.argsort(bins, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(bins[order])) + 1)
    curve = np.array([[frame[g, 0].mean() - middle[0], np.median(points[g, 2])] for g in groups])
    return Soffit(place, yaw, length, width, curve)


def _beside(soffit: Soffit, ceiling: Array, reach: float = BESIDE) -> Array:
    """(2,) along how much of a soffit, as a share, ceilings (n, 3) [m] go on beside it, higher than it, on each side.

    What falls away from it, as over stairs, is taken where it meets the soffit.
    """
    along, across = soffit.local(ceiling)
    near = (np.abs(along) < soffit.length / 2) & (np.abs(across) < soffit.width / 2 + reach)
    near &= ceiling[:, 2] > soffit.curve[:, 1].min() - UNDER
    along, across, height = along[near], across[near], ceiling[near, 2]
    higher = height - soffit.height(along)
    bins = np.floor(along / BIN).astype(np.int64)
    shares = []
    for side in (-1, 1):
        on = side * across > 0
        met = _met(side * across[on] - soffit.width / 2, higher[on])
        tops = {k: np.median(met[bins[on] == k]) for k in np.unique(bins[on])}
        shares.append(sum(top > HIGHER for top in tops.values()) * BIN)
    return np.array(shares) / soffit.length


def _is_seen_through(soffit: Soffit, ceiling: Array) -> bool:
    """Whether a ceiling (n, 3) [m] goes on along much of one side of a soffit, and some hangs beyond the other."""
    return bool(_beside(soffit, ceiling).max() >= ALONG and _beside(soffit, ceiling, BEYOND).min() > 0)


def _is_under(strip: Soffit, other: Soffit) -> bool:
    """Whether a strip hangs under another, as a tie rod does under an arch; not that of a storey below."""
    middle = np.array([[*strip.place, float(strip.height(np.zeros(1))[0])]])
    along, _ = other.local(middle)
    over = other.holds(middle) & other.parts(middle) & (other.height(along) > middle[:, 2] + SOFFIT)
    return bool(over.all())


def _met(beyond: Array, height: Array) -> Array:
    """Heights (n,) [m] of what falls away from an edge, so far beyond it (n,) [m], as if it were there."""
    if len(beyond) < ENOUGH or np.ptp(beyond) < BIN:
        return height
    return height - min(float(np.polyfit(beyond, height, 1)[0]), 0.0) * beyond


def _edged(soffits: list[Soffit], xyz: NDArray[np.floating]) -> Iterator[Soffit]:
    """Soffits up to their edges, which the points of the scan tell: patches end before."""
    if not soffits:
        return iter(())
    near = _Near.to(soffits, xyz)

    def edged(n: int) -> Soffit:
        own = near.over(soffits[n])
        return measured(measured(soffits[n], own), own)  # turned, then measured

    return spread(edged, len(soffits))


@dataclass(frozen=True)
class _Near:
    """Points (m, 3) near any of the soffits in plan, in the order of the cells that they lie over.

    starts: (cells + 1,) where those of each cell begin.
    """

    grid: PlanGrid
    points: NDArray[np.floating]
    starts: Ints

    @classmethod
    def to(cls, soffits: list[Soffit], xyz: NDArray[np.floating]) -> _Near:
        """Of all points of a scan (n, 3) [m]."""
        low = np.min([soffit.place - soffit.length for soffit in soffits], axis=0)
        high = np.max([soffit.place + soffit.length for soffit in soffits], axis=0)
        grid = PlanGrid.over(low, high, NEAR)
        held = np.append(np.any([_touches(soffit, grid) for soffit in soffits], axis=0), False)

        def some(k: int) -> tuple[NDArray[np.int32], NDArray[np.floating]]:
            number = grid.numbers(xyz[k : k + CHUNK])
            (mine,) = np.nonzero(held[number])
            return number[mine].astype(np.int32), xyz[k + mine]

        with threads() as pool:
            numbers, points = zip(*pool.map(some, range(0, len(xyz), CHUNK)), strict=True)
        number = np.concatenate(numbers)
        order = np.argsort(number, kind="stable")
        starts = np.searchsorted(number[order], np.arange(len(held)))
        return cls(grid, np.concatenate(points)[order], starts)

    def over(self, soffit: Soffit) -> NDArray[np.floating]:
        """Those (k, 3) near one of them."""
        cells = np.flatnonzero(_touches(soffit, self.grid))
        return np.concatenate([self.points[self.starts[c] : self.starts[c + 1]] for c in cells])


def _touches(soffit: Soffit, grid: PlanGrid) -> Mask:
    """Over which cells of a plan points near it may lie."""
    return soffit.holds(grid.middles, EDGE[1] + NEAR, NEAR)


def measured(soffit: Soffit, points: NDArray[np.floating]) -> Soffit:
    """A soffit up to the edges of its own of these points (n, 3) [m], in their direction."""
    near = points[soffit.holds(points, EDGE[1])].astype(np.float64)
    along, across = soffit.local(near)
    on = np.abs(near[:, 2] - soffit.height(along)) < SOFFIT
    along, across = along[on], across[on]
    strip = np.floor(along / STRIP).astype(np.int64)
    strips = [across[strip == k] for k in np.unique(strip)]
    edges = np.array([np.quantile(part, [EDGE[0], 1 - EDGE[0]]) for part in strips if len(part) > ENOUGH])
    if len(edges) < FEWEST:
        return soffit
    middles = np.array([k for k in np.unique(strip) if (strip == k).sum() > ENOUGH]) * STRIP + STRIP / 2
    turn, shift = np.polyfit(middles, edges.mean(axis=1), 1)
    # Where the scanner did not see to the edge, it is farther out.
    beside = edges - (shift + turn * middles)[:, None]
    low, high = np.quantile(beside, SEEN, axis=0).diagonal()
    shift += (low + high) / 2
    spread = SIGMA * np.median(np.abs(beside - np.median(beside, axis=0)), axis=0)
    # Each edge ends between two points, as far from it as they are apart at most.
    apart = sqrt(STRIP * (high - low) * len(edges) / len(across))
    c, s = np.cos(soffit.yaw), np.sin(soffit.yaw)
    return replace(
        soffit,
        place=soffit.place + shift * np.array([-s, c]),
        yaw=soffit.yaw + float(np.arctan(turn)),
        width=float(high - low),
        width_std=float(np.hypot(OF_QUANTILE * np.hypot(*spread) / sqrt(len(edges)), apart / sqrt(6))),
    )

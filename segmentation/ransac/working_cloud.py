"""The working cloud of RANSAC: one cell of a grid, one point; some tens of thousands stand for the whole scan."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from segmentation.notes import Note
from segmentation.ransac.settings import Settings
from segmentation.voxel import thin

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

TARGET = 24_000  # cells aimed at: small parts keep hundreds of points, and a pass over all takes a millisecond
MOST_CELLS = 1 << 20  # along an axis, whatever stray points there are; the grid can number twice as many
PROBE = 40_000  # points that the first look at the cloud takes
NORMAL_NEIGHBOURS = 12
NEIGHBOURS = 3  # cells of a surface touch so many others at least, or one that does; strays and lines do not
SPARSE = 0.1  # cells with less than this share of the usual number of points say nothing about the size of the cloud
MISFIT = 1 / 400  # masonry departs from its ideal by this share of its size; epsilon allows that
RUN, EVERY = 256, 5  # noise is measured on runs of so many cells, every fifth
NOISE_BAND = 6.0  # standard deviations of noise that epsilon holds at least
PRICE = 0.5  # of a primitive, in minimum supports: half of its points may lie near epsilon
LEAST_CELLS = 20.0
NEIGHBOUR_STEPS = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1], [-1, 0, 1], indexing="ij"), axis=-1).reshape(-1, 3)


@dataclass(frozen=True, eq=False)
class WorkingCloud:
    """Cells of surfaces, in Morton order, so that a cell of an octree is a run of them.

    mean: (m, 3) means [m], sagitta and noise averaged. raw: (m, 3) one true point of each. normal: (m, 3) unit, NaN
    where unknown. count: (m,) points. cell: (m, 3) grid coordinates. code: (m,) Morton codes, ascending. size: edge of
    a cell [m]. tail, head: (e,) edges of the graph of touching cells, both directions, ascending by tail.
    extent: diagonal [m] of the cloud, outliers aside. note: what was wrong with the normals that were given.
    """

    mean: Floats
    raw: Floats
    normal: Floats
    count: Ints
    cell: Ints
    code: Ints
    size: float
    tail: Ints
    head: Ints
    extent: float
    epsilon: float
    min_points: int
    note: Note | None = None

    def __len__(self) -> int:
        return len(self.mean)

    @property
    def price(self) -> float:
        """Cells that a primitive has to explain, which nothing else does, to be worth having."""
        return max(PRICE * self.min_points * len(self) / int(self.count.sum()), LEAST_CELLS)


def working_cloud(
    xyz: NDArray[np.floating], normals: NDArray[np.floating] | None, settings: Settings
) -> WorkingCloud | None:
    """Thin the cloud (n, 3) [m] to about `TARGET` cells and join what touches; None if none is a surface's."""
    probe = np.asarray(xyz[:: max(1, len(xyz) // PROBE)], dtype=np.float64)
    probe = probe[np.isfinite(probe).all(axis=1)]
    if len(probe) < 4:
        return None
    size, extent = _cell_size(probe, len(xyz), settings)
    size = max(size, _longest(xyz) / MOST_CELLS)
    thinned = thin(xyz, size)
    if len(thinned) < 4:
        return None
    raw = np.asarray(xyz[thinned.first], dtype=np.float64)
    cell = np.floor(raw * (1 / size)).astype(np.int64)  # as thin() rounds
    cell -= cell.min(axis=0)
    code = _morton(cell)
    order = np.argsort(code, kind="stable")
    tail, head = touching(cell[order])
    firm = np.bincount(tail, minlength=len(order)) >= NEIGHBOURS
    if firm.sum() < 4:
        return None
    firm[tail[firm[head]]] = True
    order, number = order[firm], np.cumsum(firm) - 1
    joined = firm[tail] & firm[head]
    tail, head = number[tail[joined]], number[head[joined]]
    mean, raw = np.asarray(thinned.xyz[order], dtype=np.float64), raw[order]
    cell, code, count = cell[order], code[order], thinned.count[order]
    normal, note = _normals(mean, None if normals is None else normals[thinned.first[order]])
    epsilon = settings.epsilon or max(MISFIT * extent, NOISE_BAND * _noise(mean, raw, normal, tail, head), 1e-6)
    return WorkingCloud(
        mean,
        raw,
        normal,
        count,
        cell,
        code,
        size,
        tail,
        head,
        extent,
        epsilon,
        settings.min_points(int(count.sum())),
        note,
    )


def _cell_size(probe: Floats, points: int, settings: Settings) -> tuple[float, float]:
    """Edge of a cell [m] and extent of the cloud [m], outliers aside."""
    low, high = np.percentile(probe, (0.5, 99.5), axis=0)
    coarse = (float(np.linalg.norm(high - low)) or 1.0) / 50.0
    inside = probe[((probe >= low - coarse) & (probe <= high + coarse)).all(axis=1)]
    _, cell, count = np.unique(
        np.floor((inside - low) / coarse + 1.0).astype(np.int64) @ np.array([1, 1 << 10, 1 << 20]),
        return_inverse=True,
        return_counts=True,
    )
    dense = count >= SPARSE * np.median(count[cell])  # half of the points lie in cells with more
    span = np.ptp(inside[dense[cell]], axis=0)
    extent = float(np.linalg.norm(span)) or 1.0
    area = int(dense.sum()) * coarse**2 / 1.5  # a slanting surface meets about 1.5 cells a square
    spacing = math.sqrt(area / points)
    wanted = settings.beta / 2.0 if settings.beta else math.sqrt(1.5 * area / TARGET)
    return max(wanted, 2.0 * spacing, extent * 1e-4), extent


def _longest(xyz: NDArray[np.floating]) -> float:
    """Extent [m] along the axis of the largest, of points (n, 3) of which some may not be finite."""
    spans = [0.0]
    for column in xyz.T:
        low, high = float(column.min()), float(column.max())
        if not math.isfinite(high - low):
            finite = column[np.isfinite(column)]
            low, high = float(finite.min(initial=0.0)), float(finite.max(initial=0.0))
        spans.append(high - low)
    return max(spans)


def _noise(mean: Floats, raw: Floats, normal: Floats, tail: Ints, head: Ints) -> float:
    """Standard deviation [m] of true points from the surface, by the median.

    A point's height above the mean of the cells around it is noise and curvature; curvature is what its neighbours have
    too, once their normals point alike.
    """
    sampled = np.arange(len(mean)) // RUN % EVERY == 0
    inner = sampled[tail] & sampled[head]
    tail, head = tail[inner], head[inner]
    count = np.bincount(tail, minlength=len(mean))
    degree = np.maximum(count, 1)
    direction = np.nan_to_num(normal)
    height = np.bincount(tail, np.einsum("ij,ij->i", mean[head] - raw[tail], direction[tail]), len(mean)) / degree
    alike = np.sign(np.einsum("ij,ij->i", direction[tail], direction[head]))
    rough = np.abs(height - np.bincount(tail, alike * height[head], len(mean)) / degree)[count >= NEIGHBOURS]
    return 1.4826 * float(np.median(rough)) if len(rough) else 0.0


def _normals(mean: Floats, given: NDArray[np.floating] | None) -> tuple[Floats, Note | None]:
    """Unit normals of the cells, the given ones if they are of use, or estimated, NaN where unknown; what was wrong."""
    from segmentation.given_normals import usable
    from segmentation.normals import estimate

    normal, note = (None, None) if given is None else usable(mean, given)
    if normal is None:
        normal = np.asarray(estimate(mean, NORMAL_NEIGHBOURS), dtype=np.float64)
    return normal, note


def _morton(cell: Ints) -> Ints:
    """Interleaved bits of grid coordinates (m, 3) below 2^21."""
    code = np.zeros(len(cell), dtype=np.int64)
    for axis in range(3):
        x = cell[:, axis].copy()
        for shift, mask in (
            (32, 0x1F00000000FFFF),
            (16, 0x1F0000FF0000FF),
            (8, 0x100F00F00F00F00F),
            (4, 0x10C30C30C30C30C3),
            (2, 0x1249249249249249),
        ):
            x = (x | (x << shift)) & mask
        code |= x << axis
    return code


def touching(cell: Ints) -> tuple[Ints, Ints]:
    """Edges (e,), (e,) between cells (m, 3) that share a corner, both directions, ascending by tail."""
    span = cell.max(axis=0) + 3
    key = ((cell[:, 0] + 1) * span[1] + cell[:, 1] + 1) * span[2] + cell[:, 2] + 1
    order = np.argsort(key)
    ascending = key[order]
    table = np.full((len(key), len(NEIGHBOUR_STEPS)), -1, dtype=np.int64)
    for j in range(len(NEIGHBOUR_STEPS) // 2):  # the other half are the same pairs seen from the other end
        wanted = ascending + (NEIGHBOUR_STEPS[j, 0] * span[1] + NEIGHBOUR_STEPS[j, 1]) * span[2] + NEIGHBOUR_STEPS[j, 2]
        place = np.minimum(np.searchsorted(ascending, wanted), len(key) - 1)
        found = np.flatnonzero(ascending[place] == wanted)
        tail, head = order[found], order[place[found]]
        table[tail, j] = head
        table[head, -1 - j] = tail
    joined = table >= 0
    return np.repeat(np.arange(len(key)), joined.sum(axis=1)), table[joined]

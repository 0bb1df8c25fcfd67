"""The label of every point of the full cloud, in one pass over chunks that threads share."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from segmentation.primitives.numeric import gradient, gradients
from segmentation.ransac.hypotheses import Shapes, gaps
from segmentation.ransac.working_cloud import WorkingCloud
from segmentation.threads import threads

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CHUNK = 1 << 18  # points a thread labels at a time
CANDIDATES = 6  # components that may meet within one cell and its neighbours
REACH = 3  # cells that a component may run on beyond the cells that are mostly its own: its slivers
ONE_SIDED = 0.9  # share of a primitive's cells on one side of another from which the two are known to bound each other
TANGENT = 0.9  # cosine between the normals of primitives that touch rather than cross
BITS = 21


@dataclass(frozen=True, eq=False)
class Regions:
    """Where each component may be: what the pass asks for at each cell.

    candidates: (m, CANDIDATES) components near the cell, 0 padded. owner: (c + 1,) primitive of each component.
    side: (k, k) +1 or -1 for the side of primitive b that a's points lie on, 0 where they lie on both.
    turn: (k, k, 3) direction in which a's normals lean from b's at the points of a, where the two touch; else zero.
    """

    candidates: Ints
    owner: Ints
    side: Floats
    turn: Floats


def regions(cloud: WorkingCloud, labels: Ints, components: Ints, shapes: Shapes) -> Regions:
    """What the cells tell about the points in them, from their primitives (m,) and components (m,)."""
    count = int(components.max(initial=0))
    owner = np.zeros(count + 1, dtype=np.int64)
    owner[components] = np.maximum(labels, 0)
    distance = np.abs(gaps(shapes, cloud.mean))
    differs = np.flatnonzero(components[cloud.tail] != components[cloud.head])
    tail, head = cloud.tail[differs], cloud.head[differs]
    may = np.zeros((len(cloud), count + 1), dtype=np.bool_)
    may[components > 0, components[components > 0]] = True
    cell, component = tail, components[head]
    for _ in range(REACH):
        near = (component > 0) & (distance[owner[component], cell] < cloud.size)
        new = np.zeros_like(may)
        new[cell[near], component[near]] = True
        new &= ~may
        may |= new
        cell, component = neighbours(cloud, *np.nonzero(new))
    cell, component = np.nonzero(may)
    rank = np.arange(len(cell)) - np.searchsorted(cell, cell)
    kept = rank < CANDIDATES
    candidates = np.zeros((len(cloud), CANDIDATES), dtype=np.int64)
    candidates[cell[kept], rank[kept]] = component[kept]
    side = _sides(cloud, labels, shapes)
    return Regions(candidates, owner, side, _turns(cloud, labels, shapes, side))


def neighbours(cloud: WorkingCloud, cell: Ints, component: Ints) -> tuple[Ints, Ints]:
    """The neighbours of cells (p,), each with its cell's component."""
    low, high = np.searchsorted(cloud.tail, cell), np.searchsorted(cloud.tail, cell + 1)
    number = high - low
    edge = np.arange(int(number.sum())) + np.repeat(low - np.cumsum(number) + number, number)
    return cloud.head[edge], np.repeat(component, number)


def _sides(cloud: WorkingCloud, labels: Ints, shapes: Shapes) -> Floats:
    """On which side of primitive b the points of a lie, (k, k), from cells near both."""
    side = np.zeros((len(shapes), len(shapes)))
    distance = gaps(shapes, cloud.mean)
    distance[np.abs(distance) >= 6.0 * cloud.size] = 0.0
    for a in range(len(shapes)):
        theirs = distance[:, labels == a]
        total = np.abs(theirs).sum(axis=1)
        positive = theirs.sum(axis=1) / np.where(total > 0.0, total, 1.0)
        side[a] = np.where(np.abs(positive) > 2.0 * ONE_SIDED - 1.0, np.sign(positive), 0.0)
    np.fill_diagonal(side, 0.0)
    return side


def _turns(cloud: WorkingCloud, labels: Ints, shapes: Shapes, side: Floats) -> Floats:
    """How the normals of primitives a and b tell whose a point is where they touch, (k, k, 3); zero where they do not.

    A sphere's normal is that of the drum under it on their common circle, and leans up above it, down below. Distances
    to the two hardly differ there, so that noise would decide.
    """
    turn = np.zeros((len(shapes), len(shapes), 3))
    distance, normal = np.empty(len(cloud)), np.empty((len(shapes), len(cloud), 3))
    near = np.empty((len(shapes), len(cloud)), dtype=np.bool_)
    for k, kind in enumerate(shapes.kinds):
        gradients(kind, shapes.rows[k], cloud.mean, distance, normal[k])
        near[k] = np.abs(distance) < max(cloud.epsilon, 0.5 * cloud.size)
    for a, b in np.argwhere(np.tril(side * side.T)):
        at = np.flatnonzero(near[a] & near[b] & ((labels == a) | (labels == b)))
        cosine = np.einsum("ij,ij->i", normal[a, at], normal[b, at])
        alike = np.abs(cosine) > TANGENT
        at, sign = at[alike], np.sign(cosine[alike])
        lean = normal[a, at] - sign[:, None] * normal[b, at]
        mine = np.where(labels[at] == a, 1.0, -1.0)
        total = mine @ lean
        length = float(np.sqrt(total @ total))
        if length == 0.0 or abs(mine.sum()) == len(mine):
            continue
        across = lean @ total / length
        if mine @ across > (2.0 * ONE_SIDED - 1.0) * np.abs(across).sum():
            turn[a, b] = total / length
            turn[b, a] = math.copysign(1.0, sign.sum()) * turn[a, b]
    return turn


def label_points(
    xyz: NDArray[np.floating], cloud: WorkingCloud, shapes: Shapes, found: Regions, components: Ints, noise: float
) -> tuple[NDArray[np.uint16], Ints, Floats]:
    """Labels (n,) of points (n, 3) [m], and of each component the points and the sum of squared distances [m²], (c +
    1,).

    A point goes to the component whose primitive is nearest, of those in its cell and the cells around, within epsilon;
    where two primitives bound each other, to the one it belongs to by side, on which noise has no influence. Where
    they touch, their normals tell, on which it has little; or else, within `noise` [m], a point goes with its cell.
    """
    lattice = np.floor(cloud.raw * (1 / cloud.size)).astype(np.int64)
    low = lattice.min(axis=0)
    lattice -= low
    keys = (lattice[:, 0] << 2 * BITS) | (lattice[:, 1] << BITS) | lattice[:, 2]
    table = np.full(1 << (2 * len(keys)).bit_length(), -1, dtype=np.int32)
    index_keys(keys, table)
    ends = np.searchsorted(cloud.tail, np.arange(len(cloud) + 1))
    labels = np.zeros(len(xyz), dtype=np.uint16)
    width = len(found.owner)

    def work(start: int) -> tuple[Ints, Floats]:
        count, square = np.zeros(width, dtype=np.int64), np.zeros(width)
        stop = min(start + CHUNK, len(xyz))
        _label(
            xyz[start:stop], labels[start:stop], 1 / cloud.size, low, keys, table,
            found.candidates, found.owner, found.side, found.turn, shapes.kinds, shapes.rows, cloud.epsilon, noise,
            ends, cloud.head, cloud.raw, components, count, square,
        )  # fmt: skip
        return count, square

    with threads() as pool:
        parts = list(pool.map(work, range(0, len(xyz), CHUNK)))
    none = np.zeros(width, dtype=np.int64), np.zeros(width)
    return labels, sum((part[0] for part in parts), none[0]), sum((part[1] for part in parts), none[1])


@njit(cache=True, nogil=True)
def slot_of(table: NDArray[np.int32], keys: Ints, key: np.int64) -> np.int64:
    """Where the key stands in the open-addressed table, or would."""
    mask = len(table) - 1
    slot = np.int64((np.uint64(key) * np.uint64(0x9E3779B97F4A7C15)) >> np.uint64(32)) & mask
    while table[slot] >= 0 and keys[table[slot]] != key:
        slot = (slot + 1) & mask
    return slot


@njit(cache=True, nogil=True)
def index_keys(keys: Ints, table: NDArray[np.int32]) -> None:
    """Put every key into the open-addressed table."""
    for i in range(len(keys)):
        table[slot_of(table, keys, keys[i])] = i


@njit(cache=True, nogil=True)
def _label(
    xyz: NDArray[np.floating], labels: NDArray[np.uint16],
    scale: float, low: Ints, keys: Ints, table: NDArray[np.int32],
    candidates: Ints, owner: Ints, side: Floats, turn: Floats, kinds: Ints, rows: Floats, epsilon: float, noise: float,
    ends: Ints, head: Ints, raw: Floats, components: Ints, count: Ints, square: Floats,
) -> None:  # fmt: skip
    last, cell = np.int64(-1), np.int64(-1)
    for i in range(len(xyz)):
        x, y, z = float(xyz[i, 0]), float(xyz[i, 1]), float(xyz[i, 2])
        if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(z)):
            continue
        kx, ky, kz = (
            np.int64(math.floor(x * scale)) - low[0],
            np.int64(math.floor(y * scale)) - low[1],
            np.int64(math.floor(z * scale)) - low[2],
        )
        if kx < 0 or ky < 0 or kz < 0 or max(kx, ky, kz) >= 1 << BITS:
            continue
        key = (kx << (2 * BITS)) | (ky << BITS) | kz
        if key != last:
            cell = np.int64(table[slot_of(table, keys, key)])
            last = key
        if cell < 0:
            continue
        best, best_distance, shared = 0, 0.0, False
        best_nx, best_ny, best_nz = 0.0, 0.0, 0.0
        for c in range(CANDIDATES):
            candidate = candidates[cell, c]
            if candidate == 0:
                break
            p = owner[candidate]
            if best > 0 and owner[best] == p:
                shared = True
                continue
            d, nx, ny, nz = gradient(kinds[p], rows[p], x, y, z)
            if abs(d) > epsilon:
                continue
            if best > 0:
                q = owner[best]
                parallel = nx * best_nx + ny * best_ny + nz * best_nz
                facing = side[p, q] * side[q, p] * parallel
                tx, ty, tz = turn[p, q, 0], turn[p, q, 1], turn[p, q, 2]
                if facing < 0.0 and abs(parallel) > TANGENT and (tx != 0.0 or ty != 0.0 or tz != 0.0):
                    sign = 1.0 if parallel > 0.0 else -1.0
                    lean = (nx - sign * best_nx) * tx + (ny - sign * best_ny) * ty + (nz - sign * best_nz) * tz
                    wins = lean > 0.0
                elif facing <= 0.0 and abs(parallel) > TANGENT and max(abs(d), abs(best_distance)) < noise:
                    wins = components[cell] > 0 and owner[components[cell]] == p
                elif side[p, q] * side[q, p] != 0.0:
                    wins = side[p, q] * best_distance > side[q, p] * d
                else:
                    wins = abs(d) < abs(best_distance)
                if not wins:
                    continue
            shared = False
            best, best_distance, best_nx, best_ny, best_nz = candidate, d, nx, ny, nz
        if best == 0:
            continue
        if shared:
            nearest = math.inf
            for e in range(ends[cell] - 1, ends[cell + 1]):
                other = cell if e < ends[cell] else head[e]
                if components[other] > 0 and owner[components[other]] == owner[best]:
                    gap = (raw[other, 0] - x) ** 2 + (raw[other, 1] - y) ** 2 + (raw[other, 2] - z) ** 2
                    if gap < nearest:
                        nearest = gap
                        best = components[other]
        labels[i] = best
        count[best] += 1
        square[best] += best_distance * best_distance

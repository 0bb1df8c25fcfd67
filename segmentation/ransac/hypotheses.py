"""Hypotheses: which primitives may be in the cloud, drawn where nothing is explained yet.

A round draws minimal sets within cells of an octree (localised sampling), scores them lazily on growing subsets of the
unexplained points, keeps a few that explain different points, polishes those by robust least squares and takes them in
the order of what each adds. Source: Schnabel, Wahl and Klein 2007; local optimisation: Chum, Matas and Kittler 2003.
"""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from segmentation.primitives import numeric
from segmentation.primitives.least_squares import Samples, least_squares
from segmentation.primitives.minimal_sets import MINIMAL_SETS
from segmentation.ransac.settings import Search
from segmentation.ransac.working_cloud import WorkingCloud
from segmentation.threads import threads

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DRAWS = 384  # minimal sets of each kind in a round
FIRST, SECOND = 256, 1024  # unexplained points that the lazy scores look at
JUDGES = 8000  # cells that the polished ones are judged on
FINALISTS = 12  # hypotheses of a round that are polished
SHARED = 200_000  # distances above which threads share the work: some milliseconds
NORMAL_PRICE = 0.25  # what a deviation of alpha costs beside a distance of epsilon, which costs 1
LOCAL_SUCCESS = 0.1  # share of localised sets on one primitive whose points do lie on it alone
EMPTY = (np.empty(0, dtype=np.int64), np.empty((0, 8)))


@dataclass(frozen=True, eq=False)
class Shapes:
    """Primitives of a cloud in flat form: kinds (k,), rows (k, 8)."""

    kinds: Ints
    rows: Floats

    def __len__(self) -> int:
        return len(self.kinds)

    def take(self, which: NDArray[np.int64] | NDArray[np.bool_]) -> "Shapes":
        """Those at the indices or where the mask is true."""
        return Shapes(self.kinds[which], self.rows[which])

    def joined(self, other: "Shapes") -> "Shapes":
        """These, then the others."""
        return Shapes(np.concatenate((self.kinds, other.kinds)), np.concatenate((self.rows, other.rows)))


def _shared(points: int, size: int, work: Callable[[int, int], None]) -> None:
    """`work(start, stop)` over all points, by threads if so many distances are worth it."""
    cores = (os.cpu_count() or 1) if size > SHARED else 1
    if cores == 1:
        work(0, points)
        return
    edges = [points * i // cores for i in range(cores + 1)]
    with threads() as pool:
        list(pool.map(work, edges[:-1], edges[1:]))


def gaps(shapes: Shapes, xyz: Floats) -> Floats:
    """Signed distances (k, n) [m] of points (n, 3)."""
    out = np.empty((len(shapes), len(xyz)))
    _shared(len(xyz), out.size, lambda i, j: numeric.distances(shapes.kinds, shapes.rows, xyz, out, i, j))
    return out


def support(shapes: Shapes, xyz: Floats, normals: Floats, epsilon: float, cos_alpha: float) -> Floats:
    """How well each primitive explains each point, (k, n) in [0, 1], as `primitives_numeric.supports` tells."""
    out = np.empty((len(shapes), len(xyz)))

    def work(start: int, stop: int) -> None:
        numeric.supports(shapes.kinds, shapes.rows, xyz, normals, epsilon, cos_alpha, out, start, stop)

    _shared(len(xyz), out.size, work)
    return out


class Won(NamedTuple):
    """Of each point the primitive that wins it (n,), -1 for none, its price and the price of the second (n,)."""

    labels: Ints
    price: Floats
    rival: Floats


def won(shapes: Shapes, xyz: Floats, normals: Floats, epsilon: float, cos_alpha: float) -> Won:
    """All primitives compete for each point by distance and normal, as `primitives_numeric.compete` tells."""
    found = Won(np.empty(len(xyz), dtype=np.int64), np.empty(len(xyz)), np.empty(len(xyz)))

    def work(start: int, stop: int) -> None:
        numeric.compete(
            shapes.kinds, shapes.rows, xyz, normals, epsilon, cos_alpha, NORMAL_PRICE, *found, start, stop
        )  # fmt: skip

    _shared(len(xyz), len(xyz) * len(shapes), work)
    return found


def spread(count: int, wanted: int) -> Ints:
    """Indices of at most `wanted` of `count` things in Morton order, evenly apart: a subset that covers the cloud."""
    return np.arange(count) if count <= wanted else (np.arange(wanted) * count) // wanted


def sizes_of(shapes: Shapes, settings: Search) -> Floats:
    """Bounds of the first sizes, (k, 2)."""
    bounds = np.empty((len(shapes), 2))
    for kind in np.unique(shapes.kinds):
        theirs = shapes.kinds == kind
        bounds[theirs] = settings.bounds(int(kind), shapes.rows[theirs, 6])
    return bounds


def search_round(
    cloud: WorkingCloud, active: Ints, epsilon: float, floor: float, settings: Search, rng: np.random.Generator
) -> Shapes:
    """Primitives that each explain more than `floor` of the cells `active` (a,), ascending, which nothing else
    explains.
    """
    cos_alpha = math.cos(settings.alpha)
    hypotheses = _draw(cloud, active, settings, rng)
    if len(hypotheses) == 0:
        return hypotheses
    whole = len(active)
    active = active[spread(whole, JUDGES)]
    floor *= len(active) / whole
    xyz, normals = cloud.mean[active], cloud.normal[active]
    few, many = spread(len(active), FIRST), spread(len(active), SECOND)
    total = support(hypotheses, xyz[few], normals[few], epsilon, cos_alpha).sum(axis=1)
    hypotheses = hypotheses.take(np.argsort(-total, kind="stable")[: len(hypotheses) // 4 + 1])
    share = support(hypotheses, xyz[many], normals[many], epsilon, cos_alpha)
    finalists = hypotheses.take(greedy(share, 1.0, FINALISTS))
    finalists = polish_on_all(finalists, xyz[many], normals[many], epsilon, settings)
    share = support(finalists, xyz, normals, epsilon, cos_alpha)
    share[~_stand_out(finalists, share, xyz, epsilon)] = 0.0
    return finalists.take(greedy(share, floor, len(finalists)))


def _stand_out(shapes: Shapes, share: Floats, xyz: Floats, epsilon: float) -> NDArray[np.bool_]:
    """Which primitives (k,) are surfaces: more cells lie on them than beside them. Within a volume of points, more lie
    beside.
    """
    distance = np.abs(gaps(shapes, xyz))
    beside = (distance > epsilon) & (distance <= 3.0 * epsilon)
    surfaces: NDArray[np.bool_] = (share > 0.0).sum(axis=1) > beside.sum(axis=1)
    return surfaces


def greedy(share: Floats, floor: float, most: int) -> Ints:
    """Rows of share (k, n) that add most to the pointwise maximum, one after the other, while each adds more than
    `floor`.
    """
    best = np.zeros(share.shape[1])
    chosen: list[int] = []
    while len(chosen) < most:
        gain = np.maximum(share - best, 0.0).sum(axis=1)
        k = int(np.argmax(gain))
        if gain[k] <= floor:
            break
        chosen.append(k)
        best = np.maximum(best, share[k])
    return np.array(chosen, dtype=np.int64)


def polish(shapes: Shapes, xyz: Floats, normals: Floats, owner: Ints, epsilon: float, settings: Search) -> Shapes:
    """Robust least squares (Tukey's weights, twice) on points (t, 3), each for the primitive `owner` (t,), within
    epsilon and alpha.
    """
    sizes, cos_alpha = sizes_of(shapes, settings), math.cos(settings.alpha)
    for _ in range(2):
        weights = np.empty(len(owner))
        numeric.tukey(shapes.kinds, shapes.rows, xyz, normals, owner, epsilon, cos_alpha, weights)
        rows = least_squares(shapes.kinds, shapes.rows, Samples(xyz, owner, weights), sizes, iterations=3)
        shapes = Shapes(shapes.kinds, rows)
    return shapes


def polish_on_all(shapes: Shapes, xyz: Floats, normals: Floats, epsilon: float, settings: Search) -> Shapes:
    """The same where every primitive sees all points (n, 3)."""
    copies, owner = (len(shapes), 1), np.repeat(np.arange(len(shapes)), len(xyz))
    return polish(shapes, np.tile(xyz, copies), np.tile(normals, copies), owner, epsilon, settings)


def _draw(cloud: WorkingCloud, active: Ints, settings: Search, rng: np.random.Generator) -> Shapes:
    """Primitives through minimal sets, each within one octree cell of random level, seeds stratified over the active
    cells.
    """
    active = active[np.isfinite(cloud.normal[active]).all(axis=1)]
    if len(active) < 4:
        return Shapes(*EMPTY)
    code = cloud.code[active]
    levels = max(3, math.ceil(math.log2(int(cloud.cell.max()) + 1)))
    found = Shapes(*EMPTY)
    for kind in settings.drawn:
        seed = np.minimum(
            ((np.arange(DRAWS) + rng.random(DRAWS)) * len(active) / DRAWS).astype(np.int64), len(active) - 1
        )
        shift = 3 * rng.integers(2, levels + 1, DRAWS)
        start = (code[seed] >> shift) << shift
        low, high = np.searchsorted(code, start), np.searchsorted(code, start + (np.int64(1) << shift))
        others = low[:, None] + (rng.random((DRAWS, MINIMAL_SETS[kind].size - 1)) * (high - low)[:, None]).astype(
            np.int64
        )
        sets = active[np.concatenate((seed[:, None], others), axis=1)]
        found = found.joined(through(kind, cloud.mean[sets], cloud.normal[sets], settings))
    return found


def through(kind: int, xyz: Floats, normals: Floats, settings: Search) -> Shapes:
    """The primitives of a kind through minimal sets (s, size, 3), without the degenerate and those well beyond the size
    limits.
    """
    rows, whole = MINIMAL_SETS[kind].rows(xyz, normals)
    low, high = settings.bounds(kind, rows[:, 6]).T
    whole &= (rows[:, 6] >= 0.9 * low) & (rows[:, 6] <= 1.1 * high)  # least squares brings the size within its limits
    return Shapes(np.full(int(whole.sum()), kind), rows[whole])


def draws_needed(share: float, probability: float) -> float:
    """Minimal sets after which a primitive with this share of the points has been missed with this probability."""
    success = min(max(share, 1e-9), 1.0) * LOCAL_SUCCESS
    return math.log(probability) / math.log1p(-success)

"""RANSAC shape detection: planes, spheres, cylinders, cones and tori in a point cloud, and the component of every
point.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from segmentation.labelling import label_points, regions
from segmentation.primitives import PRIMITIVES, Primitive
from segmentation.ransac_cloud import WorkingCloud, working_cloud
from segmentation.ransac_joint import cost, refine_jointly, select, winners
from segmentation.ransac_search import DRAWS, EMPTY, Shapes, draws_needed, gaps, search_round
from segmentation.settings import Settings
from segmentation.split import split

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Progress = Callable[[str, int], None]

ROUNDS = 60
LEAST_CELLS = 20.0  # what a primitive has to explain in any case
NOISE_BAND = 6.0  # standard deviations
SWEEPS = 30  # cells that a label may run along an edge
PRICE = 0.5  # of a primitive in the choice, in minimum supports: half of its points may lie near epsilon


@dataclass(frozen=True)
class Segment:
    """One component: its primitive (components may share one), its label `id`, points, rms distance [m] to the
    primitive.
    """

    id: int
    primitive: Primitive
    count: int
    rms: float


@dataclass(frozen=True, eq=False)
class Segments:
    """What was found: segments with ids 1, 2, …, and the labels (n,) of all points, 0 for none. epsilon [m] is the one
    used.
    """

    shapes: tuple[Segment, ...]
    labels: NDArray[np.uint16]
    epsilon: float

    def __len__(self) -> int:
        return len(self.shapes)


def detect(
    xyz: NDArray[np.floating],
    normals: NDArray[np.floating] | None = None,
    settings: Settings | None = None,
    rng: np.random.Generator | None = None,
    progress: Progress | None = None,
) -> Segments:
    """Segment points (n, 3) [m] into components of primitives; unit normals (n, 3) of any sign are estimated where not
    given.

    Points that are not finite get label 0. `progress(stage, shapes)` is told each stage and the primitives found so
    far.

    Raises:
        ValueError: xyz is not (n, 3), or normals have another shape. Source: Schnabel, Wahl and Klein 2007.
    """
    if xyz.ndim != 2 or xyz.shape[1] != 3:
        raise ValueError(f"xyz has shape {xyz.shape}, expected (n, 3)")
    if normals is not None and normals.shape != xyz.shape:
        raise ValueError(f"normals have shape {normals.shape}, xyz has {xyz.shape}: give one normal a point or none")
    settings, rng = settings or Settings(), rng or np.random.default_rng(0)
    tell = progress or (lambda stage, shapes: None)
    tell("thinning", 0)
    cloud = working_cloud(np.ascontiguousarray(xyz), normals, settings)
    if cloud is None:
        return Segments((), np.zeros(len(xyz), dtype=np.uint16), settings.epsilon or 0.0)
    shapes = _find(cloud, settings, rng, tell)
    tell("refinement", len(shapes))
    shapes, labels = _sharpened(shapes, cloud, settings)
    components = split(cloud, labels)
    tell("labelling", len(shapes))
    found = regions(cloud, labels, components, shapes)
    point_labels, count, square = label_points(xyz, cloud, shapes, found, components)
    segments = tuple(
        Segment(
            i,
            PRIMITIVES[shapes.kinds[p]].from_row(shapes.rows[p]),
            int(count[i]),
            math.sqrt(square[i] / max(count[i], 1)),
        )
        for i, p in enumerate(found.owner)
        if i > 0
    )
    return Segments(segments, point_labels, cloud.epsilon)


def _find(cloud: WorkingCloud, settings: Settings, rng: np.random.Generator, tell: Progress) -> Shapes:
    """Rounds of search among what is unexplained, each kept if it lowers the global criterion after joint refinement
    and choice.
    """
    shapes, price = Shapes(*EMPTY), max(PRICE * cloud.min_points * len(cloud) / int(cloud.count.sum()), LEAST_CELLS)
    active, draws = np.arange(len(cloud)), 0
    for _ in range(ROUNDS):
        if len(active) < max(price, 4.0) or draws > draws_needed(
            2.0 * price / len(active), settings.overlooking_probability
        ):
            break
        draws += DRAWS
        new = search_round(cloud, active, cloud.epsilon, price, settings, rng)
        if len(new) == 0:
            continue
        trial, _ = refine_jointly(shapes.joined(new), cloud.mean, cloud.normal, cloud.epsilon, settings, rounds=4)
        trial = select(trial, cloud, cloud.epsilon, price, settings)
        left = _unexplained(trial, cloud, settings)
        if len(left) + price * len(trial) < len(active) + price * len(shapes):
            shapes, active, draws = trial, left, 0
            tell("search", len(shapes))
    shapes, _ = refine_jointly(shapes, cloud.mean, cloud.normal, cloud.epsilon, settings)
    return select(shapes, cloud, cloud.epsilon, price, settings)


def _unexplained(shapes: Shapes, cloud: WorkingCloud, settings: Settings) -> Ints:
    """Cells that no primitive explains, and that are no edge of one: there, neither the mean nor an estimated normal is
    on a surface.
    """
    if len(shapes) == 0:
        return np.arange(len(cloud))
    price = cost(shapes, cloud.mean, cloud.normal, cloud.epsilon, math.cos(settings.alpha))
    label = winners(price)
    distance = gaps(shapes, cloud.mean)
    beside = np.flatnonzero((label[cloud.tail] < 0) & (label[cloud.head] >= 0))
    tail, owner = cloud.tail[beside], label[cloud.head[beside]]
    label[tail[np.abs(distance[owner, tail]) < max(cloud.epsilon, 0.5 * cloud.size)]] = 0
    return np.flatnonzero(label < 0)


def _sharpened(shapes: Shapes, cloud: WorkingCloud, settings: Settings) -> tuple[Shapes, Ints]:
    """Joint refinement on true points in ever narrower bands, down to their noise, and the labels (m,) of the cells.

    Where two primitives touch without crossing, a wide band leaves it open which one a point belongs to.
    """
    epsilon, extent = cloud.epsilon, float(np.ptp(cloud.raw, axis=0).max())
    shapes, labels = refine_jointly(shapes, cloud.raw, cloud.normal, epsilon, settings)
    while len(shapes) and (labels >= 0).any():
        distance = gaps(shapes, cloud.raw)
        own = np.abs(distance[labels[labels >= 0], np.flatnonzero(labels >= 0)])
        narrower = max(NOISE_BAND * 1.4826 * float(np.median(own)), 1e-4 * extent, epsilon / 4.0)
        if narrower > 0.7 * epsilon:
            break
        epsilon = narrower
        shapes, _ = refine_jointly(shapes, cloud.raw, cloud.normal, epsilon, settings)
        labels = winners(cost(shapes, cloud.raw, cloud.normal, cloud.epsilon, math.cos(settings.alpha)))
    return shapes, _settled(shapes, labels, cloud, epsilon) if len(shapes) else labels


def _settled(shapes: Shapes, labels: Ints, cloud: WorkingCloud, margin: float) -> Ints:
    """Labels after cells went over to a neighbour's primitive that is nearer by `margin`, or to any within epsilon if
    they had none.

    Along edges, and in the slivers between them, estimated normals are of no surface: there only distance and
    neighbours count.
    """
    gap = np.abs(gaps(shapes, cloud.raw))
    gap[gap > cloud.epsilon] = math.inf
    labels = labels.copy()
    own = np.where(labels >= 0, gap[labels, np.arange(len(cloud))] - margin, math.inf)
    edges = np.flatnonzero(labels[cloud.tail] != labels[cloud.head])
    for _ in range(SWEEPS):
        edges = edges[labels[cloud.head[edges]] >= 0]
        offer, taker = labels[cloud.head[edges]], cloud.tail[edges]
        theirs = gap[offer, taker]
        better = np.flatnonzero((theirs < own[taker]) & (offer != labels[taker]))
        if len(better) == 0:
            break
        order = better[np.lexsort((offer[better], theirs[better], taker[better]))]
        first = order[np.concatenate(([True], np.diff(taker[order]) > 0))]
        labels[taker[first]], own[taker[first]] = offer[first], theirs[first] - margin
        moved = np.zeros(len(cloud), dtype=np.bool_)
        moved[taker[first]] = True
        edges = np.flatnonzero(moved[cloud.head] & (labels[cloud.tail] != labels[cloud.head]))
    return labels

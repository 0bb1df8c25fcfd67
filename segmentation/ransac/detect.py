"""RANSAC shape detection: planes, spheres, cylinders, cones and tori in a point cloud, and the component of every
point.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from segmentation.notes import Note
from segmentation.primitives.shapes import PRIMITIVES, Primitive
from segmentation.ransac.bellied_walls import bowed, flattened, squares
from segmentation.ransac.cell_labels import sharpened
from segmentation.ransac.choice import select, without_surplus
from segmentation.ransac.components import split
from segmentation.ransac.hypotheses import DRAWS, EMPTY, Shapes, draws_needed, gaps, search_round, won
from segmentation.ransac.joint_refinement import refine_jointly
from segmentation.ransac.point_labels import label_points, regions
from segmentation.ransac.settings import Search, Settings
from segmentation.ransac.working_cloud import WorkingCloud, working_cloud

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Progress = Callable[[str, int], None]

ROUNDS = 32  # of search; a vault takes two to six, a wavy surface that is no primitive as many as it gets
FUTILE = 4  # rounds in succession whose primitives do not stand up to the others: what is left has none


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
    """What was found: segments with ids 1, 2, …, and the labels (n,) of all points, 0 for none.

    epsilon: the one used [m]. notes: on normals that were given and are of no use.
    """

    shapes: tuple[Segment, ...]
    labels: NDArray[np.uint16]
    epsilon: float
    notes: tuple[Note, ...] = ()

    def __len__(self) -> int:
        return len(self.shapes)


def detect(
    xyz: NDArray[np.floating],
    normals: NDArray[np.floating] | None = None,
    settings: Settings | None = None,
    rng: np.random.Generator | None = None,
    progress: Progress | None = None,
) -> Segments:
    """Segment points (n, 3) [m] into components of primitives.

    normals: (n, 3) of any sign; estimated where there are none, or they are of no use: zero, all the same, or others
    than the surface's.

    Planes compete even where they are off, or walls would pass as strips of the cylinders that they touch; their points
    then get label 0, as do those that are not finite. `progress(stage, shapes)` is told each stage and the primitives
    found so far.

    Raises:
        ValueError: xyz is not (n, 3), or normals have another shape. Source: Schnabel, Wahl and Klein 2007.

    >>> rng = np.random.default_rng(1)
    >>> angle, along = rng.uniform(0, np.pi, 5000), rng.uniform(0, 6, 5000)
    >>> found = detect(np.column_stack([2 * np.cos(angle), along, 2 * np.sin(angle)]))
    >>> [(type(segment.primitive).__name__, round(segment.primitive.radius, 3)) for segment in found.shapes]
    [('Cylinder', 2.0)]
    """
    if xyz.ndim != 2 or xyz.shape[1] != 3:
        raise ValueError(f"xyz has shape {xyz.shape}, expected (n, 3)")
    if normals is not None and normals.shape != xyz.shape:
        raise ValueError(f"normals have shape {normals.shape}, xyz has {xyz.shape}: give one normal a point or none")
    wanted, rng = settings or Settings(), rng or np.random.default_rng(0)
    tell = progress or (lambda stage, shapes: None)
    tell("thinning", 0)
    cloud = working_cloud(np.ascontiguousarray(xyz), normals, wanted)
    if cloud is None:
        return Segments((), np.zeros(len(xyz), dtype=np.uint16), wanted.epsilon or 0.0)
    settings = Search.of(wanted, cloud.extent)
    shapes = _find(cloud, settings, rng, tell)
    tell("refinement", len(shapes))
    shapes, labels, noise = sharpened(shapes, cloud, settings)
    components = split(xyz, cloud, shapes, labels, noise)
    tell("labelling", len(shapes))
    found = regions(cloud, labels, components, shapes)
    point_labels, count, square = label_points(xyz, cloud, shapes, found, components, noise)
    told = flattened(shapes, cloud, labels)
    square = squares(xyz, point_labels, found.owner, shapes, told, square)
    kept = np.isin(told.kinds[found.owner], wanted.kinds) if len(told) else np.zeros(1, dtype=np.bool_)
    kept &= count >= cloud.min_points
    kept[0] = False
    number = np.where(kept, np.cumsum(kept), 0).astype(np.uint16)
    segments = tuple(
        Segment(
            int(number[i]),
            PRIMITIVES[told.kinds[p]].from_row(told.rows[p]),
            int(count[i]),
            math.sqrt(square[i] / max(count[i], 1)),
        )
        for i, p in enumerate(found.owner)
        if kept[i]
    )
    notes = () if cloud.note is None else (cloud.note,)
    return Segments(segments, point_labels if kept[1:].all() else number[point_labels], cloud.epsilon, notes)


def _find(cloud: WorkingCloud, settings: Search, rng: np.random.Generator, tell: Progress) -> Shapes:
    """Rounds of search among what is unexplained, each kept if it lowers the global criterion after joint refinement
    and choice.
    """
    shapes, price = Shapes(*EMPTY), cloud.price
    active, draws, futile = np.arange(len(cloud)), 0, 0
    for _ in range(ROUNDS):
        if (
            len(active) < max(price, 4.0)
            or futile >= FUTILE
            or draws > draws_needed(2.0 * price / len(active), settings.overlooking_probability)
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
            shapes, active, draws, futile = trial, left, 0, 0
            tell("search", len(shapes))
        else:
            futile += 1
    shapes, _ = refine_jointly(shapes, cloud.mean, cloud.normal, cloud.epsilon, settings)
    shapes = select(shapes, cloud, cloud.epsilon, price, settings, last=True)
    return without_surplus(bowed(shapes, cloud, settings), cloud, settings)


def _unexplained(shapes: Shapes, cloud: WorkingCloud, settings: Search) -> Ints:
    """Cells that no primitive explains, and that are no edge of one: there, neither the mean nor an estimated normal is
    on a surface.
    """
    if len(shapes) == 0:
        return np.arange(len(cloud))
    label = won(shapes, cloud.mean, cloud.normal, cloud.epsilon, math.cos(settings.alpha)).labels
    distance = gaps(shapes, cloud.mean)
    beside = np.flatnonzero((label[cloud.tail] < 0) & (label[cloud.head] >= 0))
    tail, owner = cloud.tail[beside], label[cloud.head[beside]]
    label[tail[np.abs(distance[owner, tail]) < max(cloud.epsilon, 0.5 * cloud.size)]] = 0
    return np.flatnonzero(label < 0)

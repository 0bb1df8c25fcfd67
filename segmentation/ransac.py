"""RANSAC shape detection: planes, spheres, cylinders, cones and tori in a point cloud, and the component of every point."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from segmentation.labelling import label_points, regions
from segmentation.primitives import PRIMITIVES, Primitive
from segmentation.ransac_cloud import WorkingCloud, working_cloud
from segmentation.ransac_joint import cost, refine_jointly, select
from segmentation.ransac_search import EMPTY, Shapes, draws_needed, search_round, support
from segmentation.settings import Settings
from segmentation.split import split

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Progress = Callable[[str, int], None]

ROUNDS = 60
PRICE = 0.5  # of a primitive in the choice, in minimum supports: what counts fully, within epsilon / 2, may be half of its points


@dataclass(frozen=True)
class Segment:
    """One component: its primitive (components may share one), its label `id`, points, rms distance [m] to the primitive."""

    id: int
    primitive: Primitive
    count: int
    rms: float


@dataclass(frozen=True, eq=False)
class Segments:
    """What was found: segments with ids 1, 2, …, and the labels (n,) of all points, 0 for none. epsilon [m] is the one used."""

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
    """Segment points (n, 3) [m] into components of primitives; unit normals (n, 3) of any sign are estimated where not given.

    Points that are not finite get label 0. `progress(stage, shapes)` is told each stage and the primitives found so far.

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
    shapes, labels = refine_jointly(shapes, cloud.raw, cloud.normal, cloud.epsilon, settings)
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
    """Rounds of search among what is unexplained, each followed by joint refinement and the choice by the global criterion."""
    shapes, price = Shapes(*EMPTY), PRICE * cloud.min_points * len(cloud) / int(cloud.count.sum())
    draws = 0
    for _ in range(ROUNDS):
        active = _unexplained(shapes, cloud, settings)
        if len(active) < max(price, 4.0):
            break
        new = search_round(cloud, active, cloud.epsilon, price, settings, rng)
        draws += 384
        if len(new):
            shapes, _ = refine_jointly(shapes.joined(new), cloud.mean, cloud.normal, cloud.epsilon, settings, rounds=4)
            shapes = select(shapes, cloud, cloud.epsilon, price, settings)
            draws = 0
            tell("search", len(shapes))
        elif draws >= draws_needed(2.0 * price / len(active), settings.overlooking_probability):
            break
    return shapes


def _unexplained(shapes: Shapes, cloud: WorkingCloud, settings: Settings) -> Ints:
    if len(shapes) == 0:
        return np.arange(len(cloud))
    share = support(shapes, cloud.mean, cloud.normal, cloud.epsilon, math.cos(settings.alpha))
    return np.flatnonzero(share.max(axis=0) <= 0.0)

"""Labels of the cells once the primitives are found: in ever narrower bands, along edges, without ghosts."""

import math

import numpy as np
from numpy.typing import NDArray

from segmentation.ransac.bellied_walls import bows_of
from segmentation.ransac.components import connected
from segmentation.ransac.hypotheses import Shapes, gaps, support, won
from segmentation.ransac.joint_refinement import refine_jointly
from segmentation.ransac.settings import Search
from segmentation.ransac.working_cloud import WorkingCloud

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

COARSE = 0.05  # of a cell: noise above this harms more than the corners that means cut
SWEEPS = 30  # cells that a label may run along an edge


def sharpened(shapes: Shapes, cloud: WorkingCloud, settings: Search) -> tuple[Shapes, Ints, float]:
    """Joint refinement on true points in ever narrower bands, down to their noise; labels (m,) of the cells; the noise.

    Where two primitives touch without crossing, a wide band leaves it open which one a point belongs to. The bows of
    walls stay as the wide band has them: a wall may be out by more than its noise.
    """
    epsilon, extent = cloud.epsilon, float(np.ptp(cloud.raw, axis=0).max())
    shapes, labels = refine_jointly(shapes, cloud.raw, cloud.normal, epsilon, settings)
    bows = bows_of(shapes, cloud, labels)
    while len(shapes) and (labels >= 0).any():
        narrower = max(2.0 * _noise(shapes, labels, cloud), 1e-4 * extent, epsilon / 4.0)
        if narrower > 0.7 * epsilon:
            break
        epsilon = narrower
        shapes, _ = refine_jointly(shapes, cloud.raw, cloud.normal, epsilon, settings, held=bows)
        labels = won(shapes, cloud.raw, cloud.normal, cloud.epsilon, math.cos(settings.alpha)).labels
    if len(shapes) == 0:
        return shapes, labels, 0.0
    noise = _noise(shapes, labels, cloud)
    judges = cloud.mean if noise > COARSE * cloud.size else cloud.raw
    labels = won(shapes, judges, cloud.normal, cloud.epsilon, math.cos(settings.alpha)).labels
    labels = _settled(shapes, labels, cloud, judges, epsilon)
    return shapes, _absorbed(shapes, labels, cloud, epsilon, settings), noise


def _noise(shapes: Shapes, labels: Ints, cloud: WorkingCloud) -> float:
    """Three standard deviations [m], by the median, of the true points from their primitives."""
    owned = np.flatnonzero(labels >= 0)
    if len(owned) == 0:
        return 0.0
    return 3.0 * 1.4826 * float(np.median(np.abs(gaps(shapes, cloud.raw)[labels[owned], owned])))


def _settled(shapes: Shapes, labels: Ints, cloud: WorkingCloud, judges: Floats, margin: float) -> Ints:
    """Labels after cells went over to a neighbour's primitive that is nearer by `margin`, or to any within epsilon if
    they had none.

    Along edges, and in the slivers between them, estimated normals are of no surface: there only distance and
    neighbours count.
    """
    gap = np.abs(gaps(shapes, judges))
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


def _absorbed(shapes: Shapes, labels: Ints, cloud: WorkingCloud, epsilon: float, settings: Search) -> Ints:
    """Labels after regions that are not worth a primitive's price went to the primitives that explain them as well.

    The far side of a barrel's cylinder may touch the floor, and a dome's sphere cuts through the walls: no parts of
    either.
    """
    share = support(shapes, cloud.raw, cloud.normal, epsilon, math.cos(settings.alpha))
    gap = np.abs(gaps(shapes, cloud.raw))
    owned, everyone = labels >= 0, np.arange(len(cloud))
    own = np.where(owned, share[labels, everyone], 0.0)
    share[labels[owned], everyone[owned]], gap[labels[owned], everyone[owned]] = 0.0, math.inf
    region = connected(cloud, labels, owned)
    worth = np.bincount(region, weights=np.maximum(own - share.max(axis=0), 0.0))
    other = np.argmin(gap, axis=0)
    ghost = owned & (worth[region] < cloud.price) & (gap[other, everyone] <= epsilon)
    return np.where(ghost, other, labels)

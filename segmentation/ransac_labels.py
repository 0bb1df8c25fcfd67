"""Labels of the cells once the primitives are found: in ever narrower bands, along edges, without ghosts."""

import math

import numpy as np
from numpy.typing import NDArray

from segmentation.ransac_cloud import WorkingCloud
from segmentation.ransac_joint import cost, refine_jointly, winners
from segmentation.ransac_search import Shapes, gaps, support
from segmentation.settings import Settings
from segmentation.split import connected

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NOISE_BAND = 6.0  # standard deviations
SWEEPS = 30  # cells that a label may run along an edge


def sharpened(shapes: Shapes, cloud: WorkingCloud, settings: Settings) -> tuple[Shapes, Ints]:
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
    if len(shapes):
        labels = _absorbed(shapes, _settled(shapes, labels, cloud, epsilon), cloud, epsilon, settings)
    return shapes, labels


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


def _absorbed(shapes: Shapes, labels: Ints, cloud: WorkingCloud, epsilon: float, settings: Settings) -> Ints:
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

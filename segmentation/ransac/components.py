"""Components: the connected regions of each primitive, cut along its intersection curves with the others.

Opposite webs of a groin share a cylinder and touch at the crown; four pendentives share a sphere and touch below the
drum. Gaps in the points do not separate them, but another primitive's points lie around every such neck: what is next
to another primitive is taken away, what is left falls into components, and these grow back over what was taken.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from segmentation.ransac.hypotheses import Shapes
from segmentation.ransac.necks import Necks
from segmentation.ransac.working_cloud import WorkingCloud

Ints = NDArray[np.int64]

MARGIN = 2  # cells next to another primitive that are taken away
GAP = 6.0  # cells between a component and a crumb that belongs to it
LEAST_CELLS = 10  # of a component; fewer are crumbs at an edge
NECK = 0.7  # contact of two cores from which they are one: over the root of the smaller's cells, and its share of core
SMALLEST_CORE = 0.25  # of the minimum support; a smaller core grows out of its neighbours again


def split(xyz: NDArray[np.floating], cloud: WorkingCloud, shapes: Shapes, labels: Ints, noise: float) -> Ints:
    """Components (m,) of the cells, 0 for none, counted by the primitives `labels` (m,), -1 for none, in ascending
    order.

    A component has the minimum support; what is near none that has, is 0. What a strip joins is one: 0.05 m wide, or
    five times the spacing of the points xyz (n, 3) [m] where that is more.
    """
    same = labels[cloud.tail] == labels[cloud.head]
    boundary = ~same & (labels[cloud.tail] >= 0) & (labels[cloud.head] >= 0)
    inside = labels >= 0
    taken = np.zeros(len(labels), dtype=np.bool_)
    taken[cloud.tail[boundary]] = True
    for _ in range(MARGIN - 1):
        taken[cloud.tail[same & taken[cloud.head]]] = True
    cores = _components(cloud, labels, inside & ~taken, SMALLEST_CORE * cloud.min_points)
    grown = _rejoined(cloud, labels, cores, _grow(cloud, labels, cores))
    necks = Necks(xyz, cloud, shapes, labels, cores, grown, MARGIN, noise).strips()
    grown = _united(grown, *necks.T)
    rest = inside & (grown == 0)
    extra = _components(cloud, labels, rest, cloud.min_points)
    grown = np.where(extra > 0, extra + grown.max(initial=0), grown)
    points = np.bincount(grown, weights=cloud.count, minlength=1)
    kept = (points >= cloud.min_points) & (np.bincount(grown, minlength=1) >= LEAST_CELLS)
    kept[0] = False
    owner = np.zeros(len(kept), dtype=np.int64)
    owner[grown] = labels
    order = np.flatnonzero(kept)
    order = order[np.lexsort((-points[order], owner[order]))]
    number = np.zeros(len(kept), dtype=np.int64)
    number[order] = np.arange(1, len(order) + 1)
    return _with_crumbs(cloud, labels, number[grown])


def _with_crumbs(cloud: WorkingCloud, labels: Ints, components: Ints) -> Ints:
    """Components with the cells of their primitive that a narrow gap cuts off, each to the nearest."""
    from scipy.spatial import cKDTree

    out = components.copy()
    for primitive in np.unique(labels[(labels >= 0) & (components == 0)]):
        loose = np.flatnonzero((labels == primitive) & (components == 0))
        held = np.flatnonzero((labels == primitive) & (components > 0))
        if len(held):
            far, nearest = cKDTree(cloud.mean[held]).query(cloud.mean[loose], distance_upper_bound=GAP * cloud.size)
            near = np.isfinite(np.asarray(far))
            out[loose[near]] = components[held[np.asarray(nearest)[near]]]
    return out


def _components(cloud: WorkingCloud, labels: Ints, among: NDArray[np.bool_], smallest: float) -> Ints:
    """Connected regions (m,) of the cells `among` (m,) with equal labels and `smallest` points; 0 for none."""
    region = connected(cloud, labels, among)
    large = np.bincount(region, weights=cloud.count) >= smallest
    large[0] = False
    return np.where(large, np.cumsum(large), 0)[region]


def connected(cloud: WorkingCloud, labels: Ints, among: NDArray[np.bool_]) -> Ints:
    """Connected regions (m,) of the cells `among` (m,) with equal labels, counted from 1; 0 for the others."""
    size = len(labels)
    if not among.any():
        return np.zeros(size, dtype=np.int64)
    group = np.where(among, labels, -1)
    joined = (group[cloud.tail] == group[cloud.head]) & (group[cloud.tail] >= 0) & (cloud.tail < cloud.head)
    pairs = cloud.tail[joined], cloud.head[joined]
    graph = csr_array((np.ones(len(pairs[0]), dtype=np.int8), pairs), shape=(size, size))
    _, region = connected_components(graph, directed=False)
    return np.where(among, np.asarray(region, dtype=np.int64) + 1, 0)


def _grow(cloud: WorkingCloud, labels: Ints, cores: Ints) -> Ints:
    """Cores grown, ring by ring, over the cells of their own primitive; between two, the one that touches a cell more
    often.
    """
    grown = cores.copy()
    open_edges = np.flatnonzero((cores[cloud.tail] == 0) & (labels[cloud.tail] == labels[cloud.head]))
    tail, head = cloud.tail[open_edges], cloud.head[open_edges]
    width = int(cores.max(initial=0)) + 1
    while True:
        front = grown[head] > 0
        if not front.any():
            return grown
        pair, vote = np.unique(tail[front] * width + grown[head[front]], return_counts=True)
        cell, core = pair // width, pair % width
        best = np.lexsort((core, -vote, cell))
        first = best[np.concatenate(([True], np.diff(cell[best]) > 0))]
        grown[cell[first]] = core[first]
        still = grown[tail] == 0
        tail, head = tail[still], head[still]


def _rejoined(cloud: WorkingCloud, labels: Ints, cores: Ints, grown: Ints) -> Ints:
    """Components after those that meet along a front, not at a neck, became one.

    A drum that is few cells high is nearly all margin: little of it was core, and that in pieces.
    """
    width = int(grown.max(initial=0)) + 1
    met = (labels[cloud.tail] == labels[cloud.head]) & (grown[cloud.tail] != grown[cloud.head])
    met &= (grown[cloud.tail] > 0) & (grown[cloud.head] > 0)
    if not met.any():
        return grown
    touch = np.unique(cloud.tail[met] * width + grown[cloud.head[met]])  # a cell and the component it touches
    pair, contact = np.unique(grown[touch // width] * width + touch % width, return_counts=True)
    cells, core = np.bincount(grown, minlength=width), np.bincount(cores, minlength=width)
    one, other = pair // width, pair % width
    smaller = np.where(cells[one] < cells[other], one, other)
    front = contact >= NECK * core[smaller] / np.sqrt(cells[smaller])
    return _united(grown, one[front], other[front])


def _united(grown: Ints, one: Ints, other: Ints) -> Ints:
    """Components after those of each pair became one."""
    width = int(grown.max(initial=0)) + 1
    graph = csr_array((np.ones(len(one), dtype=np.int8), (one, other)), shape=(width, width))
    _, joined = connected_components(graph, directed=False)
    return np.asarray(joined, dtype=np.int64)[grown]

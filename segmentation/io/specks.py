"""Points far from all others: a 0,0,0 among projected coordinates, what a beam met through a window half a mile off."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Floats
from segmentation.io.chunk import Mask
from segmentation.io.sample import sample

FEWEST_FOR_SPECKS = 100
"""With fewer points there are no others to be far from."""
MIDDLE = (0.05, 0.95)
"""Shares of the points between which the bulk of them lies along an axis."""
CELLS = 10.0
"""Cells along the diagonal of the bulk, in which points are grouped."""
LINK = 2.5
"""Cells that a group may leave empty, from centre to centre."""
FAR = 0.5
"""Diagonals of the bulk that are far."""
SHARE = 0.01
"""What has less than this share of the points is a speck; more may be another room."""
REACH = 5e4
"""Diagonals of the bulk beyond which all is equally far."""


def far_specks(parts: Sequence[Floats], taken: Sequence[Mask], corners: NDArray[np.float64]) -> tuple[Mask, ...] | None:
    """Which of the points (k, 3) that take part are specks; None if none. corners: (2, 3) of those that do.

    Points are grouped by the cells of a grid; a group is a speck if it is far from all groups that are none, and has
    few points, or all of them in one place, as beams without an answer have that are written as 0,0,0.
    """
    bulk = sample(parts, taken)
    bulk = bulk[(bulk != 0).any(axis=1)]
    if sum(int(used.sum()) for used in taken) < FEWEST_FOR_SPECKS or len(bulk) == 0:
        return None
    inner, outer = np.quantile(bulk, MIDDLE, axis=0)
    diagonal = float(np.linalg.norm(outer - inner))
    if diagonal == 0 or ((corners[0] >= inner - diagonal).all() and (corners[1] <= outer + diagonal).all()):
        return None
    far = _grouped(parts, taken, inner, outer, diagonal)
    return tuple(far) if any(mask.any() for mask in far) else None


def _grouped(
    parts: Sequence[Floats],
    taken: Sequence[Mask],
    inner: NDArray[np.float64],
    outer: NDArray[np.float64],
    diagonal: float,
) -> list[Mask]:
    """Masks (k,) of the specks in each part."""
    from segmentation.voxel import thin  # numba takes half a second, which clouds without specks need not wait for

    size = diagonal / CELLS
    numbers: dict[tuple[int, ...], int] = {}
    places: list[NDArray[np.int32]] = []  # the cell of each point
    for part in parts:
        near = np.clip(part - inner, -REACH * diagonal, REACH * diagonal)
        thinned = thin(near, size, inverse=True)
        keys = np.floor(near[thinned.first] / size).astype(np.int64)
        mine = np.array([numbers.setdefault(tuple(key), len(numbers)) for key in keys.tolist()], np.int32)
        assert thinned.inverse is not None
        cell = mine[thinned.inverse] if len(mine) else np.zeros(0, np.int32)
        places.append(cell)
    cells = np.array(list(numbers), np.int64).reshape(-1, 3)
    total = np.zeros(len(cells), np.int64)
    lowest, highest = np.full((len(cells), 3), np.inf), np.full((len(cells), 3), -np.inf)
    for part, used, cell in zip(parts, taken, places, strict=True):
        total += np.bincount(cell[used], minlength=len(cells))
        np.minimum.at(lowest, cell[used], part[used])
        np.maximum.at(highest, cell[used], part[used])
    group = _linked(cells)
    speck = _specks(cells.astype(np.float64), group, total, lowest, highest)
    return [speck[cell] & used for cell, used in zip(places, taken, strict=True)]


def _linked(cells: NDArray[np.int64]) -> NDArray[np.int32]:
    """Number of the group (c,) of each cell (c, 3)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(cells).query_pairs(LINK, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs), np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(cells), len(cells)))
    _, group = connected_components(graph, directed=False)
    return np.asarray(group, np.int32)


def _specks(
    cells: NDArray[np.float64],
    group: NDArray[np.int32],
    total: NDArray[np.int64],
    lowest: NDArray[np.float64],
    highest: NDArray[np.float64],
) -> Mask:
    """Which cells (c,) hold specks."""
    from scipy.spatial import cKDTree

    number = int(group.max()) + 1
    points = np.bincount(group, total, minlength=number)
    low, high = np.full((number, 3), np.inf), np.full((number, 3), -np.inf)
    np.minimum.at(low, group, lowest)
    np.maximum.at(high, group, highest)
    few = (points < SHARE * points.sum()) | (low == high).all(axis=1)
    if few.all():
        return np.zeros(len(cells), np.bool_)
    gap, _ = cKDTree(cells[~few[group]]).query(cells)
    nearest = np.full(number, np.inf)
    np.minimum.at(nearest, group, np.asarray(gap, np.float64))
    speck: Mask = (few & (nearest > FAR * CELLS))[group]
    return speck

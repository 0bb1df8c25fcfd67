"""Walls that belly: found as spheres or cylinders of a huge radius, told as the planes that they nearly are.

A wall that is out by 30 mm over 4 m is no plane within epsilon, and its points are labelled best by the surface that it
follows: its bow. Yet nobody built a sphere of 100 m.
"""

import math

import numpy as np
from numpy.typing import NDArray

from segmentation.primitives.numeric import CYLINDER, PLANE, SPHERE, gradients
from segmentation.ransac.hypotheses import EMPTY, Floats, Ints, Shapes, gaps, polish_on_all, spread, support, won
from segmentation.ransac.settings import FLAT, Search
from segmentation.ransac.working_cloud import MISFIT, WorkingCloud

LEAST = 20  # cells that tell how something bows
FIT_POINTS = 1000  # cells that decide it
FLATTEST = 1e-3  # extents of the cloud over radius from which a bow counts as a plane
BOW_BANDS = 3.0  # bands within which a bow is fitted: its pieces may be out by more than one
BETTER = 0.7  # rms of a bow over that of the plane, from which the wall bellies
MISSED = 0.05  # share of two pieces of a wall that its bow may leave


def bowed(shapes: Shapes, cloud: WorkingCloud, settings: Search) -> Shapes:
    """The primitives with a bow in place of planes that it fits far better, and of flat pieces of one wall that touch.

    Where a wall bellies in a way that is no primitive's, the search may explain it by several planes and bows.
    """
    now, cos_alpha = shapes, math.cos(settings.alpha)
    labels = won(now, cloud.mean, cloud.normal, cloud.epsilon, cos_alpha).labels
    for k in np.flatnonzero(shapes.kinds == PLANE):
        mine = np.flatnonzero(labels == k)
        plane = _rms(shapes.take(np.array([k])), cloud.mean[mine])[0] if len(mine) else 0.0
        bows = _bows(cloud, mine, BETTER * plane, settings)
        if len(bows):
            rms = _rms(bows, cloud.mean[mine])
            best = int(np.argmin(rms))
            if rms[best] < BETTER * plane:
                now = Shapes(now.kinds.copy(), now.rows.copy())
                now.kinds[k], now.rows[k] = bows.kinds[best], bows.rows[best]
    while True:
        merged = _merged(now, cloud, settings)
        if merged is None:
            return now
        now = merged


def _merged(shapes: Shapes, cloud: WorkingCloud, settings: Search) -> Shapes | None:
    """With one bow for the first two primitives that touch, one of them flat, and that it explains about as well."""
    cos_alpha = math.cos(settings.alpha)
    labels = won(shapes, cloud.mean, cloud.normal, cloud.epsilon, cos_alpha).labels
    cells = [np.flatnonzero(labels == k) for k in range(len(shapes))]
    flat = np.array([len(c) > LEAST and is_flat(shapes, k, cloud.mean[c]) for k, c in enumerate(cells)])
    if not flat.any():
        return None
    one, other = labels[cloud.tail], labels[cloud.head]
    touch = (one >= 0) & (one < other)
    touch[touch] = flat[one[touch]] | flat[other[touch]]
    pairs, contact = np.unique(np.stack((one[touch], other[touch]), axis=1), axis=0, return_counts=True)
    band = max(cloud.epsilon, MISFIT * cloud.extent)  # a wall is out by its misfit, whatever epsilon is asked for
    share = support(shapes, cloud.mean, cloud.normal, band, cos_alpha)
    for i, j in pairs[np.argsort(-contact, kind="stable")]:
        both = np.sort(np.concatenate((cells[i], cells[j])))
        rest = np.delete(np.arange(len(shapes)), (i, j))
        others = share[rest].max(axis=0, initial=0.0)
        before = np.maximum(others, share[[i, j]].max(axis=0)).sum()
        trial = _bows(cloud, both, band, settings)
        after = np.maximum(others, support(trial, cloud.mean, cloud.normal, band, cos_alpha)).sum(axis=1)
        if len(trial) and after.max() > before - max(cloud.price, MISSED * len(both)):
            return shapes.take(rest).joined(trial.take(np.array([int(np.argmax(after))])))
    return None


def _rms(shapes: Shapes, xyz: Floats) -> Floats:
    """Root mean square distances (k,) [m] of points (n, 3)."""
    return np.asarray(np.sqrt((gaps(shapes, xyz) ** 2).mean(axis=1)), dtype=np.float64)


def _bows(cloud: WorkingCloud, cells: Ints, rms: float, settings: Search) -> Shapes:
    """The sphere and the cylinder that fit so many cells best, where they are flat and fit to some `rms` [m].

    They start from the quadratic height over the cells' plane. Its curvatures are small, so that least squares ends
    where it starts but for the bounds of the radii.
    """
    if len(cells) < LEAST:
        return Shapes(*EMPTY)
    xyz = cloud.mean[cells[spread(len(cells), FIT_POINTS)]]
    middle, frame = _frame(xyz)
    u, v, height = ((xyz - middle) @ frame).T
    one = np.ones(len(u))
    around = np.linalg.lstsq(np.stack((one, u, v, u * u + v * v), axis=1), height, rcond=None)[0]
    full = np.linalg.lstsq(np.stack((one, u, v, u * u, 2.0 * u * v, v * v), axis=1), height, rcond=None)[0]
    values, directions = np.linalg.eigh([[full[3], full[4]], [full[4], full[5]]])
    steep = int(np.argmax(np.abs(values)))
    axis = frame[:, :2] @ directions[:, 1 - steep]
    rows = np.zeros((2, 8))
    for row, curvature, slopes, offset in (
        (rows[0], 2.0 * around[3], around[1:3], around[0]),
        (rows[1], 2.0 * values[steep], full[1:3], full[0]),
    ):
        r = 1.0 / max(abs(curvature), FLATTEST / cloud.extent)
        normal = frame @ np.array([-slopes[0], -slopes[1], 1.0]) / math.sqrt(1.0 + slopes @ slopes)
        row[:3], row[6] = middle + offset * frame[:, 2] + math.copysign(r, curvature) * normal, r
    rows[1, 3:6] = axis
    shapes = Shapes(np.array([SPHERE, CYLINDER]), rows)
    close = _rms(shapes, xyz) < rms
    shapes = shapes.take(close & np.array([is_flat(shapes, k, xyz) for k in range(2)]))
    shapes = polish_on_all(shapes, xyz, np.full_like(xyz, np.nan), BOW_BANDS * max(cloud.epsilon, rms), settings)
    return shapes.take(np.array([is_flat(shapes, k, xyz) for k in range(len(shapes))], dtype=np.bool_))


def flattened(shapes: Shapes, cloud: WorkingCloud, labels: Ints) -> Shapes:
    """The primitives with planes in place of those whose normals turn by less than `FLAT` over their cells.

    A sphere or cylinder so has to rise by 1/50 of its length, wherever its radius is within limits or not. The plane is
    that of least squares through the cells.
    """
    kinds, rows = shapes.kinds.copy(), shapes.rows.copy()
    for k in bows_of(shapes, cloud, labels):
        middle, frame = _frame(cloud.raw[labels == k])
        kinds[k], rows[k] = PLANE, np.concatenate((middle, frame[:, 2], (0.0, 0.0)))
    return Shapes(kinds, rows)


def bows_of(shapes: Shapes, cloud: WorkingCloud, labels: Ints) -> Ints:
    """Which primitives (b,) are bows: no planes, but flat over their cells."""
    curved = (int(k) for k in np.flatnonzero(shapes.kinds != PLANE))
    cells = {k: cloud.raw[labels == k] for k in curved}
    return np.array([k for k, xyz in cells.items() if len(xyz) >= 3 and is_flat(shapes, k, xyz)], dtype=np.int64)


def is_flat(shapes: Shapes, k: int, xyz: Floats) -> bool:
    """Whether a primitive's normals turn by less than `FLAT` over points (n, 3), in the direction in which they turn
    most.

    The turn is told by their variance, which is turn² / 12 where they turn evenly: a few strays do not count.
    """
    if shapes.kinds[k] == PLANE:
        return True
    distance, normal = np.empty(len(xyz)), np.empty((len(xyz), 3))
    gradients(shapes.kinds[k], shapes.rows[k], xyz, distance, normal)
    variance = float(np.linalg.eigvalsh(np.cov(normal.T, bias=True))[-1])
    return 12.0 * variance < FLAT**2


def _frame(xyz: Floats) -> tuple[Floats, Floats]:
    """The middle (3,) of points (n, 3) and the directions (3, 3), in columns, of their plane; its normal the last."""
    middle = xyz.mean(axis=0)
    return middle, np.linalg.eigh(np.cov((xyz - middle).T, bias=True))[1][:, ::-1]


def squares(
    xyz: NDArray[np.floating], labels: NDArray[np.uint16], owner: Ints, shapes: Shapes, told: Shapes, square: Floats
) -> Floats:
    """Sums (c + 1,) [m²] of the squared distances of each component's points from the primitive that is told for it."""
    out = square.copy()
    for component in range(1, len(owner)):
        k = owner[component]
        if told.kinds[k] != shapes.kinds[k]:
            mine = np.asarray(xyz[labels == component], dtype=np.float64)
            out[component] = (gaps(told.take(np.array([k])), mine) ** 2).sum()
    return out

"""Joint refinement: all primitives compete for every point, are fitted again, and so on until no label changes.

The choice of primitives is by one global criterion, the points left unexplained plus a price for each primitive: primitives that are
not worth their price go, two that one can replace merge. Source: Isack and Boykov 2012, "Energy-Based Geometric Multi-model Fitting".
"""

import math

import numpy as np

from segmentation.ransac_cloud import WorkingCloud
from segmentation.ransac_search import Floats, Ints, Shapes, measure, polish, sizes_of, spread, support
from segmentation.refine import least_squares
from segmentation.settings import Settings

ROUNDS = 30
NORMAL_PRICE = 0.25  # what a deviation of alpha costs beside a distance of epsilon, which costs 1
FIT_POINTS = 8000  # points that decide the primitives; the labels are for all
CHOICE_POINTS = 6000


def cost(shapes: Shapes, xyz: Floats, normals: Floats, epsilon: float, cos_alpha: float) -> Floats:
    """Price (k, n) of giving each point to each primitive: squared distance over epsilon plus the normals' deviation; inf outside."""
    distance, cosine = measure(shapes, xyz, normals)
    price = (distance / epsilon) ** 2 + NORMAL_PRICE * np.maximum(1.0 - cosine, 0.0) / (1.0 - cos_alpha)
    return np.where((np.abs(distance) <= epsilon) & (cosine >= cos_alpha), price, math.inf)


def refine_jointly(
    shapes: Shapes, xyz: Floats, normals: Floats, epsilon: float, settings: Settings, rounds: int = ROUNDS
) -> tuple[Shapes, Ints]:
    """The primitives fitted to the points (n, 3) each wins, and the labels (n,), -1 for points that none explains."""
    cos_alpha, sizes = math.cos(settings.alpha), sizes_of(shapes.kinds, settings)
    some = spread(len(xyz), FIT_POINTS)
    sample, directions, labels = xyz[some], normals[some], np.full(len(some), -1)
    for _ in range(rounds if len(shapes) else 0):
        price = cost(shapes, sample, directions, epsilon, cos_alpha)
        new = _winners(price)
        if (new == labels).all():
            break
        labels = new
        shapes = Shapes(shapes.kinds, _fit_to_won(shapes, sample, labels, price, sizes))
    return shapes, _winners(cost(shapes, xyz, normals, epsilon, cos_alpha))


def _winners(price: Floats) -> Ints:
    if len(price) == 0:
        return np.full(price.shape[1], -1)
    winner = np.argmin(price, axis=0)
    lowest = np.take_along_axis(price, winner[None], axis=0)[0]
    return np.where(np.isfinite(lowest), winner, -1)


def _fit_to_won(shapes: Shapes, xyz: Floats, labels: Ints, price: Floats, sizes: Floats) -> Floats:
    """Rows fitted to the points won, those that a second primitive explains about as well weighing little."""
    mine = np.arange(len(shapes))[:, None] == labels
    own = np.where(mine, price, 0.0).sum(axis=0)
    rival = np.where(mine, math.inf, price).min(axis=0, initial=math.inf)
    clear = np.clip(4.0 * (np.sqrt(np.minimum(rival, 4.0)) - np.sqrt(own)), 0.05, 1.0)
    weights = mine * (clear * np.clip(1.0 - own, 0.0, 1.0) ** 2)
    return least_squares(shapes.kinds, shapes.rows, xyz, weights, sizes, iterations=4)


def select(shapes: Shapes, cloud: WorkingCloud, epsilon: float, price: float, settings: Settings) -> Shapes:
    """Drop and merge primitives while that lowers the cells left unexplained plus `price` for each primitive."""
    some = spread(len(cloud), CHOICE_POINTS)
    xyz, normals, cos_alpha = cloud.mean[some], cloud.normal[some], math.cos(settings.alpha)
    price = price * len(some) / len(cloud)
    changed = True
    while changed and len(shapes):
        share = support(shapes, xyz, normals, epsilon, cos_alpha)
        ranked = np.sort(share, axis=0)
        best, second = ranked[-1], ranked[-2] if len(shapes) > 1 else np.zeros(len(some))
        loss = np.where(share == best, best - second, 0.0).sum(axis=1)
        worst = int(np.argmin(loss))
        changed = bool(loss[worst] < price)
        if changed:
            shapes = shapes.take(np.arange(len(shapes)) != worst)
            continue
        merged = _merge_one(shapes, xyz, normals, share, epsilon, price, settings)
        changed = merged is not None
        shapes = merged or shapes
    return shapes


def _merge_one(
    shapes: Shapes, xyz: Floats, normals: Floats, share: Floats, epsilon: float, price: float, settings: Settings
) -> Shapes | None:
    """The primitives with the first pair of a kind replaced by one that explains as much but for `price`; None if there is none."""
    cos_alpha = math.cos(settings.alpha)
    for i in range(len(shapes)):
        for j in range(i + 1, len(shapes)):
            if shapes.kinds[i] != shapes.kinds[j]:
                continue
            pair = shapes.take(np.array([i, j]))
            rest = np.delete(share, [i, j], axis=0).max(axis=0, initial=0.0)
            before = np.maximum(rest, share[[i, j]].max(axis=0)).sum()
            theirs = np.flatnonzero((share[[i, j]].max(axis=0) > 0.0) & (share[[i, j]].max(axis=0) >= rest))
            joint = polish(pair, xyz[theirs], normals[theirs], 3.0 * epsilon, settings)
            joint = polish(joint, xyz[theirs], normals[theirs], epsilon, settings)
            after = np.maximum(rest, support(joint, xyz, normals, epsilon, cos_alpha)).sum(axis=1)
            if after.max() > before - price:
                kept = shapes.take(np.delete(np.arange(len(shapes)), [i, j]))
                return kept.joined(joint.take(np.array([int(np.argmax(after))])))
    return None

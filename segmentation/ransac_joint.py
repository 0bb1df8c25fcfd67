"""Joint refinement: all primitives compete for every point, are fitted again, and so on until no label changes.

The choice of primitives is by one global criterion, the points left unexplained plus a price for each primitive:
primitives that are not worth their price go, two that one can replace merge. Source: Isack and Boykov 2012,
"Energy-Based Geometric Multi-model Fitting".
"""

import math
from dataclasses import dataclass

import numpy as np

from segmentation.primitives_numeric import PLANE
from segmentation.primitives_sample import MINIMAL_SETS
from segmentation.ransac_cloud import WorkingCloud
from segmentation.ransac_search import (
    EMPTY,
    Floats,
    Ints,
    Shapes,
    gaps,
    measure,
    polish,
    sizes_of,
    spread,
    support,
    through,
)
from segmentation.refine import least_squares
from segmentation.settings import Settings

ROUNDS = 30
NORMAL_PRICE = 0.25  # what a deviation of alpha costs beside a distance of epsilon, which costs 1
FIT_POINTS = 8000  # points that decide the primitives; the labels are for all
CHOICE_POINTS = 6000
SIMPLER = 0.02  # share of what a primitive explains that one with fewer parameters may leave
ALIKE = 2.0  # bands that two primitives may differ by to be one surface, of which both see what misfit leaves
NEAR = 10.0  # bands that two primitives may differ by, on average over one's points, to be worth merging
OWN = 0.1  # share of the points nearest to a primitive that nothing else may explain; less, and it fits others' misfit
PROMISING = 0.5  # share of a primitive's points that the first guess of a simpler one has to explain
TRIALS = 64  # minimal sets that look for a simpler primitive


def cost(shapes: Shapes, xyz: Floats, normals: Floats, epsilon: float, cos_alpha: float) -> Floats:
    """Price (k, n) of giving each point to each primitive: squared distance over epsilon plus the normals' deviation;
    inf outside.
    """
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
        new = winners(price)
        if (new == labels).all():
            break
        labels = new
        shapes = Shapes(shapes.kinds, _fit_to_won(shapes, sample, labels, price, sizes))
    return shapes, winners(cost(shapes, xyz, normals, epsilon, cos_alpha))


def winners(price: Floats) -> Ints:
    """The cheapest primitive (n,) of prices (k, n), -1 where all are infinite."""
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
    """Drop, simplify and merge while that lowers the cells left unexplained plus `price` for each primitive."""
    some = spread(len(cloud), CHOICE_POINTS)
    choice = _Choice(cloud.mean[some], cloud.normal[some], epsilon, price * len(some) / len(cloud), settings)
    while True:
        for better in (choice.dropped, choice.simplified, choice.merged):
            changed = better(shapes)
            if changed is not None:
                shapes = changed
                break
        else:
            return shapes


@dataclass(frozen=True, eq=False)
class _Choice:
    """The points (n, 3) that judge primitives, and the price of one; each method returns a better choice or None."""

    xyz: Floats
    normals: Floats
    epsilon: float
    price: float
    settings: Settings

    def share(self, shapes: Shapes) -> Floats:
        return support(shapes, self.xyz, self.normals, self.epsilon, math.cos(self.settings.alpha))

    def dropped(self, shapes: Shapes) -> Shapes | None:
        """Without the primitive that adds least to the others, where that is less than its price or its own share."""
        if len(shapes) == 0:
            return None
        share = self.share(shapes)
        ranked = np.sort(share, axis=0)
        second = ranked[-2] if len(shapes) > 1 else np.zeros(len(self.xyz))
        loss = np.where(share == ranked[-1], ranked[-1] - second, 0.0).sum(axis=1)
        nearest = np.argmin(np.where(share > 0.0, np.abs(gaps(shapes, self.xyz)), math.inf), axis=0)
        near = np.bincount(nearest[ranked[-1] > 0.0], minlength=len(shapes))
        excess = loss - np.maximum(self.price, OWN * near)
        worst = int(np.argmin(excess))
        return shapes.take(np.arange(len(shapes)) != worst) if excess[worst] < 0.0 else None

    def simplified(self, shapes: Shapes) -> Shapes | None:
        """With a primitive of fewer parameters in place of the first that it explains about as well.

        So a floor is no giant sphere. Where planes are off, what is as well a plane is nothing.
        """
        share = self.share(shapes)
        for i in range(len(shapes)):
            rest = np.delete(share, i, axis=0).max(axis=0, initial=0.0)
            theirs = np.flatnonzero((share[i] > 0.0) & (share[i] >= rest) & np.isfinite(self.normals).all(axis=1))
            before = np.maximum(rest, share[i])[theirs].sum()
            loss = SIMPLER * max(before - rest[theirs].sum(), self.price)
            for kind in (k for k in range(shapes.kinds[i]) if k in self.settings.kinds or k == PLANE):
                simple = self._drawn(kind, theirs)
                share_simple = support(
                    simple, self.xyz[theirs], self.normals[theirs], self.epsilon, math.cos(self.settings.alpha)
                )
                after = np.maximum(rest[theirs], share_simple).sum(axis=1)
                if len(simple) and after.max() > before - loss:
                    others = shapes.take(np.arange(len(shapes)) != i)
                    return (
                        others.joined(simple.take(np.array([int(np.argmax(after))])))
                        if kind in self.settings.kinds
                        else others
                    )
        return None

    def merged(self, shapes: Shapes) -> Shapes | None:
        """With one primitive in place of the first two of a kind that explain as much but for its price.

        Where the two are alike it may explain a little less: a settled web is no one cylinder's, and two explain more.
        """
        share = self.share(shapes)
        gap = np.abs(gaps(shapes, self.xyz))
        won = (share > 0.0) & (share >= share.max(axis=0, initial=0.0))
        across = (won @ np.minimum(gap, 2.0 * NEAR * self.epsilon).T) / np.maximum(won.sum(axis=1), 1)[:, None]
        near = (np.minimum(across, across.T) < NEAR * self.epsilon) & (shapes.kinds == shapes.kinds[:, None])
        alike = np.maximum(across, across.T) < ALIKE * self.epsilon
        for i, j in zip(*np.nonzero(np.triu(near, 1)), strict=True):
            theirs = np.flatnonzero(won[i] | won[j])
            rest = np.delete(share[:, theirs], [i, j], axis=0).max(axis=0, initial=0.0)
            before = np.maximum(rest, share[np.ix_([i, j], theirs)].max(axis=0)).sum()
            few = theirs[spread(len(theirs), 8 * TRIALS)]
            joint = shapes.take(np.array([i, j]))
            for band in (3.0 * self.epsilon, self.epsilon):
                joint = polish(joint, self.xyz[few], self.normals[few], band, self.settings)
            share_joint = support(
                joint, self.xyz[theirs], self.normals[theirs], self.epsilon, math.cos(self.settings.alpha)
            )
            after = np.maximum(rest, share_joint).sum(axis=1)
            loss = max(self.price, SIMPLER * (before - rest.sum())) if alike[i, j] else self.price
            if after.max() > before - loss:
                others = shapes.take(np.delete(np.arange(len(shapes)), [i, j]))
                return others.joined(joint.take(np.array([int(np.argmax(after))])))
        return None

    def _drawn(self, kind: int, among: Ints) -> Shapes:
        """The best few primitives of a kind through minimal sets spread over the points `among`."""
        size = MINIMAL_SETS[kind].size
        if len(among) < size:
            return Shapes(*EMPTY)
        first = spread(len(among), TRIALS)
        sets = among[(first[:, None] + np.arange(size) * (len(among) // size)) % len(among)]
        drawn = through(kind, self.xyz[sets], self.normals[sets], self.settings)
        few = among[spread(len(among), 4 * TRIALS)]
        total = support(drawn, self.xyz[few], self.normals[few], self.epsilon, math.cos(self.settings.alpha)).sum(
            axis=1
        )
        if total.max(initial=0.0) < PROMISING * len(few):
            return Shapes(*EMPTY)
        best = drawn.take(np.argsort(-total, kind="stable")[:3])
        return polish(best, self.xyz[few], self.normals[few], self.epsilon, self.settings)

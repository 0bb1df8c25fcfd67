"""The choice of primitives, by one global criterion: the points left unexplained plus a price for each primitive.

Primitives that are not worth their price go, two that one can replace merge, one that a simpler one can replace is
simplified. Source: Isack and Boykov 2012, "Energy-Based Geometric Multi-model Fitting".
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from segmentation.primitives.minimal_sets import MINIMAL_SETS
from segmentation.ransac.hypotheses import (
    EMPTY,
    Floats,
    Ints,
    Shapes,
    gaps,
    polish,
    polish_on_all,
    spread,
    support,
    through,
)
from segmentation.ransac.settings import Search
from segmentation.ransac.working_cloud import WorkingCloud

CHOICE_POINTS = 6000
SIMPLER = 0.02  # share of what a primitive explains that one with fewer parameters may leave
ALIKE_SURFACES = 2.0  # bands that two primitives may differ by to be one surface, of which both see what misfit leaves
KIN = 4.0  # bands that two primitives may differ by to be pieces of one of another kind, as spheres are of a drum
NEAR_SURFACES = 10.0  # bands that two primitives may differ by, on average over one's points, to be worth merging
OWN = 0.1  # share of the points nearest to a primitive that nothing else may explain; less, and it fits others' misfit
PROMISING = 0.5  # share of a primitive's points that the first guess of a simpler one has to explain
TRIALS = 64  # minimal sets that look for a simpler primitive


def select(
    shapes: Shapes, cloud: WorkingCloud, epsilon: float, price: float, settings: Search, last: bool = False
) -> Shapes:
    """Drop, simplify and merge while that lowers the cells left unexplained plus `price` for each primitive.

    The `last` time also look for primitives of another kind in place of two, which takes longer.
    """
    some = spread(len(cloud), CHOICE_POINTS)
    choice = _Choice(cloud.mean[some], cloud.normal[some], epsilon, price * len(some) / len(cloud), settings)
    judged = choice.judged(shapes)
    ways = (choice.dropped, choice.simplified, choice.merged, *((choice.replaced,) if last else ()))
    while len(judged.shapes):
        for better in ways:
            changed = better(judged)
            if changed is not None:
                judged = changed
                break
        else:
            break
    return judged.shapes


def without_surplus(shapes: Shapes, cloud: WorkingCloud, settings: Search) -> Shapes:
    """Drop what the others explain as well by distance alone: fillets that the normals estimated at edges make."""
    blind = replace(settings, alpha=math.pi / 2)
    choice = _Choice(cloud.mean, cloud.normal, cloud.epsilon, cloud.price, blind)
    judged = choice.judged(shapes)
    while len(judged.shapes) > 1:
        loss = choice.losses(judged)
        worst = int(np.argmin(loss))
        if loss[worst] >= cloud.price:
            break
        judged = judged.without(worst)
    return judged.shapes


@dataclass(frozen=True, eq=False)
class _Judged:
    """Primitives with how well each explains each point and its distance [m], both (k, n)."""

    shapes: Shapes
    share: Floats
    gap: Floats

    def take(self, which: NDArray[np.int64] | NDArray[np.bool_]) -> "_Judged":
        return _Judged(self.shapes.take(which), self.share[which], self.gap[which])

    def without(self, *which: int) -> "_Judged":
        return self.take(np.delete(np.arange(len(self.shapes)), which))

    def joined(self, other: "_Judged") -> "_Judged":
        share, gap = np.concatenate((self.share, other.share)), np.concatenate((self.gap, other.gap))
        return _Judged(self.shapes.joined(other.shapes), share, gap)

    @cached_property
    def best(self) -> tuple[Ints, Floats]:
        """The three primitives that explain each point best (3, n), and how well (3, n)."""
        left, points = self.share.copy(), np.arange(self.share.shape[1])
        who, share = np.full((3, len(points)), -1), np.zeros((3, len(points)))
        for rank in range(min(3, len(left))):
            who[rank] = np.argmax(left, axis=0)
            share[rank] = left[who[rank], points]
            left[who[rank], points] = -1.0
        return who, share

    def rest(self, *but: int) -> Floats:
        """How well the best of the others explains each point (n,), one or two left out."""
        who, share = self.best
        rest: Floats = share[2]
        for rank in (1, 0):
            rest = np.where(np.isin(who[rank], but), rest, share[rank])
        return rest


@dataclass(frozen=True, eq=False)
class _Choice:
    """The points (n, 3) that judge primitives, and the price of one; three methods give a better choice or None."""

    xyz: Floats
    normals: Floats
    epsilon: float
    price: float
    settings: Search

    def judged(self, shapes: Shapes) -> _Judged:
        """The primitives with what the criterion asks of them."""
        return _Judged(shapes, self._support(shapes, slice(None)), np.abs(gaps(shapes, self.xyz)))

    def _support(self, shapes: Shapes, where: Ints | slice) -> Floats:
        return support(shapes, self.xyz[where], self.normals[where], self.epsilon, math.cos(self.settings.alpha))

    def losses(self, now: _Judged) -> Floats:
        """What each primitive (k,) explains that the others do not."""
        (first, _, _), share = now.best
        return np.asarray(np.bincount(first, share[0] - share[1], len(now.shapes)), dtype=np.float64)

    def dropped(self, now: _Judged) -> _Judged | None:
        """Without the primitive that adds least to the others, where that is less than its price or its own share."""
        loss, share = self.losses(now), now.best[1]
        nearest = np.argmin(np.where(now.share > 0.0, now.gap, math.inf), axis=0)
        near = np.bincount(nearest[share[0] > 0.0], minlength=len(now.shapes))
        excess = loss - np.maximum(self.price, OWN * near)
        worst = int(np.argmin(excess))
        return now.without(worst) if excess[worst] < 0.0 else None

    def simplified(self, now: _Judged) -> _Judged | None:
        """With a primitive of fewer parameters in place of the first that it explains about as well.

        So a floor is no giant sphere.
        """
        known = np.isfinite(self.normals).all(axis=1)
        for i, shape in enumerate(now.shapes.kinds):
            rest = now.rest(i)
            theirs = np.flatnonzero((now.share[i] > 0.0) & (now.share[i] >= rest) & known)
            before, rest = now.share[i, theirs].sum(), rest[theirs]
            loss = SIMPLER * max(before - rest.sum(), self.price)
            for kind in (k for k in self.settings.drawn if k < shape):
                simple = self._drawn(kind, theirs)
                after = np.maximum(rest, self._support(simple, theirs)).sum(axis=1)
                if len(simple) and after.max() > before - loss:
                    return now.without(i).joined(self.judged(simple.take(np.array([int(np.argmax(after))]))))
        return None

    def merged(self, now: _Judged) -> _Judged | None:
        """With one primitive in place of the first two of a kind that explain as much but for its price.

        Where the two are alike it may explain a little less: a settled web is no one cylinder's, and two explain more.
        """
        owned, across = self._across(now)
        near = np.minimum(across, across.T) < NEAR_SURFACES * self.epsilon
        alike = np.maximum(across, across.T) < ALIKE_SURFACES * self.epsilon
        pairs = np.argwhere(np.triu(near, 1))
        theirs = [np.flatnonzero(owned[i] | owned[j]) for i, j in pairs]
        joint = self._fitted(now.shapes.take(pairs.ravel()), (points for points in theirs for _ in range(2)))
        for (i, j), points, at in zip(pairs, theirs, range(0, len(joint), 2), strict=True):
            rest = now.rest(i, j)[points]
            before = np.maximum(rest, now.share[[i, j]][:, points].max(axis=0)).sum()
            loss = max(self.price, SIMPLER * (before - rest.sum())) if alike[i, j] else self.price
            both = joint.take(np.array([at, at + 1]))
            after = np.maximum(rest, self._support(both, points)).sum(axis=1)
            if after.max() > before - loss:
                return now.without(i, j).joined(self.judged(both.take(np.array([int(np.argmax(after))]))))
        return None

    def replaced(self, now: _Judged) -> _Judged | None:
        """With one primitive of another kind in place of the first two of a kind that it explains about as well."""
        owned, across = self._across(now)
        for i, j in np.argwhere(np.triu(np.maximum(across, across.T) < KIN * self.epsilon, 1)):
            theirs = np.flatnonzero((owned[i] | owned[j]) & np.isfinite(self.normals).all(axis=1))
            rest = now.rest(i, j)[theirs]
            before = np.maximum(rest, now.share[[i, j]][:, theirs].max(axis=0)).sum()
            loss = max(self.price, SIMPLER * (before - rest.sum()))
            for kind in (k for k in self.settings.drawn if k != now.shapes.kinds[i]):
                other = self._drawn(kind, theirs)
                after = np.maximum(rest, self._support(other, theirs)).sum(axis=1)
                if len(other) and after.max() > before - loss:
                    return now.without(i, j).joined(self.judged(other.take(np.array([int(np.argmax(after))]))))
        return None

    def _across(self, now: _Judged) -> tuple[NDArray[np.bool_], Floats]:
        """Which points each primitive explains best (k, n), and their mean distance [m] from each other one (k, k).

        Far off counts as twice `NEAR`, and so does another kind.
        """
        far = 2.0 * NEAR_SURFACES * self.epsilon
        owned = (now.share > 0.0) & (now.share >= now.best[1][0])
        weight = owned / np.maximum(owned.sum(axis=1), 1)[:, None]
        kinds = now.shapes.kinds
        return owned, np.where(kinds == kinds[:, None], weight @ np.minimum(now.gap, far).T, far)

    def _fitted(self, shapes: Shapes, theirs: Iterable[Ints]) -> Shapes:
        """The primitives fitted to a few of the points of each, in a wide band and then in epsilon."""
        few = [points[spread(len(points), 8 * TRIALS)] for points in theirs]
        if not few:
            return Shapes(*EMPTY)
        at, owner = np.concatenate(few), np.repeat(np.arange(len(few)), [len(points) for points in few])
        for band in (3.0 * self.epsilon, self.epsilon):
            shapes = polish(shapes, self.xyz[at], self.normals[at], owner, band, self.settings)
        return shapes

    def _drawn(self, kind: int, among: Ints) -> Shapes:
        """The best few primitives of a kind through minimal sets spread over the points `among`."""
        size = MINIMAL_SETS[kind].size
        if len(among) < size:
            return Shapes(*EMPTY)
        first = spread(len(among), TRIALS)
        sets = among[(first[:, None] + np.arange(size) * (len(among) // size)) % len(among)]
        drawn = through(kind, self.xyz[sets], self.normals[sets], self.settings)
        few = among[spread(len(among), 4 * TRIALS)]
        total = self._support(drawn, few).sum(axis=1)
        if total.max(initial=0.0) < PROMISING * len(few):
            return Shapes(*EMPTY)
        best = drawn.take(np.argsort(-total, kind="stable")[:3])
        return polish_on_all(best, self.xyz[few], self.normals[few], self.epsilon, self.settings)

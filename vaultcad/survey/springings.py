"""Where arches spring: the level at which the upright face of a jamb, or the ledge of a capital, ends in a soffit.

Of an arch that is all but a semicircle the curve tells little of that: a millimetre of its radius is a centimetre of
its rise. But a soffit is as broad as its arch and the stone below is upright, so that the crease between them is seen
to a centimetre or two, however the whole has settled.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.processes import spread
from vaultcad.survey.plan_grid import Laid
from vaultcad.survey.soffits import SIGMA, Soffit

Array = NDArray[np.float64]

WITHIN = 0.03  # m within a soffit's edges from which on stone is its own
BESIDE = 0.5  # m along the span from the end of a soffit within which its foot is
BELOW, ABOVE = 1.1, 0.45  # m below and above the end of a soffit that are looked at
LAYER, FEWEST = 0.02, 4  # m, height of a layer, and points of one
NEAREST, FACE = 0.1, 0.03  # quantile of what is innermost in a layer, and m about it that is one face
RELIEF = 0.002  # m by which the middle of a layer is unsure besides
JAMB, ABACUS, CURVE = 0.4, 0.13, 0.4  # m of a jamb, a capital's face, and a soffit that are compared
UNDER = ((JAMB, False), (JAMB, True), (ABACUS, True))  # jamb, pier, capital: how deep, and whether it stands out
LEDGE = 0.012, 0.08  # m by which it does
LEAN, CURVED = 0.01, 0.25  # of a jamb, and share of its curvature that a soffit's may differ at its foot
LEANING = 0.5  # share of what its curvature alone makes a soffit lean in that it must at least
STRAY = 9.0  # squared deviations from which on a layer is of something else
UNSEEN = 3.0  # what a layer costs that neither face explains
EXPLAINED = 0.7  # share of the layers of a face, and of a soffit, that a springing must explain
VAGUE = 0.03  # m; a level that is less sure is none
LEAST = 0.004  # m by which each is unsure
FEWEST_LAYERS, LEAST_LAYERS = 12, (4, 8)  # of a face; of a jamb, and of a soffit
COARSE, FINE, UNLIKELY = 0.02, 0.004, 12.0  # m between levels that are tried; what more one costs that is not the best
ROUNDS = 4  # of weights


@dataclass(frozen=True)
class Springing:
    """A place (3,) at which an arch springs [m], and the standard deviation of its level [m]."""

    place: Array
    std: float


def springings(soffits: Sequence[Soffit], laid: Laid) -> tuple[tuple[Springing, ...], ...]:
    """Those that are seen in a scan, of the arch over each soffit."""
    return tuple(spread(lambda n: tuple(_of(soffits[n], laid)), len(soffits)))


def _of(soffit: Soffit, laid: Laid) -> Iterator[Springing]:
    """Of one soffit."""
    along, curvature = np.array([np.cos(soffit.yaw), np.sin(soffit.yaw)]), _curvature(soffit.curve)
    for side in (-1, 1):
        end = side * soffit.length / 2
        middle, reach = soffit.place + end * along, float(np.hypot(BESIDE, soffit.width / 2))
        points = laid.about(middle - reach, middle + reach).astype(np.float64)
        top = float(soffit.height(np.array([end]))[0])
        u, v = soffit.local(points)
        out, height = side * (u - end), points[:, 2] - top
        mine = (np.abs(v) < soffit.width / 2 - WITHIN) & (np.abs(out) < BESIDE) & (height > -BELOW) & (height < ABOVE)
        if (found := _crease(_Face.of(out[mine], height[mine]), curvature)) is not None:
            level, std, foot = found
            yield Springing(np.array([*(middle + side * foot * along), top + level]), std)


def _curvature(curve: Array) -> float:
    """Of the circle nearest to a curve (k, 2) [1/m]."""
    x, z = curve.T
    design = np.column_stack([x, z, np.ones(len(x))])
    (a, b, c), *_ = np.linalg.lstsq(design, x**2 + z**2, rcond=None)
    return float(1 / np.sqrt(max(c + (a**2 + b**2) / 4, 1e-4)))


@dataclass(frozen=True)
class _Face:
    """The innermost face by layers: heights (m,), how far out it is (m,), standard deviations (m,) [m]."""

    height: Array
    out: Array
    std: Array

    @classmethod
    def of(cls, out: Array, height: Array) -> _Face:
        layer = np.floor(height / LAYER).astype(np.int64)
        rows = []
        for k in np.unique(layer):
            mine = out[layer == k]
            face = mine[np.abs(mine - np.quantile(mine, NEAREST)) < FACE]
            if len(face) >= FEWEST:
                middle = float(np.median(face))
                face = mine[np.abs(mine - middle) < FACE]
                spread = SIGMA * float(np.median(np.abs(face - np.median(face))))
                rows.append(((k + 0.5) * LAYER, float(np.median(face)), np.hypot(spread / np.sqrt(len(face)), RELIEF)))
        return cls(*np.array(rows).reshape(-1, 3).T)


@dataclass(frozen=True)
class _Trial:
    """A level, what squared deviations it costs, and how far out a foot there is [m]."""

    level: float
    cost: float
    foot: float


def _crease(face: _Face, curvature: float) -> tuple[float, float, float] | None:
    """Level at which a face begins to lean in, its deviation, and how far out that is [m]; None where none is seen."""
    if len(face.height) < FEWEST_LAYERS:
        return None
    coarse = _tried(face, np.arange(face.height[0] + ABACUS, face.height[-1] - CURVE / 2, COARSE), curvature)
    if not coarse:
        return None
    least = min(one.cost for one in coarse)
    near = [one.level for one in coarse if one.cost < least + UNLIKELY]
    fine = _tried(face, np.arange(min(near) - COARSE, max(near) + COARSE, FINE), curvature)
    level, cost, foot = (np.array([getattr(one, name) for one in fine]) for name in ("level", "cost", "foot"))
    chance = np.exp(-0.5 * (cost - cost.min()))
    chance /= chance.sum()
    middle = float(chance @ level)
    std = float(np.sqrt(chance @ (level - middle) ** 2 + LEAST**2))
    return (middle, std, float(foot[cost.argmin()])) if std < VAGUE else None


def _tried(face: _Face, levels: Array, curvature: float) -> list[_Trial]:
    """Those of the levels (k,) [m] at which a face may end in a soffit, as that of a jamb or of a capital."""
    every = (_trial(face, level, curvature, *below) for level in levels.tolist() for below in UNDER)
    return [one for one in every if one is not None]


def _trial(face: _Face, level: float, curvature: float, deep: float, proud: bool) -> _Trial | None:
    """A level tried: below it the face is straight, above it leans in and bends; None where it does not so.

    deep: how far below it is the same face [m]. proud: whether that stands out.
    """
    above = face.height - level
    mine = (above > -deep) & (above < CURVE)
    over, under = np.maximum(above[mine], 0.0), np.minimum(above[mine], 0.0)
    if (over > 0).sum() < LEAST_LAYERS[1] or (under < 0).sum() < LEAST_LAYERS[0]:
        return None
    columns = [np.ones(len(over)), under, -over, -(over**2) / 2, *([np.where(under < 0, -1.0, 0.0)] if proud else [])]
    design, out, std = np.column_stack(columns).astype(np.float64), face.out[mine], face.std[mine]
    known, told = np.zeros((2, len(columns))), np.array([0.0, 1 / CURVED])  # beforehand, of lean and curvature
    known[0, 1], known[1, 3] = 1 / LEAN, 1 / (CURVED * curvature)
    weight = np.ones(len(out))
    for _ in range(ROUNDS):
        scale = np.sqrt(weight) / std
        rows, values = np.vstack([design * scale[:, None], known]), np.append(out * scale, told)
        found = np.linalg.solve(rows.T @ rows, rows.T @ values)
        off = ((out - design @ found) / std) ** 2
        weight = 1 / (1 + off / STRAY) ** 2
    foot, _, slope, bend, *ledge = found.tolist()
    leaning = slope * CURVE + bend * CURVE**2 / 2
    if slope < 0 or bend < 0 or leaning < LEANING * curvature * CURVE**2 / 2:
        return None
    if ledge and not LEDGE[0] < ledge[0] < LEDGE[1]:
        return None
    if min((off[part] < STRAY).mean() for part in (under < 0, over > 0)) < EXPLAINED:
        return None
    cost = np.minimum(off, STRAY).sum() + UNSEEN * (~mine).sum() + ((known @ found - told) ** 2).sum()
    return _Trial(level, float(cost), foot)

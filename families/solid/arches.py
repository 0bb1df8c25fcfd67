"""Half an arch of a web as one or two rational curves of degree 2, from the ridge to the rib.

Two where it has two arcs: parameters up to `JOINT` are the crown's, those beyond it the haunch's.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_BSplineCurve, Geom_Curve
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array1OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

from families.declaration.profiles import BasketHandle, Elliptical, Pointed, Profile
from families.solid.curves import Path

Array = NDArray[np.float64]
DEGREE = 2
JOINT = 0.5


def half_arches(arch: Profile, ratio: Array, *, steep: bool) -> tuple[Array, Array]:
    """Poles (n, k, 2), across and up by half the span, and weights (n, k) of arches of a kind.

    Args:
        arch: their kind.
        ratio: (n,) their rise by half their span.
        steep: whether they rise more than half their span, all of them.
    """
    crown, foot = _pairs(0.0 * ratio, ratio), _pairs(1.0, 0.0 * ratio)
    if isinstance(arch, BasketHandle) and not steep:
        return _two_arcs(ratio, arch.haunch_ratio, crown, foot)
    size = np.sqrt(1 + ratio**2)
    if isinstance(arch, Elliptical) or (steep and not isinstance(arch, Pointed)):
        middle, weight = _pairs(1.0, ratio), np.full_like(ratio, sqrt(0.5))
    elif steep:
        middle, weight = _pairs(1.0, size**2 / (2 * ratio)), ratio / size
    else:
        middle, weight = _pairs(size**2 / 2, ratio), 1 / size
    return _rows(crown, middle, foot), _rows(1.0, weight, 1.0, count=len(ratio))


def _two_arcs(ratio: Array, haunch: float, crown: Array, foot: Array) -> tuple[Array, Array]:
    small = haunch * ratio
    large = (1 + ratio**2 - 2 * small) / (2 * (ratio - small))
    across, up = 1 - small, large - ratio  # from the centre of the large arc to that of the small one
    size = np.hypot(across, up)
    joint = _pairs(large * across / size, ratio - large + large * up / size)
    tops, sides = across / (size + up), up / (size + across)  # tangents of a quarter of what either arc turns by
    poles = crown, _pairs(large * tops, ratio), joint, _pairs(1.0, small * sides), foot
    weights = 1.0, 1 / np.sqrt(1 + tops**2), 1.0, 1 / np.sqrt(1 + sides**2), 1.0
    return _rows(*poles), _rows(*weights, count=len(ratio))


def _pairs(u: Array | float, z: Array) -> Array:
    return _rows(u, z, count=len(z))


def _rows(*columns: Array | float, count: int = 0) -> Array:
    """Columns, (n,) or (n, k) or `count` times a number, side by side, as `np.stack` puts them, but at once."""
    first = np.asarray(columns[0])
    found = np.empty((count or len(first), len(columns), *first.shape[1:]))
    for k, column in enumerate(columns):
        found[:, k] = column
    return found


def arch_parameters(poles: Array, weights: Array, places: Array) -> Array:
    """Parameters (n,) of places (n, 2), each on one of as many arches: by how far it is along the chord."""
    way = poles[:, -1] - poles[:, 0]
    along = np.einsum("nkx,nx->nk", poles, way)
    here = np.clip(np.einsum("nx,nx->n", places, way), along[:, 0], along[:, -1])  # rounding would leave no root
    arcs = poles.shape[1] // DEGREE
    arc = (here > along[:, DEGREE]).astype(int) if arcs > 1 else np.zeros(len(here), int)
    own = DEGREE * arc[:, None] + np.arange(DEGREE + 1)
    first, middle, last = (np.take_along_axis(weights * (along - here[:, None]), own, axis=1)).T
    # first (1 - t)² + 2 middle t (1 - t) + last t² = 0, by the root that loses no digits.
    root = np.sqrt(np.maximum(middle**2 - first * last, 0.0))
    late, early = np.where(middle > 0, (-first, middle + root), (root - middle, last))
    found: Array = (arc + np.clip(late / (late + early), 0.0, 1.0)) / arcs
    return found


def knots(count: int) -> tuple[TColStd_Array1OfReal, TColStd_Array1OfInteger]:
    """Knots of half an arch of so many poles, and how often each counts."""
    at = [0.0, 1.0] if count == DEGREE + 1 else [0.0, JOINT, 1.0]
    values, times = TColStd_Array1OfReal(1, len(at)), TColStd_Array1OfInteger(1, len(at))
    times.Init(DEGREE)
    for k, value in enumerate(at, 1):
        values.SetValue(k, value)
    for end in (1, len(at)):
        times.SetValue(end, DEGREE + 1)
    return values, times


@dataclass(frozen=True, eq=False)
class HalfArch(Path):
    """One of them in space: poles (k, 3) [mm] and weights (k,)."""

    poles: Array
    weights: Array

    @cached_property
    def geometry(self) -> Geom_Curve:
        """Rational B-spline curve."""
        count = len(self.poles)
        poles, weights = TColgp_Array1OfPnt(1, count), TColStd_Array1OfReal(1, count)
        for k, (pole, weight) in enumerate(zip(self.poles.tolist(), self.weights.tolist(), strict=True), 1):
            poles.SetValue(k, gp_Pnt(*pole))
            weights.SetValue(k, weight)
        return Geom_BSplineCurve(poles, weights, *knots(count), DEGREE)

    def points(self, t: Array) -> Array:
        """Points (n, 3) at parameters (n,)."""
        arcs = len(self.poles) // DEGREE
        arc = np.clip((t * arcs).astype(int), 0, arcs - 1)
        s = t * arcs - arc
        own = DEGREE * arc[:, None] + np.arange(DEGREE + 1)
        basis = np.stack([(1 - s) ** 2, 2 * s * (1 - s), s**2], axis=1) * self.weights[own]
        found: Array = np.einsum("nk,nkx->nx", basis, self.poles[own]) / basis.sum(axis=1)[:, None]
        return found

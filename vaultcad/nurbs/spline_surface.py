"""A free surface as a non-rational B-spline in space: control points and knots, as CAD and nurbs.json hold them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline

from vaultcad.nurbs.meeting import FreeSurface

Array = NDArray[np.float64]
DEGREE = 3
LEAST_SPANS = 4


@dataclass(frozen=True, eq=False)
class SplineSurface:
    """Bicubic. knots_u, knots_v: clamped, with their repetitions [m]. points: (n, m, 3) control points [m]."""

    knots_u: Array
    knots_v: Array
    points: Array

    def __call__(self, u: Array, v: Array) -> Array:
        """Places (n, 3) [m]."""
        rows = [_design(knots, x) for knots, x in ((self.knots_u, u), (self.knots_v, v))]
        found: Array = np.einsum("ka,kb,abc->kc", *rows, self.points)
        return found


def spline_surface(surface: FreeSurface, low: Array, high: Array) -> SplineSurface:
    """The surface between two corners (2,) of its chart, interpolated on its own knots.

    Between them the chart's turns are followed to some micrometres, as knots are nearer than a tenth of their radii.
    """
    knots = [_clamped(surface.field.knots(axis, low[axis], high[axis]), low[axis], high[axis]) for axis in (0, 1)]
    u, v = (_greville(row) for row in knots)
    places = surface.chart.place(*_on_surface(surface, np.repeat(u, len(v)), np.tile(v, len(u))))
    grid = places.reshape(len(u), len(v), 3)
    first = np.linalg.solve(_design(knots[0], u), grid.reshape(len(u), -1)).reshape(grid.shape)
    second = np.linalg.solve(_design(knots[1], v), first.swapaxes(0, 1).reshape(len(v), -1))
    points: Array = np.asarray(second.reshape(len(v), len(u), 3).swapaxes(0, 1), np.float64)
    return SplineSurface(knots[0], knots[1], points)


def _on_surface(surface: FreeSurface, u: Array, v: Array) -> tuple[Array, Array, Array]:
    return u, v, surface.field(u, v)


def _clamped(inner: Array, low: float, high: float) -> Array:
    """Knots with those within, at least so many that a curve can turn."""
    if len(inner) < LEAST_SPANS - 1:
        inner = np.linspace(low, high, LEAST_SPANS + 1)[1:-1]
    return np.concatenate([[low] * (DEGREE + 1), inner, [high] * (DEGREE + 1)])


def _greville(knots: Array) -> Array:
    """The places of the control points (Greville abscissae)."""
    found: Array = np.lib.stride_tricks.sliding_window_view(knots[1:-1], DEGREE).mean(axis=1)
    return np.clip(found, knots[0], knots[-1])


def _design(knots: Array, x: Array) -> Array:
    found: Array = BSpline.design_matrix(np.clip(x, knots[0], knots[-1]), knots, DEGREE).toarray()
    return found

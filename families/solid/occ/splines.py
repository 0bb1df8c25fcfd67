"""B-splines as OpenCASCADE takes them."""

from __future__ import annotations

from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

Array = NDArray[np.float64]


def spline_data(
    knots: Array, poles: Array, degree: int, array: Any, made: Any
) -> tuple[Any, TColStd_Array1OfReal, TColStd_Array1OfInteger, int]:
    """A spline that ends at its first and last pole: what the constructors of curves take.

    knots: (n + degree + 1,), with their repetitions. poles: (n, 2) or (n, 3); array and made: OpenCASCADE's classes of
    a row of such points, and of one.
    """
    places = array(1, len(poles))
    for k, pole in enumerate(poles.tolist(), 1):
        places.SetValue(k, made(*pole))
    return places, *counted(knots), degree


def bspline_surface(knots_u: Array, knots_v: Array, poles: Array, degree: int) -> Geom_BSplineSurface:
    """A surface, not rational, of one degree both ways. knots: with their repetitions. poles: (n, m, 3)."""
    n, m, _ = poles.shape
    places = TColgp_Array2OfPnt(1, n, 1, m)
    for i, row in enumerate(poles.tolist(), 1):
        for j, pole in enumerate(row, 1):
            places.SetValue(i, j, gp_Pnt(*pole))
    (u, times_u), (v, times_v) = counted(knots_u), counted(knots_v)
    return Geom_BSplineSurface(places, u, v, times_u, times_v, degree, degree)


def counted(knots: Array) -> tuple[TColStd_Array1OfReal, TColStd_Array1OfInteger]:
    """Knots of a spline, each once, and how often each counts."""
    found = [(value, len(list(same))) for value, same in groupby(knots.tolist())]
    once, times = TColStd_Array1OfReal(1, len(found)), TColStd_Array1OfInteger(1, len(found))
    for k, (value, count) in enumerate(found, 1):
        once.SetValue(k, value)
        times.SetValue(k, count)
    return once, times

"""Curves on roofs, laid through so many of their places that they are near enough to the roofs between these."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from families.declaration.units import MM
from families.solid.curves import Spline
from families.solid.heights import stray
from families.solid.splines import DEGREE, spread

Array = NDArray[np.float64]
LOOKED = np.linspace(0, 1, 257)  # where a curve is looked at before it is laid
NODES = 49, 97, 193, 385  # places through which it is laid, so many that it is near enough
NEAR_ENOUGH = 2e-8  # [m] that it may be off the surfaces between these
ONE_PLACE = 1e-12  # [m], places of a curve nearer than that are one


def laid(points: Callable[[Array], Array], roofs: Array, row: int) -> Spline | None:
    """A curve [mm] on a roof, by its points (n, 3) [m] at shares (n,) of it; None where it cannot be followed.

    It is laid through so many that it is near enough to the roof between them.
    """
    there = points(LOOKED)
    if np.isnan(there).any():
        return None
    for count in NODES:
        nodes = points(spread(there, LOOKED, count))
        if np.isnan(nodes).any():
            return None
        nodes = _distinct(nodes)
        spline = Spline.through(MM * nodes)
        between = spline.points((spline.nodes[1:] + spline.nodes[:-1]) / 2) / MM
        if stray(between, roofs, row) < NEAR_ENOUGH:
            break
    return spline


def _distinct(nodes: Array) -> Array:
    """Places (n, 3) [m] but for those at the next one; evenly along the chord where too few are left for a spline.

    Lines that end where a roof stands upright may be shorter than a millimetre.
    """
    kept = nodes[np.append(np.abs(np.diff(nodes, axis=0)).max(axis=1) > ONE_PLACE, True)]
    return kept if len(kept) > DEGREE else np.linspace(nodes[0], nodes[-1], DEGREE + 1)

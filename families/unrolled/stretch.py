"""How much longer or shorter a sheet shows what is on a surface."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from families.unrolled.patches import Array

if TYPE_CHECKING:
    from shapely import Geometry

NET = 24  # of the net on which it is measured, either way
STEP = 1e-4  # of the differences that measure it, as a share of what is measured
POLE = 1e-12  # squared sine of the angle between lines below which they run together

Map = Callable[[Array, Array], Array]


def measured(place: Map, flat: Map, area: Geometry) -> tuple[Array, Array]:
    """Errors (n,) of short lengths in any direction over a net on an area of coordinates, and the areas (n,) [m²]."""
    import shapely

    a0, b0, a1, b1 = area.bounds
    share = (np.arange(NET) + 0.5) / NET
    a, b = (grid.ravel() for grid in np.meshgrid(a0 + (a1 - a0) * share, b0 + (b1 - b0) * share, indexing="ij"))
    inside = shapely.contains_xy(area, a, b)
    a, b, da, db = a[inside], b[inside], STEP * (a1 - a0), STEP * (b1 - b0)
    ways = [(of(a + da, b) - of(a - da, b), of(a, b + db) - of(a, b - db)) for of in (place, flat)]
    errors, areas = _errors(*ways)
    return errors, areas / (2 * STEP * NET) ** 2


def net_errors(nodes: Array, laid: Array) -> tuple[Array, Array]:
    """The same (n - 1, m - 1) in the cells of a net of nodes (n, m, 3) that is laid flat (n, m, 2)."""
    ways = []
    for net in (nodes, laid):
        up, side = np.diff(net, axis=0), np.diff(net, axis=1)
        ways.append(((up[:, 1:] + up[:, :-1]) / 2, (side[1:] + side[:-1]) / 2))
    return _errors(*ways)


def largest(errors: Array, areas: Array, spared: float) -> float:
    """The largest of errors (n,) but for the worst ones on a share of the area."""
    if not len(errors):
        return 0.0
    order = np.argsort(-errors, kind="stable")
    passed = np.cumsum(areas[order])
    return float(errors[order[np.searchsorted(passed, spared * passed[-1], side="right").clip(0, len(order) - 1)]])


def _errors(surface: tuple[Array, Array], sheet: tuple[Array, Array]) -> tuple[Array, Array]:
    """From two directions (..., 3) and where they lie (..., 2): the largest error of lengths, and the area between.

    The stretches are roots of the eigenvalues of one metric by the other. Where both directions run together, as at a
    pole, nothing can be told, and lengths pass for true.
    """
    (e, f, g), (p, q, r) = ([(x * y).sum(axis=-1) for x, y in ((u, u), (u, v), (v, v))] for u, v in (surface, sheet))
    square = np.maximum(e * g - f * f, 0.0)
    known = square > POLE * e * g
    det = np.where(known, square, 1.0)
    half = np.where(known, (p * g - 2 * q * f + r * e) / det / 2, 1.0)
    product = np.where(known, (p * r - q * q) / det, 1.0)
    spread = np.sqrt(np.maximum(half**2 - product, 0.0))
    least, most = np.sqrt(np.maximum(half - spread, 0.0)), np.sqrt(half + spread)
    return np.maximum(most - 1, 1 - least), np.sqrt(square)

"""Where the gores of a vault lie on one sheet: as in plan, seen from above, and as far apart as they need to be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, sin
from typing import TYPE_CHECKING

import numpy as np

from families.unrolled.gores import Chart
from families.unrolled.patches import Array

if TYPE_CHECKING:
    from shapely import Geometry

GAP = 0.1  # [m] between gores
NET = 9  # points either way, by which a gore is turned as it lies in plan
ROUND = 0.3  # of a gore's turn in plan: one that is about as much turned either way is a band all round
APART = 1.06  # by which gores are moved apart, until they are
FARTHEST = 6.0  # times as far from the middle as in plan; what then still overlaps is put below
LAID = 0.01  # [m] by which outlines are simplified to see whether they overlap


@dataclass(frozen=True, eq=False)
class Placement:
    """A rotation by `turn` [rad] about the sheet's origin, then a shift [m]."""

    turn: float
    shift: tuple[float, float]

    def placed(self, st: Array) -> Array:
        """Places (n, 2) of a gore on the common sheet."""
        c, s = cos(self.turn), sin(self.turn)
        return np.stack([c * st[:, 0] - s * st[:, 1], s * st[:, 0] + c * st[:, 1]], axis=1) + self.shift

    def back(self, st: Array) -> Array:
        """And back."""
        c, s, moved = cos(self.turn), sin(self.turn), st - self.shift
        return np.stack([c * moved[:, 0] + s * moved[:, 1], c * moved[:, 1] - s * moved[:, 0]], axis=1)


@dataclass
class _Item:
    """A gore turned as in plan, about its own middle; where that is in plan, from the vault's [m]."""

    outline: Geometry
    turn: float
    middle: Array  # (2,) of the gore on its own sheet, turned
    plan: Array  # (2,)
    band: bool


def layout(charts: Sequence[Chart], centre: tuple[float, float]) -> list[Placement]:
    """Places for all gores of a vault about a centre in plan, no two nearer than `GAP`; bands lie in a row below."""
    import shapely

    items = [_item(chart, centre) for chart in charts]
    about = [k for k, item in enumerate(items) if not item.band]
    shifts, left = _apart([items[k] for k in about])
    moved = {k: shift for k, shift in zip(about, shifts, strict=True) if shift is not None}
    laid = [shapely.transform(items[k].outline, lambda xy, k=k: xy + moved[k]) for k in moved]  # type: ignore[misc]  # bound now
    x0, foot, *_ = shapely.total_bounds(laid) if laid else (0.0, 0.0)
    for k in [k for k in range(len(items)) if k not in moved]:
        low_x, low_y, _, high_y = items[k].outline.bounds
        moved[k] = np.array([x0 - low_x, foot - GAP - high_y])
        foot -= GAP + high_y - low_y
    del left
    return [
        Placement(item.turn, (float(moved[k][0] - item.middle[0]), float(moved[k][1] - item.middle[1])))
        for k, item in enumerate(items)
    ]


def _item(chart: Chart, centre: tuple[float, float]) -> _Item:
    import shapely

    area = chart.region.area
    a0, b0, a1, b1 = area.bounds
    share = (np.arange(NET) + 0.5) / NET
    a, b = (grid.ravel() for grid in np.meshgrid(a0 + (a1 - a0) * share, b0 + (b1 - b0) * share))
    inside = shapely.contains_xy(area, a, b)
    if inside.any():
        a, b = a[inside], b[inside]
    sheet, plan = chart.development.flat(a, b), chart.region.patch.place(a, b)[:, :2]
    (s, t), (x, y) = (sheet - sheet.mean(axis=0)).T, (plan - plan.mean(axis=0)).T
    along, across = float(s @ x + t @ y), float(s @ y - t @ x)
    band = hypot(along, across) < ROUND * float(np.sqrt((s @ s + t @ t) * (x @ x + y @ y)))
    turn = 0.0 if band else atan2(across, along)
    turned = Placement(turn, (0.0, 0.0))
    middle = turned.placed(sheet.mean(axis=0)[None])[0]
    outline = shapely.transform(shapely.simplify(chart.outline, LAID), lambda st: turned.placed(st) - middle)
    return _Item(outline, turn, middle, plan.mean(axis=0) - centre, band)


def _apart(items: Sequence[_Item]) -> tuple[list[Array | None], int]:
    """Shifts (2,) of gores, as far from the middle as they need, along x and y for themselves; None: there is none."""
    import shapely

    outlines, plans = [item.outline for item in items], np.array([item.plan for item in items]).reshape(-1, 2)

    def close(factor: tuple[float, float]) -> set[tuple[int, int]]:
        laid = [shapely.transform(one, lambda xy, p=p: xy + p) for one, p in zip(outlines, plans * factor, strict=True)]  # type: ignore[misc]  # bound now
        first, second = shapely.STRtree(laid).query(laid, predicate="dwithin", distance=GAP)
        return {(i, j) for i, j in zip(first.tolist(), second.tolist(), strict=True) if i < j}

    factor = 1.0
    while (pairs := close((factor, factor))) and factor < FARTHEST:
        factor *= APART
    # What still overlaps has one middle: the later ones go.
    gone = {j for _, j in pairs}
    factors = [factor, factor]
    if not gone:
        for axis in (1, 0):
            while factors[axis] > 1.0:
                tried = list(factors)
                tried[axis] = max(1.0, tried[axis] / APART)
                if close((tried[0], tried[1])):
                    break
                factors = tried
    return [None if k in gone else plan * factors for k, plan in enumerate(plans)], len(gone)

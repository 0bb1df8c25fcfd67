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
ROUND = 0.65  # of a gore's turn in plan: one that is about as much turned either way is a band all round
APART = 1.06  # by which gores are moved apart, until they are
CROWDED = 2.6  # times as far from the middle as in plan, from which on each may better be moved for itself
STEP, ALONE = 0.08, 60.0  # [m] of the steps by which it then is moved, and how far at the most
FARTHEST = 6.0  # times as far from the middle as in plan at the most
MIDDLE = 1e-3  # [m] from the middle in plan within which there is no way out of it
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
    from shapely.affinity import translate

    items = [_item(chart, centre) for chart in charts]
    about = [k for k, item in enumerate(items) if not item.band]
    shifts = _apart([items[k] for k in about])
    moved = {k: shift for k, shift in zip(about, shifts, strict=True) if shift is not None}
    laid = [translate(items[k].outline, *shift) for k, shift in moved.items()]
    x0, foot = shapely.total_bounds(laid)[:2].tolist() if laid else (0.0, 0.0)
    for k in [k for k in range(len(items)) if k not in moved]:
        low_x, low_y, _, high_y = items[k].outline.bounds
        moved[k] = np.array([x0 - low_x, foot - GAP - high_y])
        foot -= GAP + high_y - low_y
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


def _apart(items: Sequence[_Item]) -> list[Array | None]:
    """Shifts (2,) of gores, all as many times as far from the middle as in plan; along x and y for themselves.

    Where that would spread them over much more than they cover, each goes out for itself, the nearest first. None: of
    several in the middle, all but the first.
    """
    import shapely
    from shapely.affinity import translate

    plans = [item.plan for item in items]

    def close(factors: Sequence[float]) -> bool:
        laid = [translate(item.outline, *(item.plan * factors)) for item in items]
        pairs = shapely.STRtree(laid).query(laid, predicate="dwithin", distance=GAP)
        return bool(pairs.shape[1] > len(laid))  # each is near itself

    factor = 1.0
    while (still := close((factor, factor))) and factor < FARTHEST:
        factor *= APART
    factors = [factor, factor]
    for axis in (1, 0) if not still else ():
        while factors[axis] > 1.0:
            tried = [max(1.0, f / APART) if k == axis else f for k, f in enumerate(factors)]
            if close(tried):
                break
            factors = tried
    together: list[Array | None] = [plan * factors for plan in plans]
    if factor < CROWDED:
        return together
    alone = _outwards(items)
    return alone if still or _covered(items, alone) < _covered(items, together) else together


def _covered(items: Sequence[_Item], shifts: Sequence[Array | None]) -> float:
    """The area of the box about all [m²]."""
    import shapely
    from shapely.affinity import translate

    laid = [translate(item.outline, *shift) for item, shift in zip(items, shifts, strict=True) if shift is not None]
    x0, y0, x1, y1 = shapely.total_bounds(laid).tolist()
    return float((x1 - x0) * (y1 - y0))


def _outwards(items: Sequence[_Item]) -> list[Array | None]:
    import shapely
    from shapely.affinity import translate

    found: list[Array | None] = [None] * len(items)
    laid: list[Geometry] = []
    for k in sorted(range(len(items)), key=lambda k: (round(float(np.hypot(*items[k].plan)), 6), k)):
        reach = float(np.hypot(*items[k].plan))
        way = items[k].plan / reach if reach > MIDDLE else None
        steps = np.arange(0.0, ALONE, STEP) if way is not None else (0.0,)
        for step in steps:
            shift = items[k].plan + (0.0 if way is None else step * way)
            there = translate(items[k].outline, *shift)
            if not laid or not shapely.dwithin(there, laid, GAP).any():
                found[k] = shift
                laid.append(there)
                break
    return found

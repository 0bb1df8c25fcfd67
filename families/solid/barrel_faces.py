"""The surfaces of barrels and of a level ceiling in one cell of the plan, cut where they meet.

In a cell a barrel shows one side of its axis. At most one runs each way: of two pieces the higher shows, of two barrels
of one piece the lower. Their groin parts the cell, and each arc of a barrel shows in one strip of its part.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Piece
from families.declaration.units import MM
from families.solid.barrel_slopes import SAME_HEIGHT, GroinLine, Slope, groin, placed, turning
from families.solid.boundary import Loop, Step
from families.solid.curves import Point, Simple, Spline, Straight
from families.solid.plan_cells import SAME_CUT, Cell
from families.solid.surfaces import Drawn, Flat, Sheet, Translated
from families.solid.visible_sides import VisibleSides, parted, scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Web:
    """A surface within a loop; its normal points away from the void, or into it if `inwards`."""

    sheet: Sheet
    loop: Loop
    inwards: bool = False


def webs(pieces: tuple[Piece, ...], cell: Cell, sides: tuple[float, float]) -> Iterator[Web]:
    """The surfaces above the ground that pieces of barrels and ceilings show within a cell.

    `sides` are the half extents [m] of a plan on whose sides walls show too, and not only within.
    """
    here = scene(pieces, cell, sides)
    for across, slope in here.slopes.items():
        if (place := turning(slope)) is not None:
            yield from (web for part in parted(cell, across, slope.at(place)) for web in webs(pieces, part, sides))
            return
    both = [here.slopes[across] for across in here.slopes]
    line, curves = GroinLine(), []
    if len(both) == 2:
        line = groin(both[0], both[1], here.ceiling)
        curves = placed(line, both[0], both[1])
    for k, slope in enumerate(both):
        own, other = ([knot[j] for knot in line.knots] for j in (k, 1 - k))
        yield from _Half(here, slope, own, other, line.heights, curves).webs()
    yield from _ceiling(here)


@dataclass(frozen=True)
class _Half:
    """One of the barrels of a scene, u across it and v along it; `own` and `other` are u and v of the groin's knots.

    Without a barrel that crosses it, v is the coordinate along it.
    """

    scene: VisibleSides
    slope: Slope
    own: list[float]
    other: list[float]
    heights: tuple[float, ...]
    curves: list[Spline]

    @property
    def cross(self) -> Slope | None:
        return self.scene.cross(self.slope.part.across)

    def webs(self) -> Iterator[Web]:
        for start, end in pairwise(self._cuts()):
            if (strip := self._strip(start, end)) is not None:
                yield strip
            if self._behind is not None:
                arc, (near, far) = self._sheet(self.slope.bow((start + end) / 2)), self._behind
                loop = [*self._arches(start, end, near), self._ruling(arc, end, near, far)]
                yield Web(arc, [*loop, *self._arches(end, start, far), self._ruling(arc, start, far, near)])
        if self.scene.walled(self.slope):
            yield from self._wall()

    @property
    def _behind(self) -> tuple[float, float] | None:
        """Where there is only this barrel, behind the wall of one that rises towards that."""
        cross = self.cross
        if self.scene.lower or cross is None or cross.falls or self.scene.end(cross) - cross.far < SAME_CUT:
            return None
        return cross.far, self.scene.end(cross)

    def _cuts(self) -> list[float]:
        """Where strips end, in rising order of u."""
        slope = self.slope
        cuts = {*slope.breaks, *self.own[:1], *self.own[-1:]}
        if slope.level_at(slope.high) > self.scene.ceiling + SAME_HEIGHT:
            top = slope.place_of(self.scene.ceiling)
            cuts = {top, *(u for u in cuts if u > top)}
        return sorted(cuts)

    def _strip(self, start: float, end: float) -> Web | None:
        """The surface of one arc between two places; a groin bounds all of it or none."""
        middle = (start + end) / 2
        arc = self._sheet(self.slope.bow(middle))
        beyond, bound = self._range(middle)
        if bound is not None and abs(bound - beyond) < SAME_CUT:
            return None
        if bound is None:
            first, last = (self.other[self._knot(u)] for u in (start, end))
            near = self._along_groin(start, end)
        else:
            first = last = bound
            near = self._arches(start, end, bound)
        loop = [*near, self._ruling(arc, end, last, beyond), *self._arches(end, start, beyond)]
        loop.append(self._ruling(arc, start, beyond, first))
        return Web(arc, loop)

    def _range(self, u: float) -> tuple[float, float | None]:
        """The two ends in v of what shows over u, the second None if that is the groin."""
        if self.cross is None:
            low, high = self.scene.cell.side("y" if self.slope.part.across == "x" else "x")
            return high, low
        level = self.slope.level_at(u)
        beyond = self.cross.high if self.scene.lower else self._last()
        if level >= self.cross.level_at(self.cross.high):
            return beyond, self.cross.high
        return beyond, self.cross.low if level <= self.cross.level_at(self.cross.low) else None

    def _last(self) -> float:
        """The v where the higher barrel ends: behind the wall of the other one there is only this."""
        cross = self.cross
        assert cross is not None
        end = self.scene.end(cross)
        return end if cross.falls and end - cross.far > SAME_CUT else cross.low

    def _knot(self, u: float) -> int:
        return int(np.abs(np.array(self.own) - u).argmin())

    def _along_groin(self, start: float, end: float) -> Loop:
        first, last = self._knot(start), self._knot(end)
        steps = [Step(curve, 0.0, curve.end) for curve in self.curves[min(first, last) : max(first, last)]]
        return steps if first < last else [step.reversed for step in steps[::-1]]

    def _sheet(self, bow: int) -> Drawn | Translated:
        kind = Translated if self.slope.part.crown_rise else Drawn
        return kind(self.slope.side, self.slope.whole[bow])

    def _along(self, v: float) -> float:
        """Coordinate along the barrel [m]."""
        return v if self.cross is None else self.cross.at(v)

    def _point(self, u: float, v: float, height: float | None = None) -> Point:
        """Point [mm] on the barrel, or at another height [m] above u, v."""
        across, along = MM * self.slope.at(u), MM * self._along(v)
        z = MM * (self._height(u, v) if height is None else height)
        return (across, along, z) if self.slope.part.across == "x" else (along, across, z)

    def _height(self, u: float, v: float) -> float:
        """Height [m] of the barrel above u, v."""
        if u in self.own:
            # At a knot of the groin by that: near an upright wall the height is lost in the place.
            knots = zip(self.own, self.other, self.heights, strict=True)
            for z in (z for a, b, z in knots if a == u and b == v):
                return z
        part = self.slope.part
        return part.base + self.slope.height(u) + part.lift(self._along(v))

    def _arches(self, start: float, end: float, v: float) -> Loop:
        """Along the profile at v, from u to u, arc by arc."""
        low, high = sorted((start, end))
        stops = [low, *sorted(u for u in self.slope.breaks if low + SAME_CUT < u < high - SAME_CUT), high]
        steps = []
        for a, b in pairwise(stops if start < end else stops[::-1]):
            path = self._sheet(self.slope.bow((a + b) / 2)).arch(self._along(v))
            steps.append(_step(path, self._point(a, v), self._point(b, v)))
        return steps

    def _ruling(self, arc: Drawn | Translated, u: float, start: float, end: float) -> Step:
        path = arc.ruling(u, self.slope.height(u))
        return _step(path, self._point(u, start), self._point(u, end))

    def _wall(self) -> Iterator[Web]:
        """The upright plane below the springing, where it stands within the cell, as far as it shows."""
        slope, part, cross = self.slope, self.slope.part, self.cross
        foot, u = part.base + slope.height(slope.far), slope.far
        if foot + part.crown_rise < SAME_CUT:
            return
        sheet = Flat(slope.side.axis, MM * self.scene.wall(slope))
        top = self._sheet(slope.bow(u))
        loop: Loop
        for first, last in filter(None, (self._range(u)[::-1] if cross is None else None, self._behind)):
            assert first is not None
            loop = [self._ruling(top, u, first, last), self._plumb(last, None, 0.0), self._ground(last, first)]
            yield Web(sheet, [*loop, self._plumb(first, 0.0, None)], slope.sign < 0)
        if cross is None:
            return
        side = _Half(self.scene, cross, self.other, self.own, self.heights, self.curves)
        last, bound = self._range(u)
        met = self.other[self._knot(u)] if bound is None else bound
        if self.scene.lower:
            # Below both barrels, from the crown of the other one to its wall.
            loop = [self._ruling(top, u, cross.high, met)] if abs(met - cross.high) > SAME_CUT else []
            loop += side._arches(met, cross.low, u)
            first, last = (min(side._height(v, u), self._height(u, v)) for v in (cross.high, cross.low))
            loop += [self._plumb(cross.low, last, 0.0), self._ground(cross.low, cross.high)]
            loop.append(self._plumb(cross.high, 0.0, first))
        else:
            # Above the other barrel as far as that reaches, then down to the ground.
            if abs(met - last) < SAME_CUT:
                return
            loop = [self._ruling(top, u, met, last)]
            if abs(last - cross.low) < SAME_CUT:
                loop.append(self._plumb(last, None, side._height(last, u)))
            else:
                loop += [self._plumb(last, None, 0.0), self._ground(last, cross.low)]
                if abs(met - cross.low) > SAME_CUT:
                    loop.append(self._plumb(cross.low, 0.0, side._height(cross.low, u)))
            if abs(met - cross.low) > SAME_CUT:
                loop += side._arches(cross.low, met, u)
                loop.append(self._plumb(met, side._height(met, u), None))
            else:
                loop.append(self._plumb(met, 0.0, None))
        yield Web(sheet, loop, slope.sign < 0)

    def _plumb(self, v: float, start: float | None, end: float | None) -> Step:
        """Along the wall's plumb line at v, between two heights [m]; None is the springing."""
        first, last = (self._point(self.slope.far, v, height) for height in (start, end))
        return _step(Straight.through(first, 2), first, last)

    def _ground(self, start: float, end: float) -> Step:
        first, last = (self._point(self.slope.far, v, 0.0) for v in (start, end))
        return _step(Straight.through(first, 1 - self.slope.side.axis), first, last)


def _ceiling(scene: VisibleSides) -> Iterator[Web]:
    """The level plane, as far as the barrels stand higher."""
    if scene.ceiling == inf:
        return
    sides = []
    for across in ("x", "y"):
        slope = scene.slopes.get(across)
        if slope is None:
            sides.append(scene.cell.side(across))
        elif slope.level_at(slope.high) > scene.ceiling + SAME_HEIGHT:
            sides.append((slope.at(slope.near), slope.at(slope.place_of(scene.ceiling))))
        else:
            return
    (x0, x1), (y0, y1) = sides
    corners = [(MM * x, MM * y, MM * scene.ceiling) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    paths = [Straight.through(corner, k % 2) for k, corner in enumerate(corners)]
    steps = zip(paths, corners, [*corners[1:], corners[0]], strict=True)
    yield Web(Flat(2, MM * scene.ceiling), [_step(*step) for step in steps])


def _step(path: Simple, start: Point, end: Point) -> Step:
    return Step(path, path.parameter(start), path.parameter(end))

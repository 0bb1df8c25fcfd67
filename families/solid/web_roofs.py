"""Webs between ribs as roofs: doubly curved, in halves that meet in the ridge.

Across they are rational curves of degree 2, exactly; towards the wall the poles of these follow the angle of the
diagonals, by which they are smooth enough for splines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from math import hypot

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_BSplineSurface, Geom_Surface
from OCP.Geom2d import Geom2d_Curve
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array2OfReal
from scipy.optimize import brentq

from families.declaration.pieces import Piece, Web
from families.declaration.plan_sides import Vector
from families.declaration.units import MM
from families.solid import arches
from families.solid.arches import HalfArch, arch_parameters, half_arches
from families.solid.boundary import Step
from families.solid.curves import Conic, Path, Point, Spline, drawn
from families.solid.heights import WEB, WIDTH
from families.solid.occ.splines import counted
from families.solid.plan_cells import SAME_PLACE, Cut, Way
from families.solid.roofs import NOTHING, Roof
from families.solid.splines import DEGREE, interpolated
from families.solid.surfaces import UP, Sheet
from families.void import body_table, webs
from families.void.profile_outline import Bow, half_outline

Array = NDArray[np.float64]
NODES = 21  # towards the wall
LOOKS = 400  # places at which the kind of the arch is looked at
STRAIGHT = 1e-9  # [m]
ROUNDING = 1e-13  # of a cosine
AT_CENTRE = 1e-6  # of the way to the wall
BESIDE_CENTRE = 1e-4  # likewise: what is nearer is told from there


@dataclass(frozen=True, eq=False)
class WebFrame:
    """A web and its numbers: its arches at any share of the way to the wall."""

    part: Web

    @cached_property
    def packed(self) -> Array:
        """The row of the numeric surface (1, n)."""
        return body_table.pack((Piece((self.part,)),), self.part.names)

    @cached_property
    def size(self) -> tuple[float, float, float]:
        """Distance of the wall, place of its middle along it, half its length [m]."""
        row = self.packed[0]
        return float(row[body_table.DEPTH]), float(row[body_table.MIDDLE]), float(row[body_table.HALF])

    @cached_property
    def tangent(self) -> Vector:
        """Unit vector along the wall; the way out of the centre is to its right."""
        return float(self.packed[0, body_table.ACROSS_X]), float(self.packed[0, body_table.ACROSS_Y])

    @cached_property
    def bows(self) -> tuple[Bow, ...]:
        """The diagonals from wall to crown."""
        return half_outline(self.part.diagonal, 0.0, self.part.diagonal.half_span, -np.inf)

    def ratios(self, v: Array) -> Array:
        """Rise by half the span (n,) of the arches at shares of the way; at the centre, where both are 0, the limit."""

        def ratio(at: Array) -> Array:
            rises: Array = webs.web_arch_rises(at, self.packed)
            return rises / (at * self.size[2])

        far = ratio(np.maximum(v, BESIDE_CENTRE))
        slope = ratio(np.full_like(v, 2 * BESIDE_CENTRE)) - ratio(np.full_like(v, BESIDE_CENTRE))
        found: Array = far + slope * np.minimum(v / BESIDE_CENTRE - 1, 0.0)
        return found

    def shares(self, x: float, y: float) -> Vector:
        """Share of the way to the wall, and distance from the middle there [m], of a place in plan."""
        (tx, ty), (depth, middle, _), (cx, cy) = self.tangent, self.size, self.part.centre
        x, y = x - cx, y - cy
        v = (x * ty - y * tx) / depth
        return v, x * tx + y * ty - v * middle

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Shares of the way between which its arches are of one kind on one arc of the diagonals."""
        half, reach = self.size[2], self.part.reach
        bare = self.packed.copy()
        bare[0, body_table.HALF] = 0.0  # whose arches are nothing where the ridge is no higher than the diagonals
        found = {bow.at(bow.end)[0] / reach for bow in self.bows}
        places = np.linspace(0, 1, LOOKS + 1)[1:]
        for limit in (1.0, webs.FLAT):  # steep, and level

            def misses(v: Array, limit: float = limit) -> Array:
                rises: Array = webs.web_arch_rises(v, bare)
                return rises - limit * v * half

            def miss(v: float, misses: Callable[[Array], Array] = misses) -> float:
                return float(misses(np.array([v]))[0])

            values = misses(places)
            values[np.abs(values) < STRAIGHT] = 0.0
            for k in np.flatnonzero(values[:-1] * values[1:] < 0).tolist():
                found.add(float(brentq(miss, places[k], places[k + 1], xtol=1e-14)))
        kept = [v for v in sorted(found) if SAME_PLACE < v < 1 - SAME_PLACE]
        return 0.0, *kept, 1.0


@dataclass(frozen=True, eq=False)
class WebSheet(Sheet):
    """Half a web between two shares of the way to its wall.

    One parameter is the angle of the diagonals from their crown down, the other runs from 0 at the ridge to 1 at the
    rib. So that its normal looks up, the first of them is the one towards the wall on the side where `sign` is 1.
    """

    tolerance = 1e-2

    frame: WebFrame
    sign: int
    low: float
    high: float

    @cached_property
    def bow(self) -> Bow:
        """The arc of the diagonals."""
        middle = (self.low + self.high) / 2 * self.frame.part.reach
        return next(bow for bow in self.frame.bows if bow.at(bow.end)[0] < middle)

    @cached_property
    def _steep(self) -> bool:
        return bool(self.frame.ratios(np.array([(self.low + self.high) / 2]))[0] > 1)

    def angles(self, v: Array) -> Array:
        """Angles (n,) of the diagonals, less than 0, at shares of the way; what is within rounding of the end is it."""
        cosine = (v * self.frame.part.reach - self.bow.u) / self.bow.a
        found: Array = -np.arccos(np.where(cosine > 1 - ROUNDING, 1.0, np.maximum(cosine, -1.0)))
        return found

    @cached_property
    def nodes(self) -> Array:
        """Angles between which its poles are laid."""
        start, end = self.angles(np.array([self.low, self.high])).tolist()
        found: Array = np.linspace(start, end, NODES)
        return found

    def _halves(self, angle: Array) -> tuple[Array, Array]:
        """Poles (n, k, 3) [mm] and weights (n, k) of its half arches at angles of the diagonals."""
        v = (self.bow.u + self.bow.a * np.cos(angle)) / self.frame.part.reach
        v = np.where(np.abs(v) < ROUNDING, 0.0, v)
        (tx, ty), (depth, middle, half), (cx, cy) = self.frame.tangent, self.frame.size, self.frame.part.centre
        flat, weights = half_arches(self.frame.part.arch, self.frame.ratios(v), steep=self._steep)
        across = v[:, None] * (middle + self.sign * half * flat[:, :, 0])
        along = np.broadcast_to((v * depth)[:, None], across.shape)
        z = (self.bow.z - self.bow.b * np.sin(angle))[:, None] + (v * half)[:, None] * flat[:, :, 1]
        poles = np.stack([cx + across * tx + along * ty, cy + across * ty - along * tx, z], axis=2)
        return MM * poles, weights

    def arch(self, v: float) -> HalfArch:
        """Half its arch at a share of the way."""
        (poles,), (weights,) = self._halves(self.angles(np.array([v])))
        return HalfArch(poles, weights)

    @cached_property
    def ridge(self) -> Spline:
        """Its edge at the ridge."""
        points = self._halves(self.nodes)[0][:, 0]
        knots, poles = interpolated(self.nodes, points)
        return Spline(knots, poles, self.nodes, points)

    @cached_property
    def rib(self) -> Conic:
        """That on the rib."""
        part = self.frame.part
        corner = np.subtract(part.end if self.sign > 0 else part.start, part.centre)
        size = float(np.hypot(*corner))
        bow, wide = self.bow, size / part.reach
        drawn_out = replace(bow, u=wide * bow.u, a=bow.a if abs(wide - 1) < ROUNDING else wide * bow.a)
        return Conic.of(drawn_out, MM * np.array([*part.centre, 0.0]), np.array([*corner / size, 0.0]), UP)[0]

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Rational B-spline surface."""
        poles, weights = self._halves(self.nodes)
        count = weights.shape[1]
        laid = np.concatenate([poles * weights[:, :, None], weights[:, :, None]], axis=2)
        row, laid = interpolated(self.nodes, laid.reshape(NODES, -1))
        laid = laid.reshape(NODES, count, 4)
        size = (NODES, count) if self.sign > 0 else (count, NODES)
        points, factors = TColgp_Array2OfPnt(1, size[0], 1, size[1]), TColStd_Array2OfReal(1, size[0], 1, size[1])
        for i, column in enumerate(laid.tolist(), 1):
            for j, (x, y, z, weight) in enumerate(column, 1):
                at = (i, j) if self.sign > 0 else (j, i)
                points.SetValue(*at, gp_Pnt(x / weight, y / weight, z / weight))
                factors.SetValue(*at, weight)
        (once, times), (share, turns) = counted(row), arches.knots(count)
        if self.sign > 0:
            return Geom_BSplineSurface(points, factors, once, share, times, turns, DEGREE, arches.DEGREE)
        return Geom_BSplineSurface(points, factors, share, once, turns, times, arches.DEGREE, DEGREE)

    def trace(self, path: Path, start: float, end: float) -> Geom2d_Curve:
        """A path that ends at the centre, where the parameter across means nothing, ends where it was before."""
        return drawn(path, start, end, self._steady)

    def _steady(self, points: Array) -> Array:
        uv = self.parameters(points)
        across = 1 if self.sign > 0 else 0
        if self.low == 0 and len(uv) > 1:
            for end, beside in ((0, 1), (-1, -2)):
                if self.frame.shares(*(points[end, :2] / MM).tolist())[0] < AT_CENTRE:
                    uv[end, across] = uv[beside, across]
        return uv

    def parameters(self, points: Array) -> Array:
        """By their places in plan, and their heights above the diagonals."""
        (tx, ty), (depth, middle, half), (cx, cy) = self.frame.tangent, self.frame.size, self.frame.part.centre
        x, y = points[:, 0] / MM - cx, points[:, 1] / MM - cy
        v = np.clip((x * ty - y * tx) / depth, self.low, self.high)
        angle, span = self.angles(v), np.maximum(v * half, STRAIGHT)
        up = points[:, 2] / MM - self.bow.z + self.bow.b * np.sin(angle)
        places = np.stack([self.sign * (x * tx + y * ty - v * middle), up], axis=1) / span[:, None]
        share = arch_parameters(*half_arches(self.frame.part.arch, self.frame.ratios(v), steep=self._steep), places)
        return np.stack([angle, share] if self.sign > 0 else [share, angle], axis=1)


@dataclass(frozen=True, eq=False)
class WebRoof(Roof):
    """Half of a web between two of its breaks."""

    frame: WebFrame
    sign: int
    low: float
    high: float

    @cached_property
    def row(self) -> Array:
        """As the numeric surface has it."""
        found = np.zeros(WIDTH)
        found[: self.frame.packed.shape[1]] = self.frame.packed[0]
        found[0] = WEB
        return found

    @property
    def lowest(self) -> float:
        """The springing."""
        return 0.0

    @property
    def pole(self) -> tuple[Vector, int] | None:
        """The centre, where all its arches are one point."""
        return (self.frame.part.centre, 1 if self.sign > 0 else 0) if self.low == 0 else None

    @cached_property
    def web(self) -> WebSheet:
        """Its surface, for what webs alone have."""
        return WebSheet(self.frame, self.sign, self.low, self.high)

    @property
    def sheet(self) -> Sheet:
        """Spline."""
        return self.web

    def exact(self, way: Way, start: float, end: float, ends: tuple[Point, Point]) -> Step | None:
        """Its arches, its ridge and its ribs."""
        if way.centre is not None:
            return None
        (v0, u0), (v1, u1) = (self.frame.shares(*way.at(t)) for t in (start, end))
        depth, _, half = self.frame.size
        if abs(v1 - v0) * depth < STRAIGHT:
            across = 1 if self.sign > 0 else 0
            first, last = self.web.parameters(np.array(ends))[:, across].tolist()
            return Step(self.web.arch(v0), first, last)
        if max(abs(abs(u0) - v0 * half), abs(abs(u1) - v1 * half)) < STRAIGHT:
            return Step(self.web.rib, self.web.rib.parameter(ends[0]), self.web.rib.parameter(ends[1]))
        if max(abs(u0), abs(u1)) < STRAIGHT:
            first, last = self.web.angles(np.array([v0, v1])).tolist()
            return Step(self.web.ridge, first, last)
        return None


@dataclass(frozen=True, eq=False)
class WebBody:
    """A web as roofs, with the cuts of the plan at which they end."""

    part: Web
    made: dict[tuple[int, int], WebRoof] = field(default_factory=dict)

    @cached_property
    def frame(self) -> WebFrame:
        """Its numbers."""
        return WebFrame(self.part)

    def cuts(self) -> Iterator[Cut]:
        """Both diagonals, the ridge, the wall, and where the kind of its arches changes."""
        part, (tx, ty) = self.part, self.frame.tangent
        (x, y), middle = part.centre, ((part.start[0] + part.end[0]) / 2, (part.start[1] + part.end[1]) / 2)
        for a, b in (part.start, part.end, middle):
            size = hypot(a - x, b - y)
            nx, ny = (b - y) / size, -(a - x) / size
            yield Cut((nx, ny), nx * x + ny * y)
        for v in self.frame.breaks[1:]:
            yield Cut((ty, -tx), ty * x - tx * y + v * self.frame.size[0])

    def level(self, z: float) -> Iterator[Cut]:
        """None that is a line or circle."""
        yield from ()

    def roof(self, x: float, y: float) -> Roof | None:
        """What it shows over a place; nothing beyond its triangle."""
        v, u = self.frame.shares(x, y)
        if not 0 < v <= 1 or abs(u) > v * self.frame.size[2]:
            return NOTHING
        sign = 1 if u > 0 else -1
        k = next(k for k, high in enumerate(self.frame.breaks[1:]) if v <= high)
        if (sign, k) not in self.made:
            low, high = list(pairwise(self.frame.breaks))[k]
            self.made[sign, k] = WebRoof(self.frame, sign, low, high)
        return self.made[sign, k]

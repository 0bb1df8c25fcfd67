"""Webs between ribs as roofs: doubly curved, so splines through their own points, in halves that meet in the ridge."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from math import hypot

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_BSplineSurface, Geom_Surface
from OCP.Geom2d import Geom2d_Curve
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from scipy.optimize import brentq

from families.declaration.pieces import Piece, Web
from families.declaration.plan import Vector
from families.declaration.units import MM
from families.solid.boundary import Step
from families.solid.curves import Path, Point, Spline, drawn
from families.solid.heights import WEB, WIDTH
from families.solid.plan_cells import SAME_PLACE, Cut, Way
from families.solid.roofs import NOTHING, Roof
from families.solid.splines import DEGREE, interpolated
from families.solid.surfaces import Sheet
from families.void import kernel
from families.void.profile_outline import half_outline

Array = NDArray[np.float64]
NODES = 41  # along either parameter of a web
AT = np.linspace(0, 1, NODES)
LOOKS = 400  # places at which the kind of the arch is looked at
STRAIGHT = 1e-9  # [m]
ROUNDING = 1e-12
AT_CENTRE = 1e-6  # of the way to the wall


def slowed(at: Array) -> Array:
    """Shares (n,) of a way at parameters from 0 to 1: slower and slower towards 1.

    Next to a rib, where arches begin to spring upright, a web is a root of both shares: hence twice.
    """
    found: Array = np.sin(np.pi / 2 * np.sin(np.pi / 2 * at))
    return found


def paced(share: Array) -> Array:
    """The inverse of `slowed`; what is within rounding of the end is the end."""
    share = np.where(share > 1 - ROUNDING, 1.0, share)
    found: Array = np.arcsin(np.arcsin(share) * 2 / np.pi) * 2 / np.pi
    return found


@dataclass(frozen=True, eq=False)
class WebFrame:
    """A web and its numbers: its arches at any share of the way to the wall."""

    part: Web

    @cached_property
    def packed(self) -> Array:
        """The row of the numeric surface (1, n)."""
        return kernel.pack((Piece((self.part,)),), self.part.names)

    @cached_property
    def size(self) -> tuple[float, float, float]:
        """Distance of the wall, place of its middle along it, half its length [m]."""
        row = self.packed[0]
        return float(row[kernel.DEPTH]), float(row[kernel.MIDDLE]), float(row[kernel.HALF])

    @cached_property
    def tangent(self) -> Vector:
        """Unit vector along the wall; the way out of the centre is to its right."""
        return float(self.packed[0, kernel.ACROSS_X]), float(self.packed[0, kernel.ACROSS_Y])

    def arch_rise(self, v: float) -> float:
        """Rise of the arch at a share of the way."""
        return float(kernel.web_arch_rise(v, self.packed))

    def shares(self, x: float, y: float) -> Vector:
        """Share of the way to the wall, and distance from the middle there [m], of a place in plan."""
        (tx, ty), (depth, middle, _), (cx, cy) = self.tangent, self.size, self.part.centre
        x, y = x - cx, y - cy
        v = (x * ty - y * tx) / depth
        return v, x * tx + y * ty - v * middle

    def place(self, v: Array, u: Array) -> tuple[Array, Array]:
        """Places of these, the inverse."""
        (tx, ty), (depth, middle, _), (cx, cy) = self.tangent, self.size, self.part.centre
        along, across = v * depth, u + v * middle
        return cx + across * tx + along * ty, cy + across * ty - along * tx

    def points(self, v: Array, u: Array) -> Array:
        """Points (n, 3) [mm] of the web over these."""
        depth, middle, _ = self.size
        z = kernel.web_heights(v * depth, u + v * middle, self.packed)
        found: Array = MM * np.stack([*self.place(v, u), z], axis=1)
        return found

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Shares of the way between which its arches are of one kind on one arc of the diagonals."""
        _, _, half = self.size
        reach = self.part.reach
        bows = half_outline(self.part.diagonal, 0.0, self.part.diagonal.half_span, -np.inf)
        found = {bow.at(bow.end)[0] / reach for bow in bows}

        def steep(v: float) -> float:
            return self.arch_rise(v) - v * half

        def low(v: float) -> float:
            return self.arch_rise(v) - 2 * kernel.FLAT * v * half

        places = np.linspace(0, 1, LOOKS + 1)[1:]
        for miss in (steep, low):
            values = np.array([miss(v) for v in places.tolist()])
            values[np.abs(values) < STRAIGHT] = 0.0
            for k in np.flatnonzero(values[:-1] * values[1:] < 0).tolist():
                found.add(float(brentq(miss, places[k], places[k + 1], xtol=1e-14)))
        kept = [v for v in sorted(found) if SAME_PLACE < v < 1 - SAME_PLACE]
        return 0.0, *kept, 1.0


@dataclass(frozen=True)
class WebSheet(Sheet):
    """Half a web between two shares of the way to its wall: a spline through a grid of its points.

    One parameter runs from 0 to 1 towards the wall, the other from the ridge to the rib, slower towards their ends,
    where the surface may be upright. So that its normal looks up, the first of them is the one towards the wall on the
    side where `sign` is 1.
    """

    tolerance = 1e-2

    frame: WebFrame
    sign: int
    low: float
    high: float

    def points(self, uv: Array) -> Array:
        """Points (n, 3) [mm] of the web at parameters (n, 2)."""
        towards, across = (slowed(value) for value in (uv.T if self.sign > 0 else uv.T[::-1]))
        v = self.low + (self.high - self.low) * towards
        return self.frame.points(v, self.sign * v * across * self.frame.size[2])

    @cached_property
    def _poles(self) -> tuple[Array, Array]:
        """Poles (n, n, 3) [mm], towards the wall and towards the rib, and the knots of both."""
        uv = np.stack(np.meshgrid(AT, AT, indexing="ij"), axis=-1).reshape(-1, 2)
        grid = self.points(uv if self.sign > 0 else uv[:, ::-1]).reshape(NODES, NODES, 3)
        knots, along = interpolated(AT, grid.reshape(NODES, -1))
        turned = along.reshape(NODES, NODES, 3).transpose(1, 0, 2).reshape(NODES, -1)
        _, both = interpolated(AT, np.ascontiguousarray(turned))
        return both.reshape(NODES, NODES, 3).transpose(1, 0, 2), knots

    @cached_property
    def geometry(self) -> Geom_Surface:
        """B-spline surface."""
        poles, knots = self._poles
        if self.sign < 0:
            poles = poles.transpose(1, 0, 2)
        values, times = np.unique(knots, return_counts=True)
        array = TColgp_Array2OfPnt(1, NODES, 1, NODES)
        for i, row in enumerate(poles.tolist(), 1):
            for j, pole in enumerate(row, 1):
                array.SetValue(i, j, gp_Pnt(*pole))
        at, counts = TColStd_Array1OfReal(1, len(values)), TColStd_Array1OfInteger(1, len(values))
        for k, (value, count) in enumerate(zip(values.tolist(), times.tolist(), strict=True), 1):
            at.SetValue(k, value)
            counts.SetValue(k, count)
        return Geom_BSplineSurface(array, at, at, counts, counts, DEGREE, DEGREE)

    def trace(self, path: Path, start: float, end: float) -> Geom2d_Curve:
        """A path that ends at the centre, where the parameter across means nothing, ends where it was before."""
        return drawn(path, start, end, self._steady)

    def _steady(self, points: Array) -> Array:
        uv = self.parameters(points)
        towards, across = (0, 1) if self.sign > 0 else (1, 0)
        if self.low == 0 and len(uv) > 1:
            for end, beside in ((0, 1), (-1, -2)):
                if uv[end, towards] < AT_CENTRE:
                    uv[end, across] = uv[beside, across]
        return uv

    def parameters(self, points: Array) -> Array:
        """From places in plan."""
        (tx, ty), (depth, middle, half), (cx, cy) = self.frame.tangent, self.frame.size, self.frame.part.centre
        x, y = points[:, 0] / MM - cx, points[:, 1] / MM - cy
        v = (x * ty - y * tx) / depth
        u = self.sign * (x * tx + y * ty - v * middle)
        share = np.clip((v - self.low) / (self.high - self.low), 0, 1)
        across = np.clip(u / np.maximum(v * half, STRAIGHT), 0, 1)
        found = [paced(share), paced(across)]
        return np.stack(found if self.sign > 0 else found[::-1], axis=1)


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
    def sheet(self) -> Sheet:
        """Spline."""
        return WebSheet(self.frame, self.sign, self.low, self.high)

    def exact(self, way: Way, start: float, end: float, ends: tuple[Point, Point]) -> Step | None:
        """Towards the wall and across as splines, at a pace that the parameters of the surfaces beside can follow.

        From the end nearer to the centre or the ridge, slower towards the other. Arcs would run at a pace of theirs,
        which near their springing no spline in the surface's parameters can follow.
        """
        if way.centre is not None:
            return None
        (v0, u0), (v1, u1) = (self.frame.shares(*way.at(t)) for t in (start, end))
        depth, _, half = self.frame.size
        share = slowed(AT)
        if abs(v1 - v0) * depth < STRAIGHT:
            near, far = sorted((abs(u0), abs(u1)))
            v, u, forward = np.full(NODES, v0), near + (far - near) * share, abs(u1) > abs(u0)
        else:
            on_rib = max(abs(abs(u0) - v0 * half), abs(abs(u1) - v1 * half)) < STRAIGHT
            if not on_rib and max(abs(u0), abs(u1)) > STRAIGHT:
                return None
            low, high = sorted((v0, v1))
            v, forward = low + (high - low) * share, v1 > v0
            u = v * half * on_rib
        points = self.frame.points(v, self.sign * u)
        points[[0, -1]] = ends if forward else ends[::-1]
        knots, poles = interpolated(AT, points)
        spline = Spline(knots, poles, AT, points)
        return Step(spline, 0.0, 1.0) if forward else Step(spline, 1.0, 0.0)


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

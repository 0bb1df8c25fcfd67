"""Surfaces of barrels: bows drawn along a straight axis, or along one that is lifted or along which they grow."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import hypot

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_BezierSurface, Geom_CylindricalSurface, Geom_Surface, Geom_SurfaceOfLinearExtrusion
from OCP.Geom2d import Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array2OfReal

from families.declaration.pieces import BarrelPart
from families.declaration.plan_sides import Vector
from families.declaration.units import MM
from families.solid.curves import Conic, Path, Point, Straight, arc_parameter, arc_poles, arc_weight
from families.solid.heights import APEX
from families.solid.surfaces import PARALLEL, UP, Sheet
from families.void.profile_outline import Bow

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BarrelSide:
    """One side of a barrel: from its axis to the wall where `sign` · across grows."""

    part: BarrelPart
    sign: int

    @cached_property
    def outwards(self) -> Array:
        """Unit vector (3,) from the barrel's axis to the wall."""
        return self.sign * np.array([*self.part.across, 0.0])

    @cached_property
    def along(self) -> Point:
        """Vector along the barrel, a metre in plan, climbing with it: outwards × up, so normals point outwards."""
        x, y = self.part.along
        return -self.sign * x, -self.sign * y, -self.sign * self.part.slope

    def place(self, along: float = 0.0) -> Point:
        """Point [mm] on the barrel's axis at the springing, at a coordinate along it [m]."""
        (x, y), (a, b) = self.part.origin, self.part.along
        return MM * (x + along * a), MM * (y + along * b), MM * (self.part.base + self.part.lift(along))


@dataclass(frozen=True)
class Drawn(Sheet):
    """A bow of a barrel's profile drawn along it: a cylinder, circular or elliptical. u is the angle, v [mm] along.

    Both sides of a barrel lie on one cylinder where its axis is theirs: joined by CAD, they are one face.
    """

    side: BarrelSide
    bow: Bow

    @cached_property
    def frame(self) -> BarrelSide:
        """The side whose directions are the surface's."""
        return self.side if self.bow.u else BarrelSide(self.side.part, 1)

    @cached_property
    def directrix(self) -> Conic:
        """The bow at along = 0."""
        return Conic.of(self.bow, np.array(self.frame.place()), self.frame.outwards, UP)[0]

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Cylinder or surface of extrusion."""
        conic, along = self.directrix, gp_Dir(*self.frame.along)
        if conic.a == conic.b and not self.side.part.slope:
            return Geom_CylindricalSurface(gp_Ax3(gp_Pnt(*conic.centre), along, gp_Dir(*conic.x)), conic.a)
        return Geom_SurfaceOfLinearExtrusion(conic.geometry, along)

    @cached_property
    def _level(self) -> tuple[Vector, float, float]:
        """Along in plan, where it is 0, and how much longer a way along the surface is."""
        (x, y, z), centre = self.frame.along, self.directrix.centre
        return (x, y), x * centre[0] + y * centre[1], hypot(x, y, z)

    def parameters(self, points: Array) -> Array:
        """Angle and place along."""
        (x, y), start, steep = self._level
        way = points[:, 0] * x + points[:, 1] * y - start
        if not self.side.part.slope:
            return np.stack([self.directrix.parameters(points), way], axis=1)
        return np.stack([self.directrix.parameters(points - np.outer(way, self.frame.along)), way * steep], axis=1)

    def trace(self, path: Path, start: float, end: float) -> Geom2d_Curve:
        """A straight line for its rulings and arches, which need no look at their points."""
        (x, y), first, steep = self._level
        conic = self.directrix
        if isinstance(path, Straight):
            way = (path.direction[0] * x + path.direction[1] * y) * steep
            if abs(abs(way) - 1) < PARALLEL:
                (a, b, c), climb = path.origin, self.frame.along[2]
                v = a * x + b * y - first
                u = conic.parameter((a - v * x, b - v * y, c - v * climb))
                return Geom2d_Line(gp_Pnt2d(u, v * steep), gp_Dir2d(0.0, way))
        elif isinstance(path, Conic) and (path.x, path.y, path.a, path.b) == (conic.x, conic.y, conic.a, conic.b):
            v = (path.centre[0] * x + path.centre[1] * y - first) * steep
            return Geom2d_Line(gp_Pnt2d(0.0, v), gp_Dir2d(1.0, 0.0))
        return super().trace(path, start, end)

    def arch(self, along: float) -> Conic:
        """The bow at a coordinate along the barrel [m]."""
        conic = self.directrix
        x, y, z = (a + b - c for a, b, c in zip(conic.centre, self.side.place(along), self.side.place(), strict=True))
        return Conic((x, y, z), conic.x, conic.y, conic.a, conic.b)


@dataclass(frozen=True)
class Moved(Sheet):
    """A bow that moves along a barrel's axis, lifted along a parabola or growing: exactly a rational Bézier surface.

    u and v run from 0 to 1 over the whole bow and from `low` to `high` [m] along, in the direction of `side.along`.
    """

    side: BarrelSide
    bow: Bow
    low: float
    high: float

    @cached_property
    def _ends(self) -> tuple[float, float]:
        """Coordinates along at v = 0 and v = 1."""
        return (self.low, self.high) if self.side.sign < 0 else (self.high, self.low)

    @cached_property
    def poles(self) -> Array:
        """Poles (3, 3, 3) [mm]: along the bow, along the axis."""
        part, (first, last) = self.side.part, self._ends
        u, z = arc_poles(self.bow).T
        found = np.empty((3, 3, 3))
        # A polynomial of degree 2 by its polar form: the middle pole is the mixed value of both ends.
        mixed = part.lift(0.0) + part.slope * (first + last) / 2
        mixed -= part.crown_rise * first * last / part.half_length**2
        for j, (along, lift) in enumerate(
            ((first, part.lift(first)), ((first + last) / 2, mixed), (last, part.lift(last)))
        ):
            wide, high = 1 + part.splay * along, 1 + part.flare * along
            place = np.array([*part.origin, part.base + lift]) + along * np.array([*part.along, 0.0])
            found[:, j] = place + np.outer(wide * u, self.side.outwards) + np.outer(high * z, UP)
        return MM * found

    @cached_property
    def _weight(self) -> float:
        return arc_weight(self.bow.end - self.bow.start)

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Bézier surface."""
        level = self.side.part.crown_rise == 0
        columns = (0, 2) if level else (0, 1, 2)
        poles = TColgp_Array2OfPnt(1, 3, 1, len(columns))
        weights = TColStd_Array2OfReal(1, 3, 1, len(columns))
        for i in range(3):
            for j, column in enumerate(columns, 1):
                poles.SetValue(i + 1, j, gp_Pnt(*self.poles[i, column].tolist()))
                weights.SetValue(i + 1, j, self._weight if i == 1 else 1.0)
        return Geom_BezierSurface(poles, weights)

    def parameters(self, points: Array) -> Array:
        """Shares of the bow and of the length."""
        part, bow, (first, last) = self.side.part, self.bow, self._ends
        rest = points / MM - (*part.origin, part.base)
        along = rest[:, :2] @ np.array(part.along)
        wide, tall = (np.maximum(1 + rate * along, APEX) for rate in (part.splay, part.flare))
        u = rest @ self.side.outwards / wide
        lift = part.slope * along + part.crown_rise * (1 - (along / part.half_length) ** 2)
        z = (rest[:, 2] - lift) / tall
        angle = np.arctan2((z - bow.z) / bow.b, (u - bow.u) / bow.a)
        return np.stack([arc_parameter(angle, bow.start, bow.end), (along - first) / (last - first)], axis=1)

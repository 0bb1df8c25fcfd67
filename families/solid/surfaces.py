"""Surfaces [mm] of a vault's parts, each with its parameters as a formula for numpy and as OpenCASCADE's geometry.

Their normals, by increasing parameters, point away from the void.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import asin, atan2, hypot, pi

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import (
    Geom_BezierSurface,
    Geom_CylindricalSurface,
    Geom_Plane,
    Geom_SphericalSurface,
    Geom_Surface,
    Geom_SurfaceOfLinearExtrusion,
    Geom_SurfaceOfRevolution,
)
from OCP.Geom2d import Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax1, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array2OfReal

from families.declaration.pieces import BarrelPart
from families.declaration.plan import Vector
from families.declaration.units import MM
from families.solid.curves import (
    Conic,
    Path,
    Point,
    Straight,
    arc_parameter,
    arc_poles,
    arc_weight,
    drawn,
)
from families.solid.heights import APEX
from families.void.profile_outline import Bow

Array = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])
PARALLEL = 1e-12
NEAR_AXIS = 1e-6  # [mm] that a ring's centre may be off an axis


class Sheet(ABC):
    """A surface S(u, v); curves on it are as near to it as `tolerance` [mm]."""

    tolerance = 1e-3

    @property
    @abstractmethod
    def geometry(self) -> Geom_Surface:
        """OpenCASCADE's surface, with the same parameters."""

    @abstractmethod
    def parameters(self, points: Array) -> Array:
        """Parameters (n, 2) of points (n, 3) on the surface."""

    def trace(self, path: Path, start: float, end: float) -> Geom2d_Curve:
        """A path on the surface in its parameters, from one parameter of its own to another."""
        return drawn(path, start, end, self.parameters)


@dataclass(frozen=True)
class Flat(Sheet):
    """Plane across a unit vector, `place` [mm] from the origin along it; u runs along `first`, v along normal × u."""

    normal: Point
    place: float
    first: Point

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Plane."""
        origin = gp_Pnt(*(self.place * value for value in self.normal))
        return Geom_Plane(gp_Ax3(origin, gp_Dir(*self.normal), gp_Dir(*self.first)))

    @cached_property
    def _axes(self) -> Array:
        return np.stack([self.first, np.cross(self.normal, self.first)], axis=1)

    def parameters(self, points: Array) -> Array:
        """Places along u and v."""
        return points @ self._axes

    @staticmethod
    def level(z: float, gradient: Vector = (0.0, 0.0)) -> Flat:
        """The plane z + gradient · (x, y), seen from above."""
        a, b = gradient
        size = hypot(a, b, 1.0)
        reach = hypot(a, 1.0)
        return Flat((-a / size, -b / size, 1 / size), z / size, (1 / reach, 0.0, a / reach))

    @staticmethod
    def upright(normal: Vector, offset: float) -> Flat:
        """The plane normal · (x, y) = offset [mm]; u runs to the left, seen with the normal, and v up."""
        x, y = normal
        return Flat((x, y, 0.0), offset, (-y, x, 0.0))


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


def _around(path: Path, centre: Vector, about: float, height: float) -> Geom2d_Curve | None:
    """A ring about an upright axis as a line of azimuths at a parameter v, None for other paths."""
    if not isinstance(path, Conic) or path.a != path.b or abs(path.x[2]) + abs(path.y[2]) > PARALLEL:
        return None
    if abs(path.centre[0] - centre[0]) + abs(path.centre[1] - centre[1]) > NEAR_AXIS:
        return None
    turn = 1.0 if path.x[0] * path.y[1] - path.x[1] * path.y[0] > 0 else -1.0
    first = atan2(path.x[1], path.x[0])
    # The middle of a quarter, by its angle from the start, tells which turn is meant.
    shift = _near(np.array([first + turn * pi / 4]), about)[0] - (first + turn * pi / 4)
    return Geom2d_Line(gp_Pnt2d(first + shift, height), gp_Dir2d(turn, 0.0))


@dataclass(frozen=True)
class Round(Sheet):
    """Sphere. u and v are its longitude and latitude about `pole`, an axis of the frame; u is nearest to `about`."""

    centre: Point
    radius: float
    pole: int = 2
    about: float = pi

    def trace(self, path: Path, start: float, end: float) -> Geom2d_Curve:
        """Rings about an upright pole are straight."""
        if self.pole == 2 and isinstance(path, Conic):
            x, y, z = self.centre
            latitude = asin(min(max((path.centre[2] - z) / self.radius, -1.0), 1.0))
            if (line := _around(path, (x, y), self.about, latitude)) is not None:
                return line
        return super().trace(path, start, end)

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Sphere."""
        pole, first = (np.eye(3)[(self.pole + k) % 3].tolist() for k in (0, 1))
        return Geom_SphericalSurface(gp_Ax3(gp_Pnt(*self.centre), gp_Dir(*pole), gp_Dir(*first)), self.radius)

    def parameters(self, points: Array) -> Array:
        """Longitude and latitude."""
        rest = points - np.array(self.centre)
        first, second, pole = (rest[:, (self.pole + k) % 3] for k in (1, 2, 0))
        return np.stack(
            [_near(np.arctan2(second, first), self.about), np.arctan2(pole, np.hypot(first, second))], axis=1
        )


@dataclass(frozen=True)
class Revolved(Sheet):
    """A conic in a plane through an upright axis, turned about that. u is the azimuth nearest to `about`, v the angle.

    The conic lies in the plane of x and z, where the axis is at x = 0.
    """

    conic: Conic
    centre: Vector
    about: float

    def trace(self, path: Path, start: float, end: float) -> Geom2d_Curve:
        """Rings are straight."""
        if isinstance(path, Conic):
            v = float(self.parameters(path.points(np.array([start])))[0, 1])
            if (line := _around(path, self.centre, self.about, v)) is not None:
                return line
        return super().trace(path, start, end)

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Surface of revolution."""
        x, y = self.centre
        moved = Conic(
            (self.conic.centre[0] + x, y, self.conic.centre[2]), self.conic.x, self.conic.y, self.conic.a, self.conic.b
        )
        return Geom_SurfaceOfRevolution(moved.geometry, gp_Ax1(gp_Pnt(x, y, 0), gp_Dir(0, 0, 1)))

    def parameters(self, points: Array) -> Array:
        """Azimuth and angle."""
        x, y = points[:, 0] - self.centre[0], points[:, 1] - self.centre[1]
        flat = np.stack([np.hypot(x, y), np.zeros(len(points)), points[:, 2]], axis=1)
        return np.stack([_near(np.arctan2(y, x), self.about), self.conic.parameters(flat)], axis=1)


@dataclass(frozen=True)
class Drum(Sheet):
    """Upright cylinder about `centre` [mm]. u is the azimuth nearest to `about`, v the height."""

    centre: Vector
    radius: float
    about: float

    def trace(self, path: Path, start: float, end: float) -> Geom2d_Curve:
        """Rings and plumb lines are straight."""
        if isinstance(path, Straight) and abs(path.direction[2]) > 1 - PARALLEL:
            u, v = self.parameters(path.points(np.zeros(1)))[0].tolist()
            return Geom2d_Line(gp_Pnt2d(u, v), gp_Dir2d(0.0, path.direction[2]))
        line = _around(path, self.centre, self.about, path.centre[2]) if isinstance(path, Conic) else None
        return super().trace(path, start, end) if line is None else line

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Cylinder."""
        return Geom_CylindricalSurface(gp_Ax3(gp_Pnt(*self.centre, 0), gp_Dir(0, 0, 1), gp_Dir(1, 0, 0)), self.radius)

    def parameters(self, points: Array) -> Array:
        """Azimuth and height."""
        azimuth = np.arctan2(points[:, 1] - self.centre[1], points[:, 0] - self.centre[0])
        return np.stack([_near(azimuth, self.about), points[:, 2]], axis=1)


def _near(angle: Array, about: float) -> Array:
    return about + np.remainder(angle - about + pi, 2 * pi) - pi

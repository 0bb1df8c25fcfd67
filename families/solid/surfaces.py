"""Surfaces [mm] of a vault's parts, each with its parameters as a formula for numpy and as OpenCASCADE's geometry.

Their normals, by increasing parameters, point away from the void.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import pi

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
from families.declaration.units import MM
from families.solid.curves import (
    AXES,
    Bezier,
    Conic,
    Path,
    Simple,
    Spline,
    Straight,
    arc_parameter,
    arc_poles,
    arc_weight,
    drawn,
)
from families.void.profile_outline import Bow

Array = NDArray[np.float64]
UP = AXES[2]


class Sheet(ABC):
    """A surface S(u, v)."""

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
    """Plane across an axis of the frame, through `place` [mm] on it; its normal points to larger values."""

    axis: int
    place: float

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Plane."""
        x = AXES[(self.axis + 1) % 3]
        normal = AXES[self.axis]
        return Geom_Plane(
            gp_Ax3(gp_Pnt(*(self.place * normal).tolist()), gp_Dir(*normal.tolist()), gp_Dir(*x.tolist()))
        )

    def parameters(self, points: Array) -> Array:
        """The two other coordinates, in the order that makes a right-handed frame."""
        return points[:, [(self.axis + 1) % 3, (self.axis + 2) % 3]]


@dataclass(frozen=True)
class Side:
    """One side of a barrel: from its axis to the wall where `sign` · across grows."""

    part: BarrelPart
    sign: int

    @property
    def axis(self) -> int:
        """The axis of the frame across which the profile is drawn."""
        return 0 if self.part.across == "x" else 1

    @cached_property
    def outwards(self) -> Array:
        """Unit vector (3,) from the barrel's axis to the wall."""
        found: Array = np.multiply(self.sign, AXES[self.axis])
        return found

    @cached_property
    def along(self) -> Array:
        """Unit vector (3,) along the barrel: outwards × up, so that normals point outwards."""
        found: Array = np.multiply(self.sign, AXES[0] if self.axis else -AXES[1])
        return found

    def place(self, along: float = 0.0, lift: float = 0.0) -> Array:
        """Point (3,) [mm] on the barrel's axis at the springing, at a coordinate along it [m]."""
        place = self.part.centre * AXES[self.axis] + along * AXES[1 - self.axis] + (self.part.base + lift) * UP
        found: Array = np.multiply(MM, place)
        return found


@dataclass(frozen=True)
class Drawn(Sheet):
    """A bow of a barrel's profile drawn along it: a cylinder, circular or elliptical. u is the angle, v [mm] along.

    Both sides of a barrel lie on one cylinder where its axis is theirs: joined by CAD, they are one face.
    """

    side: Side
    bow: Bow

    @cached_property
    def _frame(self) -> Side:
        return self.side if self.bow.u else Side(self.side.part, 1)

    @cached_property
    def _directrix(self) -> Conic:
        return Conic.of(self.bow, self._frame.place(), self._frame.outwards, UP)[0]

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Cylinder or surface of extrusion."""
        conic, along = self._directrix, gp_Dir(*self._frame.along.tolist())
        if conic.a == conic.b:
            return Geom_CylindricalSurface(gp_Ax3(gp_Pnt(*conic.centre), along, gp_Dir(*conic.x)), conic.a)
        return Geom_SurfaceOfLinearExtrusion(conic.geometry, along)

    def parameters(self, points: Array) -> Array:
        """Angle and place along."""
        return np.stack([self._directrix.parameters(points), points @ self._frame.along], axis=1)

    def trace(self, path: Path, start: float, end: float) -> Geom2d_Curve:
        """A straight line for its rulings and arches, which need no look at their points."""
        along, conic = self._frame.along, self._directrix
        if isinstance(path, Straight) and path.axis == 1 - self.side.axis:
            u, v = self.parameters(path.points(np.zeros(1)))[0].tolist()
            return Geom2d_Line(gp_Pnt2d(u, v), gp_Dir2d(0.0, float(along[path.axis])))
        if isinstance(path, Conic) and (path.x, path.y, path.a, path.b) == (conic.x, conic.y, conic.a, conic.b):
            return Geom2d_Line(gp_Pnt2d(0.0, float(np.dot(path.centre, along))), gp_Dir2d(1.0, 0.0))
        if isinstance(path, Spline):
            # Seen from the barrel's axis all copies of a groin are the same, but mirrored on the other side.
            key = self.bow, self.side.axis, self._frame.sign == self.side.sign
            return path.trace(key, self._directrix.parameters, along)
        return super().trace(path, start, end)

    def arch(self, along: float) -> Conic:
        """The bow at a coordinate along the barrel [m]."""
        conic = self._directrix
        x, y, z = conic.centre
        centre = (x, MM * along, z) if self.side.axis == 0 else (MM * along, y, z)
        return Conic(centre, conic.x, conic.y, conic.a, conic.b)

    def ruling(self, u: float, z: float) -> Simple:
        """The line along the barrel through (u, z) [m] of the bow."""
        part = self.side.part
        across, height = MM * (part.centre + self.side.sign * u), MM * (part.base + z)
        return Straight(1, (across, 0.0, height)) if self.side.axis == 0 else Straight(0, (0.0, across, height))


@dataclass(frozen=True)
class Translated(Sheet):
    """A bow moved along the parabola of a barrel's lifted axis: a translation surface, exactly a rational Bézier one.

    u and v run from 0 to 1 over the whole bow and the whole barrel.
    """

    side: Side
    bow: Bow

    @cached_property
    def _axis(self) -> Array:
        """Poles (3, 3) [mm] of the axis, in the direction of `side.along`."""
        part, way = self.side.part, self.side.along[1 - self.side.axis]
        ends = (-part.half_length, 0.0, part.half_length)
        # The tangents at the ends of the parabola meet at twice its height.
        return np.stack([self.side.place(way * along, 2 * part.crown_rise * (along == 0)) for along in ends])

    @cached_property
    def _poles(self) -> Array:
        """Poles (3, 2, 3), those of the bow [m] with their places in the frame [mm]."""
        u, z = arc_poles(self.bow).T
        return MM * (u[:, None] * self.side.outwards + z[:, None] * UP)  # type: ignore[no-any-return]  # numpy's stubs

    @cached_property
    def _weight(self) -> float:
        return arc_weight(self.bow.end - self.bow.start)

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Bézier surface."""
        poles, weights = TColgp_Array2OfPnt(1, 3, 1, 3), TColStd_Array2OfReal(1, 3, 1, 3)
        for i, pole in enumerate(self._poles, 1):
            for j, place in enumerate(self._axis, 1):
                poles.SetValue(i, j, gp_Pnt(*(pole + place).tolist()))
                weights.SetValue(i, j, self._weight if i == 2 else 1.0)
        return Geom_BezierSurface(poles, weights)

    def parameters(self, points: Array) -> Array:
        """Shares of the bow and of the length."""
        part, bow = self.side.part, self.bow
        along = points[:, 1 - self.side.axis] / MM
        v = (1 + self.side.along[1 - self.side.axis] * along / part.half_length) / 2
        rest = points / MM - part.centre * AXES[self.side.axis]
        height = rest[:, 2] - part.base - part.crown_rise * (1 - (along / part.half_length) ** 2)
        angle = np.arctan2((height - bow.z) / bow.b, (rest @ self.side.outwards - bow.u) / bow.a)
        return np.stack([arc_parameter(angle, bow.start, bow.end), v], axis=1)

    def arch(self, along: float) -> Bezier:
        """The bow at a coordinate along the barrel [m]."""
        return Bezier(self._poles + self.side.place(along, self.side.part.lift(along)), self._weight)

    def ruling(self, u: float, z: float) -> Simple:
        """The parabola along the barrel through (u, z) [m] of the bow."""
        return Bezier(self._axis + MM * (u * self.side.outwards + z * UP))


@dataclass(frozen=True)
class Round(Sheet):
    """Sphere. u and v are its longitude and latitude about `pole`, an axis of the frame; u is nearest to `about`."""

    centre: tuple[float, float, float]
    radius: float
    pole: int = 2
    about: float = pi

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Sphere."""
        pole, first = AXES[self.pole].tolist(), AXES[(self.pole + 1) % 3].tolist()
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
    """A conic in the plane of x and z turned about the z axis. u is the azimuth nearest to `about`, v the angle."""

    conic: Conic
    about: float

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Surface of revolution."""
        return Geom_SurfaceOfRevolution(self.conic.geometry, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)))

    def parameters(self, points: Array) -> Array:
        """Azimuth and angle."""
        flat = np.stack([np.hypot(points[:, 0], points[:, 1]), np.zeros(len(points)), points[:, 2]], axis=1)
        azimuth = _near(np.arctan2(points[:, 1], points[:, 0]), self.about)
        return np.stack([azimuth, self.conic.parameters(flat)], axis=1)


@dataclass(frozen=True)
class Drum(Sheet):
    """Upright cylinder about the z axis. u is the azimuth nearest to `about`, v the height."""

    radius: float
    about: float

    @cached_property
    def geometry(self) -> Geom_Surface:
        """Cylinder."""
        return Geom_CylindricalSurface(gp_Ax3(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1), gp_Dir(1, 0, 0)), self.radius)

    def parameters(self, points: Array) -> Array:
        """Azimuth and height."""
        return np.stack([_near(np.arctan2(points[:, 1], points[:, 0]), self.about), points[:, 2]], axis=1)


def _near(angle: Array, about: float) -> Array:
    return about + np.remainder(angle - about + pi, 2 * pi) - pi

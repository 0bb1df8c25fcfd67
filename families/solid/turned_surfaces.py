"""Surfaces about an upright axis: spheres, conics turned about it, drums."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import asin, atan2, pi

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_CylindricalSurface, Geom_SphericalSurface, Geom_Surface, Geom_SurfaceOfRevolution
from OCP.Geom2d import Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax1, gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d

from families.declaration.plan_sides import Vector
from families.solid.curves import Conic, Path, Point, Straight
from families.solid.surfaces import PARALLEL, Sheet

Array = NDArray[np.float64]
NEAR_AXIS = 1e-6  # [mm] that a ring's centre may be off an axis


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

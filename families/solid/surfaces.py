"""Surfaces [mm] of a vault's parts, each with its parameters as a formula for numpy and as OpenCASCADE's geometry.

Their normals, by increasing parameters, point away from the void. Here are planes; barrel_surfaces.py and
turned_surfaces.py have the others.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import hypot

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_Plane, Geom_Surface
from OCP.Geom2d import Geom2d_Curve
from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt

from families.declaration.plan_sides import Vector
from families.solid.curves import Path, Point, drawn

Array = NDArray[np.float64]
UP = np.array([0.0, 0.0, 1.0])
PARALLEL = 1e-12


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

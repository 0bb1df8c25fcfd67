"""The primitives that RANSAC looks for: plane, sphere, cylinder, cone, torus."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from segmentation.primitives import numeric
from segmentation.primitives.least_squares import Samples, least_squares
from segmentation.primitives.minimal_sets import MINIMAL_SETS

Vector = tuple[float, float, float]
Floats = NDArray[np.float64]
ANY_SIZE = (0.0, math.inf)


@dataclass(frozen=True)
class Primitive(ABC):
    """What the five share. Points are (n, 3) [m], in any frame; distances are positive outside."""

    kind: ClassVar[int]
    name: ClassVar[str]

    @property
    @abstractmethod
    def row(self) -> Floats:
        """The flat form of `primitives_numeric`, (8,)."""

    @classmethod
    @abstractmethod
    def from_row(cls, row: Sequence[float] | Floats) -> Self:
        """The primitive of a flat row (8,)."""

    @classmethod
    def from_sample(cls, xyz: ArrayLike, normals: ArrayLike) -> Self | None:
        """Primitive through a minimal set of points (k, 3) [m] with unit normals (k, 3) of any sign; None if
        degenerate.

        Raises:
            ValueError: the set has another number of points than the kind asks for. Source: Schnabel et al. 2007,
                section 4.1.
        """
        points, directions = _points(xyz), _points(normals)
        size = MINIMAL_SETS[cls.kind].size
        if len(points) != size or len(directions) != size:
            raise ValueError(f"a {cls.name} takes {size} points with normals, not {len(points)} and {len(directions)}")
        rows, whole = MINIMAL_SETS[cls.kind].rows(points[None], directions[None])
        return cls.from_row(rows[0]) if whole[0] else None

    def distance(self, xyz: ArrayLike) -> Floats:
        """Signed distances (n,) [m] of points (n, 3) [m]."""
        return _gradients(self, _points(xyz))[0]

    def normal(self, xyz: ArrayLike) -> Floats:
        """Unit normals (n, 3) of the primitive at points (n, 3) [m]; zero on a centre or axis, where there is none."""
        return _gradients(self, _points(xyz))[1]

    def fit(self, xyz: ArrayLike, weights: ArrayLike | None = None, size: tuple[float, float] = ANY_SIZE) -> Self:
        """Least squares from here: the primitive with the smallest weighted sum of squared distances to points (n, 3)
        [m].

        `size` bounds the radius (cone: half angle [rad]; torus: major radius), both ends included; it holds for the
        result.

        Raises:
            ValueError: weights are not (n,), or a size interval is empty.
        """
        points = _points(xyz)
        weight = np.ones(len(points)) if weights is None else np.ascontiguousarray(weights, dtype=np.float64)
        if weight.shape != (len(points),):
            raise ValueError(f"weights have shape {weight.shape}, the points ask for ({len(points)},)")
        if not size[0] <= size[1]:
            raise ValueError(f"size interval [{size[0]:g}, {size[1]:g}] is empty")
        samples = Samples(points, np.zeros(len(points), dtype=np.int64), weight)
        fitted = least_squares(np.array([self.kind]), self.row[None], samples, np.array([size]), iterations=100)
        return type(self).from_row(fitted[0])


@dataclass(frozen=True)
class Plane(Primitive):
    """Plane through a point [m] with a unit normal."""

    point: Vector
    direction: Vector
    kind: ClassVar[int] = numeric.PLANE
    name: ClassVar[str] = "plane"

    @property
    def row(self) -> Floats:
        """The flat form, (8,)."""
        return np.array([*self.point, *self.direction, 0.0, 0.0])

    @classmethod
    def from_row(cls, row: Sequence[float] | Floats) -> Self:
        """The plane of a flat row (8,)."""
        return cls(_vector(row[0:3]), _vector(row[3:6]))


@dataclass(frozen=True)
class Sphere(Primitive):
    """Sphere about a centre [m], radius [m]."""

    centre: Vector
    radius: float
    kind: ClassVar[int] = numeric.SPHERE
    name: ClassVar[str] = "sphere"

    @property
    def row(self) -> Floats:
        """The flat form, (8,)."""
        return np.array([*self.centre, 0.0, 0.0, 0.0, self.radius, 0.0])

    @classmethod
    def from_row(cls, row: Sequence[float] | Floats) -> Self:
        """The sphere of a flat row (8,)."""
        return cls(_vector(row[0:3]), float(row[6]))


@dataclass(frozen=True)
class Cylinder(Primitive):
    """Cylinder about the line through a point [m] along a unit axis, radius [m]."""

    point: Vector
    axis: Vector
    radius: float
    kind: ClassVar[int] = numeric.CYLINDER
    name: ClassVar[str] = "cylinder"

    @property
    def row(self) -> Floats:
        """The flat form, (8,)."""
        return np.array([*self.point, *self.axis, self.radius, 0.0])

    @classmethod
    def from_row(cls, row: Sequence[float] | Floats) -> Self:
        """The cylinder of a flat row (8,)."""
        return cls(_vector(row[0:3]), _vector(row[3:6]), float(row[6]))


@dataclass(frozen=True)
class Cone(Primitive):
    """One nappe of a cone: apex [m], unit axis into the nappe, half angle [rad]."""

    apex: Vector
    axis: Vector
    angle: float
    kind: ClassVar[int] = numeric.CONE
    name: ClassVar[str] = "cone"

    @property
    def row(self) -> Floats:
        """The flat form, (8,)."""
        return np.array([*self.apex, *self.axis, self.angle, 0.0])

    @classmethod
    def from_row(cls, row: Sequence[float] | Floats) -> Self:
        """The cone of a flat row (8,)."""
        return cls(_vector(row[0:3]), _vector(row[3:6]), float(row[6]))


@dataclass(frozen=True)
class Torus(Primitive):
    """Torus about a centre [m] and unit axis, radii [m] of the ring and of the tube."""

    centre: Vector
    axis: Vector
    major: float
    minor: float
    kind: ClassVar[int] = numeric.TORUS
    name: ClassVar[str] = "torus"

    @property
    def row(self) -> Floats:
        """The flat form, (8,)."""
        return np.array([*self.centre, *self.axis, self.major, self.minor])

    @classmethod
    def from_row(cls, row: Sequence[float] | Floats) -> Self:
        """The torus of a flat row (8,)."""
        return cls(_vector(row[0:3]), _vector(row[3:6]), float(row[6]), float(row[7]))


PRIMITIVES: tuple[type[Primitive], ...] = (Plane, Sphere, Cylinder, Cone, Torus)  # the index is the kind


def _points(values: ArrayLike) -> Floats:
    points = np.ascontiguousarray(values, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points have shape {points.shape}, expected (n, 3)")
    return points


def _vector(values: Sequence[float] | Floats) -> Vector:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _gradients(primitive: Primitive, xyz: Floats) -> tuple[Floats, Floats]:
    """Signed distances (n,) and unit normals (n, 3)."""
    distance, normal = np.empty(len(xyz)), np.empty((len(xyz), 3))
    numeric.gradients(primitive.kind, primitive.row, xyz, distance, normal)
    return distance, normal

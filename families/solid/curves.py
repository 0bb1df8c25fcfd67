"""Curves in space [mm] that edges of a vault follow, each as a formula for numpy and as OpenCASCADE's geometry."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from math import atan2, ceil, cos, hypot, pi, sin, tan

import numpy as np
from numpy.typing import NDArray
from OCP.Geom import Geom_BezierCurve, Geom_BSplineCurve, Geom_Circle, Geom_Curve, Geom_Ellipse, Geom_Line
from OCP.Geom2d import Geom2d_BSplineCurve, Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax2, gp_Dir, gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array1OfPnt2d
from OCP.TColStd import TColStd_Array1OfReal

from families.declaration.units import MM
from families.solid.occ.splines import spline_data
from families.solid.splines import DEGREE, evaluated, interpolated
from families.void.profile_outline import Bow

Array = NDArray[np.float64]
Point = tuple[float, float, float]
SAMPLES = 25  # of a curve that is interpolated
ARC_STEP = 0.06  # [rad] between the samples of a circle
STRAIGHT = 1e-9  # of the parameters of a surface, to which a curve on it is a straight line
TINY = 1e-300
LEAST = -pi / 2 - 0.1  # of the angles of conics: no upright quarter is cut there


class Path(ABC):
    """A curve P(t) in space."""

    @property
    @abstractmethod
    def geometry(self) -> Geom_Curve:
        """OpenCASCADE's curve, with the same parameter."""

    @abstractmethod
    def points(self, t: Array) -> Array:
        """Points (n, 3) at parameters (n,)."""

    def at(self, t: float) -> Point:
        """The point at one parameter."""
        return point(self.points(np.array([t]))[0])

    def samples(self, start: float, end: float) -> tuple[Array, Array]:
        """Parameters (n,) and points (n, 3) at which a curve on a surface is to agree with this one."""
        return self._sampled(start, end, SAMPLES)

    def _sampled(self, start: float, end: float, count: int) -> tuple[Array, Array]:
        t = start + (end - start) * shares(count)
        return t, self.points(t)


class Simple(Path):
    """A curve that tells the parameters of its points."""

    @abstractmethod
    def parameters(self, points: Array) -> Array:
        """Parameters (n,) of points (n, 3) if those lie on the curve; any number for others."""

    def parameter(self, point: Point) -> float:
        """The same of one point."""
        return float(self.parameters(np.array([point]))[0])


@dataclass(frozen=True)
class Straight(Simple):
    """Line through the place of `origin` nearest to (0, 0, 0), along a unit vector; the parameter is the way along."""

    direction: Point
    origin: Point

    @cached_property
    def geometry(self) -> Geom_Curve:
        """Line."""
        return Geom_Line(gp_Pnt(*self.origin), gp_Dir(*self.direction))

    def points(self, t: Array) -> Array:
        """Points at parameters."""
        found: Array = np.outer(t, self.direction) + self.origin
        return found

    def at(self, t: float) -> Point:
        """The point at one parameter."""
        (a, b, c), (x, y, z) = self.direction, self.origin
        return x + t * a, y + t * b, z + t * c

    def parameters(self, points: Array) -> Array:
        """The way along."""
        return points @ np.array(self.direction)  # type: ignore[no-any-return]  # numpy's stubs

    def parameter(self, point: Point) -> float:
        """The same of one point."""
        (a, b, c), (x, y, z) = self.direction, point
        return a * x + b * y + c * z

    @staticmethod
    def through(point: Point, direction: Point) -> Straight:
        """The line through a point along a unit vector."""
        (a, b, c), (x, y, z) = direction, point
        way = a * x + b * y + c * z
        return Straight(direction, (x - way * a, y - way * b, z - way * c))

    @staticmethod
    def between(start: Point, end: Point) -> Straight:
        """The line through two points."""
        x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
        size = hypot(x, y, z)
        return Straight.through(start, (x / size, y / size, z / size))


@dataclass(frozen=True)
class Conic(Simple):
    """Circle or ellipse centre + a cos t X + b sin t Y, with X and Y orthonormal."""

    centre: Point
    x: Point
    y: Point
    a: float
    b: float

    @cached_property
    def geometry(self) -> Geom_Curve:
        """Circle, or ellipse with its long axis first."""
        x, y = gp_Dir(*self.x), gp_Dir(*self.y)
        frame = gp_Ax2(gp_Pnt(*self.centre), x.Crossed(y), x)
        return Geom_Circle(frame, self.a) if self.a == self.b else Geom_Ellipse(frame, self.a, self.b)

    @cached_property
    def _axes(self) -> Array:
        return np.array([self.x, self.y]) * [[self.a], [self.b]]

    def points(self, t: Array) -> Array:
        """Points at eccentric angles."""
        across, up = self._axes
        found: Array = np.cos(t)[:, None] * across + np.sin(t)[:, None] * up + self.centre
        return found

    def at(self, t: float) -> Point:
        """The point at one eccentric angle."""
        (x, y, z), (a, b, c), (d, e, f) = self.centre, self.x, self.y
        across, up = self.a * cos(t), self.b * sin(t)
        return x + across * a + up * d, y + across * b + up * e, z + across * c + up * f

    def parameters(self, points: Array) -> Array:
        """Eccentric angles from `LEAST` up."""
        rest = points - np.array(self.centre)
        angle = np.arctan2(rest @ self.y / self.b, rest @ self.x / self.a)
        return np.where(angle < LEAST, angle + 2 * pi, angle)  # type: ignore[no-any-return]  # numpy's stubs

    def parameter(self, point: Point) -> float:
        """Eccentric angle of one point."""
        x, y, z = (a - b for a, b in zip(point, self.centre, strict=True))
        across, up = (x * v[0] + y * v[1] + z * v[2] for v in (self.x, self.y))
        angle = atan2(up / self.b, across / self.a)
        return angle + 2 * pi if angle < LEAST else angle

    def samples(self, start: float, end: float) -> tuple[Array, Array]:
        """As many as the angle asks for."""
        return self._sampled(start, end, max(SAMPLES, ceil(abs(end - start) / ARC_STEP)))

    @staticmethod
    def of(bow: Bow, place: Array, across: Array, up: Array) -> tuple[Conic, float, float]:
        """A bow [m] drawn with (0, 0) at `place` (3,) [mm], and its parameters at its start and its end."""
        centre = place + MM * (bow.u * across + bow.z * up)
        # OpenCASCADE counts from the long axis.
        turned = bow.b > bow.a
        x, y, shift = (up, -across, pi / 2) if turned else (across, up, 0.0)
        a, b = (bow.b, bow.a) if turned else (bow.a, bow.b)
        return Conic(point(centre), point(x), point(y), MM * a, MM * b), bow.start - shift, bow.end - shift


@dataclass(frozen=True)
class Bezier(Simple):
    """Rational Bézier curve of degree 2 by poles (3, 3) with weights 1, w, 1; the parameter runs from 0 to 1."""

    poles: Array
    weight: float = 1.0

    @cached_property
    def geometry(self) -> Geom_Curve:
        """Bézier curve."""
        poles, weights = TColgp_Array1OfPnt(1, 3), TColStd_Array1OfReal(1, 3)
        for k, pole in enumerate(self.poles.tolist(), 1):
            poles.SetValue(k, gp_Pnt(*pole))
            weights.SetValue(k, self.weight if k == 2 else 1.0)
        return Geom_BezierCurve(poles) if self.weight == 1 else Geom_BezierCurve(poles, weights)

    def points(self, t: Array) -> Array:
        """Points at parameters."""
        basis = np.stack([(1 - t) ** 2, 2 * self.weight * t * (1 - t), t**2], axis=1)
        found: Array = np.divide(basis @ self.poles, basis.sum(axis=1)[:, None])
        return found

    def parameters(self, points: Array) -> Array:
        """Parameters: with P1 as origin an arc's point is early P0 + late P2, and t / (1 - t) = √(late / early)."""
        first, middle, last = self.poles
        if self.weight == 1:  # a parabola about the plumb line, along which it moves evenly
            along = (last - first) * (1, 1, 0)
            return (points - first) @ along / (along @ along)  # type: ignore[no-any-return]  # numpy's stubs
        frame = np.stack([first - middle, last - middle], axis=1)
        early, late = np.sqrt(np.linalg.lstsq(frame, (points - middle).T)[0].clip(min=0.0))
        return late / np.maximum(early + late, TINY)  # type: ignore[no-any-return]  # numpy's stubs


@dataclass(frozen=True)
class Spline(Path):
    """Interpolating spline: its knots (n + 6,) and poles (n, 3), laid through points (n, 3) at parameters (n,)."""

    knots: Array
    poles: Array
    nodes: Array
    laid: Array

    @staticmethod
    def through(points: Array) -> Spline:
        """Through points (n, 3), by the lengths of its chords."""
        steps = np.diff(points, axis=0)
        nodes = np.append(0.0, np.cumsum(np.sqrt((steps * steps).sum(axis=1))))
        knots, poles = interpolated(nodes, points)
        return Spline(knots, poles, nodes, points)

    @property
    def end(self) -> float:
        """Last parameter; the first is 0."""
        return float(self.nodes[-1])

    @cached_property
    def geometry(self) -> Geom_Curve:
        """B-spline curve."""
        return Geom_BSplineCurve(*spline_data(self.knots, self.poles, DEGREE, TColgp_Array1OfPnt, gp_Pnt))

    def points(self, t: Array) -> Array:
        """Points at parameters."""
        found: Array = evaluated(self.knots, self.poles, t)
        return found

    def samples(self, start: float, end: float) -> tuple[Array, Array]:
        """The points through which it was laid."""
        return self.nodes, self.laid


def drawn(path: Path, start: float, end: float, parameters: Callable[[Array], Array]) -> Geom2d_Curve:
    """A path in the parameters of a surface, given by those (n, 2) of points (n, 3): a straight line if it is one."""
    t, points = path.samples(start, end)
    uv = parameters(points)
    # Not by the ends, which may be poles, where one of the parameters means nothing.
    inner = slice(1, -1)
    first, last = uv[inner][[0, -1]]
    rate = (last - first) / (t[-2] - t[1])
    if np.abs(first + np.outer(t - t[1], rate) - uv)[inner].max() > STRAIGHT * max(1.0, np.abs(uv).max()):
        knots, poles = interpolated(t, uv)
        return Geom2d_BSplineCurve(*spline_data(knots, poles, DEGREE, TColgp_Array1OfPnt2d, gp_Pnt2d))
    origin, speed = first - t[1] * rate, hypot(*rate)
    if abs(speed - 1) < STRAIGHT:
        return Geom2d_Line(gp_Pnt2d(*origin.tolist()), gp_Dir2d(*rate.tolist()))
    ends = np.array([start, start, end, end])
    poles = origin + np.outer(ends[[0, -1]], rate)
    return Geom2d_BSplineCurve(*spline_data(ends, poles, 1, TColgp_Array1OfPnt2d, gp_Pnt2d))


def arc_weight(angle: float) -> float:
    """Weight of the middle pole of a Bézier arc over an angle."""
    return cos(angle / 2)


def arc_parameter(angle: Array, start: float, end: float) -> Array:
    """Parameter (n,) of a Bézier arc from `start` to `end` at (eccentric) angles (n,): P(t) is stereographic."""
    return (1 + np.tan((angle - (start + end) / 2) / 2) / tan((end - start) / 4)) / 2


def arc_poles(bow: Bow) -> Array:
    """Poles (3, 2) in (u, z) of a bow as a Bézier arc: the middle one is where the tangents at its ends meet."""
    angles = np.array([bow.start, (bow.start + bow.end) / 2, bow.end])
    reach = np.array([1.0, 1 / cos((bow.end - bow.start) / 2), 1.0])
    return np.stack([bow.u + bow.a * reach * np.cos(angles), bow.z + bow.b * reach * np.sin(angles)], axis=1)


@cache
def shares(count: int) -> Array:
    """Shares (`count`,) from 0 to 1, the denser towards the ends, where splines are the least accurate."""
    found: Array = (1 - np.cos(np.linspace(0, np.pi, count))) / 2
    return found


def point(vector: Array) -> Point:
    """A vector (3,) as a point."""
    x, y, z = vector.tolist()
    return x, y, z

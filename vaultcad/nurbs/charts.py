"""Charts: two directions of a component's net, and the rays along which its surface is measured.

A family gives the axis or the centre about which a component was built and how wide and high its outline is, nothing
of its curve.
In a chart every point has two coordinates along the net [m] and a reach along the ray there [m]; a surface is
its reach over both. Rays start so far below a flat arch that they meet it at a wide angle everywhere.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from math import cos, hypot, pi, sin

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Part, Turned, Web

Array = NDArray[np.float64]
DEEPEST = 0.8  # depth of an axis below the springing / half span, at the most
SHALLOWEST = 0.5  # likewise of a centre, at the least: rays to corners on its own level would be level
RIB_STEPS, RIB_POWER = 25, 5  # places along a rib, and power of the polynomial that its chord is taken for
CROWNED = 0.5  # how far below its chord the axis is at the crown, as a share of what it is at the wall beyond that
STEEPEST = 1.45  # rad, of a coordinate of a chart about a centre, beyond which rays are all but level


class Chart(ABC):
    """A way between places (n, 3) [m] and charts of them: u, v (n,) along the net and reach (n,) [m].

    turn: what u grows by in a full turn [m], for charts that close; else 0.
    """

    turn: float = 0.0

    @abstractmethod
    def chart(self, xyz: Array) -> tuple[Array, Array, Array]:
        """u, v and reach of places."""

    @abstractmethod
    def place(self, u: Array, v: Array, reach: Array) -> Array:
        """Places (n, 3)."""


@dataclass(frozen=True)
class AlongAxis(Chart):
    """u along a straight axis, v the angle about it times `size`: generators and directrices.

    The axis runs through `origin` (3,) square to `across` in plan, and climbs by `slope`.
    """

    origin: tuple[float, float, float]
    across: tuple[float, float]
    size: float
    slope: float = 0.0

    def chart(self, xyz: Array) -> tuple[Array, Array, Array]:
        """Along, angle from the side of -across over the crown, distance from the axis."""
        (ox, oy, oz), (cx, cy) = self.origin, self.across
        x, y = xyz[:, 0] - ox, xyz[:, 1] - oy
        across, along = cx * x + cy * y, cx * y - cy * x
        up = xyz[:, 2] - oz - self.slope * along
        # Measured from the crown, so that the cut of the angle lies straight below.
        return along, self.size * np.arctan2(across, up), np.hypot(across, up)

    def place(self, u: Array, v: Array, reach: Array) -> Array:
        """Places."""
        (ox, oy, oz), (cx, cy) = self.origin, self.across
        across, up = reach * np.sin(v / self.size), reach * np.cos(v / self.size)
        return np.stack([ox + cx * across - cy * u, oy + cy * across + cx * u, oz + self.slope * u + up], axis=1)


@dataclass(frozen=True)
class AboutCentre(Chart):
    """u and v the angles, times `size`, by which the ray from a centre leans towards x and towards y.

    Their lines are plane sections parallel to y and to x; unlike meridians they meet in no pole.
    """

    centre: tuple[float, float, float]
    size: float
    round: bool = False  # whether its net is of parallels and meridians all the same

    def chart(self, xyz: Array) -> tuple[Array, Array, Array]:
        """Leans and distance from the centre."""
        x, y, z = (xyz - self.centre).T
        u, v = (self.size * np.clip(np.arctan2(side, z), -STEEPEST, STEEPEST) for side in (x, y))
        return u, v, np.sqrt(x * x + y * y + z * z)

    def place(self, u: Array, v: Array, reach: Array) -> Array:
        """Places."""
        ray = np.stack([np.tan(u / self.size), np.tan(v / self.size), np.ones_like(u)], axis=1)
        ray *= (reach / np.linalg.norm(ray, axis=1))[:, None]
        found: Array = ray + self.centre
        return found


@dataclass(frozen=True)
class BetweenRibs(Chart):
    """u the angle, times `size`, of a fan of planes square to the ribs, v that about the chord of the ribs there.

    The planes hold the line through `centre` along `across`; in the one that leans by an angle a from upright, the axis
    is at `chord`(a) from that line and `middle`(a) along it, both polynomials, the highest power first [m].
    """

    centre: tuple[float, float, float]
    across: tuple[float, float]
    size: float
    width: float
    chord: tuple[float, ...]
    middle: tuple[float, ...]

    def chart(self, xyz: Array) -> tuple[Array, Array, Array]:
        """Lean, angle about the chord from its outside, distance from it."""
        x, y, z = (xyz - self.centre).T
        cx, cy = self.across
        side, ahead = cx * x + cy * y, cx * y - cy * x
        lean = np.arctan2(-ahead, z)
        out, side = np.hypot(ahead, z) - np.polyval(self.chord, lean), side - np.polyval(self.middle, lean)
        return self.size * lean, self.width * np.arctan2(side, out), np.hypot(side, out)

    def place(self, u: Array, v: Array, reach: Array) -> Array:
        """Places."""
        lean, turn = u / self.size, v / self.width
        out = reach * np.cos(turn) + np.polyval(self.chord, lean)
        side = reach * np.sin(turn) + np.polyval(self.middle, lean)
        (cx, cy), ahead = self.across, -out * np.sin(lean)
        return np.stack([cx * side - cy * ahead, cy * side + cx * ahead, out * np.cos(lean)], axis=1) + self.centre


@dataclass(frozen=True)
class Meridians(Chart):
    """u the azimuth from `start` [rad] and v the elevation over a centre, times `size`: parallels and meridians."""

    centre: tuple[float, float, float]
    start: float
    size: float

    def chart(self, xyz: Array) -> tuple[Array, Array, Array]:
        """Azimuth, elevation, distance from the centre."""
        x, y, z = (xyz - self.centre).T
        flat = np.hypot(x, y)
        return (
            self.size * _turned(np.arctan2(y, x), self.start),
            self.size * np.arctan2(z, flat),
            np.hypot(flat, z),
        )

    def place(self, u: Array, v: Array, reach: Array) -> Array:
        """Places."""
        a, e = u / self.size + self.start, v / self.size
        flat = reach * np.cos(e)
        return np.stack([flat * np.cos(a), flat * np.sin(a), reach * np.sin(e)], axis=1) + self.centre


@dataclass(frozen=True)
class AboutRing(Chart):
    """u the azimuth from `start` times `ring`, v the angle about a level circle of that radius, times `size`."""

    centre: tuple[float, float, float]
    ring: float
    start: float
    size: float
    closed: bool = False

    @property
    def turn(self) -> float:  # type: ignore[override]  # of the instance here
        """A full turn."""
        return 2 * pi * self.ring if self.closed else 0.0

    def chart(self, xyz: Array) -> tuple[Array, Array, Array]:
        """Azimuth, angle from the inner side over the crown, distance from the circle."""
        x, y, z = (xyz - self.centre).T
        out = np.hypot(x, y) - self.ring
        return (
            self.ring * _turned(np.arctan2(y, x), self.start),
            self.size * np.arctan2(out, z),
            np.hypot(out, z),
        )

    def place(self, u: Array, v: Array, reach: Array) -> Array:
        """Places."""
        a, t = u / self.ring + self.start, v / self.size
        flat = self.ring + reach * np.sin(t)
        return np.stack([flat * np.cos(a), flat * np.sin(a), reach * np.cos(t)], axis=1) + self.centre


@dataclass(frozen=True)
class Upright(Chart):
    """u the azimuth times `radius`, v the height, reach from an upright axis: of a drum."""

    centre: tuple[float, float, float]
    radius: float
    start: float
    closed: bool = False

    @property
    def turn(self) -> float:  # type: ignore[override]  # of the instance here
        """A full turn."""
        return 2 * pi * self.radius if self.closed else 0.0

    def chart(self, xyz: Array) -> tuple[Array, Array, Array]:
        """Azimuth, height, distance from the axis."""
        x, y, z = (xyz - self.centre).T
        return self.radius * _turned(np.arctan2(y, x), self.start), z, np.hypot(x, y)

    def place(self, u: Array, v: Array, reach: Array) -> Array:
        """Places."""
        a = u / self.radius + self.start
        return np.stack([reach * np.cos(a), reach * np.sin(a), v], axis=1) + self.centre


@dataclass(frozen=True, eq=False)
class OverPlane(Chart):
    """u and v in a plane and reach out of it. axes: (3, 3), rows u, v, normal."""

    origin: Array
    axes: Array

    def chart(self, xyz: Array) -> tuple[Array, Array, Array]:
        """Coordinates in the plane and from it."""
        u, v, reach = self.axes @ (xyz - self.origin).T
        return u, v, reach

    def place(self, u: Array, v: Array, reach: Array) -> Array:
        """Places."""
        found: Array = np.stack([u, v, reach], axis=1) @ self.axes + self.origin
        return found


def _turned(angle: Array, start: float) -> Array:
    """Angles [rad] as they are reached from `start` by less than a turn either way of the middle of one."""
    found: Array = (angle - start) % (2 * pi)
    return found


def chart_of(part: Part | None, name: str, outline: Array) -> Chart:
    """The chart of a component of that name, made by a part, from places (n, 3) [m] of its outline."""
    match part:
        case BarrelPart() if name != part.below:
            across = (outline[:, :2] - part.origin) @ np.array(part.across)
            along = (outline[:, :2] - part.origin) @ np.array(part.along)
            above = outline[:, 2] - part.base - part.slope * along
            return _along(part.origin, part.across, part.base, np.abs(across).max(), above.max(), part.slope)
        case Web():
            return _between_ribs(part)
        case Turned() if name == part.names[0] != part.names[1]:
            start, whole = _start(outline[:, :2] - part.centre)
            return Upright((*part.centre, 0.0), part.curve.half_span, start, whole)
        case Turned() if part.radius:
            start, whole = _start(outline[:, :2] - part.centre)
            out = np.abs(np.hypot(*(outline[:, :2] - part.centre).T) - part.radius).max()
            rise = outline[:, 2].max() - part.base
            depth = _depth(out, rise)
            return AboutRing((*part.centre, part.base - depth), part.radius, start, hypot(out, depth), whole)
        case Turned():
            reach = np.hypot(*(outline[:, :2] - part.centre).T).max()
            return replace(_about(part.centre, part.base, reach, part.curve.rise), round=True)
        case Ball() if len(part.names) == 1:
            reach = np.hypot(*(outline[:, :2] - part.centre).T).max()
            return _about(part.centre, float(outline[:, 2].min()), reach, part.top - float(outline[:, 2].min()))
        case Ball():
            start, _ = _start(outline[:, :2] - part.centre)
            return Meridians((*part.centre, part.z), start, part.radius)
    return _flat(outline)


def _along(
    origin: tuple[float, float], across: tuple[float, float], base: float, half: float, rise: float, slope: float
) -> AlongAxis:
    depth = _depth(half, rise)
    return AlongAxis((*origin, base - depth), across, (hypot(half, depth) + rise + depth) / 2, slope)


def _about(centre: tuple[float, float], base: float, half: float, rise: float) -> AboutCentre:
    depth = max(_depth(half, rise), SHALLOWEST * half)
    return AboutCentre((*centre, base - depth), (hypot(half, depth) + rise + depth) / 2)


def _between_ribs(part: Web) -> BetweenRibs:
    """By the ribs at the edges of a web and the rise of its wall arch."""
    (x, y), start, end = part.centre, np.array(part.start), np.array(part.end)
    size = float(np.hypot(*(end - start)))
    across = (end - start) / size
    depth = _depth(part.reach, part.diagonal.rise)
    share = np.sin(np.linspace(0, pi / 2, RIB_STEPS))
    height = np.array([part.diagonal.height(float(v) * part.reach) for v in share])
    middle = ((start + end) / 2 - part.centre) @ across
    wall = float((start - part.centre) @ [across[1], -across[0]])
    lean = np.arctan2(share * wall, height + depth)
    # Well below the chord, for towards the crown arches on it may be as flat as one likes, and the chord is a point.
    out = np.hypot(share * wall, height + depth) - DEEPEST * (share + CROWNED) / (1 + CROWNED) * size / 2
    chord, mean = (tuple(np.polyfit(lean, values, RIB_POWER).tolist()) for values in (out, share * middle))
    return BetweenRibs((x, y, -depth), (float(across[0]), float(across[1])), part.reach, size / 2, chord, mean)


def _depth(half: float, rise: float) -> float:
    """How far below its springing the centre of a circle through the feet and the crown of an arch lies [m]."""
    if rise >= half:
        return 0.0
    return min((half * half - rise * rise) / (2 * max(rise, 1e-9)), DEEPEST * half)


def _start(xy: Array) -> tuple[float, bool]:
    """From which azimuth [rad] places (n, 2) are reached in one turn, in the middle of the widest gap; if there is one.

    Where they go all round, a turn starts to the west.
    """
    angle = np.sort(np.arctan2(xy[:, 1], xy[:, 0]))
    gaps = np.diff(np.append(angle, angle[0] + 2 * pi))
    k = int(gaps.argmax())
    if gaps[k] < pi / 4:
        return -pi, True
    middle = angle[k] + gaps[k] / 2
    return float(np.arctan2(sin(middle), cos(middle))), False


def _flat(outline: Array) -> OverPlane:
    """Over the plane that suits an outline best; u level, its normal upwards or outwards."""
    origin = outline.mean(axis=0)
    normal = np.linalg.svd(outline - origin, full_matrices=False)[2][2]
    if abs(normal[2]) > 0.5:
        normal, along = normal * np.sign(normal[2]), np.array([1.0, 0.0, 0.0])
        along -= (along @ normal) * normal
    else:
        normal *= np.sign(normal @ [*origin[:2], 0.0] or 1.0)
        along = np.array([-normal[1], normal[0], 0.0])
    along /= np.linalg.norm(along)
    return OverPlane(origin, np.stack([along, np.cross(normal, along), normal]))

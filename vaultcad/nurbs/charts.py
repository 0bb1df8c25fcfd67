"""Charts: two directions of a component's net, and the rays along which its surface is measured.

A family gives the axis or the centre about which a component was built and how wide and high its outline is, nothing
of its curve.
In a chart every point has two coordinates along the net [m] and a reach along the ray there [m]; a surface is
its reach over both. Rays start so far below a flat arch that they meet it at a wide angle everywhere.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEEPEST = 1.45  # rad, of a coordinate of a chart about a centre, beyond which rays are all but level


class Chart(ABC):
    """A way between places (n, 3) [m] and charts of them: u, v (n,) along the net and reach (n,) [m]."""

    @property
    def turn(self) -> float:
        """What u grows by in a full turn [m], for charts that close; else 0."""
        return 0.0

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
    def turn(self) -> float:
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
class AboutUpright(Chart):
    """u the azimuth times `radius`, v the height, reach from an upright axis: of a drum."""

    centre: tuple[float, float, float]
    radius: float
    start: float
    closed: bool = False

    @property
    def turn(self) -> float:
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

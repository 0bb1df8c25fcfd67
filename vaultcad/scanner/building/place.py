"""Where something stands in a building: a frame that is moved, and turned about the vertical."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, degrees, sin

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Place:
    """The origin of a frame [m] and the yaw of its x axis [rad]; z is up in all of them."""

    x: float
    y: float
    z: float = 0.0
    yaw: float = 0.0

    @property
    def origin(self) -> Array:
        """(3,) [m]."""
        return np.array([self.x, self.y, self.z])

    @property
    def yaw_deg(self) -> float:
        """As people say it."""
        return degrees(self.yaw)

    @property
    def axes(self) -> Array:
        """The x and the y axis (2, 2) in plan, a row each."""
        c, s = cos(self.yaw), sin(self.yaw)
        return np.array([[c, s], [-s, c]])

    def out(self, points: Array) -> Array:
        """Points (n, 2) or (n, 3) [m] of the frame in that of the building."""
        found = np.array(points, np.float64)
        found[:, :2] = found[:, :2] @ self.axes
        found += self.origin[: found.shape[1]]
        return found

    def into(self, points: Array) -> Array:
        """Points (n, 2) or (n, 3) [m] of the building in the frame."""
        found = np.asarray(points, np.float64) - self.origin[: points.shape[1]]
        found[:, :2] = found[:, :2] @ self.axes.T
        return found

    def seen(self, whole: Place) -> Place:
        """The same in the frame that `whole` is placed in."""
        x, y, z = whole.out(self.origin[None])[0].tolist()
        return Place(x, y, z, self.yaw + whole.yaw)

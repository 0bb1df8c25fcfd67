"""Where a vault stands in the scan, and how it leans with it."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, hypot, sin

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Pose:
    """Where a vault stands in the scan's local frame: its origin [m], and its x axis turned by `yaw` about z [rad].

    lean: rotation vector about the scan's x and y axes [rad] by which all of it then leans with the scan.
    """

    x: float
    y: float
    z: float
    yaw: float
    lean: tuple[float, float] = (0.0, 0.0)

    @property
    def tilt(self) -> float:
        """Of its vertical from the scan's [rad]."""
        return hypot(*self.lean)

    def _turn(self) -> NDArray[np.float64]:
        """(3, 3): brings directions of the vault's frame into the scan's."""
        c, s = cos(self.yaw), sin(self.yaw)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        return tilted(self.lean) @ turn if any(self.lean) else turn

    def frame(self) -> NDArray[np.float64]:
        """(3, 4): brings points of the scan's local frame into the vault's."""
        out = np.empty((3, 4))
        turn = out[:, :3] = self._turn().T
        out[:, 3] = -turn @ [self.x, self.y, self.z]
        return out

    def placement(self) -> NDArray[np.float64]:
        """(4, 4): brings points of the vault's frame into the scan's local frame."""
        out = np.eye(4)
        out[:3, :3], out[:3, 3] = self._turn(), (self.x, self.y, self.z)
        return out


def tilted(lean: tuple[float, float]) -> NDArray[np.float64]:
    """The rotation (3, 3) by a vector about a horizontal axis [rad], by Rodrigues' formula."""
    angle = hypot(*lean)
    if angle == 0:
        return np.eye(3)
    x, y = lean[0] / angle, lean[1] / angle
    c, s = cos(angle), sin(angle)
    return np.array(
        [
            [c + x * x * (1 - c), x * y * (1 - c), y * s],
            [x * y * (1 - c), c + y * y * (1 - c), -x * s],
            [-y * s, x * s, c],
        ]
    )

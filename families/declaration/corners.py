"""Plans that are no rectangles: four free corners, between which the vault is stretched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from families.declaration.parameters import Parametric, Range

Array = NDArray[np.float64]
NEWTON_STEPS = 8  # of Newton's method at the most; from the middle of a bay three mostly do
CLOSE = 1e-12  # [m]


@dataclass(frozen=True)
class Skew(Parametric):
    """How the corners of a plan are off those of a rectangle: the one bilinear map that has them so.

    Four corners have eight coordinates: place and yaw take three, the two spans, now in the middle of the plan, two,
    and these the last three. All are 0 for a rectangle. Sides stay straight, heights stay as they are.
    """

    shear: Annotated[float, Range(-0.5, 0.5, "1", "lean of the plan: shift in x for each metre along y")] = 0.0
    taper_x: Annotated[float, Range(-0.5, 0.5, "1", "north side less the middle span in x / that span")] = 0.0
    taper_y: Annotated[float, Range(-0.5, 0.5, "1", "east side less the middle span in y / that span")] = 0.0

    def bent(self, points: Array, half: Array) -> Array:
        """Points (n, 3) [m] of the straight vault, where they are in the skewed one; `half` (2,) are its extents."""
        x, y = points[:, 0], points[:, 1]
        out = np.array(points, dtype=np.float64)
        out[:, 0] = x * (1 + self.taper_x * y / half[1]) + self.shear * y
        out[:, 1] = y * (1 + self.taper_y * x / half[0])
        return out

    def straightened(self, points: Array, half: Array) -> Array:
        """The inverse of `bent`, by Newton's method."""
        out = np.array(points, dtype=np.float64)
        for _ in range(NEWTON_STEPS):
            miss = (self.bent(out, half) - points)[:, :2]
            if not len(miss) or np.abs(miss).max() < CLOSE:
                break
            a, b, c, d = self._slopes(out, half)
            # Far outside the plan the map folds over; such points are far from the vault whatever they become.
            det = np.maximum(a * d - b * c, 0.05)
            out[:, 0] -= (d * miss[:, 0] - b * miss[:, 1]) / det
            out[:, 1] -= (a * miss[:, 1] - c * miss[:, 0]) / det
        return out

    def gradients(self, points: Array, normals: Array, half: Array) -> Array:
        """Gradients (n, 3), in the skewed frame, of distances whose gradients at straight points (n, 3) are given."""
        a, b, c, d = self._slopes(points, half)
        det = np.maximum(a * d - b * c, 0.05)
        out = np.array(normals, dtype=np.float64)
        out[:, 0] = (d * normals[:, 0] - c * normals[:, 1]) / det
        out[:, 1] = (a * normals[:, 1] - b * normals[:, 0]) / det
        return out

    def corners(self, half: Array) -> Array:
        """The corners (4, 2) [m], counterclockwise from south west."""
        square = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
        return self.bent(square * [*half, 0.0], half)[:, :2]

    def _slopes(self, points: Array, half: Array) -> tuple[Array, Array, Array, Array]:
        """Derivatives of bent x and y by x and y: xx, xy, yx, yy, each (n,)."""
        x, y = points[:, 0], points[:, 1]
        return (
            1 + self.taper_x * y / half[1],
            self.taper_x * x / half[1] + self.shear,
            self.taper_y * y / half[0],
            1 + self.taper_y * x / half[0],
        )

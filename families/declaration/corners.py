"""Plans that are no rectangles: four free corners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from families.declaration.parameters import Parametric, Range
from families.declaration.plan_sides import Vector


@dataclass(frozen=True)
class Skew(Parametric):
    """How the corners of a plan are off those of a rectangle.

    Four corners have eight coordinates: place and yaw take three, the two spans, now in the middle of the plan, two,
    and these the last three. All are 0 for a rectangle. Bodies keep their kind: between walls that converge a barrel
    narrows, one that lies askew is cut askew.
    """

    shear: Annotated[float, Range(-0.5, 0.5, "1", "lean of the plan: shift in x for each metre along y")] = 0.0
    taper_x: Annotated[float, Range(-0.5, 0.5, "1", "north side less the middle span in x / that span")] = 0.0
    taper_y: Annotated[float, Range(-0.5, 0.5, "1", "east side less the middle span in y / that span")] = 0.0

    def corners(self, half_x: float, half_y: float, taper: float = 0.0) -> tuple[Vector, ...]:
        """The corners of what had these half extents [m], counterclockwise from south west; more `taper` along x."""
        taper_x = self.taper_x + taper
        return tuple(
            (a * half_x * (1 + taper_x * b) + self.shear * b * half_y, b * half_y * (1 + self.taper_y * a))
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        )

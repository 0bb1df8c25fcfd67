"""What a scan shows of the ground under a vault before any family is tried: what first guesses begin from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

RECTANGLE, POLYGON, DISC, HALF_DISC, SECTOR = SHAPES = ("rectangle", "polygon", "disc", "half disc", "sector")
"""Of footprints; a family says which it stands over."""


@dataclass(frozen=True)
class Footprint:
    """A rectangle along x and y, or a shape about the origin: a polygon whose first side faces x, a disc, or parts of
    one about the y axis.

    span_x, span_y: clear widths [m], for all but a rectangle those of the whole circle, or of that within a polygon.
    sides: of a polygon. diagonal: how far its every second side is / the first. hole: inner radius / outer radius of a
    sector. angle: of a sector [rad]. slope_x, slope_y: by which the ceiling over a rectangle climbs along it.
    """

    span_x: float
    span_y: float
    sides: int = 4
    diagonal: float = 1.0
    hole: float = 0.0
    angle: float = 2 * pi
    slope_x: float = 0.0
    slope_y: float = 0.0

    @property
    def radius(self) -> float:
        """Half of the mean width [m]."""
        return (self.span_x + self.span_y) / 4

    def turned(self, quarters: int) -> Footprint:
        """A rectangle seen along axes that are turned by so many right angles."""
        if quarters % 4 == 0:
            return self
        once = replace(self, span_x=self.span_y, span_y=self.span_x, slope_x=self.slope_y, slope_y=-self.slope_x)
        return once.turned(quarters % 4 - 1)

    def square(self, unequal: float) -> bool:
        """Whether its spans differ by less than this share of the longer one."""
        return abs(self.span_x - self.span_y) < unequal * max(self.span_x, self.span_y)

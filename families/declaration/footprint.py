"""What a scan shows of the ground under a vault before any family is tried: what first guesses begin from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, pi, sin

from families.declaration.plan import Plan

RECTANGLE, POLYGON, GORED, DISC, HALF_DISC, SECTOR = SHAPES = (
    *("rectangle", "polygon", "gored polygon", "disc", "half disc", "sector"),
)
"""Of footprints; a family says which it stands over. Over a gored polygon ribs rise from the corners."""

CORNERED = 1.13  # every second side of an octagon so much farther away: there are the corners of a square


@dataclass(frozen=True)
class Footprint:
    """A rectangle along x and y, or a shape about the origin: a polygon whose first side faces x, a disc, or parts of
    one about the y axis.

    span_x, span_y: clear widths [m], for all but a rectangle those of the whole circle, or of that within a polygon.
    sides: of a polygon. diagonal: how far its every second side is / the first. hole: inner radius / outer radius of a
    sector. angle: of a sector [rad]. slope_x, slope_y: by which the ceiling over a rectangle climbs along it. splay_x,
    splay_y: by which share what would be one is wider at its east than in the middle, and at its north.
    """

    span_x: float
    span_y: float
    sides: int = 4
    diagonal: float = 1.0
    hole: float = 0.0
    angle: float = 2 * pi
    slope_x: float = 0.0
    slope_y: float = 0.0
    splay_x: float = 0.0
    splay_y: float = 0.0

    @property
    def radius(self) -> float:
        """Half of the mean width [m]."""
        return (self.span_x + self.span_y) / 4

    def plan(self, shape: str) -> Plan:
        """The outline of a footprint of that shape; the square of a crossing where every second side is as far."""
        radius, n = self.radius, self.sides
        if shape == DISC:
            return Plan.disc(radius)
        if shape == HALF_DISC:
            return Plan.half_disc(radius)
        if shape == SECTOR:
            return Plan.sector(self.hole * radius, radius, self.angle)
        if shape == RECTANGLE or self.diagonal > CORNERED:
            return Plan.rectangle(self.span_x / 2, self.span_y / 2)
        reach, turns = radius / cos(pi / n), [(2 * k - 1) * pi / n for k in range(n)]
        return Plan.polygon(tuple((reach * cos(turn), reach * sin(turn)) for turn in turns))

    def turned(self, quarters: int) -> Footprint:
        """A rectangle seen along axes that are turned by so many right angles."""
        if quarters % 4 == 0:
            return self
        once = replace(
            self,
            span_x=self.span_y,
            span_y=self.span_x,
            slope_x=self.slope_y,
            slope_y=-self.slope_x,
            splay_x=self.splay_y,
            splay_y=-self.splay_x,
        )
        return once.turned(quarters % 4 - 1)

    def square(self, unequal: float) -> bool:
        """Whether its spans differ by less than this share of the longer one."""
        return abs(self.span_x - self.span_y) < unequal * max(self.span_x, self.span_y)

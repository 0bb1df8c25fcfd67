"""The plan of a vault cut into cells, in each of which every body shows one side of its profile.

Surfaces are laid cell by cell: in each they rise from the wall to the crown, and two of them meet in one line.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product

from families.declaration.pieces import Ball, BarrelPart, Direction, Piece, Plan

SAME_CUT = 1e-6  # [m], cuts nearer than that are one


@dataclass(frozen=True)
class Cell:
    """Box [m] in which bodies are made: (x0, x1), (y0, y1), z from `low` up to `high`."""

    x: tuple[float, float]
    y: tuple[float, float]
    low: float
    high: float

    def side(self, direction: Direction) -> tuple[float, float]:
        """Extent along a direction."""
        return self.x if direction == "x" else self.y


@dataclass(frozen=True)
class Cuts:
    """Where a plan is cut inside, in rising order [m]."""

    x: tuple[float, ...]
    y: tuple[float, ...]

    def cells(self, half_x: float, half_y: float, low: float, high: float) -> Iterator[Cell]:
        """The cells of a rectangle."""
        xs, ys = (-half_x, *self.x, half_x), (-half_y, *self.y, half_y)
        for x, y in product(pairwise(xs), pairwise(ys)):
            yield Cell(x, y, low, high)


def cuts(pieces: tuple[Piece, ...], plan: Plan) -> Cuts:
    """Cuts at the axes of all profiles, where components part, and half-way between parallel barrels."""
    found: dict[Direction, list[float]] = {"x": [], "y": []}
    axes: dict[Direction, list[float]] = {"x": [], "y": []}
    for part in (part for piece in pieces for part in piece.parts):
        if isinstance(part, BarrelPart):
            found[part.across].append(part.centre)
            if not part.side:
                axes[part.across].append(part.centre)
            if part.crown_rise or part.names[0] != part.names[1]:
                found["y" if part.across == "x" else "x"].append(0.0)
        elif isinstance(part, Ball) and len(part.names) > 1:
            found["x"].append(0.0)
            found["y"].append(0.0)
    for direction, centres in axes.items():
        found[direction] += [(a + b) / 2 for a, b in pairwise(sorted(centres))]
    return Cuts(_apart(found["x"], plan.half_x), _apart(found["y"], plan.half_y))


def _apart(places: list[float], half: float) -> tuple[float, ...]:
    kept: list[float] = []
    for place in sorted(places):
        if abs(place) < half - SAME_CUT and (not kept or place - kept[-1] > SAME_CUT):
            kept.append(place)
    return tuple(kept)


@dataclass(frozen=True)
class View:
    """A barrel as a cell sees it: on one side of its axis, from u = near to u = far."""

    part: BarrelPart
    cell: Cell

    @property
    def sign(self) -> int:
        """Side of the axis."""
        start, end = self.cell.side(self.part.across)
        return 1 if (start + end) / 2 > self.part.centre else -1

    @property
    def near(self) -> float:
        """Distance of the cell from the axis [m]."""
        near = min(self.sign * (place - self.part.centre) for place in self.cell.side(self.part.across))
        return near if near > SAME_CUT else 0.0

    @property
    def far(self) -> float:
        """Distance of the wall or, if that comes first, of the cell's far side from the axis [m]."""
        far = max(self.sign * (place - self.part.centre) for place in self.cell.side(self.part.across))
        return far if far < self.part.curve.half_span - SAME_CUT else self.part.curve.half_span

    @property
    def bounds(self) -> bool:
        """Whether there is a profile on this side."""
        return self.part.side in {0, self.sign}

    @property
    def outside(self) -> bool:
        """Whether the cell lies behind the wall."""
        return self.bounds and self.near > self.part.curve.half_span - SAME_CUT

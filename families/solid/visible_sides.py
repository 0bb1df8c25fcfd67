"""What a cell of the plan sees: at most one side of one barrel each way, and a ceiling."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import copysign, inf

from families.declaration.pieces import BarrelPart, Ceiling, Direction, Piece
from families.solid.barrel_slopes import Slope
from families.solid.plan_cells import SAME_CUT, Cell, View

DECIMALS = 12  # of a metre, to which alike cells agree


@dataclass(frozen=True)
class VisibleSides:
    """What shows in a cell: a barrel across each direction or none, the `lower` or the higher one, below a ceiling."""

    cell: Cell
    slopes: dict[Direction, Slope]
    ceiling: float
    lower: bool
    sides: tuple[float, float]

    def cross(self, across: Direction) -> Slope | None:
        """The barrel that runs the other way."""
        return self.slopes.get("y" if across == "x" else "x")

    def end(self, slope: Slope) -> float:
        """The u of the far side of the cell."""
        return max(slope.sign * (place - slope.part.centre) for place in self.cell.side(slope.part.across))

    def walled(self, slope: Slope) -> bool:
        """Whether a barrel's wall shows."""
        if slope.far < slope.part.curve.half_span - SAME_CUT:
            return False
        return self.end(slope) - slope.far > SAME_CUT or abs(self.wall(slope)) == self.sides[slope.side.axis]

    def wall(self, slope: Slope) -> float:
        """Coordinate [m] of a barrel's wall, the very one of a side if it stands there."""
        place, side = slope.at(slope.far), self.sides[slope.side.axis]
        return copysign(side, place) if abs(abs(place) - side) < SAME_CUT else place


def scene(pieces: tuple[Piece, ...], cell: Cell, sides: tuple[float, float]) -> VisibleSides:
    """The barrels of pieces that a cell sees; about `sides` see `families.solid.barrel_faces`."""
    barrels: list[BarrelPart] = []
    ceiling, lower = inf, False
    for piece in pieces:
        views = [View(part, cell) for part in piece.parts if isinstance(part, BarrelPart)]
        if any(view.outside for view in views):
            continue
        shown = [view.part for view in views if view.bounds]
        lower |= len(shown) > 1
        barrels += shown
        ceiling = min([ceiling, *(part.z for part in piece.parts if isinstance(part, Ceiling))])
    # Of equal barrels side by side, as grown lunettes that overlap, the one whose axis is nearest is the highest.
    barrels.sort(key=lambda part: View(part, cell).near, reverse=True)
    by_direction: dict[Direction, BarrelPart] = {part.across: part for part in barrels}
    slopes: dict[Direction, Slope] = {}
    for across, part in by_direction.items():
        view = View(part, cell)
        far = view.far if view.far == part.curve.half_span else round(view.far, DECIMALS)
        cross = by_direction.get("y" if across == "x" else "x")
        slopes[across] = Slope(part, view.sign, round(view.near, DECIMALS), far, cross)
    return VisibleSides(cell, slopes, ceiling, lower, sides)


def parted(cell: Cell, across: Direction, place: float) -> tuple[Cell, Cell]:
    """The two parts of a cell that is cut at a place [m]."""
    start, end = cell.side(across)
    if across == "x":
        return replace(cell, x=(start, place)), replace(cell, x=(place, end))
    return replace(cell, y=(start, place)), replace(cell, y=(place, end))

"""A drawing in metres, y or z up, as a list of marks that `svg` and `png` write."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from families.declaration.palette import Colour
from families.drawing.deviation_colours import ROOM, STONE, signed_mm
from families.drawing.looks import CLEAR, LETTER, MARGIN

Floats = NDArray[np.float64]
SCALE_STEPS = 40  # of the bar that explains colours


@dataclass(frozen=True)
class Area:
    """Within closed rows (n, 2), in a colour."""

    rows: tuple[Floats, ...]
    look: str
    colour: Colour | None
    name: str


@dataclass(frozen=True)
class Line:
    """Through points (n, 2), in ink unless it has a colour."""

    row: Floats
    look: str
    colour: Colour | None = None
    name: str = ""


@dataclass(frozen=True)
class Dots:
    """Points (n, 2), in ink unless each has its colour (n, 3)."""

    points: Floats
    look: str
    colours: NDArray[np.uint8] | None = None


@dataclass(frozen=True)
class Cells:
    """A grid of deviations (nx, ny) [m] between corners (2,), NaN where nothing is drawn; the colours' limit [m]."""

    low: Floats
    high: Floats
    deviation: Floats
    limit: float


@dataclass(frozen=True)
class Text:
    """A word, centred about a point (2,); `turned` to be read from the right."""

    at: Floats
    text: str
    look: str
    turned: bool = False


Mark = Area | Line | Dots | Cells | Text


class Drawing:
    """Marks in and around a box from `low` to `high` (2,) [m]; letters and margins grow with the box.

    margin: around what is drawn, in parts of the box's larger side.
    """

    def __init__(self, low: ArrayLike, high: ArrayLike, title: str, margin: float = MARGIN) -> None:
        self.low, self.high = np.array(low, dtype=np.float64), np.array(high, dtype=np.float64)
        self.title = title
        self.margin = margin * float((self.high - self.low).max())
        self.marks: list[Mark] = []

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [m] with the margins."""
        width, height = (self.high - self.low + 2 * self.margin).tolist()
        return width, height

    def area(self, rows: Iterable[Floats], look: str, colour: Colour | None, name: str = "") -> None:
        """A closed area, if any row bounds it."""
        if kept := tuple(rows):
            self.marks.append(Area(kept, look, colour, name))

    def line(self, row: ArrayLike, look: str, colour: Colour | None = None, name: str = "") -> None:
        """An open line through points (n, 2)."""
        self.marks.append(Line(np.asarray(row, dtype=np.float64), look, colour, name))

    def dots(self, points: Floats, look: str, colours: NDArray[np.uint8] | None = None) -> None:
        """Points (n, 2), those within the box and a little around it."""
        around = CLEAR * self.margin
        inside = ((points > self.low - around) & (points < self.high + around)).all(axis=1)
        if inside.any():
            self.marks.append(Dots(points[inside], look, None if colours is None else colours[inside]))

    def text(self, at: ArrayLike, text: str, look: str, *, turned: bool = False) -> None:
        """A word, centred about a point."""
        self.marks.append(Text(np.asarray(at, dtype=np.float64), text, look, turned))

    def dimension(self, a: tuple[float, float], b: tuple[float, float]) -> None:
        """A line with its length [m], level or plumb."""
        (ax, ay), (bx, by) = a, b
        plumb = ax == bx
        tick = 0.12 * self.margin * np.array([1.0, 0.0] if plumb else [0.0, 1.0])
        self.line((a, b), "dimension")
        for end in (a, b):
            self.line((np.array(end) - tick, np.array(end) + tick), "dimension")
        # A third of the way, where no section's line passes.
        place = np.array([ax + (bx - ax) / 3, ay + (by - ay) / 3])
        place += self.margin * np.array([0.22, 0.0] if plumb else [0.0, -0.22])
        self.text(place, f"{abs(bx - ax) + abs(by - ay):.2f}", "size", turned=plumb)

    def cells(self, low: Floats, high: Floats, deviation: Floats, limit: float) -> None:
        """Deviations (nx, ny) [m] as a map from corner to corner; NaN leaves a cell open."""
        self.marks.append(Cells(low, high, deviation, limit))

    def scale(self, limit: float) -> None:
        """Below the box, which colour is which deviation, as far as the limit [m]."""
        low = np.array([self.low[0], self.low[1] - 0.4 * self.margin])
        high = np.array([self.high[0], self.low[1] - 0.25 * self.margin])
        steps = (np.arange(SCALE_STEPS) + 0.5) / SCALE_STEPS * 2 - 1
        self.cells(low, high, limit * steps[:, None], limit)
        for x, share, names in ((low[0], -1, (ROOM,)), ((low[0] + high[0]) / 2, 0, ()), (high[0], 1, (STONE,))):
            for line, text in enumerate((signed_mm(share * limit), *names), 1):
                self.text((x, low[1] + (0.3 - 1.1 * line) * LETTER * self.margin), text, "size")

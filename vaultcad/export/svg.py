"""A drawing in metres, y or z up, written as SVG."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

import numpy as np

from vaultcad.export.geometry import Floats
from vaultcad.export.palette import colour

UNIT = 100.0  # drawing units a metre: centimetres, written with one decimal
MARGIN = 0.2  # around what is drawn, for dimensions, in parts of its larger side


class Drawing:
    """Shapes within a box from `low` to `high` (2,) [m]; letters and margins grow with the box."""

    def __init__(self, low: Floats, high: Floats, title: str) -> None:
        self.low, self.high, self.title = low, high, title
        self.margin = MARGIN * float((high - low).max())
        self._parts: list[str] = []

    @property
    def width(self) -> float:
        """Width [m] with the margins."""
        return float(self.high[0] - self.low[0]) + 2 * self.margin

    def svg(self) -> str:
        """The drawing as an SVG element."""
        x, y = self.low[0] - self.margin, -self.high[1] - self.margin
        height = float(self.high[1] - self.low[1]) + 2 * self.margin
        box = " ".join(f"{UNIT * v:.1f}" for v in (x, y, self.width, height))
        letters = f"font-size:{UNIT * 0.27 * self.margin:.1f}px"
        inside = f"<title>{escape(self.title)}</title>{''.join(self._parts)}"
        return f'<svg class="drawing" viewBox="{box}" style="{letters}" role="img">{inside}</svg>'

    def shape(self, rows: Iterable[Floats], component: int, name: str) -> None:
        """A closed area within rows (n, 2), in the colour of a component."""
        path = "".join(f"M{_path(row)}Z" for row in rows)
        if path:
            look = f'class="stone" fill="{colour(component).hex}" fill-rule="evenodd"'
            self._parts.append(f'<path {look} d="{path}"><title>{escape(name)}</title></path>')

    def row(self, row: Floats, kind: str) -> None:
        """An open line through points (n, 2)."""
        self._parts.append(f'<path class="{kind}" d="M{_path(row)}"/>')

    def line(self, a: Iterable[float], b: Iterable[float], kind: str) -> None:
        """A straight line."""
        self._parts.append(f'<path class="{kind}" d="M{_xy(a)}L{_xy(b)}"/>')

    def dots(self, points: Floats) -> None:
        """Points (n, 2), those within the box."""
        inside = points[((points > self.low) & (points < self.high)).all(axis=1)]
        if path := "".join(f"M{_xy(p)}h0" for p in inside):
            self._parts.append(f"<path class='scan' d='{path}'/>")

    def text(self, at: Iterable[float], text: str, kind: str, *, turned: bool = False) -> None:
        """A word, centred about a point; `turned` to be read from the right."""
        x, y = at
        place = f"translate({UNIT * x:.1f} {-UNIT * y:.1f})" + (" rotate(-90)" if turned else "")
        self._parts.append(f'<text class="{kind}" transform="{place}">{escape(text)}</text>')

    def dimension(self, a: tuple[float, float], b: tuple[float, float]) -> None:
        """A line with its length [m], level or plumb."""
        (ax, ay), (bx, by) = a, b
        plumb = ax == bx
        tick = 0.12 * self.margin * np.array([1.0, 0.0] if plumb else [0.0, 1.0])
        self.line(a, b, "dimension")
        for end in (a, b):
            self.line(np.array(end) - tick, np.array(end) + tick, "dimension")
        # A third of the way, where no section's line passes.
        place = np.array([ax + (bx - ax) / 3, ay + (by - ay) / 3])
        place += self.margin * np.array([0.22, 0.0] if plumb else [0.0, -0.22])
        self.text(place, f"{abs(bx - ax) + abs(by - ay):.2f}", "size", turned=plumb)


def _path(row: Floats) -> str:
    """Points as SVG writes a line, without those that fall on the one before."""
    shown = np.round(row * UNIT, 1)
    apart = np.ones(len(row), dtype=bool)
    apart[1:] = (np.diff(shown, axis=0) != 0).any(axis=1)
    return "L".join(_xy(p) for p in row[apart])


def _xy(point: Iterable[float]) -> str:
    x, y = point
    return f"{UNIT * x:.1f} {-UNIT * y:.1f}"

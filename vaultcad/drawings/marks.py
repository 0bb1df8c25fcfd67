"""What a sheet shows, in metres at full size: lines with arcs, hatched stone, dimensions, words, each on its layer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from math import atan2, cos, hypot, sin

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

ARC_STEP = 0.05  # rad between points of an arc where it is drawn as a row


@dataclass(frozen=True)
class Path:
    """Through points (n, 2) [m]; what follows each is straight, or an arc with a bulge, as CAD has it.

    bulges: (n,) or empty, the tangent of a quarter of the arc's angle, positive counterclockwise; that of the last
    point counts where the path is closed.
    """

    layer: str
    points: Floats
    bulges: tuple[float, ...] = ()
    closed: bool = False

    def row(self) -> Floats:
        """The same as points (m, 2), arcs in steps."""
        if not self.bulges:
            return np.concatenate([self.points, self.points[:1]]) if self.closed else self.points
        count = len(self.points)
        ends = range(count if self.closed else count - 1)
        rows = [arc_row(self.points[k], self.points[(k + 1) % count], self.bulges[k])[:-1] for k in ends]
        return np.concatenate([*rows, self.points[:1] if self.closed else self.points[-1:]])


@dataclass(frozen=True)
class Hatch:
    """Stone that is cut, within closed rows (n, 2) [m]."""

    layer: str
    rows: tuple[Floats, ...]


@dataclass(frozen=True)
class Dimension:
    """The distance [m] between two points (2,), measured along an angle [rad], on a line through `through` (2,)."""

    layer: str
    a: tuple[float, float]
    b: tuple[float, float]
    through: tuple[float, float]
    angle: float = 0.0

    @property
    def size(self) -> float:
        """What it says [m]."""
        return abs((self.b[0] - self.a[0]) * cos(self.angle) + (self.b[1] - self.a[1]) * sin(self.angle))

    def ends(self) -> Floats:
        """Of its line (2, 2)."""
        along = np.array([cos(self.angle), sin(self.angle)])
        across = np.array([-along[1], along[0]])
        line = across * float(across @ self.through)
        return np.stack([line + along * float(along @ end) for end in (self.a, self.b)])


@dataclass(frozen=True)
class Word:
    """A line of text at a point (2,), `height` mm on the paper, turned by an angle [rad].

    across, up: where the point is in it: -1 at its left or its foot, 0 in its middle, 1 at its right or its top.
    """

    layer: str
    at: tuple[float, float]
    text: str
    height: float = 2.5
    across: int = 0
    up: int = 0
    angle: float = 0.0


@dataclass(frozen=True)
class Cross:
    """A point (2,) that is marked: the centre of an arch."""

    layer: str
    at: tuple[float, float]


Mark = Path | Hatch | Dimension | Word | Cross


@dataclass
class View:
    """One picture of a sheet: marks, and the box (2,), (2,) [m] of what is drawn, dimensions and words left out."""

    title: str
    low: Floats
    high: Floats
    marks: list[Mark] = field(default_factory=list)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [m] of the box."""
        width, height = (self.high - self.low).tolist()
        return width, height


def view_of(title: str, marks: Sequence[Mark]) -> View:
    """A view with the box of its lines and its stone."""
    reach = np.concatenate([*_rows(marks)])
    return View(title, reach.min(axis=0), reach.max(axis=0), list(marks))


def _rows(marks: Iterable[Mark]) -> Iterable[Floats]:
    for mark in marks:
        if isinstance(mark, Path):
            yield mark.row()
        elif isinstance(mark, Hatch):
            yield from mark.rows


def arc_row(a: Floats, b: Floats, bulge: float) -> Floats:
    """Points (n, 2) from a to b along the arc with that bulge, both ends among them."""
    chord = b - a
    length = hypot(*chord.tolist())
    if abs(bulge) < 1e-9 or length == 0:
        return np.stack([a, b])
    centre, radius = circle_of(a, b, bulge)
    start = atan2(a[1] - centre[1], a[0] - centre[0])
    sweep = 4 * np.arctan(bulge)
    turns = start + sweep * np.linspace(0, 1, max(2, int(abs(sweep) / ARC_STEP) + 2))
    row: Floats = centre + radius * np.column_stack([np.cos(turns), np.sin(turns)])
    row[0], row[-1] = a, b
    return row


def circle_of(a: Floats, b: Floats, bulge: float) -> tuple[Floats, float]:
    """Centre (2,) and radius [m] of the arc from a to b with that bulge.

    >>> centre, radius = circle_of(np.array([0.0, 0.0]), np.array([2.0, 0.0]), -1.0)
    >>> centre.tolist(), radius
    ([1.0, 0.0], 1.0)
    """
    chord = b - a
    across = np.array([-chord[1], chord[0]])
    centre: Floats = (a + b) / 2 + across * (1 - bulge**2) / (4 * bulge)
    return centre, float(np.hypot(*(a - centre)))

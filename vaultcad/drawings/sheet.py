"""A sheet of paper with views at one scale, and where on it they stand."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from vaultcad.drawings.marks import View
from vaultcad.errors import DrawingError

Floats = NDArray[np.float64]

PAPERS = {"A4": (297.0, 210.0), "A3": (420.0, 297.0), "A2": (594.0, 420.0), "A1": (841.0, 594.0), "A0": (1189.0, 841.0)}
SCALES = (10, 20, 25, 50, 100, 200, 500)
EDGE = 10.0  # mm from the edge of the paper to the frame
LEFT, BETWEEN, ABOVE = 24.0, 36.0, 22.0  # mm left of views, between them and above them, for levels and dimensions
UNDER = 40.0  # mm below a view, for dimensions and its title
BLOCK = (150.0, 56.0)  # mm, of the title block in the lower right corner


@dataclass(frozen=True)
class PlacedView:
    """A view with its lower left corner at a point (2,) [mm] of the paper."""

    view: View
    at: tuple[float, float]

    def on_paper(self, points: Floats, scale: int) -> Floats:
        """Points (n, 2) [m] of the view on the paper [mm]."""
        placed: Floats = np.asarray(self.at) + (points - self.view.low) * (1000.0 / scale)
        return placed


@dataclass(frozen=True)
class Sheet:
    """Views at one to `scale` on a paper (width, height) [mm].

    name: of its files. fields: what the title block says, label and text. north: angle on the paper from its top,
    counterclockwise [rad], None where it shows no plan.
    """

    name: str
    title: str
    paper: tuple[float, float]
    scale: int
    views: tuple[PlacedView, ...]
    fields: tuple[tuple[str, str], ...]
    north: float | None = None


@dataclass(frozen=True)
class Wish:
    """The scale and the paper that a user wants; None where what fits will do."""

    scale: int | None = None
    paper: str | None = None


def lay_out(
    name: str,
    title: str,
    views: Callable[[int], Sequence[Sequence[View]]],
    fields: Sequence[tuple[str, str]],
    wish: Wish,
    north: float | None = None,
) -> Sheet:
    """Views in rows from above, as large as a paper lets them be; the title block stands in the lower right corner.

    views: by the scale, as dimensions are as far off on any paper. Without a wish the paper is A3 and the scale the
    largest usual one that fits, or else a larger paper is taken.

    Raises:
        DrawingError: at that scale they do not fit on that paper, or on any.
    """
    papers = ("A3", "A2", "A1", "A0") if wish.paper is None else (wish.paper,)
    scales = SCALES if wish.scale is None else (wish.scale,)
    drawn = cache(views)
    for paper in papers:
        for scale in scales:
            placed = _placed(drawn(scale), scale, PAPERS[paper])
            if placed is not None:
                return Sheet(name, title, PAPERS[paper], scale, placed, tuple(fields), north)
    tried = f"{' or '.join(papers)} at 1:{scales[-1]}"
    raise DrawingError(f"{title}: does not fit on {tried}; ask for a smaller scale, or a larger paper")


def _placed(rows: Sequence[Sequence[View]], scale: int, paper: tuple[float, float]) -> tuple[PlacedView, ...] | None:
    """Where views stand on a paper [mm], rows under one another, their columns in line; None if they do not fit."""
    wide = [
        max((_mm(row[k].size[0], scale) for row in rows if k < len(row)), default=0.0)
        for k in range(max(map(len, rows)))
    ]
    tall = [max(_mm(view.size[1], scale) for view in row) for row in rows]
    width = _across(wide)
    height = sum(tall) + ABOVE + UNDER * len(tall)
    room_x, room_y = paper[0] - 2 * EDGE, paper[1] - 2 * EDGE
    last = _across(wide[: len(rows[-1])])
    beside = last + BLOCK[0] <= room_x and (len(rows) == 1 or BLOCK[1] <= tall[-1] + UNDER)
    if width > room_x or height + (0 if beside else BLOCK[1]) > room_y:
        return None
    return tuple(_stood(rows, wide, tall, scale, paper))


def _stood(
    rows: Sequence[Sequence[View]], wide: Sequence[float], tall: Sequence[float], scale: int, paper: tuple[float, float]
) -> Iterator[PlacedView]:
    y = paper[1] - EDGE - ABOVE
    for row, high in zip(rows, tall, strict=True):
        y -= high
        x = EDGE + LEFT
        for view, width in zip(row, wide, strict=False):
            yield PlacedView(view, (x + (width - _mm(view.size[0], scale)) / 2, y))
            x += width + BETWEEN
        y -= UNDER


def _across(wide: Sequence[float]) -> float:
    """What views beside one another take of the width [mm]."""
    return LEFT + sum(wide) + BETWEEN * len(wide)


def _mm(length: float, scale: int) -> float:
    """A length [m] on the paper [mm]."""
    return 1000.0 * length / scale

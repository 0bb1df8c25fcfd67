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
LEFT, BETWEEN, ABOVE = 22.0, 40.0, 8.0  # mm left of views, between them and above them, for levels and dimensions
UNDER = 36.0  # mm below a view, for dimensions and its title
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
    views: Callable[[int], tuple[Sequence[View], Sequence[View]]],
    fields: Sequence[tuple[str, str]],
    wish: Wish,
    north: float | None = None,
    coarsest: int = 0,
) -> Sheet:
    """Views in rows from above, as large as a paper lets them be; the title block stands in the lower right corner.

    views: by the scale, as dimensions are as far off on any paper: sections, then the plan and what stands beside it,
    which begin the second row.
    Without a wish the paper is A3 and the scale the largest usual one that fits, or else a larger paper is taken; and
    so it is, up to A1, before the scale is smaller than one to `coarsest`.

    Raises:
        DrawingError: at that scale they do not fit on that paper, or on any.
    """
    papers = ("A3", "A2", "A1", "A0") if wish.paper is None else (wish.paper,)
    scales = SCALES if wish.scale is None else (wish.scale,)
    drawn = cache(views)
    whole = [(paper, scale) for paper in papers for scale in scales]
    for paper, scale in sorted(whole, key=lambda one: one[1] > coarsest or one[0] == "A0"):
        for rows in _rows(*drawn(scale)):
            placed = tuple(_stood(rows, scale, PAPERS[paper]))
            if _fits(placed, scale, PAPERS[paper]):
                return Sheet(name, title, PAPERS[paper], scale, placed, tuple(fields), north)
    tried = f"{' or '.join(papers)} at 1:{scales[-1]}"
    raise DrawingError(f"{title}: does not fit on {tried}; ask for a smaller scale, or a larger paper")


def _rows(sections: Sequence[View], plan: Sequence[View]) -> Iterator[list[list[View]]]:
    """Ways to put views into rows, those with the longest rows first; the plan stands under the first section."""
    for long in range(max(len(sections), len(plan)), 0, -1):
        order = [*sections[:long], *plan, *sections[long:]]
        rows = [order[k : k + long] for k in range(0, len(order), long)]
        yield rows if len(sections) >= long else [[*row] for row in (sections, plan) if row]


def _stood(rows: Sequence[Sequence[View]], scale: int, paper: tuple[float, float]) -> Iterator[PlacedView]:
    """Where views stand on a paper [mm]: rows under one another, their columns in line, at their tops in line."""
    columns = max(map(len, rows))
    wide = [max(_mm(row[k].size[0], scale) for row in rows if k < len(row)) for k in range(columns)]
    top = paper[1] - EDGE - ABOVE
    for row in rows:
        x = EDGE + LEFT
        for view, width in zip(row, wide, strict=False):
            across, up = (_mm(size, scale) for size in view.size)
            yield PlacedView(view, (x + (width - across) / 2, top - up))
            x += width + BETWEEN
        top -= max(_mm(view.size[1], scale) for view in row) + UNDER + ABOVE


def _fits(placed: Sequence[PlacedView], scale: int, paper: tuple[float, float]) -> bool:
    """Whether all that belongs to views is within the frame and clear of the title block."""
    block = (paper[0] - EDGE - BLOCK[0], EDGE + BLOCK[1])
    for one in placed:
        (x, y), (across, _) = one.at, (_mm(size, scale) for size in one.view.size)
        right, foot = x + across + BETWEEN - LEFT, y - UNDER
        if right > paper[0] - EDGE or foot < EDGE or (right > block[0] and foot < block[1]):
            return False
    return True


def _mm(length: float, scale: int) -> float:
    """A length [m] on the paper [mm]."""
    return 1000.0 * length / scale

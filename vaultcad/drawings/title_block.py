"""Frame, titles of views, scale bar, north and title block of a sheet, as a view of the whole paper."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import cos, sin

import numpy as np

from vaultcad.drawings.marks import Mark, Path, View, Word
from vaultcad.drawings.sheet import BLOCK, EDGE, Sheet

TITLE = 27.0  # mm from a view down to its title
LINE = 4.0  # mm between lines of the block
LABEL = 24.0  # mm, the column of labels
BARS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)  # m, parts of the scale bar
PART = 14.0  # mm that a part is long at least
PARTS = 4
NORTH = 9.0  # mm, the arrow's radius


def title_block(sheet: Sheet, unit: float = 1.0) -> View:
    """All that stands on a sheet beside its views; a millimetre of the paper is so many units of this view."""
    width, height = sheet.paper
    marks: list[Mark] = [_box(EDGE, EDGE, width - EDGE, height - EDGE)]
    for placed in sheet.views:
        x, y = placed.at
        across = 1000.0 * placed.view.size[0] / sheet.scale
        marks.append(Word("TEXT", (x + across / 2, y - TITLE), f"{placed.view.title}   1:{sheet.scale}", 3.0))
    marks += _block(sheet, width - EDGE - BLOCK[0], EDGE)
    return View("", np.zeros(2), unit * np.array(sheet.paper), [_grown(mark, unit) for mark in marks])


def _grown(mark: Mark, unit: float) -> Mark:
    """A line or a word so many times as large; letters are millimetres of the paper anyway."""
    if isinstance(mark, Path):
        return replace(mark, points=unit * mark.points)
    assert isinstance(mark, Word)
    x, y = mark.at
    return replace(mark, at=(unit * x, unit * y))


def _block(sheet: Sheet, x: float, y: float) -> Iterator[Mark]:
    wide, tall = BLOCK
    yield _box(x, y, x + wide, y + tall)
    yield Word("TEXT", (x + 3, y + tall - 6.5), sheet.title, 3.5, across=-1, up=-1)
    yield Path("FRAME", np.array([[x, y + tall - 9], [x + wide, y + tall - 9]]))
    top = y + tall - 9 - LINE
    for k, (label, text) in enumerate(sheet.fields):
        yield Word("TEXT", (x + 3, top - k * LINE), label, 1.8, across=-1, up=-1)
        yield Word("TEXT", (x + LABEL, top - k * LINE), text, 1.8, across=-1, up=-1)
    yield from _bar(sheet, x + 3, y + 5)
    if sheet.north is not None:
        yield from _north(x + wide - NORTH - 5, y + NORTH + 6, sheet.north)


def _bar(sheet: Sheet, x: float, y: float) -> Iterator[Mark]:
    part = next((bar for bar in BARS if 1000 * bar / sheet.scale >= PART), BARS[-1])
    step = 1000 * part / sheet.scale
    for k in range(PARTS):
        yield _box(x + k * step, y, x + (k + 1) * step, y + 1.5)
        if k % 2 == 0:
            yield Path("FRAME", np.array([[x + k * step, y + 0.75], [x + (k + 1) * step, y + 0.75]]))
    for k in (0, 1, PARTS):
        unit = " m" if k == PARTS else ""
        yield Word("TEXT", (x + k * step, y - 2.8), f"{k * part:g}{unit}", 1.8, up=-1)


def _north(x: float, y: float, angle: float) -> Iterator[Mark]:
    way = np.array([-sin(angle), cos(angle)])
    side = np.array([way[1], -way[0]])
    middle = np.array([x, y])
    tip, tail = middle + NORTH * way, middle - NORTH * way
    yield Path("FRAME", np.stack([tail, tip]))
    yield Path("FRAME", np.stack([tip - 3 * way - 1.4 * side, tip, tip - 3 * way + 1.4 * side]))
    at = tip + 2.5 * way
    yield Word("TEXT", (float(at[0]), float(at[1])), "N", 2.5)


def _box(x0: float, y0: float, x1: float, y1: float) -> Path:
    return Path("FRAME", np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]), closed=True)

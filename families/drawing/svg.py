"""Drawings as SVG, for pages: ink is the page's own colour of text, and nothing from outside is needed."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import numpy as np
from numpy.typing import NDArray

from families.declaration.palette import Colour
from families.drawing.deviation_colours import shades
from families.drawing.looks import HALO, INK, LETTER, LOOKS, PAPER
from families.drawing.sheet import Area, Cells, Dots, Drawing, Floats, Line, Mark, Text

UNIT = 100.0  # drawing units a metre: centimetres, written with one decimal
NAMESPACE = "http://www.w3.org/2000/svg"
RIM = 0.1  # by which cells overlap, so that rounding leaves no gap


def svg(drawing: Drawing, scale: float | None = None) -> str:
    """The drawing as an SVG element, as wide as its place, or at a scale of so many pixels a metre."""
    width, height = drawing.size
    x, y = drawing.low[0] - drawing.margin, -drawing.high[1] - drawing.margin
    box = " ".join(f"{UNIT * v:.1f}" for v in (x, y, width, height))
    fixed = "" if scale is None else f' width="{scale * width:.0f}" height="{scale * height:.0f}"'
    letters = f'font-size="{UNIT * LETTER * drawing.margin:.1f}"'
    inside = "".join(part for mark in drawing.marks for part in _written(mark))
    return (
        f'<svg class="drawing" viewBox="{box}"{fixed} {letters} fill="none" role="img">'
        f"<title>{escape(drawing.title)}</title>{inside}</svg>"
    )


def document(drawing: Drawing, scale: float) -> str:
    """The drawing as a file of its own, in ink on paper, at a scale of so many pixels a metre."""
    alone = f'xmlns="{NAMESPACE}" font-family="sans-serif" style="color:{INK};background:{PAPER}"'
    return svg(drawing, scale).replace("<svg ", f"<svg {alone} ", 1) + "\n"


def _written(mark: Mark) -> Iterator[str]:
    match mark:
        case Area(rows, look, colour, name):
            yield _path("".join(f"M{_row(row)}Z" for row in rows), look, None, name, fill=colour)
        case Line(row, look, colour, name):
            yield _path(f"M{_row(row)}", look, colour, name)
        case Dots(points, look, colours):
            if colours is None:
                yield _path(_dots(points), look, None)
            else:
                yield from (_path(_dots(points[of]), look, colour) for colour, of in _alike(colours))
        case Cells(low, high, deviation, limit):
            known, step = np.isfinite(deviation), (high - low) / deviation.shape
            places, (wide, tall) = np.argwhere(known), UNIT * step + RIM
            for colour, of in _alike(shades(deviation[known], limit)):
                corners = low + places[of] * step
                d = _each(f"M{{}}h{wide:.1f}v{-tall:.1f}h{-wide:.1f}z", corners)
                yield f'<path class="cells" shape-rendering="crispEdges" fill="{colour.hex}" d="{d}"/>'
        case Text(at, text, look, turned):
            place = f"translate({_each('{}', np.array(at))})" + (" rotate(-90)" if turned else "")
            weight = ' font-weight="bold"' if LOOKS[look].bold else ""
            ink = "currentColor"
            if LOOKS[look].halo:
                ink, weight = INK, f'{weight} stroke="{PAPER}" stroke-width="{HALO:g}pt" paint-order="stroke"'
            how = f'fill="{ink}" text-anchor="middle" dominant-baseline="middle"'
            yield f'<text class="{look}" {how}{weight} transform="{place}">{escape(text)}</text>'


def _path(d: str, look: str, colour: Colour | None, name: str = "", fill: Colour | None = None) -> str:
    """A path as its look has it: in ink unless it has a colour, as wide on the page at any size."""
    how, told = LOOKS[look], [f'class="{look}"']
    if fill is not None:
        told.append(f'fill="{fill.hex}" fill-opacity="{how.fill:g}" fill-rule="evenodd"')
    if how.width:
        told.append(
            f'stroke="{colour.hex if colour else "currentColor"}" stroke-width="{how.width:g}pt" '
            f'stroke-opacity="{how.ink:g}" stroke-linejoin="round" vector-effect="non-scaling-stroke"'
        )
        if how.dashes:
            told.append(f'stroke-dasharray="{" ".join(f"{dash:g}" for dash in how.dashes)}"')
        else:
            told.append('stroke-linecap="round"')
    return f'<path {" ".join(told)} d="{d}">{f"<title>{escape(name)}</title>" if name else ""}</path>'


def _alike(colours: NDArray[np.uint8]) -> Iterator[tuple[Colour, NDArray[np.bool_]]]:
    """Each colour among (n, 3), and which have it."""
    kinds, which = np.unique(colours, axis=0, return_inverse=True)
    for k, kind in enumerate(kinds.tolist()):
        yield Colour(*kind), which == k


def _dots(points: Floats) -> str:
    return _each("M{}h0", points)


def _row(row: Floats) -> str:
    """Points as SVG writes a line, without those that fall on the one before."""
    shown = np.round(row * UNIT, 1)
    apart = np.ones(len(row), dtype=bool)
    apart[1:] = (np.diff(shown, axis=0) != 0).any(axis=1)
    return _each("L{}", row[apart])[1:]


def _each(how: str, points: Floats) -> str:
    """Points (n, 2) one after another, each written in place of the braces; at once, as there are tens of thousands."""
    drawn = np.asarray(points, np.float64).reshape(-1, 2) * (UNIT, -UNIT)
    return how.format("%.1f %.1f") * len(drawn) % tuple(drawn.ravel().tolist())

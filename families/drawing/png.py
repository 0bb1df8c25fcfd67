"""Drawings on matplotlib's axes, for pictures in pixels."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path as FilePath
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from families.drawing.deviation_colours import shades
from families.drawing.looks import HALO, INK, LOOKS, PAPER, TITLE_WIDTH
from families.drawing.sheet import Area, Cells, Dots, Drawing, Line, Mark, Text

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def write_png(
    drawing: Drawing, path: FilePath, size: tuple[float, float], dpi: float, *, top: float, look: Mapping[str, Any]
) -> None:
    """Write the drawing as a picture of that size [inch], whatever matplotlib is set to elsewhere.

    top: the share of the height up to which it reaches, with its title. look: matplotlib's settings besides.
    """
    from matplotlib import style
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with style.context(["default", dict(look)]):
        figure = Figure(figsize=size, dpi=dpi)
        FigureCanvasAgg(figure)
        paint(figure.add_axes((0, 0, 1, top)), drawing)
        figure.savefig(path, format="png", metadata={"Software": None})


def paint(axes: Axes, drawing: Drawing, width: float | None = None) -> None:
    """Put the drawing on axes, under its title, in the middle of a width [m] that is its own unless told."""
    for order, mark in enumerate(drawing.marks, 1):
        _put(axes, mark, order)
    middle, wide = float(drawing.low[0] + drawing.high[0]) / 2, width or drawing.size[0]
    axes.set_xlim(middle - wide / 2, middle + wide / 2)
    axes.set_ylim(float(drawing.low[1]) - drawing.margin, float(drawing.high[1]) + drawing.margin)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(fill(drawing.title, TITLE_WIDTH), y=1.0, va="top")  # within the margin


def _put(axes: Axes, mark: Mark, order: int) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path
    from matplotlib.patheffects import withStroke

    match mark:
        case Area(rows, look, colour, _):
            closed = Path.make_compound_path(*(Path(np.concatenate([row, row[:1]]), closed=True) for row in rows))
            how, face = LOOKS[look], (0.0,) * 4 if colour is None else (*colour.unit, LOOKS[look].fill)
            axes.add_patch(
                PathPatch(closed, facecolor=face, edgecolor=(INK, how.ink), linewidth=how.width, zorder=order)
            )
        case Line(row, look, colour, _):
            how = LOOKS[look]
            style: dict[str, Any] = {"dashes": how.dashes} if how.dashes else {"solid_capstyle": "round"}
            ink = (INK if colour is None else colour.hex, how.ink)
            axes.plot(*row.T, color=ink, linewidth=how.width, zorder=order, **style)
        case Dots(points, look, colours):
            how = LOOKS[look]
            shade: Any = INK if colours is None else colours / 255
            x, y = points.T
            axes.scatter(x, y, how.width**2, c=shade, alpha=how.ink, linewidths=0, zorder=order)
        case Cells(low, high, deviation, limit):
            opaque = np.where(np.isfinite(deviation), 255, 0).astype(np.uint8)
            pixels = np.dstack([shades(deviation, limit), opaque]).transpose(1, 0, 2)
            extent = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
            axes.imshow(pixels, origin="lower", extent=extent, interpolation="nearest", zorder=order)
        case Text(at, text, look, turned):
            weight, turn = "bold" if LOOKS[look].bold else "normal", 90 if turned else 0
            around = [withStroke(linewidth=HALO, foreground=PAPER)] if LOOKS[look].halo else None
            place: dict[str, Any] = {"ha": "center", "va": "center", "rotation": turn, "path_effects": around}
            axes.text(float(at[0]), float(at[1]), text, color=INK, weight=weight, zorder=order, **place)

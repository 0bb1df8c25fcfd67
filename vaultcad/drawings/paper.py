"""Sheets on paper, to scale: SVG a sheet, PDF a page a sheet, drawn by matplotlib without clock or chance."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import cos, sin
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import numpy as np

from vaultcad.drawings.layers import INKS
from vaultcad.drawings.marks import Cross, Dimension, Hatch, Mark, Path, Word
from vaultcad.drawings.sheet import PlacedView, Sheet
from vaultcad.drawings.title_block import title_block

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INCH = 25.4  # mm
POINT = INCH / 72  # mm
TICK = 1.4  # mm, half of the stroke at the end of a dimension
CROSS = 1.6  # mm, half of the lines of a centre
SIZE = 2.2  # mm, height of the numbers of dimensions
CAP = 0.72  # height of a capital in parts of the letters' size


def write_svg(sheet: Sheet, path: FilePath) -> None:
    """Write one sheet as SVG of the paper's size."""
    with _settings():
        _figure(sheet).savefig(path, format="svg", metadata={"Date": None, "Title": sheet.title})


def write_pdf(sheets: Sequence[Sheet], path: FilePath) -> None:
    """Write all sheets as pages of one PDF, each of its paper's size."""
    from matplotlib.backends.backend_pdf import PdfPages

    with _settings(), PdfPages(path, metadata={"CreationDate": None, "ModDate": None}) as pages:
        for sheet in sheets:
            pages.savefig(_figure(sheet))


@contextmanager
def _settings() -> Iterator[None]:
    """Text stays text, and ids do not come by chance."""
    import matplotlib

    own: Any = {
        "svg.hashsalt": "vaultcad",
        "svg.fonttype": "none",
        "pdf.fonttype": 42,
        "font.family": "DejaVu Sans",
        "hatch.linewidth": 0.25,
        "path.simplify": False,
    }
    with matplotlib.rc_context(own):
        yield


def _figure(sheet: Sheet) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    width, height = sheet.paper
    figure = Figure(figsize=(width / INCH, height / INCH))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, width)
    axes.set_ylim(0, height)
    axes.set_axis_off()
    order = 1
    for placed in sheet.views:
        for mark in placed.view.marks:
            _put(axes, placed, mark, sheet.scale, order)
            order += 1
    whole = PlacedView(title_block(sheet), (0.0, 0.0))
    for mark in whole.view.marks:
        _put(axes, whole, mark, 1000, order)
        order += 1
    return figure


def _put(axes: Axes, placed: PlacedView, mark: Mark, scale: int, order: int) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    ink = INKS[mark.layer]
    match mark:
        case Path():
            _line(axes, placed.on_paper(mark.row(), scale), mark.layer, order)
        case Hatch(_, rows):
            there = [placed.on_paper(row, scale) for row in rows]
            closed = Outline.make_compound_path(
                *(Outline(np.concatenate([row, row[:1]]), closed=True) for row in there)
            )
            axes.add_patch(
                PathPatch(closed, facecolor="none", edgecolor=ink.colour, hatch="/////", linewidth=0, zorder=order)
            )
        case Dimension():
            ends = placed.on_paper(mark.ends(), scale)
            _line(axes, ends, mark.layer, order)
            along = np.array([cos(mark.angle), sin(mark.angle)])
            slash = TICK * np.array([along[0] - along[1], along[0] + along[1]]) / 2**0.5
            for end, at in zip(ends, placed.on_paper(np.array([mark.a, mark.b]), scale), strict=True):
                _line(axes, np.stack([end - slash, end + slash]), mark.layer, order)
                gap = end - at
                length = float(np.hypot(*gap))
                if length > 3:  # an extension line, which leaves the drawing itself free
                    _line(axes, np.stack([at + 1.5 * gap / length, end + 1.2 * gap / length]), mark.layer, order)
            across = np.array([-along[1], along[0]])
            _text(axes, ends.mean(axis=0) + 0.8 * across, f"{mark.size:.3f}", SIZE, mark.angle, (0, -1), ink.colour)
        case Word():
            (at,) = placed.on_paper(np.array([mark.at]), scale)
            _text(axes, at, mark.text, mark.height, mark.angle, (mark.across, mark.up), ink.colour)
        case Cross():
            (at,) = placed.on_paper(np.array([mark.at]), scale)
            for arm in np.eye(2):
                _line(axes, np.stack([at - CROSS * arm, at + CROSS * arm]), mark.layer, order)


def _line(axes: Axes, row: Any, layer: str, order: int) -> None:
    ink = INKS[layer]
    width = ink.width / POINT
    style: dict[str, Any] = {"solid_capstyle": "round", "solid_joinstyle": "round"}
    if ink.dashes:
        style = {"linestyle": (0, [dash / POINT / width for dash in ink.dashes])}
    axes.plot(*np.asarray(row).T, color=ink.colour, linewidth=width, zorder=order, **style)


def _text(axes: Axes, at: Any, text: str, height: float, angle: float, place: tuple[int, int], colour: str) -> None:
    across, up = place
    axes.text(
        float(at[0]),
        float(at[1]),
        text,
        fontsize=height / CAP / POINT,
        rotation=float(np.degrees(angle)),
        rotation_mode="anchor",
        ha=("left", "center", "right")[across + 1],
        va=("baseline", "center", "top")[up + 1],
        color=colour,
        zorder=10_000,
        parse_math=False,
    )

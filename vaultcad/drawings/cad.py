"""Sheets as DXF: at full size in model space, which any reader shows, and a layout with a viewport each."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vaultcad.drawings.layers import INKS
from vaultcad.drawings.marks import Cross, Dimension, Hatch, Mark, Path, Word
from vaultcad.drawings.paper import CROSS, SIZE, TICK
from vaultcad.drawings.sheet import Sheet
from vaultcad.drawings.title_block import title_block
from vaultcad.dxf_document import add_layers, dxf_document

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts import BaseLayout

Floats = NDArray[np.float64]

USUAL = 50  # the scale at which dashes are as long as they are meant to be
STYLE = "VAULTCAD"
FONT = "DejaVuSans.ttf"
STONE = "ANSI31"  # pattern of cut stone
STONE_LINES = 0.5  # how large it is on paper
APART = 20.0  # mm of paper between sheets in model space


def write_dxf(sheets: Sequence[Sheet], path: FilePath, place: str) -> None:
    """Write all sheets, one beside the other in model space; `place` says to what the model's coordinates are relative.

    Dimensions are real ones, and hatches too; every layout shows its sheet at its scale.
    """
    with dxf_document(path, place, dash=max(sheet.scale for sheet in sheets) / USUAL) as document:
        add_layers(document, {name: ink.layer for name, ink in INKS.items()})
        document.styles.add(STYLE, font=FONT)
        for scale in sorted({sheet.scale for sheet in sheets}):
            _dimension_style(document, scale)
        left = 0.0
        for number, sheet in enumerate(sheets):
            _sheet(document, sheet, number, left)
            left += (sheet.paper[0] + APART) * sheet.scale / 1000.0


def _sheet(document: Drawing, sheet: Sheet, number: int, left: float) -> None:
    """Enter a sheet, the lower left corner of its paper at (left, 0) [m] of model space."""
    space, mm, (width, height) = document.modelspace(), sheet.scale / 1000.0, sheet.paper
    for placed in sheet.views:
        shift = np.asarray(placed.at) * mm - placed.view.low + [left, 0.0]
        for mark in placed.view.marks:
            _put(space, mark, shift, sheet.scale, mm)
    for mark in title_block(sheet, unit=mm).marks:
        _put(space, mark, np.array([left, 0.0]), sheet.scale, mm)
    layout = document.paperspace() if number == 0 else document.layouts.new(sheet.name)
    if number == 0:
        document.layouts.rename(layout.name, sheet.name)
    layout.page_setup(size=(width, height), margins=(0, 0, 0, 0), units="mm")
    layout.add_viewport(
        center=(width / 2, height / 2),
        size=(width, height),
        view_center_point=(left + width * mm / 2, height * mm / 2),
        view_height=height * mm,
        dxfattribs={"layer": "FRAME"},
    )


def _dimension_style(document: Drawing, scale: int) -> None:
    """Strokes at the ends, the number above the line, to the millimetre."""
    mm = scale / 1000.0
    style: Any = document.dimstyles.add(_style(scale))
    style.dxf.dimtxt, style.dxf.dimtsz = SIZE * mm, TICK * mm
    style.dxf.dimexo, style.dxf.dimexe, style.dxf.dimgap = 1.5 * mm, 1.2 * mm, 0.8 * mm
    style.dxf.dimtad, style.dxf.dimdec, style.dxf.dimzin, style.dxf.dimdsep = 1, 3, 0, ord(".")
    style.dxf.dimtxsty = STYLE


def _style(scale: int) -> str:
    return f"{STYLE}-{scale}"


def _put(space: BaseLayout, mark: Mark, shift: Floats, scale: int, mm: float) -> None:
    """Enter a mark moved by `shift` (2,); a millimetre of the paper is so many of the layout's units."""
    layer = {"layer": mark.layer}

    def there(point: Any) -> tuple[float, float]:
        x, y = (np.asarray(point) + shift).tolist()
        return x, y

    match mark:
        case Path(_, points, bulges, closed):
            corners = [(*there(p), bulge) for p, bulge in zip(points, bulges or (0.0,) * len(points), strict=True)]
            space.add_lwpolyline(corners, format="xyb", close=closed, dxfattribs=layer)
        case Hatch(_, rows):
            hatch = space.add_hatch(dxfattribs=layer)
            hatch.set_pattern_fill(STONE, scale=STONE_LINES * mm)
            for row in rows:
                hatch.paths.add_polyline_path([there(p) for p in row], is_closed=True)
        case Dimension():
            line = space.add_linear_dim(
                base=there(mark.through),
                p1=there(mark.a),
                p2=there(mark.b),
                angle=degrees(mark.angle),
                dimstyle=_style(scale),
                dxfattribs=layer,
            )
            line.render()
        case Word():
            _word(space, mark, there(mark.at), mm)
        case Cross():
            for arm in np.eye(2) * CROSS * mm:
                space.add_line(there(mark.at - arm), there(mark.at + arm), dxfattribs=layer)


def _word(space: BaseLayout, word: Word, at: tuple[float, float], mm: float) -> None:
    from ezdxf.enums import TextEntityAlignment

    across = ("LEFT", "CENTER", "RIGHT")[word.across + 1]
    up = ("", "MIDDLE_", "TOP_")[word.up + 1]
    look = {"layer": word.layer, "style": STYLE, "rotation": degrees(word.angle)}
    entity = space.add_text(word.text, height=word.height * mm, dxfattribs=look)
    entity.set_placement(at, align=TextEntityAlignment[f"{up}{across}"])

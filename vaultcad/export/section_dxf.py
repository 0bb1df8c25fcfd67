"""sections.dxf: all sections side by side in metres, springings on one line; layers by kind of cut and of line."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vaultcad.dxf_document import Layer, add_layers, dxf_document
from vaultcad.fitted_arcs import fitted_arcs
from vaultcad.model import Model
from vaultcad.sections.section import Section, SectionArc

if TYPE_CHECKING:
    from ezdxf.layouts import Modelspace

LAYERS = {
    "SCAN": Layer(1, "CONTINUOUS", 35),  # the stone's line
    "IDEAL": Layer(8, "CONTINUOUS", 18),
    "AS-BUILT": Layer(5, "CONTINUOUS", 18),
    "ARCS": Layer(4, "DASHED", 25),  # circles that arches are drawn with, and curves of those without
    "CENTRES": Layer(6, "CONTINUOUS", 18),
    "TEXT": Layer(3, "CONTINUOUS", 18),
}
APART = 1.5  # m between sections
LETTER = 0.15  # m
CROSS = 0.05  # m, half of the mark of a centre
OFF = 0.0001  # m by which points may be off the arcs that are drawn for a line


def write_section_dxf(model: Model, sections: Sequence[Section], path: Path) -> None:
    """Write them, each kind of section on layers of its own, as DIAGONAL-SCAN."""
    with dxf_document(path, model.place) as document:
        for kind in dict.fromkeys(section.plane.kind for section in sections):
            add_layers(document, {f"{_prefix(kind)}-{name}": layer for name, layer in LAYERS.items()})
        at = 0.0
        for section in sections:
            reach = np.concatenate([line.line for line in section.ideal])
            low, high = reach.min(axis=0), reach.max(axis=0)
            _draw(document.modelspace(), section, np.array([at - low[0], 0.0]), float(low[1]))
            at += float(high[0] - low[0]) + APART


def _prefix(kind: str) -> str:
    return kind.upper().replace(" ", "-")


def _draw(space: Modelspace, section: Section, move: NDArray[np.float64], bottom: float) -> None:
    on = {name: {"layer": f"{_prefix(section.plane.kind)}-{name}"} for name in LAYERS}
    for run in section.profile:
        _line(space, run.line + move, on["SCAN"])
    for layer, lines in (("IDEAL", section.ideal), ("AS-BUILT", section.as_built)):
        for line in lines:
            _line(space, line.line + move, on[layer])
    texts = [f"{section.id}: {section.plane.told}"]
    for arch in section.arches:
        for arc in arch.arcs:
            _arc(space, arc, move, on)
        if not arch.arcs:
            _line(space, arch.line + move, on["ARCS"])
        span, rise = arch.sizes["span"], arch.sizes["rise"]
        odds = ", ".join(f"{kind} {chance:.0%}" for kind, chance in arch.odds.items() if chance >= 0.05)
        texts.append(f"{odds}; span {span.value:.3f}, rise {rise.value:.3f} m")
    for part in section.parts:
        if part.arc is not None:
            _arc(space, part.arc, move, on)
    left = float(min(line.line[:, 0].min() for line in section.ideal))
    for k, text in enumerate(texts, 2):
        place = (left + float(move[0]), bottom - 1.6 * k * LETTER)
        space.add_text(text, height=LETTER, dxfattribs=on["TEXT"]).set_placement(place)


def _line(space: Modelspace, row: NDArray[np.float64], on: dict[str, str]) -> None:
    corners, bulges = fitted_arcs(row, OFF)
    space.add_lwpolyline(np.column_stack([corners, bulges]).tolist(), format="xyb", dxfattribs=on)


def _arc(space: Modelspace, arc: SectionArc, move: NDArray[np.float64], on: dict[str, dict[str, str]]) -> None:
    u, z = arc.u.value + float(move[0]), arc.z.value + float(move[1])
    space.add_arc((u, z), arc.radius.value, degrees(arc.start), degrees(arc.end), dxfattribs=on["ARCS"])
    for a, b in (((u - CROSS, z), (u + CROSS, z)), ((u, z - CROSS), (u, z + CROSS))):
        space.add_line(a, b, dxfattribs=on["CENTRES"])

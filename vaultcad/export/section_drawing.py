"""A section as a drawing: the stone's line in its components' colours, the model's behind, arches with centres."""

from __future__ import annotations

import numpy as np

from families.declaration.palette import colour
from families.drawing.deviation_colours import CONVENTION, limit_of, shades
from families.drawing.looks import OUTSIDE
from families.drawing.sheet import Drawing
from vaultcad.model import said
from vaultcad.sections.section import Level, Section

NEAR = 1.0  # of the section's height below it, as far as centres are shown
LEAST = 1.0  # m, of the box of a drawing


def section_drawing(section: Section) -> Drawing:
    """It, with points of the scan in the colours of their deviations, sizes of its arches, and what they may be."""
    reach = np.concatenate([line.line for line in section.ideal])
    low, high = reach.min(axis=0), reach.max(axis=0)
    high = np.maximum(high, low + LEAST)
    drawing = Drawing(low, high, _title(section))
    for line in section.ideal:
        drawing.line(line.line, "closer")
    for line in section.as_built:
        drawing.line(line.line, "projected")
    limit = limit_of(section.scanned_deviation)
    drawing.dots(section.scanned, "deviation", shades(section.scanned_deviation, limit))
    for run in section.profile:
        numbers = run.component
        ends = np.concatenate([[0], np.flatnonzero(np.diff(numbers)) + 1, [len(numbers)]])
        for a, b in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
            number = int(numbers[a])
            name = section.names[number - 1] if number else "wall"
            drawing.line(run.line[a : b + 1], "surface", colour(number) if number else None, name)
    if not isinstance(section.plane.cut, Level):
        _sizes(drawing, section)
    drawing.scale(limit)
    return drawing


def _title(section: Section) -> str:
    arches = "; ".join(" or ".join(said(arch.odds)) for arch in section.arches)
    dots = f"dots: the scan within {100 * section.slab:g} cm, {CONVENTION}"
    return f"Section {section.id}, {section.plane.told}{': ' + arches if arches else ''}; {dots}"


def _sizes(drawing: Drawing, section: Section) -> None:
    """Springing line, spans and rises, and the centres of arcs that lie near enough to be shown."""
    out = OUTSIDE * drawing.margin
    left, right = float(drawing.low[0]), float(drawing.high[0])
    drawing.line(((left - out, 0.0), (right + out, 0.0)), "springing")
    for arch in section.arches:
        middle, half, foot = (arch.sizes[name].value for name in ("middle", "span", "springing"))
        low, high = middle - half / 2, middle + half / 2
        above = float(drawing.high[1]) + out / 2
        drawing.dimension((low, above), (high, above))
        drawing.dimension((right + out, foot), (right + out, foot + arch.sizes["rise"].value))
    arcs = [arc for arch in section.arches for arc in arch.arcs]
    arcs += [part.arc for part in section.parts if part.arc is not None]
    floor = float(drawing.low[1]) - NEAR * drawing.margin
    for arc in arcs:
        u, z = arc.u.value, arc.z.value
        if not (left < u < right and floor < z < drawing.high[1]):
            continue
        drawing.line(arc.points(), "projected")
        reach = 0.06 * drawing.margin
        drawing.line(((u - reach, z), (u + reach, z)), "dimension")
        drawing.line(((u, z - reach), (u, z + reach)), "dimension")
        drawing.text((u, z - 3 * reach), f"R {arc.radius.value:.2f}", "size")

"""A small map of deviations on the unrolled intrados, for the report."""

from __future__ import annotations

from math import ceil

import numpy as np

from families.drawing.deviation_colours import CONVENTION
from families.drawing.sheet import Drawing
from families.unrolled.sheet import unrolled
from vaultcad.export.seen import PER_CELL, Seen

CELLS = (75, 60, 45, 30)  # along the longer side of the sheet; the first in which points lie in most cells
DISTORTED = 0.1  # relative error of lengths: fewer gores than on the maps of `vaultcad unroll`
SIMPLE = 0.01  # [m] by which outlines may be off
MARGIN = 0.08  # around the sheet, in parts of its larger side


def unrolled_map(seen: Seen) -> Drawing:
    """Mean deviation a cell of the unrolled intrados, with outlines of its parts and its scale."""
    import shapely

    sheet = unrolled(seen.vault, DISTORTED)
    s0, t0, s1, t1 = sheet.bounds
    low, high = np.array([s0, t0]), np.array([s1, t1])
    drawing = Drawing(low, high, f"Deviation on the unrolled intrados: {CONVENTION}", MARGIN)
    place, _ = sheet.lay(seen.points[seen.on], seen.component[seen.on])
    known = np.isfinite(place[:, 0])
    s, t = place[known].T
    deviation = seen.deviation[seen.on][known]
    for along in CELLS:
        cells = [ceil(along * side) for side in (high - low) / (high - low).max()]
        counts, *_ = np.histogram2d(s, t, cells, [(s0, s1), (t0, t1)])
        if (counts >= PER_CELL).sum() > 0.5 * (counts > 0).sum():
            break
    sums, *_ = np.histogram2d(s, t, cells, [(s0, s1), (t0, t1)], weights=deviation)
    mean = np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0)
    drawing.cells(low, high, seen.stepped(mean), seen.limit)
    for leaf in sheet.leaves:
        for part in shapely.get_parts(shapely.simplify(leaf.outline, SIMPLE)):
            if isinstance(part, shapely.Polygon):
                for ring in (part.exterior, *part.interiors):
                    drawing.line(shapely.get_coordinates(ring), "edge", name=leaf.name)
    drawing.scale(seen.limit)
    return drawing

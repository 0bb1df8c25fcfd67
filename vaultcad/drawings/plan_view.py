"""A vault in plan, seen overhead, as a view of a sheet: outline, groins overhead, lines of equal height, sections."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import ceil, floor

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.void.columns import heights
from vaultcad.drawings.marks import Dimension, Mark, Path, View, Word, view_of
from vaultcad.drawings.section_view import Cut
from vaultcad.export.building_plan import arrow
from vaultcad.export.plan_shape import Outline, plan_shape
from vaultcad.model import Assembly, PlacedVault
from vaultcad.pose import Pose

Floats = NDArray[np.float64]

INTERVALS = (0.05, 0.1, 0.2, 0.25, 0.5, 1.0)  # m between lines of equal height
MOST_LINES = 12  # of them between springing and crown
CELLS = 140  # along the longer side of the plan, on which heights are taken
SMOOTH = 0.002  # m by which lines of equal height may be off
SHORTEST = 0.15  # m; shorter ones are left out
ROOM = 7.0  # mm that the number of a height needs
AWAY = 14.0  # mm on the paper from the plan to its dimensions, beyond the letters of sections
HEAD = 1.2  # mm, half of an arrow's head


def plan_view(model: Assembly, placed: PlacedVault, cuts: Sequence[Cut], scale: int) -> View:
    """The view in the vault's own frame, for a sheet at one to `scale`."""
    vault, mm = placed.vault, scale / 1000.0
    up = placed.pose.z + float(model.origin[2])
    shape = plan_shape(model, replace(placed, pose=Pose(0.0, 0.0, 0.0, 0.0)))
    marks: list[Mark] = [outline_path("OUTLINE", outline) for outline in shape.outlines]
    marks += [Path("GROINS", groin) for groin in shape.groins]
    view = view_of("Plan, the vault overhead", marks)
    view.marks += contours(vault, up, mm)
    view.marks += [Path("ARROWS", line) for line in arrow(shape, HEAD * mm)]
    for section in cuts:
        view.marks += _cutting(section, view, mm)
    (x0, y0), (x1, y1) = view.low.tolist(), view.high.tolist()
    out = AWAY * mm
    view.marks.append(Dimension("DIMENSIONS", (x0, y0), (x1, y0), (x0, y0 - out)))
    view.marks.append(Dimension("DIMENSIONS", (x1, y0), (x1, y1), (x1 + out, y0), np.pi / 2))
    return view


def outline_path(layer: str, outline: Outline) -> Path:
    """A closed outline as CAD has it."""
    return Path(layer, outline.corners, outline.bulges, closed=True)


def contours(vault: Vault, up: float, mm: float) -> Iterator[Mark]:
    """Lines of equal height of the intrados within the plan, with their heights [m]; `up` is that of the springing.

    mm: a millimetre of the paper [m]; lines without room for their number have none.
    """
    import contourpy
    import shapely

    low, high = vault.plan.box
    step = float((high - low).max()) / CELLS
    x, y = (np.arange(a - step, b + 1.5 * step, step) for a, b in zip(low, high, strict=True))
    places = np.stack(np.meshgrid(x, y), axis=-1)
    z = heights(vault, places.reshape(-1, 2)).reshape(places.shape[:2])
    rim, *holes = vault.plan.outlines()
    within = shapely.Polygon(rim, holes)
    rise = vault.top
    every = next((v for v in INTERVALS if rise / v <= MOST_LINES), INTERVALS[-1])
    lines = contourpy.contour_generator(x, y, z, name="serial")
    for n in range(ceil((up + 1e-6) / every), floor((up + rise - 1e-6) / every) + 1):
        level = n * every
        parts = [part for line in lines.lines(level - up) for part in inside(line, within)]
        for part in parts:
            yield Path("CONTOURS", part)
        longest = max(parts, default=np.zeros((2, 2)), key=lambda part: float(lengths(part).max()))
        k = int(lengths(longest).argmax())
        if lengths(longest)[k] > ROOM * mm:
            (x0, y0), (x1, y1) = longest[k].tolist(), longest[k + 1].tolist()
            turn = float(np.arctan2(y1 - y0, x1 - x0))
            upright = turn - np.pi * round(turn / np.pi)
            yield Word("CONTOURS", ((x0 + x1) / 2, (y0 + y1) / 2), f"{level:.2f}", 1.6, angle=upright)


def lengths(row: Floats) -> Floats:
    """Of the stretches between points (n, 2) of a line, (n - 1,)."""
    found: Floats = np.hypot(*np.diff(row, axis=0).T)
    return found


def inside(line: object, within: object) -> Iterator[Floats]:
    """The parts (n, 2) of a line that are within a polygon, with no more points than it needs."""
    import shapely

    found = shapely.intersection(shapely.LineString(line), within)
    for part in getattr(found, "geoms", [found]):
        if part.geom_type == "LineString" and part.length > SHORTEST:
            yield np.asarray(part.simplify(SMOOTH).coords)


def _cutting(section: Cut, view: View, mm: float) -> Iterator[Mark]:
    """Where a section cuts, with its letter at both ends."""
    origin, along = np.asarray(section.plane.origin), np.asarray(section.plane.direction)
    reach = [u for chord in section.chords for u in chord]
    out = 4.0 * mm
    a, b = origin + (min(reach) - out) * along, origin + (max(reach) + out) * along
    yield Path("CUTTING", np.stack([a, b]))
    for end, way in ((a, -1), (b, 1)):
        x, y = (end + way * 2.5 * mm * along).tolist()
        yield Word("TEXT", (x, y), section.letter, 3.5)

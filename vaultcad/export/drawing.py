"""Plan, map of deviations and sections of a fitted vault, drawn from its triangulated bodies and the scan's points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.drawing.deviation_colours import CONVENTION, UNKNOWN, shades
from families.drawing.looks import OUTSIDE, SLAB
from families.drawing.section import PLANES, CutPlane, measured
from families.drawing.sheet import Drawing
from vaultcad.export.component_bodies import Body
from vaultcad.export.geometry import bodies, shell
from vaultcad.export.mesh_borders import Floats, loops
from vaultcad.export.palette import colour
from vaultcad.export.seen import Seen

OFF_CENTRE = 1e-5  # [m] beside the middle, where triangles end
ENLARGED = 10  # deviations in sections are drawn so many times


def plan(seen: Seen, *, scanned: bool = False) -> Drawing:
    """The components seen from above, or instead the scan's points on them; lines of both sections, and clear sizes."""
    if not scanned:
        return ideal_plan(seen.vault, seen.thickness)
    drawing = Drawing(*_stone_box(seen.vault, seen.thickness), "Plan: components; grey: walls at the springing")
    drawing.dots(seen.walls[:, :2], "scan-closer")
    drawing.dots(seen.points[seen.on, :2], "scan", component_colours(seen))
    _edges(drawing, seen)
    _cut_and_measured(drawing, seen.vault)
    return drawing


def ideal_plan(vault: Vault, thickness: float) -> Drawing:
    """The components seen from above with their masonry [m], lines of both sections, and clear sizes."""
    drawing = Drawing(*_stone_box(vault, thickness), "Plan: components and clear sizes in metres")
    for k, name in enumerate(vault.components, 1):
        drawing.area(_borders(vault, thickness, k), "stone", colour(k), name)
    _cut_and_measured(drawing, vault)
    return drawing


def _cut_and_measured(drawing: Drawing, vault: Vault) -> None:
    """Add to a plan where the sections cut, and the clear widths there."""
    low, high = drawing.low, drawing.high
    for plane in PLANES:
        ends = np.zeros((2, 2))
        ends[:, plane.across] = low[plane.across], high[plane.across]
        out = np.array([[-1.0], [1.0]]) * np.eye(2)[plane.across] * drawing.margin
        drawing.line(ends + 0.12 * out, "cutting")
        for end in ends + 0.3 * out:
            drawing.text(end, plane.letter, "letter")
    below, right = low[1] - OUTSIDE * drawing.margin, high[0] + OUTSIDE * drawing.margin
    across, along = (plane.chords(vault) for plane in PLANES)
    for x0, x1 in across:
        drawing.dimension((x0, below), (x1, below))
    for y0, y1 in along:
        drawing.dimension((right, y0), (right, y1))


def deviations(seen: Seen) -> Drawing:
    """Mean deviation a cell of the plan, with its scale; grey where the scan saw nothing of the model."""
    drawing = Drawing(*_stone_box(seen.vault, seen.thickness), f"Deviation: {CONVENTION}; grey: no points")
    for k in range(1, len(seen.vault.components) + 1):
        drawing.area(_borders(seen.vault, seen.thickness, k), "unseen", UNKNOWN)
    drawing.cells(*seen.box, seen.stepped(seen.map()), seen.limit)
    _edges(drawing, seen)
    drawing.scale(seen.limit)
    return drawing


def section(seen: Seen, plane: CutPlane) -> Drawing:
    """The stone cut through the middle and, behind it, nearer to the wall that the section looks to; the points near.

    Those at the middle come a second time in colour, with their deviations enlarged.
    """
    vault, closer, (left, right) = seen.vault, plane.closer(seen.vault), plane.clear(seen.vault)
    pieces = bodies(vault, seen.thickness)
    cuts, behind = ([_cut_rows(body, plane, at) for body in pieces] for at in (OFF_CENTRE, closer))
    outline = np.concatenate([[[left, 0.0], [right, 0.0]], *(row for rows in (*cuts, *behind) for row in rows)])
    known = "taken" if seen.fitted.measured_shell is None else "measured"
    thick = f"stone, {known} as {100 * seen.thickness:.3g} cm thick; grey: nearer the wall"
    dots = f"; dots: the scan within {100 * SLAB:g} cm of the cut; in colour: deviations × {ENLARGED}"
    title = f"Section {plane.letter}–{plane.letter}: {thick}{dots if len(seen.points) else ''}"
    drawing = Drawing(outline.min(axis=0), outline.max(axis=0), title)
    for row in (row for rows in behind for row in rows):
        drawing.line(row, "closer")
    for body, rows in zip(pieces, cuts, strict=True):
        drawing.area(rows, "stone", colour(body.id), body.name)
    drawing.dots(plane.drawn(seen.points[plane.near(seen.points, closer)]), "scan-closer")
    near = plane.near(seen.points)
    drawing.dots(plane.drawn(seen.points[near]), "scan")
    on = near[seen.on[near]]
    drawing.dots(plane.drawn(_enlarged(seen, on)), "deviation", shades(seen.stepped(seen.deviation[on]), seen.limit))
    measured(drawing, vault, plane)
    return drawing


def component_colours(seen: Seen) -> NDArray[np.uint8]:
    """Red, green, blue (m, 3) of the points on the vault, by component."""
    kinds = [colour(k) for k in range(len(seen.vault.components) + 1)]
    table = np.array([(c.red, c.green, c.blue) for c in kinds], dtype=np.uint8)
    found: NDArray[np.uint8] = table[seen.component[seen.on]]
    return found


def cut(body: Body, axis: int, at: float) -> list[Floats]:
    """Closed outlines (n, 3) of a body cut by the plane where a coordinate is `at`; no vertex may lie on it."""
    vertices, triangles = body.vertices, body.triangles
    above = vertices[:, axis] > at
    crossing = triangles[above[triangles].any(axis=1) & ~above[triangles].all(axis=1)]
    following: dict[tuple[int, int], tuple[int, int]] = {}
    for triangle in crossing.tolist():
        edges = [(triangle[k], triangle[(k + 1) % 3]) for k in range(3)]
        (leaves,) = (e for e in edges if above[e[0]] and not above[e[1]])
        (enters,) = (e for e in edges if above[e[1]] and not above[e[0]])
        # The neighbour has this edge the other way round: rows are keyed by the edge from above to below.
        following[leaves] = enters[1], enters[0]
    rows = []
    while following:
        start, edge = following.popitem()
        row = [start]
        while edge != start:
            row.append(edge)
            edge = following.pop(edge)
        a, b = (vertices[list(ends)] for ends in zip(*row, strict=True))
        share = (at - a[:, axis]) / (b[:, axis] - a[:, axis])
        rows.append(a + share[:, None] * (b - a))
    return rows


def _cut_rows(body: Body, plane: CutPlane, at: float) -> list[Floats]:
    """Closed rows (n, 2) of a body in a section."""
    rows = [plane.drawn(row) for row in cut(body, plane.axis, at)]
    return [np.concatenate([row, row[:1]]) for row in rows]


def _enlarged(seen: Seen, of: NDArray[np.intp]) -> Floats:
    """Points (m, 3) of the vault where they would be if they were off it by so many times as much."""
    mine = seen.points[of]
    if not len(mine):
        return mine
    moved: Floats = mine + (ENLARGED - 1) * seen.deviation[of, None] * seen.vault.evaluate(mine).normal
    return moved


def _stone_box(vault: Vault, thickness: float) -> tuple[Floats, Floats]:
    """The lower and the upper corner (2,) [m] of what the masonry covers."""
    vertices = shell(vault, thickness).vertices[:, :2]
    return vertices.min(axis=0), vertices.max(axis=0)


def _borders(vault: Vault, thickness: float, component: int) -> list[Floats]:
    """Of a component in plan, as closed rows (n, 2)."""
    mesh = shell(vault, thickness)
    return [mesh.vertices[[*row, row[0]], :2] for row in loops(mesh.triangles[mesh.component == component])]


def _all_borders(seen: Seen) -> Iterator[Floats]:
    """Of all components, without what of them lies in the mouths of lunettes."""
    for k in range(1, len(seen.vault.components) + 1):
        for row in _borders(seen.vault, seen.thickness, k):
            yield np.clip(row, *seen.box)


def _edges(drawing: Drawing, seen: Seen) -> None:
    for row in _all_borders(seen):
        drawing.line(row, "edge")

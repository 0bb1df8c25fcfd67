"""Plan and sections of a fitted vault as SVG, drawn from its triangulated bodies, with the scan's points on the cut."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vaultcad.export.geometry import Body, Floats, bodies, loops, shell
from vaultcad.export.svg import Drawing
from vaultcad.model import FittedVault

OFF_CENTRE = 1e-5  # [m] beside the middle, where triangles end
SLICE = 0.03  # [m] to either side of a section from which points are shown
MOST_POINTS = 4000


@dataclass(frozen=True)
class CutPlane:
    """A vertical section through the middle: across which axis (0 or 1), its letter, and to which side it looks."""

    axis: int
    letter: str
    looks: int

    @property
    def across(self) -> int:
        """The axis that is drawn from left to right."""
        return 1 - self.axis


PLANES = (CutPlane(1, "A", +1), CutPlane(0, "B", -1))


def plan(fitted: FittedVault, thickness: float) -> Drawing:
    """The components seen from above, with the lines of both sections and the clear sizes."""
    mesh, box = shell(fitted.vault, thickness), fitted.vault.plan
    half = np.array([box.half_x, box.half_y])
    reach = half + thickness * np.array([box.on_wall_x, box.on_wall_y])
    drawing = Drawing(-reach, reach, f"Plan of the {fitted.vault.title}")
    for k, name in enumerate(fitted.vault.components, 1):
        rows = [mesh.vertices[row][:, :2] for row in loops(mesh.triangles[mesh.component == k])]
        drawing.shape(rows, k, name)
    for plane in PLANES:
        end = np.zeros(2)
        end[plane.across] = reach[plane.across] + 0.4 * drawing.margin
        drawing.line(-end, end, "cutting")
        for sign in (-1, 1):
            drawing.text(sign * end * (1 + 0.25 * drawing.margin / end.max()), plane.letter, "letter")
    x, y = reach + 0.5 * drawing.margin
    drawing.dimension((-half[0], -y), (half[0], -y))
    drawing.dimension((x, -half[1]), (x, half[1]))
    return drawing


def section(fitted: FittedVault, thickness: float, plane: CutPlane, points: Floats) -> Drawing:
    """The stone cut through the middle, edges beyond the cut, and the points (n, 3) [m] near it, in the local frame."""
    vault, pieces = fitted.vault, bodies(fitted.vault, thickness)
    edges, half = _beyond(fitted, thickness, plane), (vault.plan.half_x, vault.plan.half_y)[plane.across]
    cuts = [[row[:, [plane.across, 2]] for row in cut(body, plane.axis, OFF_CENTRE)] for body in pieces]
    feet = np.array([[-half, 0.0], [half, 0.0]])
    outline = np.concatenate([feet, *edges, *(row for rows in cuts for row in rows)])
    drawing = Drawing(outline.min(axis=0), outline.max(axis=0), f"Section {plane.letter}–{plane.letter}: {vault.title}")
    for row in edges:
        drawing.row(row, "beyond")
    for body, rows in zip(pieces, cuts, strict=True):
        drawing.shape(rows, body.id, body.name)
    drawing.dots(_near(fitted, plane, points))
    out = 0.5 * drawing.margin
    drawing.line((drawing.low[0] - out, 0.0), (drawing.high[0] + out, 0.0), "springing")
    drawing.dimension((-half, -out), (half, -out))
    crown = min((_crossing(row) for rows in cuts for row in rows), default=np.inf)
    if 0 < crown < np.inf:
        drawing.dimension((drawing.high[0] + out, 0.0), (drawing.high[0] + out, crown))
    return drawing


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


def _crossing(row: Floats) -> float:
    """Lowest height [m] at which an outline (n, 2) crosses the middle; infinite if it does not."""
    u, z = row.T
    after = np.roll(np.arange(len(u)), -1)
    at = np.flatnonzero((u > OFF_CENTRE) != (u[after] > OFF_CENTRE))
    share = (OFF_CENTRE - u[at]) / (u[after[at]] - u[at])
    return float(np.min(z[at] + share * (z[after[at]] - z[at]), initial=np.inf))


def _beyond(fitted: FittedVault, thickness: float, plane: CutPlane) -> list[Floats]:
    """Borders of the components on the side that a section looks to, as rows (n, 2)."""
    mesh, rows = shell(fitted.vault, thickness), []
    for k in range(1, len(fitted.vault.components) + 1):
        for loop in loops(mesh.triangles[mesh.component == k]):
            ring = mesh.vertices[[*loop, loop[0]]]
            seen = plane.looks * ring[:, plane.axis] > -OFF_CENTRE
            runs = np.split(np.arange(len(ring)), np.flatnonzero(np.diff(seen)) + 1)
            rows += [ring[run][:, [plane.across, 2]] for run in runs if seen[run[0]] and len(run) > 1]
    return rows


def _near(fitted: FittedVault, plane: CutPlane, points: Floats) -> Floats:
    """The points (n, 2) within a slice about the section, thinned."""
    frame = fitted.pose.frame()
    local = points @ frame[:, :3].T + frame[:, 3]
    near = local[np.abs(local[:, plane.axis]) < SLICE][:, [plane.across, 2]]
    return near[:: max(1, -(-len(near) // MOST_POINTS))]

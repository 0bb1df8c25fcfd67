"""Plan and sections of a fitted vault as SVG, drawn from its triangulated bodies, with the scan's points on the cut."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from vaultcad.export.geometry import Body, Floats, Triangles, bodies, loops, shell
from vaultcad.export.palette import colour
from vaultcad.model import FittedVault

UNIT = 100.0  # drawing units a metre: centimetres, written with one decimal
MARGIN = 0.55  # [m] around a drawing, for its dimensions
OFF_CENTRE = 1e-5  # [m] beside the middle, where triangles end
SLICE = 0.03  # [m] to either side of a section from which points are shown
MOST_POINTS = 4000


@dataclass(frozen=True)
class Plane:
    """A vertical section through the middle of a vault: where it looks along (axis 0 or 1), and its letter."""

    axis: int
    letter: str

    @property
    def across(self) -> int:
        """The axis that is drawn from left to right."""
        return 1 - self.axis


PLANES = (Plane(1, "A"), Plane(0, "B"))


def plan(fitted: FittedVault, thickness: float) -> str:
    """The components seen from above, with the lines of both sections and the clear sizes."""
    mesh, box = shell(fitted.vault, thickness), fitted.vault.plan
    half = np.array([box.half_x, box.half_y])
    shapes = []
    for k, name in enumerate(fitted.vault.components, 1):
        rows = [mesh.vertices[row][:, :2] for row in loops(mesh.triangles[mesh.component == k])]
        shapes.append(_shape(rows, k, name))
    marks = []
    for plane in PLANES:
        end = half[plane.across] + 0.3
        a, b = (np.zeros(2), np.zeros(2))
        a[plane.across], b[plane.across] = -end, end
        letters = "".join(_text(p, plane.letter, "letter") for p in (a * 1.04, b * 1.04))
        marks.append(_line(a, b, "cutting") + letters)
    x, y = half
    sizes = _dimension((-x, -y - 0.4), (x, -y - 0.4)) + _dimension((x + 0.4, -y), (x + 0.4, y))
    reach = half + thickness * np.array([box.on_wall_x, box.on_wall_y]) + MARGIN
    return _svg([*shapes, *marks, sizes], -reach, reach, f"Plan of the {fitted.vault.title}")


def section(fitted: FittedVault, thickness: float, plane: Plane, points: Floats) -> str:
    """The stone cut through the middle, and the points (n, 3) [m] near the cut, in the scan's local frame."""
    pieces = bodies(fitted.vault, thickness)
    shapes, all_rows = [], [np.zeros((1, 2))]
    for body in pieces:
        rows = [row[:, [plane.across, 2]] for row in cut(body.vertices, body.triangles, plane.axis, OFF_CENTRE)]
        all_rows += rows
        shapes.append(_shape(rows, body.id, body.name))
    outline = np.concatenate(all_rows)
    low, high = outline.min(axis=0), outline.max(axis=0)
    half = (fitted.vault.plan.half_x, fitted.vault.plan.half_y)[plane.across]
    crown = _crown(pieces, plane)
    marks = [
        _line((low[0] - 0.2, 0.0), (high[0] + 0.2, 0.0), "springing"),
        _dimension((-half, -0.3), (half, -0.3)),
        _dimension((high[0] + 0.35, 0.0), (high[0] + 0.35, crown)) if crown > 0 else "",
    ]
    title = f"Section {plane.letter}–{plane.letter} of the {fitted.vault.title}"
    low, high = low - (MARGIN, MARGIN), high + (MARGIN + 0.25, 0.15)
    return _svg([*shapes, _dots(fitted, plane, points, low, high), *marks], low, high, title)


def cut(vertices: Floats, triangles: Triangles, axis: int, at: float) -> list[Floats]:
    """Closed outlines (n, 3) of a closed mesh cut by the plane where a coordinate is `at`; no vertex may lie on it."""
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


def _crown(pieces: tuple[Body, ...], plane: Plane) -> float:
    """Height [m] at which a plumb line in the middle of the section meets the stone."""
    heights = []
    for body in pieces:
        for row in cut(body.vertices, body.triangles, plane.axis, OFF_CENTRE):
            u, z = row[:, plane.across], row[:, 2]
            before, after = u, np.roll(u, -1)
            at = np.flatnonzero((before > OFF_CENTRE) != (after > OFF_CENTRE))
            share = (OFF_CENTRE - before[at]) / (after[at] - before[at])
            heights += (z[at] + share * (np.roll(z, -1)[at] - z[at])).tolist()
    return min(heights, default=0.0)


def _dots(fitted: FittedVault, plane: Plane, points: Floats, low: Floats, high: Floats) -> str:
    frame = fitted.pose.frame()
    local = points @ frame[:, :3].T + frame[:, 3]
    near = local[np.abs(local[:, plane.axis]) < SLICE][:, [plane.across, 2]]
    near = near[((near > low) & (near < high)).all(axis=1)]
    near = near[:: max(1, -(-len(near) // MOST_POINTS))]
    if not len(near):
        return ""
    return f'<path class="scan" d="{"".join(f"M{_xy(p)}h0" for p in near)}"/>'


def _svg(shapes: Iterable[str], low: Floats, high: Floats, title: str) -> str:
    x, y = UNIT * low[0], -UNIT * high[1]
    width, height = UNIT * (high - low)
    box = f"{x:.1f} {y:.1f} {width:.1f} {height:.1f}"
    inside = f"<title>{escape(title)}</title>{''.join(shapes)}"
    return f'<svg class="drawing" viewBox="{box}" role="img" style="--width:{width / UNIT:.2f}">{inside}</svg>'


def _shape(rows: list[Floats], component: int, name: str) -> str:
    if not rows:
        return ""
    path = "".join(f"M{'L'.join(_xy(p) for p in _sparse(row))}Z" for row in rows)
    fill = colour(component).hex
    return f'<path class="stone" fill="{fill}" fill-rule="evenodd" d="{path}"><title>{escape(name)}</title></path>'


def _sparse(row: Floats) -> Floats:
    """Without points that are drawn at the place of the one before."""
    shown = np.round(row * UNIT, 1)
    return row[(shown != np.roll(shown, 1, axis=0)).any(axis=1)] if len(row) > 1 else row


def _dimension(a: tuple[float, float], b: tuple[float, float]) -> str:
    """A line with its length in metres, level or plumb."""
    (ax, ay), (bx, by) = a, b
    length, plumb = abs(bx - ax) + abs(by - ay), ax == bx
    place = ((ax + bx) / 2 + 0.1 * plumb, (ay + by) / 2 + (0.0 if plumb else -0.22))
    label = _text(place, f"{length:.2f} m", "size plumb" if plumb else "size")
    tick = np.array([0.06, 0.0] if plumb else [0.0, 0.06])
    ends = "".join(_line(np.array(p) - tick, np.array(p) + tick, "dimension") for p in (a, b))
    return _line(a, b, "dimension") + ends + label


def _line(a: Iterable[float], b: Iterable[float], kind: str) -> str:
    return f'<path class="{kind}" d="M{_xy(a)}L{_xy(b)}"/>'


def _text(at: Iterable[float], text: str, kind: str) -> str:
    x, y = at
    return f'<text class="{kind}" x="{UNIT * x:.1f}" y="{-UNIT * y:.1f}">{escape(text)}</text>'


def _xy(point: Iterable[float] | NDArray[np.floating]) -> str:
    x, y = point
    return f"{UNIT * x:.1f} {-UNIT * y:.1f}"

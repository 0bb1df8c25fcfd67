"""One regular net of quadrangles a region: so many lines either way along its chart, from border to border.

Lines of the one kind run straight across the chart from border to border, along the direction in which each meets it
twice alone and narrows to a point at as few ends as can be; those of the other kind divide them evenly. A dome's are
parallels and meridians. Where a border leaps, as at the jambs of a lunette, two lines stand close together.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.nurbs.charts import AboutCentre
from vaultcad.nurbs.freeform import FreeForm

Array = NDArray[np.float64]
LOOKS = 32  # lines by which a direction is judged
NARROW = 0.05  # of the widest line, below which one is all but a point
LEAP = 0.02  # m, of a border from one side of a line to the other
ASIDE = 0.002  # m, from a leap
SNAP = 0.45  # of the distance of lines, from which one moves to a corner of the border
AT_END = 0.03  # m, that the nodes of an edge at the end of a net may lie apart along it
MOST_LINES = 400


@dataclass(frozen=True, eq=False)
class QuadNet:
    """points: (n, m, 3) [m] in the vault's frame, rows by columns; uv: (n, m, 2) from 0 to 1.

    quads: (k, 4) of indices into the points as one row of them, counterclockwise seen from the room; where a line is a
    point the last two of a quad are one.
    """

    region: int
    points: Array
    uv: Array
    quads: NDArray[np.int64]

    @property
    def triangles(self) -> NDArray[np.int64]:
        """Two of each quad (k, 3), those without an area left out."""
        found = np.concatenate([self.quads[:, [0, 1, 2]], self.quads[:, [0, 2, 3]]])
        a, b, c = found.T
        whole: NDArray[np.int64] = found[(a != b) & (b != c) & (c != a)]
        return whole


def nets(form: FreeForm, size: float) -> tuple[QuadNet, ...]:
    """The nets of all regions, with lines about so far apart [m]."""
    return tuple(_net(form, k, size) for k in range(len(form.surfaces)))


def _net(form: FreeForm, region: int, size: float) -> QuadNet:
    border = _Border(form, region)
    chart = form.surfaces[region].chart
    around = isinstance(chart, AboutCentre) and chart.round and border.encloses_origin()
    places = _star(border, size) if around else _rows(border, size)
    rows, columns, _ = places.shape
    u, v = places.reshape(-1, 2).T
    points = chart.place(u, v, form.surfaces[region].field(u, v))
    i, j = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    index = np.arange(rows * columns).reshape(rows, columns)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    quads = _turned(form, region, points, _collapsed(points, quads))
    return QuadNet(region, points.reshape(rows, columns, 3), np.stack([j, i], axis=-1), quads)


def _collapsed(points: Array, quads: NDArray[np.int64]) -> NDArray[np.int64]:
    """Quads with a side that is a point as three corners, the last of them twice."""
    found = quads.copy()
    for k in range(4):
        same = np.linalg.norm(points[quads[:, k]] - points[quads[:, (k + 1) % 4]], axis=1) < 1e-6
        order = [(k + 2) % 4, (k + 3) % 4, k, k]
        found[same] = quads[same][:, order]
    return found


def _turned(form: FreeForm, region: int, points: Array, quads: NDArray[np.int64]) -> NDArray[np.int64]:
    """Quads that face the room."""
    a, b, c = (points[quads[:, k]] for k in (0, 1, 2))
    across = np.cross(b - a, c - a)
    _, into_stone = form.surfaces[region].off((a + b + c) / 3)
    return quads if np.einsum("ij,ij->", across, into_stone) < 0 else quads[:, [1, 0, 3, 2]]


class _Border:
    """The border of a region over its chart as pieces of line (n, 2, 2), and its corners (m, 2)."""

    def __init__(self, form: FreeForm, region: int) -> None:
        outline, chart = form.outline, form.surfaces[region].chart
        pieces, corners, self.length = [], [], 0.0
        for edge in outline.edges:
            if [outline.faces[face].field for face, _ in edge.sides].count(region) != 1:
                continue
            nodes = outline.nodes[list(edge.nodes)]
            self.length += float(np.linalg.norm(np.diff(nodes, axis=0), axis=1).sum())
            u, v, _ = chart.chart(nodes)
            if chart.turn:
                u = np.unwrap(u, period=chart.turn)
            row = np.column_stack([u, v])
            line = np.stack([row[:-1], row[1:]], axis=1)
            pieces += [line + np.array([shift * chart.turn, 0.0]) for shift in ((-1, 0, 1) if chart.turn else (0,))]
            corners += [row[0], row[-1]]
        self.pieces, self.corners, self.turn = np.concatenate(pieces), np.array(corners), chart.turn
        places = self.pieces.reshape(-1, 2)
        self.low, self.high = places.min(axis=0), places.max(axis=0)
        if self.turn:
            self.low[0], self.high[0] = 0.0, self.turn

    def crossings(self, axis: int, at: float) -> Array:
        """Where the line along the other axis meets the border."""
        a, b = self.pieces[:, 0], self.pieces[:, 1]
        one, other = a[:, axis] - at, b[:, axis] - at
        hit = (one < 0) != (other < 0)
        share = one[hit] / (one[hit] - other[hit])
        found: Array = np.sort(a[hit, 1 - axis] + share * (b[hit, 1 - axis] - a[hit, 1 - axis]))
        return found

    def span(self, axis: int, at: float) -> tuple[float, float]:
        """The first and the last of them; beyond the ends of the border those at the end."""
        low, high = self.low[axis] + self._depth(axis, 0), self.high[axis] - self._depth(axis, 1)
        found = self.crossings(axis, float(np.clip(at, low, high)))
        return (float(found[0]), float(found[-1])) if len(found) else (0.0, 0.0)

    def _depth(self, axis: int, end: int) -> float:
        """How far the nodes of an edge at an end of the border lie from that, and a little more [m]."""
        size = float(self.high[axis] - self.low[axis])
        nodes = self.pieces.reshape(-1, 2)
        off = np.abs(nodes[:, axis] - (self.low, self.high)[end][axis])
        at_end = off < min(AT_END, size / 10)
        if np.ptp(nodes[at_end, 1 - axis]) < AT_END:
            return 1e-6 * size
        return float(off[at_end].max()) + 1e-4

    def axis(self) -> int:
        """Along which lines are square to those across."""
        if self.turn:
            return 0
        judged = []
        for axis in (0, 1):
            size = self.high[axis] - self.low[axis]
            at = self.low[axis] + size * (np.arange(LOOKS) + 0.5) / LOOKS
            widths = np.array([high - low for low, high in (self.span(axis, float(x)) for x in at)])
            several = sum(len(self.crossings(axis, float(x))) > 2 for x in at)
            ends = [self.span(axis, self.low[axis] + share * size) for share in (0.01, 0.99)]
            narrow = sum(high - low < NARROW * widths.max() * 3 for low, high in ends)
            judged.append((several, narrow, axis))
        return min(judged)[2]

    def encloses_origin(self) -> bool:
        """Whether the border goes round the middle of the chart."""
        angle = np.arctan2(self.pieces[:, :, 1], self.pieces[:, :, 0])
        turn = (angle[:, 1] - angle[:, 0] + np.pi) % (2 * np.pi) - np.pi
        return bool(np.abs(turn).sum() > 1.9 * np.pi)


def _rows(border: _Border, size: float) -> Array:
    """Places (n, m, 2) on lines across the chart."""
    axis = border.axis()
    low, high = border.low[axis], border.high[axis]
    at = np.linspace(low, high, _count(high - low, size) + 1)
    lines: list[float] = []
    corners = np.unique(np.round(border.corners[:, axis], 3))
    for even in at.tolist():
        nearest = float(corners[np.abs(corners - even).argmin()])
        near = abs(nearest - even) < SNAP * (at[1] - at[0]) and low < nearest < high and low < even < high
        x = nearest if near else even
        leap = np.abs(np.subtract(border.span(axis, x - ASIDE), border.span(axis, x + ASIDE))).max()
        lines += [x - ASIDE, x + ASIDE] if leap > LEAP and low + ASIDE < x < high - ASIDE else [x]
    spans = np.array([border.span(axis, x) for x in lines])
    share = np.linspace(0, 1, _count(float(np.ptp(spans, axis=1).max()), size) + 1)
    across = spans[:, :1] + np.ptp(spans, axis=1)[:, None] * share
    along = np.tile(np.array(lines)[:, None], (1, len(share)))
    if not border.turn:
        part = (along - low) / (high - low)
        along = along + (1 - part) * _end(border, axis, low, across[0]) + part * _end(border, axis, high, across[-1])
    found = np.stack([along, across], axis=-1)
    return found if axis == 0 else found[..., ::-1]


def _end(border: _Border, axis: int, at: float, across: Array) -> Array:
    """By how much an edge at the end of a net lies off a straight line there, at places (m,) along it."""
    nodes = border.pieces.reshape(-1, 2)
    nodes = nodes[np.abs(nodes[:, axis] - at) < AT_END]
    order = np.argsort(nodes[:, 1 - axis], kind="stable")
    if np.ptp(nodes[:, 1 - axis]) < AT_END:
        return np.zeros_like(across)
    found: Array = np.interp(across, nodes[order, 1 - axis], nodes[order, axis]) - at
    return found


def _star(border: _Border, size: float) -> Array:
    """Places (n, m, 2) on lines from the middle of the chart to its border, the first and the last the same."""
    nodes = border.pieces.reshape(-1, 2)
    angle, reach = np.arctan2(nodes[:, 1], nodes[:, 0]), np.hypot(*nodes.T)
    order = np.argsort(angle, kind="stable")
    way = np.linspace(-np.pi, np.pi, _count(border.length, size) + 1)
    edge = np.interp(way, angle[order], reach[order], period=2 * np.pi)
    share = np.linspace(1, 0, _count(float(reach.mean()), size) + 1)
    found: Array = (share[:, None] * edge)[..., None] * np.stack([np.cos(way), np.sin(way)], axis=-1)
    return found


def _count(length: float, size: float) -> int:
    return int(np.clip(round(length / size), 1, MOST_LINES))

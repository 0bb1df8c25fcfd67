"""Where free surfaces meet and end: each runs on past its edge, they are intersected there, and clipped.

All nodes of an outline are moved at once, by weighted least squares: onto the surfaces of the faces that they are on,
and, at free edges, into the plan's side or the level of the springing. How far they slide otherwise is held to what
groins are off their ideal. So where two surfaces cross at an angle a node comes to lie on both; where they all but
touch, as near the crown of a groin vault, their crossing is no figure to be had from a scan, and it stays on an edge
between them, which both surfaces are fitted again to pass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan
from vaultcad.nurbs.charts import Chart
from vaultcad.nurbs.field import Field
from vaultcad.nurbs.outline import Outline

Array = NDArray[np.float64]
STEP = 1e-5  # m, of differences
ON_SURFACE = 1e-3  # m, to which a node is on a surface
IN_SIDE = 1e-2  # m, to which a node of a free edge is in the plan's side or level: walls are no better fitted
ALONG = 1e-4  # m, to which a node stays in its place along its edge
SLIDING = 2e-2  # m, by which edges are off their ideal otherwise
ON_SIDE = 1e-5  # m, from the plan's side or the springing
ROUNDS = 8
CROSSING = np.sin(np.radians(5.0))  # of the angle between two surfaces from which on they are intersected


@dataclass(frozen=True, eq=False)
class FreeSurface:
    """A surface by its reach in a chart; it has no end."""

    chart: Chart
    field: Field

    def off(self, xyz: Array) -> tuple[Array, Array]:
        """Signed distances (n,) [m] to first order, positive away from the chart's axis, and unit normals (n, 3)."""
        value = self._reach_off(xyz)
        slope = np.stack([self._reach_off(xyz + STEP * unit) - value for unit in np.eye(3)], axis=1) / STEP
        size = np.maximum(np.linalg.norm(slope, axis=1), 1e-9)
        return value / size, slope / size[:, None]

    def distance(self, xyz: Array) -> Array:
        """The first of them alone, for many points near the surface."""
        u, v, reach = self.chart.chart(xyz)
        here = self.field.values(u, v)
        value = reach - here[:, 0]
        # The steepness of the difference by u and v, whose own steepness follows from places a step apart.
        at = self.chart.place(u, v, here[:, 0])
        along = (self.chart.place(u + STEP, v, here[:, 0] + STEP * here[:, 1]) - at) / STEP
        across = (self.chart.place(u, v + STEP, here[:, 0] + STEP * here[:, 2]) - at) / STEP
        ray = self.chart.place(u, v, here[:, 0] + STEP) - at
        normal = np.cross(along, across)
        size = np.maximum(np.linalg.norm(normal, axis=1) * np.linalg.norm(ray, axis=1), 1e-30)
        found: Array = value * np.abs(np.einsum("ij,ij->i", normal, ray)) / size
        return found

    def _reach_off(self, xyz: Array) -> Array:
        u, v, reach = self.chart.chart(xyz)
        found: Array = reach - self.field(u, v)
        return found


def met(
    outline: Outline, surfaces: list[FreeSurface], plan: Plan, start: Array, seen: list[NDArray[np.bool_]]
) -> Array:
    """The nodes (n, 3) [m] moved from `start` to where surfaces meet and end.

    seen: of each region's nodes whether its surface is known there; a node of no known surface goes along with those
    of its edge that are.
    """
    corners = outline.corners
    nodes = start.copy()
    nodes[:corners] = _moved(outline, surfaces, plan, start, np.arange(corners), seen)
    known = np.zeros(len(nodes), bool)
    for mine, of in zip(outline.of_region, seen, strict=True):
        known[mine[of]] = True
    for edge in outline.edges:  # those between go along with their ends
        _carry(nodes, start, edge.nodes, np.array([True, *[False] * (len(edge.nodes) - 2), True]))
    nodes[corners:] = _moved(outline, surfaces, plan, nodes, np.arange(corners, len(nodes)), seen)
    for edge in outline.edges:
        found = known[list(edge.nodes)]
        found[[0, -1]] = True
        _carry(nodes, start, edge.nodes, found)
    return nodes


def _carry(nodes: Array, start: Array, row: tuple[int, ...], known: NDArray[np.bool_]) -> None:
    """Move nodes of a row that are not known by what those beside them were moved."""
    at, moved = np.flatnonzero(known), nodes[list(row)] - start[list(row)]
    for axis in range(3):
        shift = np.interp(np.arange(len(row)), at, moved[at, axis])
        nodes[np.array(row)[~known], axis] = (start[list(row), axis] + shift)[~known]


def _moved(
    outline: Outline,
    surfaces: list[FreeSurface],
    plan: Plan,
    start: Array,
    which: NDArray[np.int64],
    seen: list[NDArray[np.bool_]],
) -> Array:
    """Some of the nodes, moved."""
    fixed, goal = _held(outline, plan, start)
    nodes = start.copy()
    chosen = np.zeros(len(nodes), bool)
    chosen[which] = True
    of_region = [mine[chosen[mine] & known] for mine, known in zip(outline.of_region, seen, strict=True)]
    for _ in range(ROUNDS):
        matrix = fixed[which].copy()
        right = goal[which] - np.einsum("nij,nj->ni", fixed[which], nodes[which])
        place = np.full(len(nodes), -1)
        place[which] = np.arange(len(which))
        for surface, mine in zip(surfaces, of_region, strict=True):
            if not len(mine):
                continue
            off, normal = surface.off(nodes[mine])
            rows = place[mine]
            matrix[rows] += normal[:, :, None] * normal[:, None, :] / ON_SURFACE**2
            right[rows] -= normal * (off / ON_SURFACE**2)[:, None]
        nodes[which] += np.linalg.solve(matrix, right[:, :, None])[:, :, 0]
    return nodes[which]


def _held(outline: Outline, plan: Plan, start: Array) -> tuple[Array, Array]:
    """Normal matrices (n, 3, 3) of what holds nodes beside the surfaces, and the right sides (n, 3) of its places."""
    ideal = outline.nodes
    matrix = np.tile(np.eye(3) / SLIDING**2, (len(ideal), 1, 1))
    goal = np.einsum("nij,nj->ni", matrix, start)

    def hold(which: NDArray[np.int64], normal: Array, place: Array, to: float) -> None:
        outer = normal[:, :, None] * normal[:, None, :] / to**2
        matrix[which] += outer
        goal[which] += np.einsum("nij,nj->ni", outer, place)

    inner = np.arange(outline.corners, len(ideal))
    hold(inner, outline.tangents[inner], start[inner], ALONG)
    free = np.array(sorted({k for edge in outline.edges if len(edge.sides) == 1 for k in edge.nodes}), np.int64)
    ground = free[np.abs(ideal[free, 2]) < ON_SIDE]
    hold(ground, np.tile([0.0, 0.0, 1.0], (len(ground), 1)), ideal[ground], IN_SIDE)
    for side in plan.sides:
        xy = ideal[free, :2]
        if side.centre is None:
            normal = np.tile(side.normal, (len(free), 1))
            beside = np.abs(xy @ np.array(side.normal) - side.offset) < ON_SIDE
        else:
            away = xy - side.centre
            size = np.hypot(*away.T)
            normal = away / np.maximum(size, 1e-9)[:, None]
            beside = np.abs(size - side.radius) < ON_SIDE
        mine = free[beside]
        hold(mine, np.hstack([normal[beside], np.zeros((len(mine), 1))]), ideal[mine], IN_SIDE)
    return matrix, goal


def crossing(outline: Outline, surfaces: list[FreeSurface], nodes: Array) -> list[float]:
    """Of each edge the share of its nodes at which its two surfaces cross at an angle; 1 for free edges."""
    normals: list[dict[int, Array]] = []
    for surface, mine in zip(surfaces, outline.of_region, strict=True):
        normals.append(dict(zip(mine.tolist(), surface.off(nodes[mine])[1], strict=True)))
    shares = []
    for edge in outline.edges:
        fields = [outline.faces[face].field for face, _ in edge.sides]
        if len(set(fields)) < 2:
            shares.append(1.0)
            continue
        a, b = (np.array([normals[field][k] for k in edge.nodes]) for field in fields)
        shares.append(float((np.linalg.norm(np.cross(a, b), axis=1) > CROSSING).mean()))
    return shares

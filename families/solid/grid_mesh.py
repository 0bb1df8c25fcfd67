"""The masonry as a closed mesh over a grid in plan, from the numeric surface alone: rougher, but it needs no B-Rep."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan
from families.declaration.plan_sides import Side
from families.declaration.vault import Vault
from families.solid.mesh import Mesh
from families.void.columns import heights

GRID_STEPS = 121  # of the grid, along either side of the plan
INSIDE = 1 - 1e-9  # of the plan: on its edge the walls begin
ONE_PLACE = 9  # decimals of a metre to which the ends of a ring agree

Array = NDArray[np.float64]


def relief(vault: Vault, thickness: float) -> Mesh:
    """The masonry between the intrados and an extrados with all radii larger by `thickness` [m], cut off at the plan.

    Steps in plan grow smaller towards the sides, where arches are steep; what is plumb leans by one of them.
    """
    plan, cells = _welded(_grid(vault.plan), _cells())
    lower, upper = (np.column_stack([plan, heights(vault, plan, more)]) for more in (0.0, thickness))
    count = len(plan)
    rim, after = _rim(cells).T
    sides = np.concatenate(
        [np.column_stack([rim, after + count, after]), np.column_stack([rim, rim + count, after + count])]
    )
    middles = lower[cells].mean(axis=1)
    shown = np.maximum(vault.evaluate(middles).component, 1)
    names = np.zeros(len(sides), np.uint16)
    above = np.full(len(cells), len(vault.components) + 1, np.uint16)
    return Mesh(
        np.concatenate([lower, upper]),
        np.concatenate([cells[:, ::-1], cells + count, sides[:, ::-1]]).astype(np.int32),
        np.concatenate([shown, above, names]).astype(np.uint16),
    )


def _grid(plan: Plan) -> Array:
    """Places (n, 2) of a grid laid over a plan, row by row."""
    u = INSIDE * np.sin(np.linspace(-np.pi / 2, np.pi / 2, GRID_STEPS))
    x, y = (axis.ravel()[:, None] for axis in np.meshgrid(u, u, indexing="ij"))
    if hubs := [side for side in plan.sides if not side.inside]:
        return _ring(plan, hubs[0], u)
    if len(plan.sides) == 4 and all(side.centre is None for side in plan.sides):
        a, b, c, d = plan.corners
        quad: Array = (
            (1 - x) * (1 - y) * a + (1 + x) * (1 - y) * b + (1 + x) * (1 + y) * c + (1 - x) * (1 + y) * d
        ) / 4
        return quad
    outline = plan.outline()
    middle = outline.mean(axis=0)
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1))])
    closed = np.vstack([outline, outline[:1]])
    reach = np.maximum(np.abs(x), np.abs(y))
    turn = np.mod(np.arctan2(y, x) / (2 * np.pi), 1.0) * lengths[-1]
    rim = np.column_stack([np.interp(turn.ravel(), lengths, closed[:, k]) for k in (0, 1)])
    found: Array = middle + reach * (rim - middle)
    return found


def _ring(plan: Plan, hub: Side, u: Array) -> Array:
    """A grid from the inner to the outer arc of a sector, at `u` from -1 to 1, in even steps of its angle."""
    rim = [side for side in plan.sides if side.centre is not None and side.inside]
    outer, (x, y) = rim[0].radius, rim[0].start
    assert hub.centre is not None
    middle = np.array(hub.centre)
    start = np.arctan2(y - middle[1], x - middle[0])
    sweep = sum(side.sweep for side in rim)
    angles = start + sweep * np.linspace(0, 1, GRID_STEPS)
    radii = (hub.radius + outer) / 2 + u * (outer - hub.radius) / 2
    r, angle = (axis.ravel()[:, None] for axis in np.meshgrid(radii, angles, indexing="ij"))
    found: Array = middle + r * np.hstack([np.cos(angle), np.sin(angle)])
    return found


def _welded(plan: Array, cells: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """Places (n, 2), each once, and the triangles of their indices."""
    _, first, where = np.unique(np.round(plan, ONE_PLACE), axis=0, return_index=True, return_inverse=True)
    return plan[first], where.ravel()[cells]


def _cells() -> NDArray[np.int64]:
    """Triangles of the grid, counterclockwise from above."""
    a = (np.arange(GRID_STEPS - 1)[:, None] * GRID_STEPS + np.arange(GRID_STEPS - 1)).ravel()
    b, c, d = a + GRID_STEPS, a + GRID_STEPS + 1, a + 1
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _rim(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Edges (n, 2) of the triangles that bound the grid, counterclockwise from above about it."""
    edges = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    count = int(cells.max()) + 1
    inner = np.isin(edges @ [count, 1], edges @ [1, count])
    return edges[~inner]

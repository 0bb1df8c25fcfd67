"""The masonry as a closed mesh over a grid in plan, from the numeric surface alone: rougher, but it needs no B-Rep."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan
from families.declaration.vault import Vault
from families.solid.mesh import Mesh

GRID_STEPS = 121  # of the grid, along either side of the plan
HALVINGS = 30  # of the height, in which a surface is looked for
INSIDE = 1 - 1e-9  # of the plan: on its edge the walls begin

Array = NDArray[np.float64]


def relief(vault: Vault, thickness: float) -> Mesh:
    """The masonry between the intrados and a surface `thickness` [m] farther into the stone, cut off at the plan.

    Steps in plan grow smaller towards the sides, where arches are steep; what is plumb leans by one of them.

    Raises:
        ValueError: the plan cannot be seen whole from its middle, as a ring.
    """
    plan = _grid(vault.plan)
    top = vault.derived_values()["rise"] + 2 * thickness + 1.0
    lower, upper = (np.column_stack([plan, _height(vault, plan, depth, top)]) for depth in (0.0, thickness))
    count, cells = len(plan), _cells()
    rim = _rim()
    after = np.roll(rim, -1)
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
    if any(not side.inside for side in plan.sides):
        raise ValueError("a plan with a hole cannot be covered by a grid about its middle")
    u = np.sin(np.linspace(-np.pi / 2, np.pi / 2, GRID_STEPS))
    x, y = (axis.ravel()[:, None] for axis in np.meshgrid(u, u, indexing="ij"))
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


def _height(vault: Vault, plan: Array, depth: float, top: float) -> Array:
    """Height (n,) [m] over places (n, 2) at which the stone is `depth` [m] deep, by halving from the springing up."""
    low, high = np.zeros(len(plan)), np.full(len(plan), top)
    for _ in range(HALVINGS):
        z = (low + high) / 2
        below = vault.distance(np.column_stack([plan * INSIDE, z])) < depth
        low, high = np.where(below, z, low), np.where(below, high, z)
    return low


def _cells() -> NDArray[np.int64]:
    """Triangles of the grid, counterclockwise from above."""
    a = (np.arange(GRID_STEPS - 1)[:, None] * GRID_STEPS + np.arange(GRID_STEPS - 1)).ravel()
    b, c, d = a + GRID_STEPS, a + GRID_STEPS + 1, a + 1
    return np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _rim() -> NDArray[np.int64]:
    """The grid's edge, counterclockwise from above."""
    grid = np.arange(GRID_STEPS * GRID_STEPS).reshape(GRID_STEPS, GRID_STEPS)
    return np.concatenate([grid[:-1, 0], grid[-1, :-1], grid[:0:-1, -1], grid[0, :0:-1]])

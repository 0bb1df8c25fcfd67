"""Vaults and arches seen from above, as lines for plans: outlines, projected groins, arrows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import tan

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.export.geometry import KEPT, shell
from vaultcad.model import Assembly, PlacedVault

Floats = NDArray[np.float64]

WELD = 3  # decimals of a metre to which lines over one another in plan are one
STRAIGHT = 0.005  # m by which a line's points may be left out
ARROW = 0.7  # of the clear width, along which an arrow runs
FLAT = 0.01  # rise / length, up to which a vault is level


@dataclass(frozen=True)
class Outline:
    """A closed row of corners (n, 2) [m]; what follows each is straight, or an arc with a bulge (n,), as CAD has it.

    A bulge is the tangent of a quarter of the arc's angle, positive counterclockwise.
    """

    corners: Floats
    bulges: tuple[float, ...]


@dataclass(frozen=True)
class PlanShape:
    """What a plan shows of a vault, in the scan's local frame [m].

    outlines: the rim, then that of a hole. rows: the same as points (n, 2), arcs in steps. groins: open or closed rows
    (n, 2) in which its components meet. arrows: rows (2, 2), with a head at the end, and at both ends where `both`.
    """

    outlines: tuple[Outline, ...]
    rows: tuple[Floats, ...]
    groins: tuple[Floats, ...]
    arrow: Floats | None
    both: bool

    @property
    def middle(self) -> Floats:
        """(2,) within the rim."""
        low, high = self.rows[0].min(axis=0), self.rows[0].max(axis=0)
        middle: Floats = (low + high) / 2
        return middle


def outline_rows(placed: PlacedVault) -> list[Floats]:
    """The rim of a plan, then that of a hole, as points (n, 2) in the scan's local frame [m], arcs in steps."""
    out = placed.pose.placement()[:2]
    return [row @ out[:, :2].T + out[:, 3] for row in placed.vault.plan.outlines()]


def plan_shape(model: Assembly, placed: PlacedVault) -> PlanShape:
    """Of a vault or an arch of a model."""
    vault, out = placed.vault, placed.pose.placement()[:2]

    def there(points: Sequence[Sequence[float]] | Floats) -> Floats:
        flat = np.asarray(points, dtype=np.float64)
        return flat @ out[:, :2].T + out[:, 3]

    outlines = tuple(
        Outline(
            there([side.start for side in loop]),
            tuple(0.0 if side.centre is None else tan(side.sweep / 4) for side in loop),
        )
        for loop in vault.plan.loops
    )
    lines = tuple(there(row) for row in groins(vault, model.thickness_of(placed)))
    arrow, both = _arrow(placed)
    return PlanShape(outlines, tuple(outline_rows(placed)), lines, None if arrow is None else there(arrow), both)


@lru_cache(maxsize=KEPT)
def groins(vault: Vault, thickness: float) -> tuple[Floats, ...]:
    """Rows (n, 2) in plan, in the vault's frame [m], in which two components meet, from one joint to the next."""
    mesh, count = shell(vault, thickness), len(vault.components)
    shown = (mesh.component > 0) & (mesh.component <= count)
    triangles, component = mesh.triangles[shown].astype(np.int64), mesh.component[shown].astype(np.int64)
    places, weld = np.unique(np.round(mesh.vertices[:, :2], WELD), axis=0, return_inverse=True)
    ends = np.sort(np.stack([triangles, np.roll(triangles, 1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges = ends @ [len(mesh.vertices), 1]
    owned = np.unique(edges * (count + 1) + np.repeat(component, 3))  # each edge once for each of its components
    edges, owners = np.unique(owned // (count + 1), return_counts=True)
    a, b = weld.ravel()[np.stack(np.divmod(edges[owners > 1], len(mesh.vertices)))]
    pairs = zip(np.minimum(a, b).tolist(), np.maximum(a, b).tolist(), strict=True)
    return tuple(simplified(places[row]) for row in _chained({(a, b) for a, b in pairs if a != b}))


def _chained(edges: set[tuple[int, int]]) -> list[list[int]]:
    """Edges as rows of vertices from one joint to the next; what has no joint, as a closed row."""
    around: dict[int, list[int]] = {}
    for a, b in sorted(edges):
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    joints = [k for k in sorted(around) if len(around[k]) != 2]
    rows = []
    for start in (*joints, *sorted(around)):
        while around[start]:
            row = [start]
            while True:
                here = row[-1]
                after = around[here].pop(0)
                around[after].remove(here)
                row.append(after)
                if after in joints or after == start or not around[after]:
                    break
            rows.append(row)
    return rows


def simplified(row: Floats) -> Floats:
    """A row (n, 2) without the points that are nearer than `STRAIGHT` to a line without them (Douglas and Peucker).

    >>> simplified(np.array([[0.0, 0.0], [1.0, 0.001], [2.0, 0.0], [2.0, 1.0]])).tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]
    """
    if len(row) < 3:
        return row
    a, b = row[0], row[-1]
    x, y = (b - a) / max(float(np.hypot(*(b - a))), 1e-12)
    off = np.abs((row - a) @ np.array([-y, x])) if (a != b).any() else np.hypot(*(row - a).T)
    k = int(off.argmax())
    if off[k] <= STRAIGHT:
        return np.stack([a, b])
    return np.concatenate([simplified(row[: k + 1])[:-1], simplified(row[k:])])


def _arrow(placed: PlacedVault) -> tuple[Floats | None, bool]:
    """Up a ramp; else across what stands on two walls alone, both ways."""
    vault = placed.vault
    plan, climb = vault.plan, 2 * vault.lift / max(2 * vault.plan.half_y, 1e-9)
    if climb > FLAT:
        up = 1.0 if vault.values().get("slope", 0.0) > 0 else -1.0
        return ARROW * np.array([[0.0, -up * plan.half_y], [0.0, up * plan.half_y]]), False
    if plan.on_wall_x and not plan.on_wall_y:
        return ARROW * np.array([[-plan.half_x, 0.0], [plan.half_x, 0.0]]), True
    if plan.on_wall_y and not plan.on_wall_x:
        return ARROW * np.array([[0.0, -plan.half_y], [0.0, plan.half_y]]), True
    return None, False

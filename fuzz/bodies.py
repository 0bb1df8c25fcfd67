"""What is room and what is stone, by the numeric surface alone: what bodies are measured against."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.pieces import Lid, Piece, Web
from families.declaration.plan import Plan
from families.declaration.vault import IDENTITY
from families.solid.mesh import mesh
from families.void import kernel
from families.void.columns import heights

Array = NDArray[np.float64]
Within = Callable[[Array], NDArray[np.bool_]]
FINE, FINER = 5e-4, 1e-4  # [m] between triangles and the surface; where the plan is round, on whose rim they are short
COARSE = 5e-3  # [m] likewise of webs, which end in straight lines of the plan, so that no triangle is on two of them
NARROW = 1e-3  # of half the width of a plan, no farther
GAUSS = (np.ones((3, 3)) + 3 * np.eye(3)) / 6  # barycentric coordinates of points that integrate degree 2 exactly
BOX = np.random.default_rng(0).uniform((-1, -1, 0), 1, (400_000, 3))


def inside(pieces: tuple[Piece, ...], plan: Plan | None, points: Array) -> NDArray[np.bool_]:
    """Whether points (n, 3) [m] are in a void above the springing; pieces with a foot stand free of the plan."""
    found = np.zeros(len(points), bool)
    for piece in pieces:
        names = {name for part in piece.parts if not isinstance(part, Lid) for name in part.names}
        names |= {part.below for part in piece.parts if getattr(part, "below", "")}
        table = kernel.pack((piece,), tuple(sorted(names)))
        here = kernel.distances(points, IDENTITY, table, kernel.pack_plan(None)) < 0
        if piece.foot is not None and plan is not None:
            here &= points[:, 2] > piece.foot
        elif plan is not None:
            here &= plan.holds(points[:, :2])
        found |= here
    return found & (points[:, 2] > 0)


def room_of(vault: Vault) -> Within:
    """The void of a vault."""
    return lambda points: inside(vault.pieces(), vault.plan, points)


def stone_of(vault: Vault, thickness: float) -> Within:
    """Its masonry."""
    pieces = vault.pieces()
    grown, plan = tuple(piece.grown(thickness) for piece in pieces), vault.plan.grown(thickness)
    return lambda points: inside(grown, plan, points) & ~inside(pieces, None, points)


def volume_of(vault: Vault, within: Within, thickness: float, points: Array = BOX) -> tuple[float, float]:
    """Volume [m³] by random points, and its standard deviation; domes stand beyond their square by the thickness."""
    top = max(part.top for piece in vault.pieces() for part in piece.grown(thickness).parts)
    size = np.array([*(vault.plan.half + 2 * thickness), top])
    share, whole = float(within(size * points).mean()), 4 * float(size.prod())
    return whole * share, whole * float(np.sqrt(max(share * (1 - share), 1e-5) / len(points)))


def integral_of(vault: Vault) -> tuple[float, float]:
    """Volume [m³] under the numeric surface, and the area [m²] over which it was summed: no more than the plan's.

    By Gauss over triangles of the B-Rep seen from above, so that none of them lies on both sides of a groin or of a
    step; only their places are the B-Rep's, the heights are not.
    """
    plan, fine = vault.plan, FINE
    if any(isinstance(part, Web) for piece in vault.pieces() for part in piece.parts):
        fine = COARSE
    if any(side.centre is not None for side in plan.sides):
        rim = sum(float(np.linalg.norm(row - np.roll(row, 1, axis=0), axis=1).sum()) for row in plan.outlines())
        fine = min(FINER, NARROW * plan.area / rim)
    shown = mesh(vault, fine)
    corners = shown.vertices[shown.triangles][:, ::-1, :2]  # they face the room
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    areas = (ax * by - ay * bx) / 2
    level = areas > 0
    places = np.einsum("pc,tcx->tpx", GAUSS, corners[level])
    z = heights(vault, places.reshape(-1, 2)).reshape(-1, 3)
    return float(areas[level] @ z.mean(axis=1)), float(areas.sum())

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
from families.void import body_table, kernel
from families.void.columns import heights

Array = NDArray[np.float64]
Within = Callable[[Array], NDArray[np.bool_]]
FINE = 1.5e-3  # [m] between triangles and the surface, and between their edges and a round rim: volumes to 3e-5
DRUM = 5e-4  # [m] likewise where edges cut corners off a step as high as a drum
COARSE = 5e-3  # [m] likewise of webs, which end in straight lines of the plan, so that no triangle is on two of them
FLAT_WEBS = 1e-3  # of their rise, no farther
NARROW = 2e-3  # of half the width of a plan with a round rim, no farther
AROUND = 4.0  # times that distance, above and below a triangle, within which the surface is looked for first
RIM = 1e-6  # [m] that the ends of edges may be off a round rim
WIDER = 2.0  # no splay is wider at its end than so many times the middle, and its stone thicker by as much
GAUSS = (np.ones((3, 3)) + 3 * np.eye(3)) / 6  # barycentric coordinates of points that integrate degree 2 exactly
BOX = np.random.default_rng(0).uniform((-1, -1, 0), 1, (400_000, 3))


def inside(pieces: tuple[Piece, ...], plan: Plan | None, points: Array) -> NDArray[np.bool_]:
    """Whether points (n, 3) [m] are in a void above the springing; pieces with a foot stand free of the plan."""
    found = np.zeros(len(points), bool)
    for piece in pieces:
        names = {name for part in piece.parts if not isinstance(part, Lid) for name in part.names}
        names |= {part.below for part in piece.parts if getattr(part, "below", "")}
        table = body_table.pack((piece,), tuple(sorted(names)))
        here = kernel.distances(points, IDENTITY, table, body_table.pack_plan(None)) < 0
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
    pieces = vault.pieces()
    grown = [(new.top, old.top) for p in pieces for new, old in zip(p.grown(thickness).parts, p.parts, strict=True)]
    top = vault.top + WIDER * max(new - old for new, old in grown)
    size = np.array([*(vault.plan.half + 2 * thickness), top])
    share, whole = float(within(size * points).mean()), 4 * float(size.prod())
    return whole * share, whole * float(np.sqrt(max(share * (1 - share), 1e-5) / len(points)))


def integral_of(vault: Vault) -> tuple[float, float]:
    """Volume [m³] under the numeric surface, and the area [m²] over which it was summed: no more than the plan's.

    By Gauss over triangles of the B-Rep seen from above, so that none of them lies on both sides of a groin or of a
    step; only their places are the B-Rep's, and where heights are looked for first, the heights are not. Where the plan
    is round, the segments between chords and rim are added.
    """
    plan, fine = vault.plan, DRUM if "drum" in vault.components else FINE
    if any(isinstance(part, Web) for piece in vault.pieces() for part in piece.parts):
        fine = min(COARSE, FLAT_WEBS * vault.top)
    rounds = {(side.centre, round(side.radius, 12), side.inside) for side in plan.sides if side.centre is not None}
    if rounds:
        rim = sum(float(np.linalg.norm(row - np.roll(row, 1, axis=0), axis=1).sum()) for row in plan.outlines())
        fine = min(fine, NARROW * plan.area / rim)
    shown = mesh(vault, fine)
    triangles = shown.triangles[:, ::-1]  # they face the room
    for (x, y), radius, _ in rounds:  # walls, upright but for how their chords lie
        off = np.abs(np.hypot(*(shown.vertices[:, :2] - (x, y)).T) - radius)
        triangles = triangles[off[triangles].max(axis=1) > RIM]
    corners = shown.vertices[triangles]
    (ax, ay, _), (bx, by, _) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    areas = (ax * by - ay * bx) / 2
    level = areas > 0
    places = np.einsum("pc,tcx->tpx", GAUSS, corners[level]).reshape(-1, 3)
    for (x, y), radius, within in rounds:  # chords about a hole lie in it
        if not within:
            places[:, :2] = np.add(_outside(places[:, :2] - (x, y), radius), (x, y))
    z = _heights(vault, places, AROUND * fine).reshape(-1, 3).mean(axis=1)
    size, over = float(areas[level] @ z), float(areas.sum())
    edges = shown.vertices[_rim(triangles[level]), :2]
    for (x, y), radius, within in rounds:
        middles, segments = _segments(edges - (x, y), radius)
        sign = 1 if within else -1
        middles = np.add(middles if within else _outside(middles, radius), (x, y))
        size += sign * float(segments @ heights(vault, middles))
        over += sign * float(segments.sum())
    return size, over


def _heights(vault: Vault, guesses: Array, reach: float) -> Array:
    """Heights (n,) [m] at which columns through points (n, 3) leave the room: by a secant within `reach` [m] of them.

    By halving where the column does not leave the room there: where it is steep, or the guess is wrong.
    """
    low, high = guesses.copy(), guesses.copy()
    low[:, 2], high[:, 2] = np.maximum(guesses[:, 2] - reach, 0.0), guesses[:, 2] + reach
    before, after = vault.distance(low), vault.distance(high)
    leaves = (before < 0) & (after >= 0)
    share = np.divide(before, before - after, out=np.zeros_like(before), where=leaves)
    z: Array = low[:, 2] + share * (high[:, 2] - low[:, 2])
    z[~leaves] = heights(vault, guesses[~leaves, :2])
    return z


def _rim(triangles: NDArray[np.int32]) -> NDArray[np.int64]:
    """Edges (n, 2) of triangles (m, 3) that no other triangle has."""
    edges = np.concatenate([triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]).astype(np.int64)
    size = int(edges.max()) + 1
    return edges[~np.isin(edges @ [size, 1], edges @ [1, size])]


def _outside(places: Array, radius: float) -> Array:
    """Places (n, 2), those within a circle about the origin moved to where it has just been left."""
    moved: Array = places * np.maximum(1.0, (radius + RIM) / np.hypot(*places.T))[:, None]
    return moved


def _segments(edges: Array, radius: float) -> tuple[Array, Array]:
    """Between chords of a circle about the origin, among edges (m, 2, 2), and its arcs: middles (n, 2), areas (n,)."""
    middle = edges.mean(axis=1)
    size = np.hypot(*middle.T)
    chords = (np.abs(np.hypot(edges[..., 0], edges[..., 1]) - radius).max(axis=1) < RIM) & (radius - size < 2 * FINE)
    middle, size = middle[chords], size[chords]
    half = np.arccos(np.minimum(size / radius, 1.0))
    centroid = size + 0.4 * (radius - size)
    return (centroid / size)[:, None] * middle, radius**2 * (half - np.sin(half) * np.cos(half))

"""A vault on its walls, or on piers, as triangles: what a scanner in the room can see of the building.

All in the vault's frame: the springing at z = 0, the floor at -wall_height. The scanner stands inside, so that bodies
may run on into the stone: the vault hides what is behind it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.errors import VaultcadError
from vaultcad.scanner.furnish import furnish
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.triangles import Triangles, box, join, plain, rectangle, split

Array = NDArray[np.float64]

TOLERANCE = 0.0006  # of the vault's mesh [m], as little as the noise of a good scanner
LONGEST_EDGE = 0.15  # edge [m], so that a mesh that is bent by the settlement stays about as smooth
EXACT_VERTEX = 1e-5  # what the vertices of the mesh may be off [m]
GAP = 0.0005  # of the walls behind the plan [m]: where a stilted vault runs up along a wall, the vault shows
VAULT, WALL, FLOOR, DOOR = 0.65, 0.6, 0.3, 0.25  # reflectance
REVEAL = 0.35  # depth of the jambs of doors and windows [m]
ARCH_DEPTH, ARCH_DROP = 0.45, 0.12  # transverse arches between piers: their width, and how far they hang below [m]
BEYOND = 3.0  # what is seen of the neighbouring bays [m]
MARGIN = 0.2  # masonry left around an opening [m]


@dataclass(frozen=True)
class Opening:
    """Door or window in a wall: along the wall from s0 to s1, from z0 to z1 [m]."""

    s0: float
    s1: float
    z0: float
    z1: float
    closed: bool  # by a leaf; else rays go out and never return


def build(vault: Vault, settings: ScannerSettings, stations: Array, rng: np.random.Generator) -> Triangles:
    """The room before it settles; occluders keep clear of the scanner positions `stations` (k, 3) [m].

    Raises:
        ValueError: piers are asked for under a vault that stands on its walls.
        VaultcadError: the vault could not be meshed.
    """
    intrados = vault_triangles(vault)
    piers = settings.walls == "piers"
    shell = _on_piers(vault, settings, intrados) if piers else _on_walls(vault, settings, intrados, rng)
    return join([intrados, split(join(shell), LONGEST_EDGE), *furnish(vault, settings, stations, rng)])


def vault_triangles(vault: Vault) -> Triangles:
    """The intrados with its components, meshed finely enough to be bent.

    Raises:
        VaultcadError: the mesh of the B-Rep has a gap or leaves the numeric surface, so that labels would be wrong.
    """
    from families.solid.mesh import mesh

    ideal = mesh(vault, TOLERANCE)
    off = float(np.abs(vault.distance(ideal.vertices)).max())
    rim = ideal.vertices[_rim(ideal.triangles)].reshape(-1, 3)
    in_wall = (np.abs(np.abs(rim[:, :2]) - (vault.plan.half_x, vault.plan.half_y)) < EXACT_VERTEX).any(1)
    gap = not (in_wall | (np.abs(rim[:, 2]) < EXACT_VERTEX)).all()
    if off > EXACT_VERTEX or gap:
        fault = "has a gap" if gap else f"leaves its numeric surface by {off:.4f} m"
        raise VaultcadError(f"the mesh of {vault} {fault}; change a size a little")
    bright = np.full(len(ideal.triangles), VAULT, np.float32)
    return split(Triangles(ideal.vertices, ideal.triangles.astype(np.int64), ideal.component, bright), LONGEST_EDGE)


def _rim(triangles: NDArray[np.integer]) -> NDArray[np.integer]:
    """Edges (n, 2) that only one triangle has."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), 1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    rim: NDArray[np.integer] = edges[count == 1]
    return rim


def _on_walls(
    vault: Vault, settings: ScannerSettings, intrados: Triangles, rng: np.random.Generator
) -> list[Triangles]:
    half = np.array([vault.plan.half_x, vault.plan.half_y]) + GAP
    openings = _draw_openings(vault, settings, rng)
    floor = -settings.wall_height
    top = _top(intrados) + 0.3
    parts = [rectangle([-half[0], -half[1], floor], [2 * half[0], 0, 0], [0, 2 * half[1], 0], FLOOR)]
    for (axis, sign), holes in openings.items():
        parts += _wall(axis, sign, half, (floor, top), holes)
    return parts


def _wall(
    axis: int, sign: int, half: Array, levels: tuple[float, float], openings: list[Opening]
) -> Iterator[Triangles]:
    """The wall at `sign * half[axis]`, cut up along the edges of its openings, with their jambs and leaves."""
    length = half[1 - axis]

    def panel(s: tuple[float, float], z: tuple[float, float], depth: tuple[float, float], bright: float) -> Triangles:
        """Rectangle between two corners given along the wall, in height and in depth behind the wall's face."""
        corners = np.zeros((2, 3))
        corners[:, 1 - axis], corners[:, axis], corners[:, 2] = s, sign * (half[axis] + np.array(depth)), z
        edges = [np.eye(3)[k] * (corners[1, k] - corners[0, k]) for k in range(3) if corners[0, k] != corners[1, k]]
        return rectangle(corners[0], edges[0], edges[1], bright)

    cuts_s = sorted({-length, length, *(v for o in openings for v in (o.s0, o.s1))})
    cuts_z = sorted({*levels, *(v for o in openings for v in (o.z0, o.z1))})
    for s in pairwise(cuts_s):
        for z in pairwise(cuts_z):
            if not any(o.s0 <= s[0] < o.s1 and o.z0 <= z[0] < o.z1 for o in openings):
                yield panel(s, z, (0, 0), WALL)
    for o in openings:
        for end in (o.s0, o.s1):
            yield panel((end, end), (o.z0, o.z1), (0, REVEAL), WALL)
        for level in (o.z0, o.z1):
            yield panel((o.s0, o.s1), (level, level), (0, REVEAL), WALL)
        if o.closed:
            yield panel((o.s0, o.s1), (o.z0, o.z1), (0.8 * REVEAL, 0.8 * REVEAL), DOOR)


def _draw_openings(
    vault: Vault, settings: ScannerSettings, rng: np.random.Generator
) -> dict[tuple[int, int], list[Opening]]:
    """Doors and windows by wall (axis, sign); those that would cut into the vault or into each other are left out."""
    walls: dict[tuple[int, int], list[Opening]] = {(axis, sign): [] for axis in (0, 1) for sign in (-1, 1)}
    half = (vault.plan.half_x, vault.plan.half_y)
    for k in range(settings.openings):
        axis, sign = int(rng.integers(2)), int(rng.choice([-1, 1]))
        length = half[1 - axis]
        door = k % 2 == 0
        width = rng.uniform(0.8, 1.2)
        height = rng.uniform(2.0, 2.3) if door else rng.uniform(0.7, 1.5)
        sill = -settings.wall_height + (0.0 if door else rng.uniform(0.9, settings.wall_height + 0.8))
        middle = rng.uniform(-1, 1) * max(0.0, length - width / 2 - MARGIN)
        new = Opening(middle - width / 2, middle + width / 2, sill, sill + height, closed=door)
        clear = all(
            new.s1 + MARGIN < o.s0 or o.s1 + MARGIN < new.s0 or new.z1 + MARGIN < o.z0 or o.z1 + MARGIN < new.z0
            for o in walls[axis, sign]
        )
        if clear and width / 2 + MARGIN < length and _in_wall(vault, axis, sign, new):
            walls[axis, sign].append(new)
    return walls


def _in_wall(vault: Vault, axis: int, sign: int, opening: Opening) -> bool:
    """Whether an opening lies in bare wall: below the springing, or under a wall arch."""
    if opening.z1 < -MARGIN:
        return True
    s = np.array([opening.s0, opening.s1, opening.s0, opening.s1, (opening.s0 + opening.s1) / 2])
    z = np.array([opening.z0, opening.z0, opening.z1, opening.z1, opening.z1])
    points = np.zeros((5, 3))
    points[:, axis] = sign * (vault.plan.half_x, vault.plan.half_y)[axis]
    points[:, 1 - axis], points[:, 2] = s, np.maximum(z, 0.01)
    return bool((vault.distance(points) < -MARGIN).all())


def _on_piers(vault: Vault, settings: ScannerSettings, intrados: Triangles) -> list[Triangles]:
    plan = vault.plan
    if plan.on_wall_x or plan.on_wall_y:
        raise ValueError(f"walls = 'piers': a {vault.title} stands on its walls; take walls = 'walls'")
    floor = -settings.wall_height
    inner = np.array([plan.half_x, plan.half_y]) - ARCH_DROP
    outer = inner + ARCH_DROP + ARCH_DEPTH
    far = np.append(outer + BEYOND, _top(intrados) + 1)
    parts = [rectangle([-far[0], -far[1], floor], [2 * far[0], 0, 0], [0, 2 * far[1], 0], FLOOR)]
    for sx in (-1, 1):
        for sy in (-1, 1):
            ends = np.sort([[sx * inner[0], sy * inner[1]], [sx * outer[0], sy * outer[1]]], axis=0)
            parts.append(box([*ends[0], floor], [*ends[1], 0.0], WALL))
    for axis in (0, 1):
        along = np.eye(3)[1 - axis] * 2 * far[1 - axis]
        for sign in (-1, 1):
            corner = np.array([-far[0], -far[1], floor])
            corner[axis] = sign * far[axis]
            parts += [
                rectangle(corner, along, [0, 0, far[2] - floor], WALL),
                _transverse_arch(intrados, axis, sign, (plan.half_x, plan.half_y)),
            ]
    return parts


def _top(mesh: Triangles) -> float:
    return float(mesh.vertices[:, 2].max())


def _transverse_arch(intrados: Triangles, axis: int, sign: int, half: tuple[float, float]) -> Triangles:
    """Front and soffit of the arch between two bays: the vault's edge there, dropped, and drawn out of the plan."""
    xyz, rim = intrados.vertices, _rim(intrados.triangles)
    in_wall = np.abs(xyz[:, axis] - sign * half[axis]) < EXACT_VERTEX
    edges = rim[in_wall[rim].all(1)]
    edge = xyz[edges.reshape(-1)]
    dropped = edge * np.array([1, 1, 1 - ARCH_DROP / half[1 - axis]])
    dropped[:, 1 - axis] *= 1 - ARCH_DROP / half[1 - axis]
    outside = dropped.copy()
    outside[:, axis] += sign * ARCH_DEPTH
    n = len(edge)
    a, b = np.arange(0, n, 2), np.arange(1, n, 2)
    strips = [np.column_stack(t) + s for s in (0, n) for t in ((a, b, b + n), (a, b + n, a + n))]
    return plain(np.concatenate([edge, dropped, outside]), np.concatenate(strips), WALL)

"""A vault on its walls, or on piers, as triangles: what a scanner in the room can see of the building.

All in the vault's frame: the springing at z = 0, the floor at -wall_height. The scanner stands inside, so that bodies
may run on into the stone: the vault hides what is behind it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.errors import VaultcadError
from vaultcad.scanner.furnish import furnish
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.triangles import Triangles, box, join, plain, rectangle, split
from vaultcad.scanner.walls import WALL, draw_openings, walls_of

Array = NDArray[np.float64]

TOLERANCE = 0.0006  # of the vault's mesh [m], as little as the noise of a good scanner
LONGEST_EDGE = 0.15  # edge [m], so that a mesh that is bent by the settlement stays about as smooth
EXACT_VERTEX = 1e-5  # what the vertices of the mesh may be off [m]
GAP = 0.0005  # of the walls behind the plan [m]: where a stilted vault runs up along a wall, the vault shows
VAULT, RIB, FLOOR = 0.65, 0.5, 0.3  # reflectance
ARCH_DEPTH, ARCH_DROP = 0.45, 0.12  # transverse arches between piers: their width, and how far they hang below [m]
BEYOND = 3.0  # what is seen of the neighbouring bays [m]


def build(vault: Vault, settings: ScannerSettings, stations: Array, rng: np.random.Generator) -> Triangles:
    """The room before it settles; occluders keep clear of the scanner positions `stations` (k, 3) [m].

    Raises:
        ValueError: piers are asked for under a vault that stands on its walls.
        VaultcadError: the vault could not be meshed, or no such ribs can hang under it.
    """
    intrados = vault_triangles(vault)
    piers = settings.walls == "piers"
    shell = _on_piers(vault, settings, intrados) if piers else _on_walls(vault, settings, intrados, rng)
    ribs = [split(part, LONGEST_EDGE) for part in _ribs(vault, settings)]
    return join([intrados, *ribs, split(join(shell), LONGEST_EDGE), *furnish(vault, settings, stations, rng)])


def _ribs(vault: Vault, settings: ScannerSettings) -> Iterator[Triangles]:
    """Its ribs, each with a number of its own in place of a component: those after the vault's.

    Raises:
        VaultcadError: no such ribs can hang under it.
    """
    from families.solid.mesh import mesh_shape
    from families.solid.ribs import rib_bodies

    if settings.ribs is None:
        return
    try:
        bodies = rib_bodies(vault, settings.ribs)
    except ValueError as error:
        raise VaultcadError(f"rib_width = {settings.rib_width:g}: {error}") from error
    for number, body in enumerate(bodies, 1 + len(vault.components)):
        mesh = mesh_shape(body.shape, TOLERANCE)
        shown = np.full(len(mesh.triangles), number, np.uint16)
        bright = np.full(len(mesh.triangles), RIB, np.float32)
        yield Triangles(mesh.vertices, mesh.triangles.astype(np.int64), shown, bright)


def vault_triangles(vault: Vault) -> Triangles:
    """The intrados with its components, meshed finely enough to be bent.

    Raises:
        VaultcadError: as `vault_mesh` does.
    """
    return split(vault_mesh(vault), LONGEST_EDGE)


def vault_mesh(vault: Vault) -> Triangles:
    """The intrados with its components.

    Raises:
        VaultcadError: the mesh of the B-Rep has a gap or leaves the numeric surface, so that labels would be wrong.
    """
    from families.solid.mesh import mesh

    try:
        ideal = mesh(vault, TOLERANCE)
    except ValueError as error:
        raise VaultcadError(f"{vault} could not be meshed: {error}") from error
    off = float(np.abs(vault.distance(ideal.vertices)).max())
    rim = ideal.vertices[_rim(ideal.triangles)].reshape(-1, 3)
    in_wall = np.abs(vault.plan.distance(rim[:, :2])) < EXACT_VERTEX
    gap = not (in_wall | (np.abs(rim[:, 2]) < EXACT_VERTEX)).all()
    if off > EXACT_VERTEX or gap:
        fault = "has a gap" if gap else f"leaves its numeric surface by {off:.4f} m"
        raise VaultcadError(f"the mesh of {vault} {fault}; change a size a little")
    bright = np.full(len(ideal.triangles), VAULT, np.float32)
    return Triangles(ideal.vertices, ideal.triangles.astype(np.int64), ideal.component, bright)


def _rim(triangles: NDArray[np.integer]) -> NDArray[np.integer]:
    """Edges (n, 2) that only one triangle has."""
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), 1)
    size = int(ends.max()) + 1
    edges, count = np.unique(ends.astype(np.int64) @ [size, 1], return_counts=True)
    return np.stack(np.divmod(edges[count == 1], size), axis=1)


def _on_walls(
    vault: Vault, settings: ScannerSettings, intrados: Triangles, rng: np.random.Generator
) -> list[Triangles]:
    half, floor = vault.plan.half + GAP, -settings.wall_height
    openings = draw_openings(vault, settings, rng).values()
    walls = (wall for pair in walls_of(vault.plan, GAP) for wall in pair)
    parts = [rectangle([-half[0], -half[1], floor], [2 * half[0], 0, 0], [0, 2 * half[1], 0], FLOOR)]
    for wall, holes in zip(walls, openings, strict=True):
        parts += wall.built((floor, _top(intrados) + 0.3), holes)
    return parts


def _on_piers(vault: Vault, settings: ScannerSettings, intrados: Triangles) -> list[Triangles]:
    plan = vault.plan
    if plan.on_wall_x or plan.on_wall_y:
        raise ValueError(f"walls = 'piers': {vault.called} stands on its walls; take walls = 'walls'")
    if len(plan.sides) != 4:
        raise ValueError(f"walls = 'piers': {vault.called} has no four corners for them; take walls = 'walls'")
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

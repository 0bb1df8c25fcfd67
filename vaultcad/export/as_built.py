"""Bodies of a vault as exporters draw them: the ideal ones of geometry.py, or those displaced to where the stone is.

What is displaced is closed as what it was made of: bodies are moved vertex by vertex, edge by edge, face by face.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.solid.mesh import Mesh
from vaultcad.displacement import Displacement
from vaultcad.errors import ExportError
from vaultcad.export.component_bodies import Body
from vaultcad.export.geometry import KEPT, bodies, masonry, shell
from vaultcad.export.mesh_borders import Floats
from vaultcad.model import Assembly, PlacedVault

GRAIN = 0.5  # [m], longest side of a displaced triangle, which is then within about 1 mm of a settlement of 3 cm

AS_BUILT = "as built"


def solid_of(vault: Vault, thickness: float, surface: Displacement | None) -> Any:
    """The masonry (TopoDS_Shape) in the vault's frame [mm], displaced by `surface`.

    Raises:
        ValueError: OpenCASCADE cannot build it, or the displacement may fold it.
    """
    return masonry(vault, thickness) if surface is None else _solid(vault, thickness, surface)


def shell_of(vault: Vault, thickness: float, surface: Displacement | None) -> Mesh:
    """The masonry as one closed mesh, displaced by `surface`."""
    return shell(vault, thickness) if surface is None else _shell(vault, thickness, surface)


def bodies_of(vault: Vault, thickness: float, surface: Displacement | None) -> tuple[Body, ...]:
    """One body for each component of which something shows, displaced by `surface`.

    Raises:
        ExportError: the mesh of the masonry is not closed.
    """
    return bodies(vault, thickness) if surface is None else _bodies(vault, thickness, surface)


def names_of(model: Assembly, placed: PlacedVault) -> list[tuple[str, Displacement | None]]:
    """The bodies to be drawn of a vault: what is added to their names, and what they are displaced by."""
    return [("" if surface is None else AS_BUILT, surface) for surface in model.surfaces(placed)]


@lru_cache(maxsize=KEPT)
def _solid(vault: Vault, thickness: float, surface: Displacement) -> Any:
    from families.solid.displaced import displaced

    surface.check()
    return displaced(masonry(vault, thickness), surface)


@lru_cache(maxsize=KEPT)
def _shell(vault: Vault, thickness: float, surface: Displacement) -> Mesh:
    ideal = shell(vault, thickness)
    vertices, triangles, source = _refined(ideal.vertices, ideal.triangles)
    return Mesh(surface.moved(vertices), triangles, ideal.component[source])


@lru_cache(maxsize=KEPT)
def _bodies(vault: Vault, thickness: float, surface: Displacement) -> tuple[Body, ...]:
    whole = _shell(vault, thickness, surface)
    areas = np.bincount(whole.component, whole.areas, len(vault.components) + 2)
    found = []
    for body in bodies(vault, thickness):
        vertices, triangles, _ = _refined(body.vertices, body.triangles)
        found.append(Body(body.id, body.name, surface.moved(vertices), triangles, float(areas[body.id])))
    return tuple(found)


def _refined(vertices: Floats, triangles: NDArray[np.integer]) -> tuple[Floats, NDArray[np.int32], NDArray[np.integer]]:
    """A closed mesh with no side longer than `GRAIN`: vertices, triangles, and of which each of these is a part.

    Raises:
        ExportError: it is not closed.
    """
    import manifold3d

    mesh = manifold3d.Mesh64(
        np.array(vertices, np.float64, order="C"),  # it takes no array that is read-only
        np.array(triangles, np.uint64, order="C"),
        face_id=np.arange(len(triangles), dtype=np.uint64),
    )
    made = manifold3d.Manifold(mesh)
    if made.status() != manifold3d.Error.NoError:
        raise ExportError(f"the masonry's mesh is not closed ({made.status().name}); try another --thickness")
    fine = made.refine_to_length(GRAIN).to_mesh64()
    return (
        np.array(fine.vert_properties)[:, :3],
        np.array(fine.tri_verts).astype(np.int32),
        np.array(fine.face_id).astype(np.int64),
    )

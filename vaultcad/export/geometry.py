"""Solids and meshes of a vault, each made once and shared by all exporters."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from families import Ribs, Vault
from families.solid.grid_mesh import relief
from families.solid.mesh import Mesh, mesh_shape, mesh_solid
from vaultcad.export.component_bodies import Body, cut
from vaultcad.export.mesh_borders import closed

TOLERANCE = 0.003  # [m] between triangles and the exact surface, below what scanners can tell
KEPT = 256  # vaults and arches whose meshes are remembered, as all exporters draw those of a whole building


@lru_cache(maxsize=KEPT)
def masonry(vault: Vault, thickness: float) -> Any:
    """The exact masonry (TopoDS_Shape) in the vault's frame [mm]."""
    from families.solid import brep

    return brep.masonry(vault, thickness)


@lru_cache(maxsize=KEPT)
def rib_solids(vault: Vault, ribs: Ribs) -> Mapping[str, Any]:
    """The exact bodies (TopoDS_Shape) of ribs and bosses in the vault's frame [mm], by their names.

    Raises:
        ValueError: no such ribs can hang under it.
    """
    from families.solid.ribs import rib_bodies

    return {one.rib.name: one.shape for one in rib_bodies(vault, ribs)}


@lru_cache(maxsize=KEPT)
def rib_bodies(vault: Vault, ribs: Ribs) -> tuple[Body, ...]:
    """The same as closed meshes.

    Raises:
        ValueError: likewise, or a mesh has a hole.
    """
    meshes = {name: closed(mesh_shape(shape, TOLERANCE)) for name, shape in rib_solids(vault, ribs).items()}
    return tuple(Body(0, name, mesh.vertices, mesh.triangles, 0.0) for name, mesh in meshes.items())


@lru_cache(maxsize=KEPT)
def exact(vault: Vault, thickness: float) -> Mesh:
    """The masonry as one closed mesh, as `families.solid.mesh.mesh_solid` makes it.

    Raises:
        ValueError: OpenCASCADE cannot build it, or it has a hole.
    """
    return closed(mesh_solid(vault, thickness, TOLERANCE, masonry(vault, thickness)))


@lru_cache(maxsize=KEPT)
def shell(vault: Vault, thickness: float) -> Mesh:
    """The masonry as one closed mesh, from the numeric surface where no B-Rep can be built."""
    try:
        return exact(vault, thickness)
    except ValueError:
        return relief(vault, thickness)


@lru_cache(maxsize=KEPT)
def bodies(vault: Vault, thickness: float) -> tuple[Body, ...]:
    """One body for each component of which something shows, in the order of the components.

    Raises:
        ExportError: the mesh of the masonry is not closed.
    """
    try:
        return cut(vault, exact(vault, thickness))
    except ValueError:
        return cut(vault, relief(vault, thickness))

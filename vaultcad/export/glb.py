"""GLB (binary glTF 2): a named, coloured node a component, one for the rest; metres from the origin in its extras."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from families.solid.mesh import Mesh
from vaultcad.displacement import Displacement
from vaultcad.export.as_built import names_of, shell_of
from vaultcad.export.geometry import rib_bodies
from vaultcad.export.mesh_borders import Floats, Triangles
from vaultcad.export.palette import Colour, colour
from vaultcad.model import Assembly, PlacedVault

if TYPE_CHECKING:
    import trimesh

# glTF is y up: x stays, the model's z becomes y, its y becomes -z.
Y_UP = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=np.float64)


def write_glb(model: Assembly, path: Path) -> None:
    """Write vaults and arches; where there are several, nodes begin with their number and label.

    Those of the stone as it stands have "as built/" before their component.
    """
    import trimesh

    scene = trimesh.Scene()
    several = len(model.vaults) > 1
    named = [
        (f"{k} {placed.label}".rstrip() + "/" if several else "", placed) for k, placed in enumerate(model.vaults, 1)
    ]
    named += [(f"arch {k} {arch.label}".rstrip() + "/", arch) for k, arch in enumerate(model.arches, 1)]
    for prefix, placed in named:
        for more, surface in names_of(model, placed):
            within = f"{prefix}{more}/" if more else prefix
            for name, part in _parts(placed, model.thickness_of(placed), surface):
                scene.add_geometry(part, node_name=within + name, geom_name=within + name)
        for rib in rib_bodies(placed.vault, placed.ribs) if placed.ribs else ():
            part = _sharp(rib.vertices, rib.triangles, Y_UP @ placed.pose.placement())
            scene.add_geometry(part, node_name=prefix + rib.name, geom_name=prefix + rib.name)
    scene.metadata["origin"] = model.origin.tolist()  # becomes the extras of the scene
    scene.metadata["crs"] = None if model.crs is None else model.crs.title
    path.write_bytes(scene.export(file_type="glb", include_normals=True))


def _parts(
    placed: PlacedVault, thickness: float, surface: Displacement | None
) -> Iterator[tuple[str, trimesh.Trimesh]]:
    """Intrados by component, with smooth normals; then the rest of the stone, with those of its triangles."""
    mesh, names = shell_of(placed.vault, thickness, surface), placed.vault.components
    place = Y_UP @ placed.pose.placement()
    for k, name in enumerate(names, 1):
        patch = mesh.component == k
        if patch.any():
            yield name, _trimesh(mesh, mesh.triangles[patch], place, colour(k), {"component": k})
    rest = mesh.triangles[(mesh.component == 0) | (mesh.component > len(names))]
    yield "extrados", _sharp(mesh.vertices, rest, place)


def _sharp(vertices: Floats, triangles: Triangles, place: Floats) -> trimesh.Trimesh:
    """Stone with sharp edges: every triangle has its own corners."""
    corners = vertices[triangles].reshape(-1, 3)
    own = np.arange(len(corners), dtype=np.int32).reshape(-1, 3)
    return _trimesh(Mesh(corners, own, np.empty(0, np.uint16)), own, place, colour(0), {})


def _trimesh(
    mesh: Mesh, triangles: Triangles, place: Floats, colour: Colour, extras: dict[str, Any]
) -> trimesh.Trimesh:
    import trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    used, where = np.unique(triangles, return_inverse=True)
    corners = where.reshape(-1, 3).astype(np.int32)
    points = mesh.vertices[used] @ place[:3, :3].T + place[:3, 3]
    material = PBRMaterial(
        name=colour.hex, baseColorFactor=linear(colour), metallicFactor=0.0, roughnessFactor=0.9, doubleSided=True
    )
    return trimesh.Trimesh(
        points,
        corners,
        vertex_normals=vertex_normals(points, corners),
        visual=TextureVisuals(material=material),
        metadata=extras,
        process=False,
    )


def vertex_normals(points: Floats, corners: Triangles) -> Floats:
    """Unit normals (n, 3) of vertices: the mean of their triangles', weighted by area."""
    a, b, c = (points[corners[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    total = np.zeros_like(points)
    for k in range(3):
        np.add.at(total, corners[:, k], across)
    normals: Floats = total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)
    return normals


def linear(colour: Colour) -> list[int]:
    """The colour as glTF wants it, linear, with full opacity (IEC 61966-2-1)."""
    s = np.array(colour.unit)
    linear = np.where(s <= 0.04045, s / 12.92, ((s + 0.055) / 1.055) ** 2.4)
    return [*(round(255 * float(v)) for v in linear), 255]

"""The nets of the free route as meshes: OBJ of quadrangles with texture coordinates, GLB of triangles with the same."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from vaultcad.export.glb import Y_UP, linear, vertex_normals
from vaultcad.export.palette import Colour, colour
from vaultcad.nurbs.net import QuadNet
from vaultcad.nurbs.route import FreeRoute, FreeVault


def named_nets(route: FreeRoute) -> Iterator[tuple[str, FreeVault, QuadNet, Colour]]:
    """Every net by the name of its component, with its vault's number where there are several; and its colour.

    A component that is creased has several nets, numbered.
    """
    for vault in route.vaults:
        regions = vault.form.outline.regions
        names = [region.name for region in regions]
        for net in vault.nets:
            region = regions[net.region]
            of = names[: net.region].count(region.name) + 1
            name = region.name if names.count(region.name) == 1 else f"{region.name} {of}"
            prefix = f"{vault.number}/" if len(route.model.vaults) > 1 else ""
            yield prefix + name, vault, net, colour(region.component)


def write_nurbs_obj(route: FreeRoute, path: Path) -> None:
    """Write one group a net, metres from the model's origin, z up, vt from 0 to 1 along columns and rows."""
    lines = [f"# vaultcad: free surfaces of {route.model.scan.name}; m, z up, relative to {route.model.place}"]
    start = 1
    for name, vault, net, _ in named_nets(route):
        place = vault.fitted.pose.placement()
        points = net.points.reshape(-1, 3) @ place[:3, :3].T + place[:3, 3]
        lines.append(f"g {name.replace(' ', '_')}")
        lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in (points + 0.0).tolist()]
        lines += [f"vt {u:.6f} {v:.6f}" for u, v in net.uv.reshape(-1, 2).tolist()]
        for quad in (net.quads + start).tolist():
            corners = quad if quad[2] != quad[3] else quad[:3]
            lines.append("f " + " ".join(f"{k}/{k}" for k in corners))
        start += len(points)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def write_nurbs_glb(route: FreeRoute, path: Path) -> None:
    """Write a named, coloured node a net with TEXCOORD_0."""
    import trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    scene = trimesh.Scene()
    for name, vault, net, shade in named_nets(route):
        place = Y_UP @ vault.fitted.pose.placement()
        points = net.points.reshape(-1, 3) @ place[:3, :3].T + place[:3, 3]
        triangles = net.triangles.astype(np.int32)
        material = PBRMaterial(
            name=shade.hex, baseColorFactor=linear(shade), metallicFactor=0.0, roughnessFactor=0.9, doubleSided=True
        )
        part = trimesh.Trimesh(
            points,
            triangles,
            vertex_normals=vertex_normals(points, triangles),
            visual=TextureVisuals(uv=net.uv.reshape(-1, 2), material=material),
            metadata={"component": vault.form.outline.regions[net.region].component},
            process=False,
        )
        scene.add_geometry(part, node_name=name, geom_name=name)
    scene.metadata["origin"] = route.model.origin.tolist()
    scene.metadata["crs"] = None if route.model.crs is None else route.model.crs.title
    path.write_bytes(scene.export(file_type="glb", include_normals=True))

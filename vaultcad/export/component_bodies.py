"""A vault's masonry in one body for each component.

A component's body is its share of the masonry: the closed mesh of the whole is cut along joints that rise plumb from
the edges between components on the intrados (level joints between dome, drum and pendentives). Bodies therefore fill
the whole without gap or overlap, whatever the family.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.pieces import BarrelPart, Lid, Turned
from families.solid.mesh import Mesh
from vaultcad.errors import ExportError
from vaultcad.export.mesh_borders import ON_EDGE, area, loops

BEYOND = 10.0  # [m] by which the prisms that cut reach past the masonry
NO_VOLUME = 1e-7  # m³; a cube of 5 mm

Floats = NDArray[np.float64]
Triangles = NDArray[np.int32]


@dataclass(frozen=True)
class Body:
    """A component's share of the masonry in the vault's frame: a closed mesh, triangles (m, 3) turned outwards.

    `id` is the component's label, `vertices` are (n, 3) [m], `intrados_area` [m²] is what the room sees of it.
    """

    id: int
    name: str
    vertices: Floats
    triangles: Triangles
    intrados_area: float

    @property
    def volume(self) -> float:
        """Enclosed volume [m³]."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def cut(vault: Vault, mesh: Mesh) -> tuple[Body, ...]:
    """The masonry in one body for each component of which something shows.

    Raises:
        ExportError: the mesh is not closed.
    """
    areas = np.bincount(mesh.component, mesh.areas, len(vault.components) + 2)
    names = {k: name for k, name in enumerate(vault.components, 1) if areas[k] > 0}
    if len(names) == 1:
        (k,) = names
        return (Body(k, names[k], mesh.vertices, mesh.triangles, float(areas[k])),)
    parts = (
        _tiered(vault, mesh, areas)
        if _tiers(vault)
        else _plumb(vault, mesh, areas, list(names), _manifold(mesh.vertices, mesh.triangles))
    )
    shares = {k: _arrays(share) for k, share in parts}
    return tuple(Body(k, name, *shares[k], float(areas[k])) for k, name in names.items())


@dataclass(frozen=True)
class _Tiers:
    """What stands above the springing in tiers, cut by level planes at these heights [m]: corners, drum, crown."""

    ring: float
    base: float
    drum: str
    crown: tuple[str, ...]


def _tiers(vault: Vault) -> _Tiers | None:
    """Those of a dome, of webs on a drum or over a crossing; None where there are none."""
    pieces = vault.pieces()
    upper = next((piece for piece in pieces if piece.foot is not None), pieces[0])
    lids = [part.z for piece in pieces for part in piece.parts if isinstance(part, Lid)]
    ring = min(lids, default=0.0)
    for part in upper.parts:
        if isinstance(part, Turned):
            low, high = part.names
            return _Tiers(ring, part.base, low if low != high else "", (high,))
    webs = [part for part in upper.parts if isinstance(part, BarrelPart) and part.side]
    if not webs or not (lids or webs[0].below):
        return None
    return _Tiers(ring, webs[0].base, webs[0].below, tuple(name for web in webs for name in web.names[:1]))


def _tiered(vault: Vault, mesh: Mesh, areas: NDArray[Any]) -> Iterator[tuple[int, Any]]:
    """Crown, drum and corners, cut by level planes; webs of the crown by plumb ones, corners along the axes."""
    tiers, up = _tiers(vault), (0.0, 0.0, 1.0)
    assert tiers is not None
    ids = {name: k for k, name in enumerate(vault.components, 1)}
    crown, below = _manifold(mesh.vertices, mesh.triangles).split_by_plane(up, tiers.ring)
    if tiers.drum:
        crown, drum = crown.split_by_plane(up, tiers.base)
        yield ids[tiers.drum], drum
    yield from _plumb(vault, mesh, areas, [ids[name] for name in tiers.crown], crown)
    for name in (name for name in vault.components if name not in {tiers.drum, *tiers.crown}):
        centre = mesh.vertices[mesh.triangles[mesh.component == ids[name]]].mean(axis=(0, 1))
        quarter = below
        for axis in (0, 1):
            normal = [0.0, 0.0, 0.0]
            normal[axis] = float(np.sign(centre[axis]))
            quarter = quarter.trim_by_plane(normal, 0.0)
        yield ids[name], quarter


def _plumb(vault: Vault, mesh: Mesh, areas: NDArray[Any], ids: Sequence[int], whole: Any) -> Iterator[tuple[int, Any]]:
    """Each component cut out of the whole by a prism over its plan; the largest is what is left: nothing is lost."""
    import manifold3d

    shown = [k for k in ids if areas[k]]
    largest = max(shown, key=lambda k: float(areas[k]))
    prisms = {k: _prism(vault, mesh, k) for k in shown if k != largest}
    for k, prism in prisms.items():
        yield k, whole ^ prism
    others = manifold3d.Manifold.batch_boolean(list(prisms.values()), manifold3d.OpType.Add)
    yield largest, whole - others


def _prism(vault: Vault, mesh: Mesh, component: int) -> Any:
    """Over the plan of one component, carried on outwards where it ends at a wall."""
    import manifold3d

    rows = loops(mesh.triangles[mesh.component == component])
    plans = [_carried_on(vault, mesh.vertices[row]) for row in rows]
    triangles = manifold3d.triangulate(plans)
    points = np.concatenate(plans)
    n, low, high = len(points), -BEYOND, mesh.vertices[:, 2].max() + BEYOND
    vertices = np.concatenate([np.column_stack([points, np.full(n, z)]) for z in (low, high)])
    sides, start = [], 0
    for plan in plans:
        a = np.arange(start, start + len(plan))
        b = np.roll(a, -1)
        sides += [np.column_stack([a, b, b + n]), np.column_stack([a, b + n, a + n])]
        start += len(plan)
    return _manifold(vertices, np.concatenate([triangles[:, ::-1], triangles + n, *sides]))


def _carried_on(vault: Vault, row: Floats) -> Floats:
    """A border (n, 3) in plan, (m, 2) counterclockwise; stretches at the walls go out, joints from their ends."""
    normals, offsets, on_wall = _walls(vault)
    at_wall = np.abs(row[:, :2] @ normals.T - offsets) < ON_EDGE
    # Where wall arches stand outside the springings, the corner between is shared along the diagonal.
    low = row[:, 2] < ON_EDGE
    corner = (at_wall & ~on_wall).any(axis=1) & low
    row = row[keep := at_wall.any(axis=1) | ~(low & np.roll(low, 1) & np.roll(low, -1))]
    out, corner = at_wall[keep], corner[keep]
    for j in np.flatnonzero(corner).tolist():
        nearest = int(np.linalg.norm(vault.corners - row[j, :2], axis=1).argmin())
        out[j, [nearest - 1, nearest]] = True
    far = np.array([_beyond(point, normals[of], offsets[of]) for point, of in zip(row[:, :2], out, strict=True)])
    points: list[Floats] = []
    for k, moved in enumerate([any(sides) for sides in out.tolist()]):
        near = [] if corner[k] else [row[k, :2]]
        if not moved:
            points += near
        elif not out[k - 1].any():
            points += [*near, far[k]]
        elif not out[(k + 1) % len(row)].any():
            points += [far[k], *near]
        else:
            points.append(far[k])
    outline = np.array(points)[::-1]  # triangles face the room below: clockwise from above
    return outline if area(outline) > 0 else outline[::-1]


def _walls(vault: Vault) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Normals (n, 2) and offsets (n,) [m] of the walls at which components end, and whether stone stands on them."""
    free = [part for piece in vault.pieces() if piece.foot is not None for part in piece.parts]
    webs = [part for part in free if isinstance(part, BarrelPart)]
    if webs:  # free of the plan
        across = np.array([np.multiply(web.side, web.across) for web in webs])
        inset = [float(normal @ web.origin) for normal, web in zip(across, webs, strict=True)]
        return across, np.array(inset) + [web.curve.half_span for web in webs], np.ones(len(webs), bool)
    sides = [side for side in vault.plan.sides if side.centre is None]
    return (
        np.array([s.normal for s in sides]),
        np.array([s.offset for s in sides]),
        np.array([s.on_wall for s in sides]),
    )


def _beyond(point: Floats, normals: Floats, offsets: Floats) -> Floats:
    """A point (2,) moved out past the walls at which it stands, by as much past each of them."""
    if not len(normals):
        return point
    beyond = offsets[:2] + BEYOND - normals[:2] @ point
    moved: Floats = point + np.linalg.lstsq(normals[:2], beyond, rcond=None)[0]
    return moved


def _manifold(vertices: Floats, triangles: NDArray[np.integer]) -> Any:
    import manifold3d

    mesh = manifold3d.Mesh64(np.ascontiguousarray(vertices), np.ascontiguousarray(triangles, dtype=np.uint64))
    made = manifold3d.Manifold(mesh)
    if made.status() != manifold3d.Error.NoError:
        raise ExportError(f"the masonry's mesh is not closed ({made.status().name}); try another --thickness")
    return made


def _arrays(manifold: Any) -> tuple[Floats, Triangles]:
    """Vertices and triangles, without the shells of no volume that cuts along a common face leave."""
    import manifold3d

    parts = manifold.decompose()
    whole = [part for part in parts if part.volume() > NO_VOLUME]
    if len(whole) < len(parts):
        manifold = manifold3d.Manifold.compose(whole)
    mesh = manifold.to_mesh64()
    return np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts).astype(np.int32)

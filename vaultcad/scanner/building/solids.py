"""Closed bodies with a label a triangle, and what is left of the stone when they are taken away or put in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vaultcad.errors import VaultcadError
from vaultcad.scanner.building.labels import SKY, Label, Labels
from vaultcad.scanner.building.place import Place
from vaultcad.scanner.triangles import Triangles

Array = NDArray[np.float64]
SIDES = 32  # of a round pier


@dataclass(frozen=True, eq=False)
class Body:
    """A closed mesh: vertices (v, 3) [m], triangles (t, 3), counterclockwise from outside, numbers of labels (t,)."""

    vertices: Array
    triangles: NDArray[np.int64]
    label: NDArray[np.int64]

    def put(self, place: Place) -> Body:
        """Moved from its own frame into the building's."""
        return Body(place.out(self.vertices), self.triangles, self.label)


def prism(outline: ArrayLike, low: float, high: float, sides: ArrayLike, ends: tuple[int, int]) -> Body:
    """Upright body over a polygon (n, 2) [m], counterclockwise, between two levels.

    sides: number of the label of each side, or one for all. ends: of bottom and top.
    """
    import manifold3d

    xy = np.asarray(outline, np.float64)
    n = len(xy)
    lid = np.asarray(manifold3d.triangulate([xy]), np.int64)
    k, after = np.arange(n), (np.arange(n) + 1) % n
    sheet = np.concatenate([np.column_stack([k, after, after + n]), np.column_stack([k, after + n, k + n])])
    vertices = np.concatenate([np.column_stack([xy, np.full(n, z)]) for z in (low, high)])
    side = np.broadcast_to(np.asarray(sides, np.int64), n)
    label = np.concatenate([side, side, *(np.full(len(lid), end) for end in ends)])
    return Body(vertices, np.concatenate([sheet, lid[:, ::-1], lid + n]), label)


def along_y(body: Body) -> Body:
    """A prism over a polygon in (x, z), drawn along y: what stood up lies."""
    return Body(body.vertices[:, [0, 2, 1]], body.triangles[:, ::-1], body.label)


def box(low: ArrayLike, high: ArrayLike, label: int, floor: int | None = None) -> Body:
    """Between two corners (3,) [m]; `floor` is the label of its bottom where that is another."""
    (x0, y0, z0), (x1, y1, z1) = np.asarray(low, np.float64).tolist(), np.asarray(high, np.float64).tolist()
    bottom = label if floor is None else floor
    return prism([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], z0, z1, label, (bottom, label))


def cylinder(radius: float, low: float, high: float, label: int) -> Body:
    """About the z axis."""
    turn = np.arange(SIDES) * (2 * np.pi / SIDES)
    return prism(radius * np.column_stack([np.cos(turn), np.sin(turn)]), low, high, label, (label, label))


def carved(rooms: Sequence[Body], stones: Sequence[Body], labels: Labels) -> Triangles:
    """The surface of what the rooms hollow out together, and the stones fill again; without what is sky.

    Raises:
        VaultcadError: a body is not closed.
    """
    import manifold3d

    shown: dict[int, int] = {}  # id of a run -> number of its label; ids that bodies share would weld these
    hollow = manifold3d.Manifold.batch_boolean([_manifold(b, shown) for b in rooms], manifold3d.OpType.Add)
    filled = [_manifold(b, shown) for b in stones]
    mesh = manifold3d.Manifold.batch_boolean([hollow, *filled], manifold3d.OpType.Subtract).to_mesh64()
    runs = np.asarray(mesh.run_index, np.int64)
    number = np.repeat([shown[int(k)] for k in mesh.run_original_id], (runs[1:] - runs[:-1]) // 3)
    there = number != labels.of(SKY)
    triangles, number = np.asarray(mesh.tri_verts, np.int64)[there], number[there]
    vertices = np.ascontiguousarray(np.asarray(mesh.vert_properties)[:, :3])
    return Triangles(vertices, triangles, number.astype(np.uint16), labels.reflectance(number))


def _manifold(body: Body, shown: dict[int, int]) -> Any:
    import manifold3d

    order = np.argsort(body.label, kind="stable")
    numbers, starts = np.unique(body.label[order], return_index=True)
    first = manifold3d.Manifold.reserve_ids(len(numbers))
    shown.update(enumerate(numbers.tolist(), first))
    made = manifold3d.Manifold(
        manifold3d.Mesh64(
            np.ascontiguousarray(body.vertices),
            np.ascontiguousarray(body.triangles[order], np.uint64),
            run_index=np.append(3 * starts, 3 * len(order)).astype(np.uint64),
            run_original_id=(first + np.arange(len(numbers))).astype(np.uint32),
        )
    )
    if made.status() != manifold3d.Error.NoError or made.volume() <= 0:
        raise VaultcadError(f"a part of the building is no closed body ({made.status().name}); change a size a little")
    return made


def named(labels: Labels, *told: Label) -> tuple[int, ...]:
    """Numbers of labels."""
    return tuple(labels.of(label) for label in told)

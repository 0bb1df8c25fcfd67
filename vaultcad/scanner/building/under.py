"""The room under a vault as a closed body, and the curves in which it ends over the straight sides of its plan."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from math import hypot

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.plan_sides import Side
from vaultcad.scanner.building.elements import Bay
from vaultcad.scanner.building.labels import FLOOR, WALL, Kind, Label, Labels
from vaultcad.scanner.building.solids import Body
from vaultcad.scanner.room import vault_mesh
from vaultcad.scanner.triangles import Triangles

Array = NDArray[np.float64]
ON_SIDE = 1e-5  # m
OVERLAP = 0.001  # by which rooms without an arch between them reach into each other [m]
SIDES = ("south", "east", "north", "west")

ideal_mesh = lru_cache(maxsize=64)(vault_mesh)
"""Of a vault; equal bays share it."""


@dataclass(frozen=True, eq=False)
class Edge:
    """A straight side of a bay, in the building's frame.

    middle, along, normal: (2,) [m], the way along it with the bay on its left, and out of the bay. half: its half
    length [m]. curve: (n, 2), way from the middle and height of the intrados there [m], rising `rise` above
    `springing`. floor: height below it [m].
    """

    bay: int
    name: str
    middle: Array
    along: Array
    normal: Array
    half: float
    curve: Array
    springing: float
    floor: float

    @property
    def rise(self) -> float:
        """How high the intrados rises over it [m]; about 0 where that stands on a wall."""
        return float(self.curve[:, 1].max()) - self.springing

    def height(self, along: Array) -> Array:
        """Of the intrados (n,) [m] at ways (n,) from the middle."""
        found: Array = np.interp(along, self.curve[:, 0], self.curve[:, 1])
        return found


def edges(number: int, bay: Bay) -> Iterable[Edge]:
    """The straight sides of a bay."""
    plan, mesh = bay.vault.plan, ideal_mesh(bay.vault)
    rim = mesh.vertices[np.unique(boundary(mesh.triangles))]
    for name, side in zip(names(bay.vault), plan.sides, strict=True):
        if side.centre is not None:
            continue
        start, end, normal = np.array(side.start), np.array(side.end), np.array(side.normal)
        middle, half = (start + end) / 2, hypot(*(end - start)) / 2
        along = (end - start) / (2 * half)
        own = rim[np.abs(rim[:, :2] @ normal - side.offset) < ON_SIDE]
        s = np.round((own[:, :2] - middle) @ along, 5)
        order = np.lexsort((-own[:, 2], s))
        s, z = s[order], own[order, 2]
        first = np.append(True, np.diff(s) > 0)  # of what stands above each other the highest
        place = bay.place
        yield Edge(
            number,
            name,
            place.out(middle[None])[0],
            along @ place.axes,
            normal @ place.axes,
            half,
            np.column_stack([s[first], z[first] + place.z]),
            float(own[:, 2].min()) + place.z,
            float(bay.floor_at(middle[None])[0]),
        )


def names(vault: Vault) -> tuple[str, ...]:
    """What the sides of its plan are called: by the compass where there are four, else by their numbers from 1."""
    sides = vault.plan.sides
    if len(sides) == len(SIDES) and all(side.centre is None for side in sides):
        return SIDES
    return tuple(str(k) for k in range(1, len(sides) + 1))


def boundary(triangles: NDArray[np.integer]) -> NDArray[np.int64]:
    """Directed edges (n, 2) that no triangle has the other way round."""
    ways = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    size = int(ways.max()) + 1
    return ways[~np.isin(ways[:, 0] * size + ways[:, 1], ways[:, 1] * size + ways[:, 0])]


def room(number: int, bay: Bay, open_sides: Iterable[str], labels: Labels) -> Body:
    """The room from the floor to the intrados, its walls the outline of the plan; bays count from 0.

    Across `open_sides` it reaches a little into the next bay, which reaches into it.
    """
    import manifold3d

    mesh = ideal_mesh(bay.vault)
    sheet = _widened(mesh, bay.vault, {*open_sides})
    xyz = sheet.vertices
    rim = boundary(sheet.triangles)
    feet, below = np.unique(np.round(xyz[rim[:, 0], :2], 6), axis=0, return_inverse=True)
    foot = np.full(len(xyz), -1)
    foot[rim[:, 0]] = len(xyz) + below.ravel()
    a, b = rim.T
    walls = np.concatenate([np.column_stack([b, a, foot[a]]), np.column_stack([b, foot[a], foot[b]])])
    walls = walls[(walls[:, 1] != walls[:, 2]) & (walls[:, 0] != walls[:, 1])]
    loops = _loops(foot[rim] - len(xyz))
    chained = np.concatenate(loops)
    ground = chained[np.asarray(manifold3d.triangulate([feet[loop] for loop in loops]), np.int64)][:, ::-1] + len(xyz)
    wall, floor = labels.of(WALL), labels.of(FLOOR)
    shown = [labels.of(Label(Kind.VAULT, number + 1, k)) for k in range(len(bay.vault.components) + 1)]
    vertices = np.concatenate(
        [bay.place.out(xyz), np.column_stack([bay.place.out(feet), bay.floor_at(feet)])],
    )
    return Body(
        vertices,
        np.concatenate([sheet.triangles, walls, ground]),
        np.concatenate([np.array(shown)[sheet.component], np.full(len(walls), wall), np.full(len(ground), floor)]),
    )


def _widened(mesh: Triangles, vault: Vault, open_sides: set[str]) -> Triangles:
    """The intrados turned to be seen from above, drawn out across open sides."""
    triangles, component, xyz = mesh.triangles[:, ::-1], mesh.component, mesh.vertices
    for name, side in zip(names(vault), vault.plan.sides, strict=True):
        if name in open_sides:
            xyz, triangles, component = _drawn_out(xyz, triangles, component, side)
    return replace(mesh, vertices=xyz, triangles=triangles, component=component)


def _drawn_out(
    xyz: Array, triangles: NDArray[np.int64], component: NDArray[np.uint16], side: Side
) -> tuple[Array, NDArray[np.int64], NDArray[np.uint16]]:
    rim = boundary(triangles)
    at = np.abs(xyz[:, :2] @ np.array(side.normal) - side.offset) < ON_SIDE
    a, b = rim[at[rim].all(axis=1)].T
    own = np.unique(np.concatenate([a, b]))
    new = np.full(len(xyz), -1)
    new[own] = len(xyz) + np.arange(len(own))
    size = len(xyz)
    which = {(int(p) * size + int(q)): int(c) for t, c in zip(triangles, component, strict=True) for p, q in _ways(t)}
    names_ = np.array([which[int(p) * size + int(q)] for p, q in zip(a, b, strict=True)], np.uint16)
    strip = np.concatenate([np.column_stack([b, a, new[a]]), np.column_stack([b, new[a], new[b]])])
    out = xyz[own] + OVERLAP * np.array([*side.normal, 0.0])
    return (
        np.concatenate([xyz, out]),
        np.concatenate([triangles, strip]),
        np.concatenate([component, names_, names_]),
    )


def _ways(t: NDArray[np.int64]) -> tuple[tuple[int, int], ...]:
    return (t[0], t[1]), (t[1], t[2]), (t[2], t[0])


def _loops(ways: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Directed edges (n, 2) as closed rows of their starts; those of no length are left out."""
    after = {int(a): int(b) for a, b in ways if a != b}
    found = []
    while after:
        start = next(iter(after))
        loop, k = [start], after.pop(start)
        while k != start:
            loop.append(k)
            k = after.pop(k)
        found.append(np.array(loop))
    return found

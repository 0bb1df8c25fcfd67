"""A building as triangles: rooms hollowed out, arches and piers put back, and what stands about."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vaultcad.scanner.building import solids
from vaultcad.scanner.building.elements import Arch, Bay, Building, Door, Pier
from vaultcad.scanner.building.joints import ARCHED, Joints, check_apart, joined
from vaultcad.scanner.building.labels import FLOOR, PIER, SKY, WALL, Labels, arch_label
from vaultcad.scanner.building.solids import Body, along_y
from vaultcad.scanner.building.under import Edge, edges, room
from vaultcad.scanner.triangles import Triangles

Array = NDArray[np.float64]

PROUD = 0.002  # by which arches and jambs stand out of the walls, so that their faces are theirs [m]
THROUGH = 0.003  # by which ways through walls reach into the rooms [m]
RISER = 0.17  # of a step [m]
ABACUS = 0.15  # height of a capital [m]
WINDOW, REVEAL, SILL, ABOVE = 1.0, 0.35, 1.0, 0.3  # width, depth, least height above floor, masonry above [m]


@dataclass(frozen=True, eq=False)
class Built:
    """The scene before it settles, with the table of its labels, and the arches and piers in the order of these."""

    mesh: Triangles
    labels: Labels
    arches: tuple[Arch, ...]
    piers: tuple[Pier, ...]


def build(building: Building) -> Built:
    """Raise it.

    Raises:
        VaultcadError: a vault could not be meshed, bays stand in each other, or an arch has no room.
    """
    bays, labels = building.bays, Labels()
    check_apart(bays)
    sides = [edge for k, bay in enumerate(bays) for edge in edges(k, bay)]
    joints = joined(bays, sides)
    arches, piers = (*joints.arches, *building.arches), (*joints.piers, *building.piers)
    rooms = [room(k, bay, joints.open.get(k, ()), labels) for k, bay in enumerate(bays)]
    rooms += [_way(arch, k, labels) for k, arch in enumerate(arches, 1)]
    rooms += [_doorway(door, labels) for door in building.doors]
    rooms += [_clearing(pier, labels) for pier in piers if pier.clear]
    rooms += [body for edge in sides for body in _window(bays, edge, joints, labels)]
    stones = [body for k, arch in enumerate(arches, 1) for body in _masonry(arch, k, labels)]
    stones += [body for pier in piers for body in _standing(pier, labels)]
    stones += [body for bay in bays for body in _steps(bay, labels)]
    return Built(solids.carved(rooms, stones, labels), labels, arches, piers)


def _way(arch: Arch, number: int, labels: Labels) -> Body:
    """What an arch opens, a little smaller than its stone, so that this lines it."""
    wall, pier, floor = solids.named(labels, WALL, PIER, FLOOR)
    middle = (arch.intrados + arch.extrados) / 2
    low = arch.floor - arch.place.z
    outline = np.concatenate([[[middle[-1, 0], low]], middle[::-1], [[middle[0, 0], low]]])
    sides = [pier, *[labels.of(arch_label(number))] * (len(middle) - 1), pier, floor]
    back = -arch.width / 2 - (0.0 if arch.blind else THROUGH)
    return along_y(solids.prism(outline, back, arch.width / 2 + THROUGH, sides, (wall, wall))).put(arch.place)


def _masonry(arch: Arch, number: int, labels: Labels) -> Iterator[Body]:
    """The arch itself, and the jambs under its feet."""
    shown, pier = solids.named(labels, arch_label(number), PIER)
    half = arch.width / 2 + PROUD
    ring = np.concatenate([arch.extrados[::-1], arch.intrados])
    yield along_y(solids.prism(ring, -half, half, shown, (shown, shown))).put(arch.place)
    inner, outer = arch.span / 2, float(arch.extrados[-1, 0])
    for sign, jamb in zip((-1, 1), arch.jambs, strict=True):
        if jamb < arch.place.z:
            x = sorted((sign * inner, sign * outer))
            low, high = (x[0], -half, jamb - arch.place.z - PROUD), (x[1], half, 0.0)
            yield solids.box(low, high, pier).put(arch.place)


def _clearing(pier: Pier, labels: Labels) -> Body:
    half = pier.clear / 2
    wall, floor = solids.named(labels, WALL, FLOOR)
    return solids.box((-half, -half, 0.0), (half, half, pier.top - pier.place.z), wall, floor).put(pier.place)


def _standing(pier: Pier, labels: Labels) -> Iterator[Body]:
    shown, height, half = labels.of(PIER), pier.top - pier.place.z, pier.size / 2
    if pier.kind == "round":
        cap = max(pier.clear, pier.size) / 2 + ABACUS / 5
        yield solids.cylinder(half, -PROUD, height - ABACUS / 2, shown).put(pier.place)
        yield solids.box((-cap, -cap, height - ABACUS), (cap, cap, height + PROUD), shown).put(pier.place)
    else:
        yield solids.box((-half, -half, -PROUD), (half, half, height + PROUD), shown).put(pier.place)


def _doorway(door: Door, labels: Labels) -> Body:
    wall, floor = solids.named(labels, WALL, FLOOR)
    x, y = door.width / 2, door.depth / 2
    return solids.box((-x, -y, 0.0), (x, y, door.height), wall, floor).put(door.place)


def _steps(bay: Bay, labels: Labels) -> Iterator[Body]:
    """Of stairs: as many as the climb asks for, each up to the middle of what the ramp climbs over it."""
    if not bay.slope:
        return
    floor, (half_x, half_y) = labels.of(FLOOR), bay.vault.plan.half.tolist()
    count = max(1, round(abs(bay.slope) * 2 * half_y / RISER))
    ends = np.linspace(-half_y, half_y, count + 1)
    for a, b in pairwise(ends.tolist()):
        low, high = bay.floor_at(np.array([[0.0, a], [0.0, b]])) - bay.place.z
        level = max(low, high)
        # As wide as the room and a little more: what reaches into the stone is no more than stone.
        yield solids.box((-half_x - 0.1, a, min(low, high) - 0.1), (half_x + 0.1, b, level), floor).put(bay.place)


def _window(bays: Sequence[Bay], edge: Edge, joints: Joints, labels: Labels) -> Iterator[Body]:
    """In a free wall, where there is room under its arch and nothing beyond."""
    bay = bays[edge.bay]
    if not bay.windows or edge.name in joints.taken.get(edge.bay, set()) or edge.half < 0.8:
        return
    if bay.wall_arches and edge.rise > ARCHED and edge.name not in bay.closed:
        return  # below a wall arch the wall stays whole
    half = min(WINDOW, 0.5 * edge.half) / 2
    top = float(edge.height(np.array([-half, half])).min()) - ABOVE
    low = max(edge.floor + SILL, top - 2.2)
    outside = edge.middle + (REVEAL + 0.15) * edge.normal + np.outer((-half, half), edge.along)
    if top - low < 0.5 or any(_reaches(other, outside, low, top) for other in bays):
        return
    wall, sky = solids.named(labels, WALL, SKY)
    x, y, depth = half, REVEAL, THROUGH
    outline = [(-x, -depth), (x, -depth), (x, y), (-x, y)]
    frame = np.stack([edge.along, edge.normal])  # left-handed: the normal is to the right of the way along
    hole = solids.prism(outline, low, top, [wall, wall, sky, wall], (wall, wall))
    there = hole.vertices.copy()
    there[:, :2] = there[:, :2] @ frame + edge.middle
    yield Body(there, hole.triangles[:, ::-1], hole.label)


def _reaches(bay: Bay, places: Array, low: float, high: float) -> bool:
    """Whether the room of a bay lies at places (n, 2) between two heights [m]."""
    if high < bay.floor or low > bay.top:
        return False
    return bool((bay.vault.plan.distance(bay.place.into(places)) < 0.1).any())

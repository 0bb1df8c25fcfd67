"""The planes by which a vault is understood, from the pieces that its family declares; and planes by hand.

No family is named here: barrels are cut across and along, domes by meridians, rings by planes through their axis, webs
along their ridges, creases from the corners in which they end, arches on walls just inside these.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from math import atan2, ceil, cos, hypot, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.pieces import Ball, BarrelPart, Turned, Web
from families.declaration.plan_sides import Side, Vector
from families.void.columns import heights
from families.void.upright import Upright, chords, outlines
from vaultcad.model import PlacedVault
from vaultcad.sections.guide import guides
from vaultcad.sections.section import Level, SectionPlane

INSET = 0.06  # m from a wall to the plane that shows the arch on it: the slab is clear of the wall
BELOW = 0.03  # m below the springing, of the level plane that shows the walls there: a slab, so that no vault is in it
ALIKE_OFFSET, ALIKE_ANGLE = 0.05, radians(0.5)  # m, rad: planes so near to each other are one
SHORTEST = 0.3  # m over the plan, of a plane that shows anything
ON_A_WALL, WALL_MIDDLE = 0.1, 0.8  # of the whole rise, by which an arch on a wall rises over so much of its length
MOSTLY = 0.5  # of its width that an arch on a wall is to be cut
CORNER_REACH = (0.5, 0.3)  # of the way from a corner to the middle, where creases are looked for
CREASE_STEPS, CREASE_ROUNDS = 61, 3  # directions in which they are, again and again between two of them
CREASE_ANGLE = radians(1.5)  # by which a crease may turn between both reaches
TURNS = 4  # planes through the axis of what is turned about one and has no corners
RING_PLANES = 3  # through a part of a ring, besides its ends

Asked = tuple[str, Upright]


def genesis_planes(vault: Vault) -> tuple[SectionPlane, ...]:
    """The planes that a vault's genesis asks for, in its frame; the last is level at its springing."""
    kept: list[Asked] = []
    for kind, plane in (*_of_pieces(vault), *_creases(vault), *_on_walls(vault)):
        alike = any(_alike(plane, other) for _, other in kept)
        if not alike and _within(vault, plane):
            kept.append((kind, plane))
    return (*_named([*kept, *_between(vault, kept)]), SectionPlane("springing", "springing", Level(vault.lift - BELOW)))


def every(vault: Vault, spacing: float) -> tuple[SectionPlane, ...]:
    """Planes `spacing` [m] apart along the whole axis: across it, else as the first of its genesis.

    Of a ring they go through its centre, and are so far apart on the circle along its middle.

    Raises:
        ValueError: the spacing is not positive.
    """
    if not spacing > 0:
        raise ValueError(f"every = {spacing!r} m is no distance of planes; give one above 0")
    rings = [part for piece in vault.pieces() for part in piece.parts if isinstance(part, Turned) and part.radius > 0]
    if rings:
        return _named([("every", plane) for plane in _round(vault, rings[0], spacing)])
    upright = [(plane.kind, plane.cut) for plane in genesis_planes(vault) if isinstance(plane.cut, Upright)]
    first = next((cut for kind, cut in upright if kind == "across"), upright[0][1])
    reach = first.off(vault.plan.outline())
    steps = range(ceil((reach.min() + INSET) / spacing), int((reach.max() - INSET) // spacing) + 1)
    (x, y), (a, b) = first.origin, first.normal
    moved = (Upright((x + k * spacing * a, y + k * spacing * b), first.direction) for k in steps)
    return _named([("every", plane) for plane in moved if chords(vault.plan, plane)])


def _round(vault: Vault, ring: Turned, spacing: float) -> Iterator[Upright]:
    """Planes through the axis of a part of a ring, from its middle to both ends."""
    arc = next(side for side in vault.plan.sides if side.centre is not None)
    (cx, cy), (x, y) = ring.centre, arc.points(2)[1].tolist()
    most = int((abs(arc.sweep) / 2 * ring.radius - INSET) / spacing)
    for k in range(-most, most + 1):
        angle = atan2(y - cy, x - cx) + k * spacing / ring.radius
        yield Upright(ring.centre, (cos(angle), sin(angle)))


def given(placed: PlacedVault, planes: Iterable[tuple[float, float, float]]) -> tuple[SectionPlane, ...]:
    """Planes through places (x, y) [m] of the scan's local frame, towards azimuths there [rad], that cross the vault.

    They are upright in the vault's frame, which leans with the scan if it leans.
    """
    frame, found = placed.pose.frame(), []
    for x, y, azimuth in planes:
        here = np.array([[x, y, placed.pose.z], [x + cos(azimuth), y + sin(azimuth), placed.pose.z]])
        (ax, ay, _), (bx, by, _) = (here @ frame[:, :3].T + frame[:, 3]).tolist()
        plane = Upright.through((ax, ay), (bx, by))
        if chords(placed.vault.plan, plane):
            found.append(("given", plane))
    return _named(found)


def _named(planes: list[Asked]) -> tuple[SectionPlane, ...]:
    """Each with its kind as its name, and a number where there are several of the kind."""
    found, count = [], {kind: sum(other == kind for other, _ in planes) for kind, _ in planes}
    seen: dict[str, int] = {}
    for kind, plane in planes:
        seen[kind] = seen.get(kind, 0) + 1
        found.append(SectionPlane(kind, f"{kind} {seen[kind]}" if count[kind] > 1 else kind, plane))
    return tuple(found)


def _alike(a: Upright, b: Upright) -> bool:
    turn = abs(a.direction[0] * b.direction[1] - a.direction[1] * b.direction[0])
    return turn < sin(ALIKE_ANGLE) and abs(float(b.off(np.array([a.origin]))[0])) < ALIKE_OFFSET


def _within(vault: Vault, plane: Upright) -> bool:
    """Whether it crosses the plan, and does not only run along its edge."""
    found = chords(vault.plan, plane)
    middles = plane.places(np.array([(low + high) / 2 for low, high in found]))
    return any(
        high - low > SHORTEST and inside < -INSET / 2
        for (low, high), inside in zip(found, vault.plan.distance(middles), strict=True)
    )


def _of_pieces(vault: Vault) -> Iterator[Asked]:
    """By what the void is made of, in the order of the declaration."""
    for part in (part for piece in vault.pieces() for part in piece.parts):
        match part:
            case BarrelPart(across=across, origin=origin, side=side):
                yield _way(across), Upright(origin, _rightwards(across))
                if not side:
                    yield _way(part.along), Upright(origin, _rightwards(part.along))
            case Ball(centre=centre) | Turned(centre=centre, radius=0.0):
                yield from (("meridian", plane) for plane in _meridians(vault, centre))
            case Turned(centre=centre):
                yield from (("radial", plane) for plane in _radials(vault, centre))
            case Web(centre=centre, start=(ax, ay), end=(bx, by)):
                yield "ridge", _through(centre, ((ax + bx) / 2, (ay + by) / 2))


def _way(direction: Vector) -> str:
    """Frames have x across."""
    return "across" if abs(direction[0]) >= abs(direction[1]) - 1e-9 else "along"


def _rightwards(direction: Vector) -> Vector:
    """The direction or its opposite, whichever is drawn along x, or else along y."""
    x, y = direction
    return (-x + 0.0, -y + 0.0) if x < -1e-9 or (abs(x) <= 1e-9 and y < 0) else direction


def _through(centre: Vector, to: Vector) -> Upright:
    away = Upright.through(centre, to)
    return Upright(centre, _rightwards(away.direction))


def _meridians(vault: Vault, centre: Vector) -> Iterator[Upright]:
    straight = [side for side in vault.plan.sides if side.centre is None]
    if len(straight) < 3:  # no corners: half a disc has an open side, along which there is nothing to see
        for k in range(TURNS):
            yield Upright(centre, _rightwards((cos(k * pi / TURNS), sin(k * pi / TURNS))))
        return
    yield Upright(centre, (1.0, 0.0))
    yield Upright(centre, (0.0, 1.0))
    yield from (_through(centre, side.start) for side in straight)


def _radials(vault: Vault, centre: Vector) -> Iterator[Upright]:
    if vault.plan.turns:
        yield from (Upright(centre, (cos(k * pi / TURNS), sin(k * pi / TURNS))) for k in range(TURNS))
        return
    arcs = [side for side in vault.plan.sides if side.centre is not None and side.inside]
    points = np.concatenate([side.points(64) for side in arcs])
    for share in np.linspace(0, 1, RING_PLANES + 2)[1:-1]:
        x, y = points[round(share * (len(points) - 1))].tolist()
        yield Upright.through(centre, (x, y))


def _creases(vault: Vault) -> Iterator[Asked]:
    """From corners of the plan along the crease that ends there: groins, hips, ribs."""
    sides, width = vault.plan.sides, vault.plan.width
    for before, after in zip((sides[-1], *sides[:-1]), sides, strict=True):
        if before.centre is None and after.centre is None and before.end == after.start:
            ways = [way for share in CORNER_REACH if (way := _crease(vault, before, after, share * width / 2))]
            if len(ways) == len(CORNER_REACH):
                (ax, ay), (bx, by) = ways
                if abs(ax * by - ay * bx) < sin(CREASE_ANGLE):
                    yield "diagonal", Upright(after.start, _rightwards(ways[0]))


def _crease(vault: Vault, before: Side, after: Side, reach: float) -> Vector | None:
    """The direction from a corner in which, at a distance [m], one component passes into another, if just one does."""
    corner = np.array(after.start)
    to, back = (np.subtract(p, corner) for p in (after.end, before.start))
    first = np.arctan2(to[1], to[0])
    turn = (np.arctan2(back[1], back[0]) - first) % (2 * pi)
    low, high = first + 0.02 * turn, first + 0.98 * turn
    for _ in range(CREASE_ROUNDS):
        angle = np.linspace(low, high, CREASE_STEPS)
        places = corner + reach * np.column_stack([np.cos(angle), np.sin(angle)])
        component = vault.evaluate(np.column_stack([places, heights(vault, places)])).component
        changes = np.flatnonzero(np.diff(component))
        if len(changes) != 1:
            return None
        low, high = angle[changes[0]], angle[changes[0] + 1]
    return cos((low + high) / 2), sin((low + high) / 2)


def _on_walls(vault: Vault) -> Iterator[Asked]:
    """Just inside each straight side on which the vault stands higher in some places than in others."""
    for side in vault.plan.sides:
        if side.centre is not None:
            continue
        (x, y), (a, b) = side.start, side.normal
        along = (side.end[0] - side.start[0], side.end[1] - side.start[1])
        size = hypot(*along)
        plane = Upright((x - INSET * a, y - INSET * b), _rightwards((along[0] / size, along[1] / size)))
        for line, _ in outlines(vault, plane):
            u, z = line.T
            inner = z[np.abs(u - (u[0] + u[-1]) / 2) < WALL_MIDDLE * (u[-1] - u[0]) / 2]
            if len(inner) and np.ptp(inner) > ON_A_WALL * vault.top and _is_cut(vault, plane, line):
                yield "wall arch", plane
                break


def _is_cut(vault: Vault, plane: Upright, line: NDArray[np.float64]) -> bool:
    """Whether a plane cuts the vault along most of a line, and does not all but touch it."""
    _, along = guides(vault, plane)
    shown = sum(float(np.ptp(guide.at[piece, 0])) for guide in along for piece in guide.pieces())
    return shown > MOSTLY * float(line[-1, 0] - line[0, 0])


def _between(vault: Vault, planes: list[Asked]) -> Iterator[Asked]:
    """Midway between those across a barrel beside each other, as between lunettes."""
    across = [plane for kind, plane in planes if kind == "across"]
    beside = [plane for plane in across if abs(plane.direction[0] - across[0].direction[0]) < 1e-9]
    for a, b in pairwise(sorted(beside, key=lambda plane: float(across[0].off(np.array([plane.origin]))[0]))):
        middle = ((a.origin[0] + b.origin[0]) / 2, (a.origin[1] + b.origin[1]) / 2)
        plane = Upright(middle, a.direction)
        if not any(_alike(plane, other) for other in across):
            yield "between", plane

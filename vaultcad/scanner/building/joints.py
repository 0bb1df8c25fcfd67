"""Where bays meet: which sides face each other, the arches between them, and the piers where arches end."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from math import atan2

import numpy as np
from numpy.typing import NDArray

from vaultcad.errors import VaultcadError
from vaultcad.scanner.building.elements import STEPS, Arch, Bay, Pier, PierKind
from vaultcad.scanner.building.place import Place
from vaultcad.scanner.building.under import Edge

Array = NDArray[np.float64]

PARALLEL = 0.9995  # cosine between the normals of sides that face each other, at least
WIDEST = 1.6  # wall between two bays through which an arch is made [m]
NO_GAP = 0.02  # up to which bays touch, without an arch [m]
OVERLAP = 0.75  # of the shorter side that has to face the other
ARCHED = 0.3  # an intrados that rises less over a side stands on a wall there [m]
BURIED = 0.03  # by which arches reach into the stone above the vaults' edges [m]
STOREY = 1.2  # floors that differ by more are those of two storeys [m]
NEAR = 0.06  # m; levels of arches that stand on one pier
CAPITAL = 0.03  # how far piers stand out below their arches [m]


@dataclass(frozen=True)
class Joints:
    """What follows from the bays: open sides by bay, taken sides by bay, arches, and piers that stand free."""

    open: dict[int, set[str]] = field(default_factory=dict)
    taken: dict[int, set[str]] = field(default_factory=dict)
    arches: tuple[Arch, ...] = ()
    piers: tuple[Pier, ...] = ()


def joined(bays: Sequence[Bay], edges: Sequence[Edge]) -> Joints:
    """All that meet, and what stands between.

    Raises:
        VaultcadError: an arch would have no room; names the bays.
    """
    open_: dict[int, set[str]] = {}
    taken: dict[int, set[str]] = {}
    arches: list[Arch] = []
    kinds: list[PierKind] = []
    may = [e for e in edges if e.rise > ARCHED and e.name not in bays[e.bay].closed]
    for one, other in combinations(may, 2):
        span = facing(one, other)
        if span is None:
            continue
        for edge in (one, other):
            taken.setdefault(edge.bay, set()).add(edge.name)
        gap = float((other.middle - one.middle) @ one.normal)
        if gap < NO_GAP:
            for edge in (one, other):
                open_.setdefault(edge.bay, set()).add(edge.name)
            continue
        arches.append(_arch(bays, one, other, span, gap))
        kinds.append(bays[one.bay].style.piers)
    for edge in may:
        bay = bays[edge.bay]
        if bay.wall_arches and edge.name not in taken.get(edge.bay, set()):
            arches.append(_wall_arch(bay, edge))
            kinds.append("jambs")
    arches, piers = _supported(arches, kinds)
    return Joints(open_, taken, tuple(arches), tuple(piers))


def facing(one: Edge, other: Edge) -> tuple[float, float] | None:
    """From where to where [m] along the first side the other faces it nearby; None if it does not."""
    if one.bay == other.bay or one.normal @ other.normal > -PARALLEL or abs(one.floor - other.floor) > STOREY:
        return None
    apart = other.middle - one.middle
    if not -NO_GAP < apart @ one.normal < WIDEST:
        return None
    shift = float(apart @ one.along)
    low, high = max(-one.half, shift - other.half), min(one.half, shift + other.half)
    return (low, high) if high - low > OVERLAP * 2 * min(one.half, other.half) else None


def _arch(bays: Sequence[Bay], one: Edge, other: Edge, span: tuple[float, float], gap: float) -> Arch:
    """Between two bays: the lower of their edges, moved in by the thickness."""
    middle, half = sum(span) / 2, (span[1] - span[0]) / 2
    shift = float((other.middle - one.middle) @ one.along)
    u = half * np.cos(np.linspace(np.pi, 0, STEPS + 1))[1:-1]
    edge = np.minimum(one.height(middle + u), other.height(shift - middle - u))
    low, high = sorted((one.springing, other.springing))
    springing = low if edge[0] < high else high
    centre = one.middle + middle * one.along + gap / 2 * one.normal
    place = Place(float(centre[0]), float(centre[1]), springing, atan2(one.along[1], one.along[0]))
    told = f"between {called(bays, one.bay)} and {called(bays, other.bay)}"
    floor = max(one.floor, other.floor)
    return _under(np.column_stack([u, edge - springing]), half, place, gap, bays[one.bay].style.thickness, floor, told)


def _wall_arch(bay: Bay, edge: Edge) -> Arch:
    """Before a wall that is set back by its width."""
    u = edge.half * np.cos(np.linspace(np.pi, 0, STEPS + 1))[1:-1]
    centre = edge.middle + bay.wall_arches / 2 * edge.normal
    place = Place(float(centre[0]), float(centre[1]), edge.springing, atan2(edge.along[1], edge.along[0]))
    curve = np.column_stack([u, edge.height(u) - edge.springing])
    told = f"before the {edge.name} wall of {bay.name or f'vault {edge.bay + 1}'}"
    return _under(curve, edge.half, place, bay.wall_arches, bay.style.thickness, edge.floor, told, blind=True)


def _under(
    edge: Array, half: float, place: Place, width: float, thickness: float, floor: float, told: str, blind: bool = False
) -> Arch:
    """Under the edge (n, 2) of vaults, nowhere nearer to it than its share of the thickness."""
    rise = float(edge[:, 1].max())
    if thickness > min(half, rise) / 2 or place.z - floor < 0.3:
        raise VaultcadError(
            f"the arch {told} has no room: span {2 * half:.2f} m, rise {rise:.2f} m, thickness {thickness:g} m, "
            f"springing {place.z - floor:.2f} m above the floor; take a smaller thickness or move the bays"
        )
    over = np.column_stack([edge[:, 0], np.maximum(edge[:, 1], 0.0)])
    curve = np.concatenate([[[-half, 0.0]], over, [[half, 0.0]]])
    size = np.array([half, rise])
    beyond = curve * (1 + BURIED / size)
    return Arch(place, width, thickness, floor, curve * (1 - thickness / size), beyond, (floor, floor), blind)


def _supported(arches: Sequence[Arch], kinds: Sequence[PierKind]) -> tuple[list[Arch], list[Pier]]:
    """Arches with their jambs ending on the piers that stand free where three of them or more meet, and these."""
    ends = [(k, side, _end(arch, side)) for k, arch in enumerate(arches) for side in (0, 1) if not arch.blind]
    jambs = [[arch.floor, arch.floor] for arch in arches]
    piers = []
    for group in _clusters(ends, arches):
        own = [arches[k] for k, _, _ in group]
        kind = kinds[group[0][0]]
        if len(group) < 3 or kind == "jambs":
            continue
        lowest = min(own, key=lambda arch: arch.place.z)
        top, floor = lowest.place.z, max(arch.floor for arch in own)
        broad = max(arch.width for arch in own) + 2 * max(arch.thickness for arch in own)
        centre = np.mean([point for _, _, point in group], axis=0)
        place = Place(float(centre[0]), float(centre[1]), floor, lowest.place.yaw)
        piers.append(Pier(place, top, kind, broad + 2 * CAPITAL if kind == "square" else 0.8 * broad, broad))
        for k, side, _ in group:
            jambs[k][side] = top if arches[k].place.z > top + NEAR else np.inf
    return [_standing(arch, jamb) for arch, jamb in zip(arches, jambs, strict=True)], piers


def _standing(arch: Arch, jambs: Sequence[float]) -> Arch:
    low, high = (min(jamb, arch.place.z) for jamb in jambs)
    return Arch(
        arch.place, arch.width, arch.thickness, arch.floor, arch.intrados, arch.extrados, (low, high), arch.blind
    )


def _end(arch: Arch, side: int) -> Array:
    """Where an arch ends in plan (2,) [m]: at the corner of its bays."""
    half = float(np.abs(arch.extrados[:, 0]).max()) - BURIED
    found: Array = arch.place.out(np.array([[half if side else -half, 0.0]]))[0]
    return found


def _clusters(ends: Sequence[tuple[int, int, Array]], arches: Sequence[Arch]) -> Iterator[list[tuple[int, int, Array]]]:
    """Ends on one storey no farther from each other than their arches are wide, directly or by others."""

    def meet(one: tuple[int, int, Array], other: tuple[int, int, Array]) -> bool:
        a, b = arches[one[0]], arches[other[0]]
        apart = float(np.hypot(*(one[2] - other[2])))
        return apart < 1.1 * max(a.width, b.width) + NEAR and abs(a.floor - b.floor) < STOREY

    left = list(ends)
    while left:
        group = [left.pop(0)]
        for one in group:
            near = [other for other in left if meet(one, other)]
            group += near
            left = [other for other in left if not any(other is found for found in near)]
        yield group


def called(bays: Sequence[Bay], number: int) -> str:
    """How messages name a bay, counted from 0."""
    return repr(bays[number].name) if bays[number].name else f"vault {number + 1}"


def check_apart(bays: Sequence[Bay]) -> None:
    """Refuse bays that stand in each other.

    Raises:
        VaultcadError: two do; names them.
    """
    levels = [(bay.floor, bay.top) for bay in bays]
    plans = [bay.place.out(_spread(bay)) for bay in bays]
    for (i, one), (j, other) in combinations(enumerate(bays), 2):
        if min(levels[i][1], levels[j][1]) <= max(levels[i][0], levels[j][0]):
            continue
        deepest = min(
            one.vault.plan.distance(one.place.into(plans[j])[:, :2]).min(),
            other.vault.plan.distance(other.place.into(plans[i])[:, :2]).min(),
        )
        if deepest < -NO_GAP:
            raise VaultcadError(
                f"{called(bays, i)} and {called(bays, j)} stand in each other by {-deepest:.2f} m; move one away"
            )


def _spread(bay: Bay) -> Array:
    """Places (n, 2) [m] along the sides of a plan and within it."""
    plan = bay.vault.plan
    low, high = plan.box
    grid = np.stack(np.meshgrid(*np.linspace(low, high, 9)[1:-1].T), axis=-1).reshape(-1, 2)
    return np.concatenate([grid[plan.holds(grid)], *(side.points(24) for side in plan.sides)])

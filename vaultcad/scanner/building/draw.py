"""Random buildings of realistic sizes: what benchmarks are fed with."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np

from families import (
    Annular,
    Barrel,
    Cloister,
    Conch,
    Dome,
    Semicircular,
    Vault,
)
from families.declaration.usual_arches import either
from vaultcad.errors import VaultcadError
from vaultcad.scanner.building.elements import PIERS, Arch, Bay, Building, Door, PierKind, Style
from vaultcad.scanner.building.joints import check_apart
from vaultcad.scanner.building.place import Place
from vaultcad.scanner.building.rows import at, beside, in_row
from vaultcad.scanner.building.usual_vaults import bay_vault, lunettes, room_vault
from vaultcad.scanner.settings import ScannerSettings

Random = np.random.Generator
HERE = Place(0.0, 0.0)
POINTS_A_BAY = 120_000
MOST_STATIONS = 12


def draw_building(rng: Random, kind: str | None = None) -> Building:
    """A building of a kind in KINDS, of any if none is named, and how it is to be scanned.

    Raises:
        KeyError: no such kind.

    >>> building = draw_building(np.random.default_rng(1), "crypt")
    >>> building.name, 4 <= len(building.bays) <= 20
    ('crypt', True)
    """
    kind = kind or str(rng.choice(list(KINDS)))
    building = KINDS[kind](rng)
    count = len(building.bays)
    settings = ScannerSettings(
        points=min(1_500_000, POINTS_A_BAY * count),
        stations=min(MOST_STATIONS, max(3, count)),
        noise=rng.uniform(0.001, 0.004),
        mixed=rng.uniform(0.1, 0.4),
        registration_shift=rng.uniform(0.001, 0.003),
        relief=rng.uniform(0, 0.002),
        settlement=rng.uniform(0.01, 0.03),
    )
    far = (round(rng.uniform(2e5, 8e5), 2), round(rng.uniform(4e6, 6e6), 2), round(rng.uniform(0, 900), 2))
    return replace(
        building,
        name=kind,
        rods=bool(rng.random() < 0.5),
        pews=int(rng.integers(0, 3 * count)),
        yaw=rng.uniform(-pi, pi),
        origin=far if rng.random() < 0.2 else (0.0, 0.0, 0.0),
        settings=settings,
    )


def _style(rng: Random, *piers: PierKind) -> Style:
    """Arches of a usual thickness, on piers of one of these kinds or of any."""
    kinds = piers or PIERS
    return Style(rng.uniform(0.12, 0.25), kinds[int(rng.integers(len(kinds)))])


def _bay(vault: Vault, place: Place, springing: float, style: Style, floor: float = 0.0, group: int = 0) -> Bay:
    """A bay at a place in plan; its springing is above its floor [m]."""
    return Bay(vault, Place(place.x, place.y, floor + springing, place.yaw), floor, style, group=group)


def _church(rng: Random) -> Building:
    """A nave, with or without aisles, a choir and an apse."""
    count, span, pitch = int(rng.integers(2, 6)), rng.uniform(5, 7.5), rng.uniform(3.8, 5.2)
    gap, style = rng.uniform(0.35, 0.6), _style(rng)
    high, low = rng.uniform(4.2, 5.5), rng.uniform(2.4, 2.9)
    rise = rng.uniform(0.45, 0.58) * span
    kind = str(rng.choice(["groin", "groin", "sail", "barrel"]))
    nave = bay_vault(kind, span, pitch, rise)
    places = in_row([nave] * count, HERE, gap)
    bays = [_bay(nave, place, high, style, group=int(kind == "barrel")) for place in places]
    wall = rng.uniform(0.6, 0.9)
    if kind != "barrel":
        width = rng.uniform(2.6, 4)
        aisle = bay_vault(str(rng.choice(["groin", "sail"])), width, pitch, min(0.48 * width, high - low + 0.4))
        for sign in rng.permutation([-1, 1])[: int(rng.integers(0, 3))]:
            x = sign * (span / 2 + wall + width / 2)
            bays += [_bay(aisle, at(place, x, 0.0), low, style) for place in places]
    choir = bay_vault("barrel", span - rng.uniform(0.6, 1.4), rng.uniform(3, 5), 0.5 * span)
    place = beside(nave, places[-1], "north", choir, gap, enter="south")
    if rng.random() < 0.7:
        bays.append(_bay(choir, place, high - rng.uniform(0, 0.2), style))
        conch = Conch(choir.plan.half_x - rng.uniform(0.3, 0.6))
        bays.append(_bay(conch, beside(choir, place, "north", conch, gap, enter="1"), high - 0.3, style))
    return Building("church", tuple(bays))


def _crypt(rng: Random) -> Building:
    """Bays on a grid of columns."""
    columns, rows = int(rng.integers(2, 6)), int(rng.integers(2, 6))
    widths, depths = rng.uniform(2.2, 3.4, columns), rng.uniform(2.2, 3.4, rows)
    if rng.random() < 0.6:
        widths[:], depths[:] = widths[0], depths[0]
    gap, style = rng.uniform(0.3, 0.45), _style(rng, "round", "square")
    rise, springing = 0.5 * min(widths.min(), depths.min()), rng.uniform(1.3, 1.9)
    kind = str(rng.choice(["groin", "groin", "sail"]))
    bays, x = [], 0.0
    for width in widths.tolist():
        y = 0.0
        for depth in depths.tolist():
            vault = bay_vault(kind, width, depth, rise)
            bays.append(_bay(vault, Place(x + width / 2, y + depth / 2), springing, style))
            y += depth + gap
        x += width + gap
    return Building("crypt", tuple(bays))


def _cloister(rng: Random) -> Building:
    """Two walks about a corner, and rooms off one of them at odd angles."""
    width, springing, gap = rng.uniform(2.8, 4), rng.uniform(2.4, 3), rng.uniform(0.35, 0.5)
    style, rise = _style(rng, "jambs"), rng.uniform(0.4, 0.5) * width
    corner = bay_vault(str(rng.choice(["sail", "groin"])), width, width, rise)
    bay = bay_vault("groin", width, width * rng.uniform(0.85, 1.1), rise)
    bays = [_bay(corner, HERE, springing, style)]
    for side, walk in (("north", str(rng.choice(["groin", "lunette"]))), ("east", "groin")):
        count = int(rng.integers(2, 5))
        vaults = [bay] * count if walk == "groin" else [lunettes(width, 3 * width, rise, 3)]
        place, last, leave = HERE, corner, side
        for vault in vaults:
            place = beside(last, place, leave, vault, gap, enter="south")
            last, leave = vault, "north"
            bays.append(_bay(vault, place, springing, style))
    doors = list(_rooms(bays, bays[1], "west", int(rng.integers(1, 3)), rng))
    return Building("cloister", tuple(bays), doors=tuple(doors))


def _rooms(bays: list[Bay], first: Bay, side: str, count: int, rng: Random) -> Iterator[Door]:
    """Further rooms one after the other, each turned a little, with doors between them; as many as find room."""
    last, tries = first, 0
    while count and tries < 30:
        tries += 1
        vault = room_vault(rng)
        turn = rng.uniform(-0.5, 0.5)
        ways = ("north", "east", "west", "south")
        leave = side if last is first else str(rng.choice(ways))
        enter = str(rng.choice(ways))
        along = vault.plan.half_x if enter in ("north", "south") else vault.plan.half_y
        gap = 0.5 + along * abs(sin(turn))
        place = beside(last.vault, last.place, leave, vault, gap, enter=enter, turn=turn)
        new = _bay(vault, place, rng.uniform(2.4, 3.2), last.style, last.floor)
        new = replace(new, closed=("north", "east", "west", "south"))
        try:
            check_apart([*bays, new])
        except VaultcadError:
            continue
        way = beside(last.vault, last.place, leave, Barrel(1.2, gap), 0.0, enter="south")
        yield Door(Place(way.x, way.y, last.floor, way.yaw), gap + 1.2 * abs(sin(turn)) + 0.1, rng.uniform(0.9, 1.3))
        bays.append(new)
        last, count, tries = new, count - 1, 0


def _palace(rng: Random) -> Building:
    """Rooms at angles, doors between them."""
    vault = room_vault(rng)
    bays = [_bay(vault, HERE, rng.uniform(2.4, 3.2), Style())]
    bays[0] = replace(bays[0], closed=("north", "east", "west", "south"))
    doors = list(_rooms(bays, bays[0], "north", int(rng.integers(2, 7)), rng))
    return Building("palace", tuple(bays), doors=tuple(doors))


def _crossing(rng: Random) -> Building:
    """A crossing tower between arms of barrels, one of them with an apse."""
    radius, springing, gap = rng.uniform(2.6, 3.6), rng.uniform(3.2, 4.5), rng.uniform(0.4, 0.6)
    style = _style(rng, "jambs")
    if rng.random() < 0.6:
        crossing: Vault = Cloister(
            8, radius, Semicircular(), either(rng, 0.5, 0.0, 0.3, 0.7), crossing=int(rng.integers(1, 3))
        )
    else:
        crossing = Dome(radius, drum_ratio=either(rng, 0.5, 0.0, 0.3, 0.6))
    bays = [_bay(crossing, HERE, springing, style)]
    span = 2 * radius - rng.uniform(0.6, 0.9)
    for number, side in enumerate(("north", "east", "south", "west"), 1):
        arm = Barrel(span, rng.uniform(2.5, 5))
        place, last, leave = HERE, crossing, side
        for _ in range(int(rng.integers(1, 3))):
            place = beside(last, place, leave, arm, gap, enter="south")
            bays.append(_bay(arm, place, springing, style, group=number))
            last, leave = arm, "north"
        if side == "north":
            conch = Conch(span / 2 - 0.3)
            bays.append(_bay(conch, beside(arm, place, "north", conch, gap, enter="1"), springing, style))
    return Building("crossing", tuple(bays))


def _chevet(rng: Random) -> Building:
    """A choir and its apse, and an ambulatory about it."""
    radius, wall, width = rng.uniform(2.6, 3.4), rng.uniform(0.5, 0.7), rng.uniform(2.2, 3)
    style, gap = _style(rng, "jambs"), rng.uniform(0.35, 0.5)
    high, low = rng.uniform(4.2, 5), rng.uniform(2.2, 2.6)
    conch = Conch(radius)
    x, y = conch.plan.centre
    bays = [_bay(conch, HERE, high, style)]
    choir = bay_vault(str(rng.choice(["barrel", "groin"])), 2 * radius + 0.6, rng.uniform(3.5, 5), radius + 0.3)
    last: Vault = conch
    place, leave = HERE, "1"
    for _ in range(int(rng.integers(1, 4))):
        place = beside(last, place, leave, choir, gap, enter="north")
        bays.append(_bay(choir, place, high, style, group=int(choir.id == "barrel")))
        last, leave = choir, "south"
    axis = radius + wall + width / 2
    ring = Annular(axis, width / axis, pi)
    a, b = ring.plan.centre
    bays.append(_bay(ring, Place(x - a, y - b), low, style))
    count, span = int(rng.integers(3, 6)), rng.uniform(1.1, 1.5)
    arches = []
    for k in range(count):
        angle = pi * (k + 0.5) / count
        near = sqrt(radius**2 - (span / 2 + 0.2) ** 2) - 0.05
        middle, depth = (near + radius + wall) / 2, radius + wall - near + 0.05
        there = Place(x + middle * cos(angle), y + middle * sin(angle), low - 0.2, angle - pi / 2)
        arches.append(Arch.of(Semicircular(), span, there, depth, 0.15, 0.0))
    return Building("chevet", tuple(bays), arches=tuple(arches))


def _stairs(rng: Random) -> Building:
    """Flights of stairs between landings, with a room below and one above."""
    width, gap, style = rng.uniform(1.8, 2.6), rng.uniform(0.3, 0.45), _style(rng, "jambs")
    springing, floor = rng.uniform(2.1, 2.5), 0.0
    landing = bay_vault(str(rng.choice(["groin", "sail"])), width, width, 0.5 * width)
    bays = [_bay(landing, HERE, springing, style)]
    leave = "north"
    for _ in range(int(rng.integers(1, 4))):
        flight = Barrel(width, rng.uniform(3, 5), slope=rng.uniform(0.45, 0.6))
        place = beside(bays[-1].vault, bays[-1].place, leave, flight, gap, enter="south")
        bays.append(_bay(flight, place, springing, style, floor))
        floor += flight.slope * flight.length
        place = beside(flight, place, "north", landing, gap, enter="south")
        bays.append(_bay(landing, place, springing, style, floor))
        leave = str(rng.choice(["north", "east"]))
    doors = [*_rooms(bays, bays[0], "south", 1, rng), *_rooms(bays, bays[-1 if len(bays) % 2 else -2], "west", 1, rng)]
    return Building("stairs", tuple(bays), doors=tuple(doors))


def _storeys(rng: Random) -> Building:
    """A hall of two aisles, and another above it, with no way between that is vaulted."""
    count, width, depth = int(rng.integers(2, 4)), rng.uniform(3, 4), rng.uniform(3, 4)
    gap, style, rise = rng.uniform(0.35, 0.5), _style(rng), 0.45 * min(width, depth)
    kinds = rng.choice(["groin", "sail"], 2)
    bays, floor = [], 0.0
    for kind in kinds:
        vault, springing = bay_vault(str(kind), width, depth, min(rise, 0.5 * min(width, depth))), rng.uniform(1.8, 2.8)
        for x in (0.0, width + gap):
            bays += [_bay(vault, p, springing, style, floor) for p in in_row([vault] * count, Place(x, 0.0), gap)]
        floor += springing + vault.top + rng.uniform(0.4, 0.8)
    return Building("storeys", tuple(bays))


KINDS: dict[str, Callable[[Random], Building]] = {
    "church": _church,
    "crypt": _crypt,
    "cloister": _cloister,
    "palace": _palace,
    "crossing": _crossing,
    "chevet": _chevet,
    "stairs": _stairs,
    "storeys": _storeys,
}

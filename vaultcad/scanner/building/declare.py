"""A building as people write it: a TOML file of rows, vaults, arches, piers and doors, checked key by key.

Lengths are in metres, angles in degrees. What the keys mean stands in docs/commands.md.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Any

from families import Semicircular, Vault, family, ideal
from families.catalogue import profile
from vaultcad.errors import VaultcadError
from vaultcad.scanner.building.elements import PIERS, Arch, Bay, Building, Door, Pier, Style
from vaultcad.scanner.building.place import Place
from vaultcad.scanner.building.rows import at, beside, in_row
from vaultcad.scanner.building.table import Table
from vaultcad.scanner.building.under import names
from vaultcad.scanner.settings import ScannerSettings

FAR = 1e4  # m, from the origin of a building to what stands in it
PARTS = ("row", "vault", "arch", "pier", "door")
INSTRUMENT = (
    *("points", "stations", "station_height", "noise", "ranging_error", "angle_noise", "mixed", "dropout"),
    *("registration_shift", "registration_turn", "relief", "settlement"),
)
"""The settings that a building has; the others are of a single room."""
BAY_KEYS = (
    *("name", "at", "yaw", "beside", "side", "enter", "turn", "apart", "gap", "springing", "floor", "thickness"),
    *("piers", "wall_arches", "windows", "closed"),
)


def read_building(path: Path) -> Building:
    """The building that a file declares.

    Raises:
        VaultcadError: it is no TOML, or declares what cannot be; says where, what, and the way out.
        OSError: the file cannot be read.
    """
    try:
        told = tomllib.loads(path.read_text(encoding="utf-8"))
        return declared(told, path.stem)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise VaultcadError(f"{path}: is no TOML file: {error}") from error
    except ValueError as error:
        raise VaultcadError(f"{path}: {error}") from error


def declared(told: Mapping[str, Any], name: str) -> Building:
    """The building of a file's values.

    Raises:
        ValueError: a key, a value or a name that cannot be; says where, and what can.
    """
    whole = Table(told, "the file")
    head, scanner = whole.table("building"), whole.table("scanner")
    parts = [(kind, Table(one, f"{kind} {k}")) for kind in PARTS for k, one in enumerate(whole.tables(kind), 1)]
    whole.done()
    bays: list[Bay] = []
    arches, piers, doors = [], [], []
    for number, (kind, table) in enumerate(parts, 1):
        if kind in ("row", "vault"):
            bays += _bays(table, kind, bays, number)
        elif kind == "arch":
            arches.append(_arch(table))
        elif kind == "pier":
            piers.append(_pier(table))
        else:
            doors.append(_door(table, bays))
    if not bays:
        raise ValueError("the file has no [[row]] and no [[vault]]; a building needs one at least")
    stations = scanner.places("places", FAR)
    building = Building(
        head.text("name", name),
        tuple(bays),
        tuple(arches),
        tuple(piers),
        tuple(doors),
        rods=head.flag("rods", False),
        pews=head.whole("pews", 0, 0, 1000),
        yaw=radians(head.number("yaw", 0.0, -360, 360)),
        origin=head.point("origin", (0.0, 0.0, 0.0), 1e8),
        stations=stations,
        settings=_settings(scanner, len(stations) or min(12, 2 + len(bays) // 2)),
    )
    head.done()
    return building


def _settings(table: Table, stations: int) -> ScannerSettings:
    given = {key: table.take(key) for key in INSTRUMENT if key in table.left}
    table.done(INSTRUMENT)
    for key, value in given.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"scanner: {key} = {value!r} is no number")
    try:
        return ScannerSettings(**{"stations": stations, **given})
    except ValueError as error:
        raise ValueError(f"scanner: {error}") from error


def _bays(table: Table, kind: str, others: list[Bay], number: int) -> list[Bay]:
    """One vault, or a row of equal ones."""
    name = table.text("name", table.called)
    if any(bay.name in (name, f"{name} 1") for bay in others):
        raise ValueError(f"{table.called}: name = {name!r} is that of another; give each its own")
    count = table.whole("bays", 2, 1, 100) if kind == "row" else 1
    gap = table.number("gap", 0.4, 0.0, 1.5)
    place, vault = _start(table, others, gap)
    floor, springing = place.z, table.number("springing", 3.0, 1.0, 60)
    style = Style(
        table.number("thickness", 0.2, 0.02, 1.0),
        table.choice("piers", "jambs", PIERS),
    )
    closed = table.texts("closed", names(vault))
    first = Bay(
        vault,
        replace(place, z=floor + springing),
        floor,
        style,
        closed,
        table.flag("windows", True),
        table.number("wall_arches", 0.0, 0.0, 1.0),
        number if count > 1 and vault.id == "barrel" else 0,
        name,
    )
    table.done()
    if count == 1:
        return [first]
    places = in_row([vault] * count, at(first.place, 0.0, -vault.plan.half_y), gap)
    return [replace(first, place=there, name=f"{name} {k}") for k, there in enumerate(places, 1)]


def _start(table: Table, others: list[Bay], gap: float) -> tuple[Place, Vault]:
    """Where the first one stands on its floor, and what it is."""
    neighbour = _named(table, others)
    own = {key: table.take(key) for key in BAY_KEYS if key in table.left}
    vault = _vault(table)
    table.left.update(own)
    floor = table.number("floor", neighbour.floor if neighbour else 0.0, -100, 100)
    if neighbour is None:
        x, y = table.point("at", (0.0, 0.0), FAR)
        return Place(x, y, floor, radians(table.number("yaw", 0.0, -360, 360))), vault
    side = table.choice("side", names(neighbour.vault)[0], names(neighbour.vault))
    straight = [n for n, s in zip(names(vault), vault.plan.sides, strict=True) if s.centre is None]
    if not straight:
        raise ValueError(f"{table.called}: {vault.called} has no straight side; give it a place by at = [x, y]")
    enter = table.choice("enter", straight[0], straight)
    apart = table.number("apart", gap, 0.0, 100)
    turn = radians(table.number("turn", 0.0, -90, 90))
    there = beside(neighbour.vault, neighbour.place, side, vault, apart, enter=enter, turn=turn)
    return replace(there, z=floor), vault


def _named(table: Table, others: list[Bay]) -> Bay | None:
    """The bay that `beside` names; of a row the last, if no number follows its name."""
    if "beside" not in table.left:
        return None
    name = table.text("beside", "")
    found = [bay for bay in others if name in (bay.name, bay.name.rsplit(" ", 1)[0])]
    if not found:
        known = ", ".join(bay.name for bay in others) or "none before it"
        raise ValueError(f"{table.called}: beside = {name!r} is no vault; there are {known}")
    return found[-1]


def _vault(table: Table) -> Vault:
    """Of its family, and of all keys that are the family's."""
    name = table.text("family", "")
    if not name:
        raise ValueError(f"{table.called} has no family; give it one, such as family = 'groin'")
    try:
        vault = family(name)()
        known = {*vault.profiles, *vault.values(), *vault.ratios}
        known |= {p.name for cls in _profiles(table, vault) for p in vault.with_arches(cls).parameters()}
        given = {key: table.take(key) for key in list(table.left) if key in known}
        table.done((*BAY_KEYS, "bays", *sorted(known)))
        return ideal(name, **given)
    except ValueError as error:
        told = str(error)
        raise ValueError(told if told.startswith(table.called) else f"{table.called}: {told}") from error


def _profiles(table: Table, vault: Vault) -> list[dict[str, Any]]:
    return [{key: profile(str(table.left[key]))()} for key in vault.profiles if key in table.left]


def _place(table: Table) -> Place:
    x, y = table.point("at", None, FAR)
    floor, yaw = table.number("floor", 0.0, -100, 100), table.number("yaw", 0.0, -360, 360)
    return Place(x, y, floor, radians(yaw))


def _arch(table: Table) -> Arch:
    place = _place(table)
    kind = table.text("profile", Semicircular.id)
    span = table.number("span", 1.5, 0.3, 30)
    rise = table.number("rise", span / 2, 0.05, 30)
    try:
        arch = profile(kind).over(rise / span)
    except ValueError as error:
        raise ValueError(f"{table.called}: {error}") from error
    if arch is None:
        raise ValueError(f"{table.called}: rise = {rise:g} over a span of {span:g} m is no {kind} arch; change either")
    springing = table.number("springing", 2.0, 0.3, 60)
    width, thickness = table.number("width", 0.4, 0.05, 10), table.number("thickness", 0.2, 0.02, 1.0)
    table.done()
    return Arch.of(arch, span, replace(place, z=place.z + springing), width, thickness, place.z)


def _pier(table: Table) -> Pier:
    place = _place(table)
    height, size = table.number("height", 3.0, 0.1, 60), table.number("size", 0.5, 0.05, 5)
    kind = table.choice("kind", "square", PIERS[1:])
    table.done()
    return Pier(place, place.z + height, kind, size)


def _door(table: Table, bays: list[Bay]) -> Door:
    """Through the walls beyond a side of a vault, or at a place."""
    neighbour = _named(table, bays)
    width, height = table.number("width", 1.2, 0.3, 10), table.number("height", 2.2, 0.3, 20)
    depth = table.number("depth", 0.6, 0.05, 30)
    if neighbour is None:
        place = _place(table)
    else:
        side = table.choice("side", names(neighbour.vault)[0], names(neighbour.vault))
        way = beside(neighbour.vault, neighbour.place, side, ideal("barrel", span=1, length=depth), 0.0, enter="south")
        place = replace(way, z=neighbour.floor)
    table.done()
    return Door(place, depth + 0.02, width, height)

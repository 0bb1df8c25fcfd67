"""`vaultcad scan`: the virtual scanner."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

import typer

from families import Vault
from vaultcad.cli.errors import refusing
from vaultcad.cli.family import FamilyGroup, vault_of
from vaultcad.cli.options import Bounds, Option, Seed, number, read
from vaultcad.cli.outputs import check_file
from vaultcad.scanner.settings import ScannerSettings

SUFFIXES = (".laz", ".las", ".e57", ".ply")
PANEL = "Room and scanner"
PLACE = Bounds(-1e8, 1e8, "m", "coordinate of the origin")
OTHERS = (
    Option("walls", str, "what the vault stands on: walls, or piers, open on all sides; default walls", "KIND", PANEL),
    Option("lamp", bool, "a lamp hangs from the crown; default yes", panel=PANEL),
    Option("cornice", bool, "a cornice runs along the springing; default no", panel=PANEL),
    Option("scaffold", bool, "a scaffold stands in the room; default no", panel=PANEL),
    Option("crop", bool, "keep only the vault and what is just below its springing; default no", panel=PANEL),
    Option(
        "origin",
        tuple[float, float, float],
        "floor under the middle of the plan, in file coordinates; default 0 0 0",
        "X Y Z",
        PANEL,
        lambda text: read(text, "origin", PLACE),
    ),
)
"""The settings that are no declared numbers."""


def command() -> Any:
    """The command for the program."""
    default = ScannerSettings()
    values = default.values()
    numbers = [number(p.name, p.range, values[p.name], integer=p.integer, panel=PANEL) for p in default.parameters()]
    help = "Scan a vault in a room virtually; the truth goes beside it."
    return FamilyGroup("scan", help, scan, [*numbers, *OTHERS])


def scan(
    cls: type[Vault],
    out: Annotated[Path, typer.Option("--out", "-o", help=f"File to write: {', '.join(SUFFIXES)}.")],
    declared: Mapping[str, Any],
    seed: Seed = 0,
) -> None:
    """A virtual scan, and its truth beside it."""
    check_file(out, SUFFIXES)
    vault, settings = vault_of(cls, declared), settings_of(declared)

    import numpy as np

    from vaultcad.scanner import scan as shoot
    from vaultcad.scanner import write_scan

    with refusing():  # it says so where the settings do not suit the vault
        virtual = shoot(vault, settings, rng=np.random.default_rng(seed))
    truth = write_scan(virtual, out)
    typer.echo(f"{len(virtual):,} points of {vault.called}: {out}; its truth: {truth}")


def settings_of(declared: Mapping[str, Any]) -> ScannerSettings:
    """The settings of the options that were given; others of `declared` are left alone.

    Raises:
        InputError: a value outside its range.
    """
    names = {field.name for field in fields(ScannerSettings)}
    with refusing():
        return ScannerSettings(**{name: value for name, value in declared.items() if name in names})

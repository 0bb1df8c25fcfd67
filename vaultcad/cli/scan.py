"""`vaultcad scan`: the virtual scanner."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from families import Vault
from families.declaration.ribs import RIB_KINDS
from vaultcad.cli.errors import refusing
from vaultcad.cli.family import FamilyGroup, vault_of
from vaultcad.cli.options import Bounds, Option, Seed, number, read, single
from vaultcad.cli.outputs import check_file
from vaultcad.scanner.settings import ScannerSettings

SUFFIXES = (".laz", ".las", ".e57", ".ply")
BUILDING = "--building"
PANEL = "Room and scanner"
PLACE = Bounds(-1e8, 1e8, "m", "coordinate of the origin")
OTHERS = (
    Option("walls", str, "what the vault stands on: walls, or piers, open on all sides; default walls", "KIND", PANEL),
    Option(
        "rib_kinds",
        tuple,
        f"where ribs run, of {', '.join(RIB_KINDS)}, with commas between them; default all",
        "KINDS",
        PANEL,
        lambda text: tuple(text.split(",")),
    ),
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
    help = "Scan a vault in a room virtually, or a whole building; the truth goes beside it."
    return ScanGroup("scan", help, scan, [*numbers, *OTHERS])


class ScanGroup(FamilyGroup):
    """Where a family would stand, `--building FILE` may."""

    def __init__(self, name: str, help: str, run: Callable[..., Any], further: Sequence[Option]) -> None:
        super().__init__(name, help, run, further)
        self.add_command(TyperCommand(BUILDING, help="a whole building, of the file that declares it."))

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """As options of a command of that name, which is none of a family."""
        whole = any(arg.split("=")[0] == BUILDING for arg in args)
        return super().parse_args(ctx, ["--", BUILDING, *args] if whole else args)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command of a family, or that of buildings."""
        name, *rest = args
        if name == BUILDING:
            told = single(scan_building, name, "Scan a whole building virtually; the truth goes beside it.")
            return name, told, ["--help"] if "--help" in rest else rest
        return super().resolve_command(ctx, args)


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


def scan_building(
    building: Annotated[Path, typer.Option(help="File that declares the building: .toml.", metavar="FILE")],
    out: Annotated[Path, typer.Option("--out", "-o", help=f"File to write: {', '.join(SUFFIXES)}.")],
    seed: Seed = 0,
) -> None:
    """A virtual scan of a building, and its truth beside it."""
    check_file(out, SUFFIXES, inputs=[building])

    import numpy as np

    from vaultcad.scanner import building as whole

    declared = whole.read_building(building)
    virtual = whole.scan_building(declared, rng=np.random.default_rng(seed))
    truth = whole.write_building(virtual, out)
    vaults, arches = (len(virtual.case[key]) for key in ("vaults", "arches"))
    typer.echo(f"{len(virtual):,} points; vaults: {vaults}, arches: {arches}: {out}; their truth: {truth}")


def settings_of(declared: Mapping[str, Any]) -> ScannerSettings:
    """The settings of the options that were given; others of `declared` are left alone.

    Raises:
        InputError: a value outside its range.
    """
    names = {field.name for field in fields(ScannerSettings)}
    with refusing():
        return ScannerSettings(**{name: value for name, value in declared.items() if name in names})

"""`vaultcad freecad`: the add-on for FreeCAD, put in and taken out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

ModFolder = Annotated[
    Path | None, typer.Option("--mod-folder", metavar="FOLDER", help="FreeCAD's folder for add-ons; found if left out.")
]


def command() -> Any:
    """The command for the program."""
    from typer.main import get_command

    app = typer.Typer(add_completion=False, help="The add-on for FreeCAD: docs/freecad.md shows how it is used.")
    app.command("install")(install)
    app.command("uninstall")(uninstall)
    return get_command(app)


def install(mod_folder: ModFolder = None) -> None:
    """Put the workbench VaultCad into the user's FreeCAD. Run it again after vaultcad was updated or moved."""
    from vaultcad.workbench import install as files

    target = files.install(mod_folder or files.mod_folder())
    typer.echo(f"{target}: start FreeCAD anew and choose the workbench VaultCad")


def uninstall(mod_folder: ModFolder = None) -> None:
    """Take the workbench out again. Vaults in documents keep their last shape."""
    from vaultcad.workbench import install as files

    typer.echo(f"{files.uninstall(mod_folder or files.mod_folder())}: removed")

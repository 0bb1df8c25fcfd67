"""The program itself: finds the command, runs it, and turns what goes wrong into one line and an exit code."""

from __future__ import annotations

import io
import logging
import os
import signal
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from segmentation.errors import ReadError, WriteError
from vaultcad.caches import find_caches
from vaultcad.cli.errors import InputError
from vaultcad.cli.supervise import StoppedError, supervised
from vaultcad.errors import VaultcadError

NAME = "vaultcad"
# It also tells how long the stages take.
DEBUG = "VAULTCAD_DEBUG"  # environment variable that lets exceptions through with their tracebacks
WRONG, BUG, INTERRUPTED = 2, 1, 130
HALTED = "interrupted; nothing half written is left"
THIN = "thin the scan or crop it to one bay"
REPORT = f"run again with {DEBUG}=1 and report what it prints"
COMMANDS = {
    "fit": "Fit a vault to a scan: STEP, IFC, GLB, labelled points, report.",
    "export": "Write the model of a fit again, after an edit or with another thickness.",
    "drawings": "Draw the model of a fit to scale: sections, plans, dimensions as DXF, PDF, SVG.",
    "sections": "Cut a fitted scan: profiles, their arches and how they were set out.",
    "unroll": "Lay the intrados of a fit flat: maps in true lengths; bring back what was drawn on them.",
    "segment": "Label the planes, spheres, cylinders and cones of a scan.",
    "compare": "Judge the labels of a cloud by a truth.",
    "ideal": "Points of an ideal vault, with normals and labels.",
    "scan": "Scan a vault in a room virtually; the truth goes beside it.",
    "families": "List the families of vaults and their parameters.",
    "freecad": "Put the workbench into FreeCAD, or take it out.",
    "doctor": "Say what of the installation is missing or broken.",
}


class Commands(TyperGroup):
    """Knows its commands by name and help alone; each is imported when it is the one that runs."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        for name, text in COMMANDS.items():
            self.add_command(TyperCommand(name, help=text))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The real command of the first argument, with its name and the arguments left."""
        name, _, rest = super().resolve_command(ctx, args)
        return name, import_module(f"vaultcad.cli.{name}").command(), rest


# Plain help here: the panels of rich, which the commands have, take longer to import than all the rest.
app = typer.Typer(cls=Commands, add_completion=False, rich_markup_mode=None)


def _show_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(f"{NAME} {version(NAME)}")
        raise typer.Exit


@app.callback()
def _program(
    version: bool = typer.Option(False, "--version", is_eager=True, callback=_show_version, help="Show the version."),
) -> None:
    """From laser scans of masonry vaults to BIM-ready parametric solids."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program with the given arguments; by default with those of this process, and the work in another one.

    Returns the exit code. 0: done. 1: the doctor found something, or an error of vaultcad's own. 2: wrong input, or not
    enough memory. 130, 143, 129: stopped by Ctrl-C, a request to end, the terminal's end.
    """
    if os.environ.get(DEBUG):
        logging.basicConfig(level=logging.INFO, format="%(name)s: %(message)s")
    for stream in (sys.stdout, sys.stderr):  # names of files are bytes, and need not be text of this terminal
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    find_caches()
    if arguments is not None or os.environ.get(DEBUG):
        return _run(list(sys.argv[1:] if arguments is None else arguments))
    try:
        return supervised(lambda: _run(sys.argv[1:]))
    except StoppedError as stop:
        if stop.asked:
            return _complain(HALTED, stop.code)
        if stop.signal == signal.SIGKILL:
            return _complain(f"killed by the system, as it does when memory runs out; {THIN}", WRONG)
        return _complain(f"error in vaultcad itself ({stop}); {REPORT}", BUG)


def _run(arguments: Sequence[str]) -> int:
    given = list(arguments) or ["--help"]
    try:
        code = get_command(app).main(args=given, prog_name=NAME, standalone_mode=False)
    except typer.TyperException as error:
        return _complain(_usage(error), WRONG)
    except (InputError, ReadError, VaultcadError) as error:
        return _complain(str(error), WRONG)
    except OSError as error:
        return _complain(_os_error(error), WRONG)
    except MemoryError:
        return _complain(f"not enough memory; {THIN}", WRONG)
    except Exception as error:
        if os.environ.get(DEBUG):
            raise
        what = f"{type(error).__name__}: {error}"
        return _complain(f"error in vaultcad itself ({what}); {REPORT}", BUG)
    if code == INTERRUPTED:  # typer makes this of a KeyboardInterrupt
        return _complain(HALTED, INTERRUPTED)
    return code or 0


def _complain(message: str, code: int) -> int:
    """One line on standard error, whatever the message."""
    typer.echo(f"{NAME}: {' '.join(message.split())}", err=True)
    return code


def _usage(error: typer.TyperException) -> str:
    """What typer says of a command that makes no sense to it, and where to read how it is meant."""
    said = error.format_message().replace("Value error, ", "").rstrip(".")
    context = getattr(error, "ctx", None)
    return f"{said}; see {context.command_path if context else NAME} --help"


def _os_error(error: OSError) -> str:
    if error.filename is None or isinstance(error, WriteError):
        return str(error)
    return f"{error.filename}: {error.strerror}; check the path, its permissions and the space left"

"""The options of commands that read a scan: how its file is to be understood."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from vaultcad.cli.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from segmentation.cloud import Cloud, Up
    from segmentation.io.chunk import Progress
    from segmentation.notes import Note

DOUBTFUL = ("unit-assumed", "columns", "precision")  # codes of notes that tell why a scan may hold no vault
UPRIGHT = (".e57", ".las", ".laz", ".ptx")  # suffixes of formats in which z is up; others come from phones, too
FARTHEST = 1e9  # m, of an origin, so that what is none is told at once
Unit = Annotated[
    Literal["m", "cm", "mm", "ft", "ftUS", "in"] | None,
    typer.Option(help="Unit of the scan; by default what the file states, else metres if rooms can have that size."),
]
Columns = Annotated[
    str | None,
    typer.Option(metavar="NAMES", help="What the columns of a text hold, as y,x,z,-,r,g,b,intensity; - for none."),
]
Origin = Annotated[
    tuple[float, float, float] | None,
    typer.Option(
        metavar="X Y Z",
        help="Origin of STEP, GLB and IFC [m]; by default 0 0 0, or whole kilometres for projected coordinates.",
    ),
]
KeepMarked = Annotated[
    bool, typer.Option("--keep-marked", help="Use points that the file marks as noise, withheld, synthetic or invalid.")
]


def read_scan(
    scan: Path,
    *,
    up: Up,
    unit: str | None,
    columns: str | None,
    origin: tuple[float, float, float] | None,
    keep_marked: bool,
    progress: Progress,
) -> Cloud:
    """The scan as the options say.

    Raises:
        ReadError: it cannot be read, or not so.
        InputError: an option does not suit the file.
    """
    from segmentation.io.formats import READERS, read

    if origin is not None and not all(abs(v) <= FARTHEST for v in origin):
        raise InputError(f"--origin {' '.join(f'{v:g}' for v in origin)}: is no place on earth; give metres")
    if columns is not None and not is_text(scan) and scan.suffix.lower() in READERS:
        texts = ", ".join(suffix for suffix in READERS if is_text(scan.with_suffix(suffix)))
        raise InputError(f"--columns {columns}: {scan.suffix} files name their own; it is for {texts}")
    return read(scan, up=up, unit=unit, columns=columns, origin=origin, keep_marked=keep_marked, progress=progress)


def is_text(scan: Path) -> bool:
    """Whether it is a text, whose columns may mean anything."""
    from segmentation.io.formats import READERS
    from segmentation.io.text import read_text

    return READERS.get(scan.suffix.lower()) is read_text


def has_up(scan: Path) -> bool:
    """Whether the format of a scan says that z is up."""
    return scan.suffix.lower() in UPRIGHT


def doubts(notes: Iterable[Note]) -> list[str]:
    """What was assumed of a scan, where that may be why nothing was found in it."""
    return [note.text for note in notes if note.code in DOUBTFUL]


def show_notes(notes: Iterable[Note]) -> None:
    """One line each on standard error."""
    for note in notes:
        typer.echo(f"vaultcad: {note.text}", err=True)

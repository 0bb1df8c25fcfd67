"""Where results may go: checked before the work starts, so that no one waits for an error."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path

import typer

from vaultcad.cli.errors import InputError


def check_file(out: Path, suffixes: Iterable[str], *, inputs: Iterable[Path] = ()) -> None:
    """Whether a file can be written there.

    Raises:
        InputError: the suffix is none of those known, the folder is not there or not to be written to, something that
            is no file is in the way, or it is one of the files that are read.
    """
    known = ", ".join(suffixes)
    if out.suffix.lower() not in known.split(", "):
        raise InputError(f"{out}: unknown suffix {out.suffix!r}; name a file that ends in one of {known}")
    if out.exists() and not out.is_file():
        raise InputError(f"{out}: is a folder; name a file in it")
    for path in inputs:
        if out.exists() and path.exists() and out.samefile(path):
            raise InputError(f"{out}: is the file that is read; name another")
    if not out.parent.exists():
        raise InputError(f"{out}: there is no folder {out.parent}; make it first")
    _check_writable(out, out.parent)


def check_folder(
    out: Path, *, inputs: Iterable[Path] = (), review: bool = False, force: bool = False, more: Iterable[str] = ()
) -> None:
    """Whether a result, with or without a review, and with `more` files can be put into that folder.

    Raises:
        ExportError: a file is in the way, or a folder with something else than an earlier result, or, without `force`,
            with what would be lost.
        InputError: there is no place for it, or it would replace a file that is read.
    """
    from vaultcad.export.bundle import REVIEW, WRITERS
    from vaultcad.labelled_scan import SEGMENTS

    check_result(out, [*WRITERS, SEGMENTS, *([REVIEW] if review else []), *more], inputs=inputs, force=force)


def check_result(out: Path, names: Sequence[str], *, inputs: Iterable[Path] = (), force: bool = False) -> None:
    """Whether a result of files with these names can be put into that folder; raises as `check_folder` does."""
    from vaultcad.export.folder import check_target

    for path in inputs:
        if path.is_dir() and out.exists() and path.samefile(out):
            raise InputError(f"{path}: would be replaced by the result; name another folder than {out}")
        if any((out / name).exists() and path.exists() and path.samefile(out / name) for name in names):
            raise InputError(f"{path}: would be replaced by the result; name another folder than {out}")
    check_target(out, names, force=force)
    real = Path(os.path.realpath(out))
    _check_writable(out, next(folder for folder in real.parents if folder.exists()))


def show_kept(kept: Path | None) -> None:
    """One line on standard error about an earlier result that a person changed while its successor was made."""
    if kept is not None:
        typer.echo(f"vaultcad: the earlier result had been changed meanwhile; it is kept as {kept}", err=True)


def _check_writable(out: Path, folder: Path) -> None:
    if not folder.is_dir():
        raise InputError(f"{out}: {folder} is no folder; name another")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{out}: the folder {folder} may not be written to; name another")

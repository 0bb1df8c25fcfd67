"""Where results may go: checked before the work starts, so that no one waits for an error."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

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
    folder = out.parent
    if not folder.is_dir():
        raise InputError(f"{out}: there is no folder {folder}; make it first")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{out}: the folder {folder} may not be written to; choose another")

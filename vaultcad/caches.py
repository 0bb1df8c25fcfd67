"""Where libraries keep what they have compiled or looked up, for accounts that have no home."""

from __future__ import annotations

import os
import stat
import tempfile
from contextlib import suppress
from pathlib import Path


def find_caches() -> None:
    """If the user's own folder for caches cannot be written to, name a private one in the environment.

    numba, matplotlib and fontconfig look there; numba fails, the others warn, where they find none. To be called before
    they are imported. What others could have written is not taken, for compiled code is run as it is.
    """
    if not hasattr(os, "geteuid"):  # Windows, where every account has such a folder
        return
    given = Path(os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache"))
    if given.is_absolute() and _writable(given):  # without a home it is no path but ~
        return
    folder = Path(tempfile.gettempdir()) / f"vaultcad-{os.geteuid()}"
    with suppress(OSError):
        folder.mkdir(0o700, exist_ok=True)
    if not _private(folder):
        folder = Path(tempfile.mkdtemp(prefix="vaultcad-"))
    os.environ["XDG_CACHE_HOME"] = str(folder)
    os.environ.setdefault("MPLCONFIGDIR", str(folder / "matplotlib"))


def _writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK | os.X_OK)


def _private(folder: Path) -> bool:
    """Whether it is a folder of this user's, no link, that nobody else may write to."""
    try:
        found = folder.lstat()
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.geteuid() and not found.st_mode & 0o077

"""Files that appear whole or not at all."""

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from segmentation.errors import WriteError
from segmentation.temporary import announce

LIBRARIES = ("lazrs", "laspy", "pye57")
"""What writes for us, and has exceptions of its own for a disk that is full."""
LITTLE = 1 << 20
"""Bytes left on a disk that is called full."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path beside `path`, of the same suffix, to write to; it takes the place of `path` at the end.

    It is a new, empty file whose name nobody can foresee, so that no link of a stranger's is followed. If the body
    raises, it is removed and what was at `path` stays as it was. Raises WriteError, see `writing`.
    """
    beside = path.with_name(f".vaultcad-{secrets.token_hex(8)}{path.suffix}")
    announce(beside)
    with writing(path):
        os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        try:
            yield beside
            os.replace(beside, path)
        finally:
            beside.unlink(missing_ok=True)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """In the body `path` is written, under whatever name.

    Raises WriteError where the system or a library that writes says that it cannot be.
    """
    try:
        yield
    except WriteError as error:
        raise WriteError(path, error.reason) from error
    except Exception as error:
        ours = not isinstance(error, OSError) and type(error).__module__.split(".")[0] not in LIBRARIES
        if ours or isinstance(error, FileNotFoundError):
            raise
        raise WriteError(path, _reason(path, error)) from error


def _reason(path: Path, error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    if shutil.disk_usage(path.absolute().parent).free < LITTLE:
        return "No space left on device"
    return str(error).splitlines()[0] if str(error) else type(error).__name__

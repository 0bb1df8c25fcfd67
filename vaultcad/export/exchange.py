"""What is asked of the system about folders: to change places in one step, to be locked, to outlast a power cut."""

from __future__ import annotations

import ctypes
import errno
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

SWAPPED = ".swapped"  # ends the stem of the name under which a folder waits where there is no step for both
NAME_MAX = 255  # bytes that most file systems allow a name
HERE, EXCHANGE = -100, 2  # AT_FDCWD and RENAME_EXCHANGE of linux/fs.h
UNABLE = {errno.ENOSYS, errno.EINVAL, errno.ENOTSUP, errno.EPERM}  # of a file system that knows no exchange


def exchange(one: Path, other: Path) -> None:
    """Let two folders of the same parent change their names, in one step where the system can.

    Where it cannot, `other` is away for the moment between two steps; it waits under the name of `one`, with SWAPPED
    before its suffix, so that whoever finds it can put it back.

    Raises:
        OSError: the system refuses; both are where they were.
    """
    sys.audit("os.rename", str(one), str(other))
    swap = _swap()
    if swap is not None:
        if swap(HERE, os.fsencode(one), HERE, os.fsencode(other), EXCHANGE) == 0:
            return
        code = ctypes.get_errno()
        if code not in UNABLE:
            raise OSError(code, os.strerror(code), str(other))
    waiting = one.with_name(f"{one.stem}{SWAPPED}{one.suffix}")
    os.rename(other, waiting)
    try:
        os.rename(one, other)
    except OSError:
        os.rename(waiting, other)
        raise
    os.rename(waiting, one)


@cache
def _swap() -> Any:
    """The C library's renameat2 (Linux 3.15, glibc 2.28), or None."""
    if not sys.platform.startswith("linux"):
        return None
    call = getattr(ctypes.CDLL(None, use_errno=True), "renameat2", None)
    if call is not None:
        call.argtypes = [ctypes.c_int, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_uint]
    return call


@contextmanager
def locked(folder: Path, *, wait: bool = True) -> Iterator[bool]:
    """Whether the folder is locked for this process in the body; False too where folders cannot be locked.

    The system itself takes the lock away when the process ends, however it ends.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        yield False
        return
    fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        try:
            fcntl.flock(fd, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except OSError:
            yield False
        else:
            yield True
    finally:
        os.close(fd)


def settle(folder: Path) -> None:
    """See the files of a folder, of those within it, and its own list of them, safe on the disk.

    Raises:
        OSError: the disk is full or broken.
    """
    for path in sorted(folder.iterdir()):
        if path.is_dir() and not path.is_symlink():
            settle(path)
        elif path.is_file() and not path.is_symlink():
            _sync(path)
    sync_folder(folder)


def sync_folder(folder: Path) -> None:
    """See the names in a folder safe on the disk, where the system has that for folders."""
    with suppress(OSError):
        _sync(folder)


def _sync(path: Path) -> None:
    fd = os.open(path, os.O_RDONLY)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


def is_mounted(folder: Path) -> bool:
    """Whether a disk, or a folder from elsewhere, is mounted there."""
    if os.path.ismount(folder):
        return True
    with suppress(OSError):  # where there is such a list, one mounted from the same disk stands in it alone
        mounts = Path("/proc/self/mountinfo").read_bytes().splitlines()
        return any(_unescaped(line.split()[4]) == os.fsencode(folder) for line in mounts)
    return False


def _unescaped(name: bytes) -> bytes:
    return re.sub(rb"\\([0-7]{3})", lambda found: bytes([int(found[1], 8)]), name)


def longest_name(folder: Path) -> int:
    """Bytes that a name in a folder may have."""
    try:
        return os.pathconf(folder, "PC_NAME_MAX")
    except (OSError, ValueError, AttributeError):  # it is not there yet, or the system does not tell
        return NAME_MAX

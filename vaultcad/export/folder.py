"""A result's folder, which changes as one thing: whole as it was, or whole as it is now.

The new one is made beside it, under a name that nobody can foresee; then the two change places. What others have put
into the folder goes along. A marker tells which files are ours.
"""

from __future__ import annotations

import os
import platform
import re
import shutil
import time
from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from secrets import token_hex

from segmentation.io.whole import writing
from segmentation.temporary import announce
from vaultcad.errors import ExportError
from vaultcad.export.exchange import SWAPPED, exchange, is_mounted, locked, longest_name, settle, sync_folder
from vaultcad.export.marker import (
    MARKER,
    UNFINISHED,
    UNMARKED,
    is_folder,
    losses,
    mark,
    marked,
    names_in,
    of_another_kind,
    of_others,
)

ENDING = ".part"  # of the names of such folders
GONE = ".gone"  # before that ending, of those of which nothing is to be kept
OLD_PART = re.compile(r"\d+")  # what then stood between name and ending: the number of the process
PART = re.compile(r"[0-9a-f]{16}")  # and what stands there now
ROOM = 32  # bytes of a name that these take
DAY = 86_400.0  # s


@dataclass
class Place:
    """Where a result is made. part: the folder to write to. kept: where an earlier one is that a person had changed."""

    part: Path
    kept: Path | None = None


def check_target(out: Path, names: Collection[str], *, force: bool = False) -> None:
    """See that a result of files with these names may take the place of `out`, before the work that leads to it.

    Only a result of the same kind is replaced: sections do not do away with the fit that they are of.

    Raises:
        ExportError: something else is there, or, without `force`, what would be lost; names it and the way out.
    """
    real = _real(out)
    if len(os.fsencode(real.name)) + ROOM > longest_name(real.parent):
        raise ExportError(f"{out}: the name is too long; name a folder with a shorter one with -o")
    if not out.exists():
        return
    if not out.is_dir():
        raise ExportError(f"{out} is a file; name a folder for the result with -o")
    if is_mounted(real) or _real(Path()).is_relative_to(real):
        what = "where a disk is mounted" if is_mounted(real) else "the folder that you are in"
        raise ExportError(f"{out} is {what} and cannot be replaced as a whole; name a folder in it, as {out}/result")
    ours = marked(real)
    if ours is None and any(real.iterdir()):
        raise ExportError(f"{out} holds other files and no earlier result; name a new or empty folder with -o")
    if other := of_another_kind({*(ours or ())} - {MARKER}, {*names}):
        raise ExportError(f"{out} holds another kind of result, with {other}; name another folder with -o")
    lost = () if force else losses(real, names)
    if lost:
        name, why = lost[0]
        raise ExportError(f"{out / name} {why} and would be lost; name another folder with -o, or say --force")


@contextmanager
def replacing_folder(out: Path, *, force: bool = False) -> Iterator[Place]:
    """A folder beside `out` to write to, which takes its place at the end; if the body raises, all is as it was.

    Folders above it are made, and gone if the body raises. force: whether what a person has changed in an earlier
    result is given up; else that one is kept, under another name.

    Raises:
        ExportError: no folder can be made there, or it cannot take the place of `out` and is beside it, which is said.
        WriteError: the disk is full, or the system refuses for another reason.
    """
    out = _real(out)
    made = [folder for folder in out.parents if not folder.exists()]
    place = Place(out.with_name(f".{out.name}.{token_hex(8)}{ENDING}"))
    done = False
    try:
        with ExitStack() as mine:
            _make(place.part, out, made, mine)
            yield place
            with writing(out):
                mark(place.part)
                settle(place.part)
            with writing(out), locked(out.parent):
                mode = out.stat().st_mode & 0o7777 if out.exists() else None
                _carry_along(out, place.part)
                (place.part / UNFINISHED).unlink()
                if mode is not None:
                    place.part.chmod(mode | 0o700)
                done = True
                _take_place(place.part, out)
                if mode is not None:
                    place.kept = _retire(place.part, out, force=force)
                    out.chmod(mode)
        clear(out)
    finally:
        if not done:
            _discard(place.part)
            for folder in made:
                with suppress(OSError):
                    folder.rmdir()


def clear(out: Path) -> None:
    """Take away what processes that are dead left beside `out`; what others had put into a result goes back to it."""
    out = _real(out)
    if not out.parent.is_dir():
        return
    with locked(out.parent) as alone:
        for part in sorted(out.parent.iterdir()) if alone else ():
            if target(part) == out and part.is_dir() and not part.is_symlink():
                with locked(part, wait=False) as dead:
                    if dead and not _is_elsewhere(part):
                        _clear(part, out)


def target(part: Path) -> Path | None:
    """Whose place a folder was to take, by its name; None if it is no such folder."""
    name, _, token = part.stem.removesuffix(SWAPPED).removesuffix(GONE).rpartition(".")
    ours = part.suffix == ENDING and name[:1] == "." and (PART.fullmatch(token) or OLD_PART.fullmatch(token))
    return part.with_name(name[1:]) if ours and name[1:] else None


def _clear(part: Path, out: Path) -> None:
    ours = marked(part)
    there = {path.name for path in part.iterdir()}
    if UNFINISHED in there or part.stem.endswith(GONE):
        _discard(part)
    elif ours is not None and {*ours} <= {*names_in(part)} and not out.exists():
        os.rename(part, out)  # the process died while they changed places
    elif ours is not None and out.is_dir():
        _retire(part, out)
    elif OLD_PART.fullmatch(part.stem.rpartition(".")[2]) and there <= {*UNMARKED, "review.png"}:
        _discard(part)
    elif not there:
        part.rmdir()


def _retire(part: Path, out: Path, *, force: bool = False) -> Path | None:
    """Do away with a result that another has taken the place of; where it is kept, if a person had changed it."""
    new = marked(out) or {}
    if not force and losses(part, new):
        return _named(part, out.with_name(f"{out.name}-before"))
    for name in of_others(part, {*(marked(part) or {}), *new}):
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        _give_back(part / name, out / name)
    _discard(part)
    return None


def _discard(part: Path) -> None:
    """Remove a folder; its name says so first, for whoever finds the half of it."""
    gone = part if part.stem.endswith(GONE) else part.with_name(f"{part.stem}{GONE}{ENDING}")
    with suppress(OSError):
        part.chmod(0o700)
        os.rename(part, gone)
    shutil.rmtree(gone if gone.exists() else part, ignore_errors=True)


def _make(part: Path, out: Path, made: list[Path], locks: ExitStack) -> None:
    """Make the folder that is written to, locked, and those above it, `made`, which come with the innermost first."""
    try:
        for folder in reversed(made):
            announce(folder)
            folder.mkdir(exist_ok=True)
        clear(out)
        announce(part)
        with locked(out.parent):
            part.mkdir()
            (part / UNFINISHED).write_text(platform.node(), encoding="utf-8")
            locks.enter_context(locked(part))
    except OSError as error:
        raise ExportError(f"{out} cannot be made ({error.strerror}); name another folder with -o") from error


def _is_elsewhere(part: Path) -> bool:
    """Whether another computer may be writing to it: its locks need not be seen here."""
    with suppress(OSError):
        told = (part / UNFINISHED).read_text(encoding="utf-8", errors="replace")
        return told not in ("", platform.node()) and time.time() - part.stat().st_mtime < DAY
    return False


def _carry_along(out: Path, part: Path) -> None:
    """What others have put into `out` is in `part` too; their files are there once, under two names.

    What cannot have two names moves later, see `_retire`.
    """
    if not out.is_dir():
        return
    for name in of_others(out, {*(marked(out) or {}), *names_in(part)}):
        with suppress(OSError):
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            _link(out / name, part / name)


def _link(path: Path, to: Path) -> None:
    if is_folder(path):
        to.mkdir()
        shutil.copystat(path, to)
        for inner in sorted(path.iterdir()):
            _link(inner, to / inner.name)
    else:
        os.link(path, to, follow_symlinks=False)


def _take_place(part: Path, out: Path) -> None:
    """Afterwards `out` is what `part` was, and `part`, if there was one, what `out` was."""
    try:
        if out.exists():
            exchange(part, out)
        else:
            os.rename(part, out)
    except OSError as error:
        beside = _named(part, out.with_name(f"{out.name}-new"))
        why = f"{out} cannot be replaced ({error.strerror})"
        raise ExportError(f"{why}: the new result is in {beside}; name another folder with -o next time") from error
    sync_folder(out.parent)


def _give_back(path: Path, to: Path) -> None:
    """Move what others have put into a folder that was replaced to the new one, but for what is there already."""
    if is_folder(path) and to.is_dir():
        for inner in sorted(path.iterdir()):
            _give_back(inner, to / inner.name)
    elif not os.path.lexists(to) or path.lstat().st_mtime_ns > to.lstat().st_mtime_ns:
        os.replace(path, to)


def _named(part: Path, name: Path) -> Path:
    """Put a result under a name of its own, with a number."""
    number = 1
    while os.path.lexists(numbered := name.with_name(f"{name.name}-{number}")):
        number += 1
    os.rename(part, numbered)
    return numbered


def _real(out: Path) -> Path:
    return Path(os.path.realpath(out))

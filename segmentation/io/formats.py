"""Which reader reads which file, and `read`."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from segmentation.cloud import AXES, Cloud, Up
from segmentation.errors import ReadError
from segmentation.io.assemble import assemble
from segmentation.io.chunk import Chunk, Progress
from segmentation.io.e57 import read_e57
from segmentation.io.facts import Facts
from segmentation.io.las import read_las
from segmentation.io.pcd import read_pcd
from segmentation.io.ply import read_ply
from segmentation.io.ptx import read_ptx
from segmentation.io.text import read_text
from segmentation.units import UNITS

Reader = Callable[[Path, Facts], Iterator[Chunk]]
READERS: dict[str, Reader] = {
    ".e57": read_e57,
    ".las": read_las,
    ".laz": read_las,
    ".pcd": read_pcd,
    ".ply": read_ply,
    ".ptx": read_ptx,
    **dict.fromkeys((".xyz", ".txt", ".asc", ".pts", ".csv"), read_text),
}
SIGNATURES = {
    b"ASTM-E57": (".e57",),
    b"LASF": (".las", ".laz"),
    b"ply": (".ply",),
    b"# .PCD": (".pcd",),
    b"VERSION": (".pcd",),
}
"""First bytes of a file, and the suffixes that go with them."""
UNSIGNED = (".pcd",)
"""Files that may begin with something else: PCD with another comment, or none."""


def read(
    path: Path | str,
    *,
    up: Up = "z",
    unit: str | None = None,
    columns: str | None = None,
    origin: Sequence[float] | None = None,
    keep_marked: bool = False,
    progress: Progress | None = None,
) -> Cloud:
    """A scan as a Cloud: in metres, Z up, local where coordinates are large; its `notes` tell what was assumed.

    path: a file with one of the suffixes of READERS. up: the axis that is up in it, one of `segmentation.cloud.AXES`.
    unit: one of `segmentation.units.UNITS`; by default what the file states, else metres, if a scan of rooms can have
    that size. columns: what the columns of a text hold, as "y,x,z,-". origin: (3,) of the local frame [m], Z up; by
    default zero or, for coordinates beyond 10 km, rounded to whole kilometres. keep_marked: whether points that the
    file calls noise, withheld, synthetic or invalid are used all the same. progress: called with the share read so far,
    0..1.
    Points far from all others are set aside. Raises ReadError (a ValueError) if the file is missing, empty, truncated,
    no point cloud or without valid points, or if it is not clear what its numbers are; ValueError for a keyword.

    >>> cloud = read("examples/room.laz")
    >>> len(cloud), cloud.xyz.shape, cloud.origin.tolist()
    (350456, (350456, 3), [0.0, 0.0, 0.0])
    >>> [note.code for note in cloud.notes]
    ['unit-assumed']
    """
    path = Path(path)
    if up not in AXES:
        raise ValueError(f"up = {up!r} is not one of {', '.join(AXES)}")
    if unit is not None and unit not in UNITS:
        raise ValueError(f"unit = {unit!r} is not one of {', '.join(UNITS)}")
    if origin is not None and (len(origin) != 3 or not np.isfinite(origin).all()):
        raise ValueError(f"origin = {tuple(origin)} is no place: give x, y and z in metres")
    reader, facts = reader_of(path), Facts()
    if columns is not None:
        if reader is not read_text:
            raise ValueError(f"columns = {columns!r}: {path.suffix} files name theirs; leave it out")
        reader = partial(read_text, columns=columns)
    # what a stranger's file holds may be NaN or overflow, which is judged by what comes of it
    with np.errstate(invalid="ignore", over="ignore"):
        return assemble(
            reader(path, facts),
            path,
            facts,
            up=up,
            unit=unit,
            origin=None if origin is None else np.asarray(origin, np.float64),
            keep_marked=keep_marked,
            progress=progress,
        )


def reader_of(path: Path) -> Reader:
    """The reader for a file. Raises ReadError if it is none that can be read, judged by name and first bytes."""
    known = ", ".join(READERS)
    if not path.exists():
        raise ReadError(path, "no such file", "check the path")
    if path.is_dir():
        raise ReadError(path, "is a folder", f"name a file in it ({known})")
    if not path.is_file():
        raise ReadError(path, "is no file but a pipe, a device or a socket", "give a file that is stored on a disk")
    suffix = path.suffix.lower()
    if suffix not in READERS:
        raise ReadError(path, f"unknown suffix {suffix!r}", f"export the scan as one of {known}")
    try:
        with path.open("rb") as file:
            head = file.read(16)
    except OSError as error:
        raise ReadError(path, f"cannot be opened ({error.strerror})", "check its permissions") from error
    if not head:
        raise ReadError(path, "is empty", "export the scan again")
    own = [s for s, suffixes in SIGNATURES.items() if suffix in suffixes]
    other = next((suffixes for s, suffixes in SIGNATURES.items() if head.startswith(s) and s not in own), None)
    if other:
        raise ReadError(path, f"is a {other[0]} file by its content", f"rename it to {other[0]}")
    if own and suffix not in UNSIGNED and not head.startswith(tuple(own)):
        raise ReadError(path, f"is no {suffix} file by its first bytes", f"export the scan again as one of {known}")
    return READERS[suffix]

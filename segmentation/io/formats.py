"""Which reader reads which file, and `read`."""

from collections.abc import Callable, Iterator
from pathlib import Path

from segmentation.cloud import AXES, Cloud, Up
from segmentation.errors import ReadError
from segmentation.io.chunk import Chunk, Progress, assemble
from segmentation.io.e57 import read_e57
from segmentation.io.las import read_las
from segmentation.io.pcd import read_pcd
from segmentation.io.ply import read_ply
from segmentation.io.text import read_text

Reader = Callable[[Path], Iterator[Chunk]]
READERS: dict[str, Reader] = {
    ".e57": read_e57,
    ".las": read_las,
    ".laz": read_las,
    ".pcd": read_pcd,
    ".ply": read_ply,
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


def read(path: Path | str, *, up: Up = "z", progress: Progress | None = None) -> Cloud:
    """A scan as a Cloud: invalid points dropped, Z up, shifted to a local origin where coordinates are large.

    path: a file with one of the suffixes of READERS. up: the axis that is up in it, one of `segmentation.cloud.AXES`.
    progress: called with the share read so far, 0..1.
    Raises ReadError (a ValueError) if the file is missing, empty, truncated, no point cloud or without valid points.
    """
    path = Path(path)
    if up not in AXES:
        raise ValueError(f"up = {up!r} is not one of {', '.join(AXES)}")
    return assemble(reader_of(path)(path), path, up=up, progress=progress)


def reader_of(path: Path) -> Reader:
    """The reader for a file. Raises ReadError if it is none that can be read, judged by name and first bytes."""
    known = ", ".join(READERS)
    if not path.exists():
        raise ReadError(path, "no such file", "check the path")
    if path.is_dir():
        raise ReadError(path, "is a folder", f"name a file in it ({known})")
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
    if own and not head.startswith(tuple(own)):
        raise ReadError(path, f"is no {suffix} file by its first bytes", f"export the scan again as one of {known}")
    return READERS[suffix]

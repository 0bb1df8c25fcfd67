"""PLY (Turk 1994), ascii and binary: the vertices, with any properties; faces are left alone."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.chunk import SIZE, Chunk
from segmentation.io.records import XYZ, chunk_of, from_table
from segmentation.io.table import Rows

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float": "f4", "double": "f8", "float32": "f4", "float64": "f8",
}  # fmt: skip
ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
WAY_OUT = "export the scan again as PLY, E57 or LAZ"


@dataclass(frozen=True)
class Layout:
    """Where the vertices lie in a file, and how."""

    ascii: bool
    start: int
    """Bytes before the first vertex; in an ascii file bytes before the data."""
    skip: int
    """Lines before the first vertex, in an ascii file."""
    count: int
    dtype: np.dtype[np.void]


def read_ply(path: Path) -> Iterator[Chunk]:
    """The vertices with normals, colour, intensity and classification where there are such properties.

    Raises ReadError if the header makes no sense or vertices are missing.
    """
    layout = _layout(path)
    for values, done in (_ascii if layout.ascii else _binary)(path, layout):
        yield chunk_of(values, done)


def _layout(path: Path) -> Layout:
    """What the header says of the vertices. Elements before them must be of fixed size."""
    with path.open("rb") as file:
        lines: list[list[str]] = []
        while ["end_header"] not in lines:
            line = file.readline(10_000)
            if not line or len(lines) > 10_000:
                raise ReadError(path, "has no whole PLY header", WAY_OUT)
            lines.append(line.decode("latin-1").split())
        start = file.tell()
    order, encoding, skip = "", "", 0
    name, count = "", 0
    fields: list[tuple[str, str]] = []
    try:
        for words in lines:
            match words:
                case ["format", kind, *_]:
                    encoding, order = kind, ORDERS[kind]
                case ["element", *_] | ["end_header"] if name == "vertex":
                    break
                case ["element", new, number]:
                    start += 0 if encoding == "ascii" else count * np.dtype(fields).itemsize
                    skip += count
                    name, count, fields = new, int(number), []
                case ["property", "list", *_]:
                    raise ReadError(path, f"has a list among or before its vertices (element {name!r})", WAY_OUT)
                case ["property", kind, field]:
                    fields.append((field, order + TYPES[kind]))
        if count < 0:
            raise ValueError(f"{count} vertices")
        layout = Layout(encoding == "ascii", start, skip, count, np.dtype(fields))
    except (KeyError, ValueError) as error:
        if isinstance(error, ReadError):
            raise
        raise ReadError(path, f"its PLY header makes no sense ({error})", WAY_OUT) from error
    if name != "vertex" or not set(XYZ) <= set(layout.dtype.names or ()):
        raise ReadError(path, "has no vertices with x, y and z", WAY_OUT)
    return layout


def _binary(path: Path, layout: Layout) -> Iterator[tuple[NDArray[np.void], float]]:
    """Vertices as a structured array, chunk by chunk."""
    have = (path.stat().st_size - layout.start) // layout.dtype.itemsize
    if have < layout.count:
        raise _truncated(path, layout.count, max(have, 0))
    with path.open("rb") as file:
        file.seek(layout.start)
        for at in range(0, layout.count, SIZE):
            values = np.fromfile(file, layout.dtype, min(SIZE, layout.count - at))
            yield values, (at + len(values)) / layout.count


def _ascii(path: Path, layout: Layout) -> Iterator[tuple[NDArray[np.void], float]]:
    """Vertices as a structured array, chunk by chunk."""
    rows = Rows(path, len(layout.dtype.names or ()), start=layout.start, skip=layout.skip, limit=layout.count)
    have = 0
    for table in rows:
        have += len(table)
        yield from_table(table, layout.dtype), have / layout.count
    if have < layout.count:
        raise _truncated(path, layout.count, have)


def _truncated(path: Path, promised: int, have: int) -> ReadError:
    return ReadError(path, f"is truncated: {have} of {promised} points are there", "copy it again from where it comes")

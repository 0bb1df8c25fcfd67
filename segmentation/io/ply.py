"""PLY (Turk 1994), ascii and binary: the vertices, with any properties; faces are left alone."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.chunk import SIZE, Chunk
from segmentation.io.facts import Facts
from segmentation.io.records import XYZ, chunk_of, from_table, unique
from segmentation.io.table import Rows, opened

TYPES = {
    "char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4",
    "float": "f4", "double": "f8", "float32": "f4", "float64": "f8",
}  # fmt: skip
ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
MOST = 1 << 40
"""Records that no file holds."""
WAY_OUT = "export the scan again as PLY, E57 or LAZ"
Values = Iterator[tuple[NDArray[np.void], float]]


@dataclass(frozen=True)
class Property:
    """One property of an element: the type of its values and, of a list, that of the number before them."""

    name: str
    kind: np.dtype[np.generic]
    length: np.dtype[np.generic] | None = None


@dataclass(frozen=True)
class Element:
    """One element of a file: so many records of these properties."""

    name: str
    count: int
    properties: tuple[Property, ...]

    @property
    def dtype(self) -> np.dtype[np.void]:
        """Of a record without its lists, names in small letters."""
        plain = [p for p in self.properties if p.length is None]
        return np.dtype(list(zip(unique(p.name for p in plain), (p.kind for p in plain), strict=True)))

    @property
    def has_lists(self) -> bool:
        """Whether its records differ in length."""
        return any(p.length is not None for p in self.properties)


@dataclass(frozen=True)
class Layout:
    """Where the vertices lie in a file, and how. start: bytes of the header. before: elements between it and them."""

    encoding: str
    start: int
    before: tuple[Element, ...]
    vertex: Element

    @property
    def dtype(self) -> np.dtype[np.void]:
        """Of a vertex without its lists."""
        return self.vertex.dtype


def read_ply(path: Path, facts: Facts) -> Iterator[Chunk]:
    """The vertices with normals, colour, intensity and classification where there are such properties; no lists.

    Raises ReadError if the header makes no sense or vertices are missing.
    """
    layout = layout_of(path, facts)
    for values, done in vertices(path, layout):
        yield chunk_of(values, done)


def vertices(path: Path, layout: Layout) -> Values:
    """Vertices as a structured array, chunk by chunk, each with the share of the file that is read then."""
    if layout.encoding == "ascii":
        return _ascii_lists(path, layout) if layout.vertex.has_lists else _ascii(path, layout)
    if layout.vertex.has_lists or any(e.has_lists for e in layout.before):
        return _binary_lists(path, layout)
    return _binary(path, layout)


def layout_of(path: Path, facts: Facts) -> Layout:
    """What the header says of the vertices.

    Raises ReadError if it makes no sense.
    """
    with path.open("rb") as file:
        lines: list[list[str]] = []
        while ["end_header"] not in lines:
            line = file.readline(10_000)
            if not line or len(lines) > 10_000:
                raise ReadError(path, "has no whole PLY header", WAY_OUT)
            lines.append(line.decode("latin-1").split())
        start = file.tell()
    encoding = ""
    found: list[tuple[str, int, list[Property]]] = []
    try:
        for words in lines:
            match words:
                case ["comment" | "obj_info", *said]:
                    facts.listen(" ".join(said))
                case ["format", kind, *_]:
                    encoding, order = kind, ORDERS[kind]
                case ["element", name, number]:
                    found.append((name.lower(), _count(number), []))
                case ["property", "list", length, kind, name]:
                    found[-1][2].append(Property(name, np.dtype(order + TYPES[kind]), _whole(order + TYPES[length])))
                case ["property", kind, name]:
                    found[-1][2].append(Property(name, np.dtype(order + TYPES[kind])))
    except (KeyError, ValueError, IndexError, UnboundLocalError) as error:
        raise ReadError(path, f"its PLY header makes no sense ({error})", WAY_OUT) from error
    elements = [Element(name, count, tuple(properties)) for name, count, properties in found]
    k = next((k for k, e in enumerate(elements) if e.name == "vertex"), None)
    if k is None or not set(XYZ) <= set(elements[k].dtype.names or ()):
        raise ReadError(path, "has no vertices with x, y and z", WAY_OUT)
    return Layout(encoding, start, tuple(e for e in elements[:k] if e.count and e.properties), elements[k])


def _count(text: str) -> int:
    if not 0 <= int(text) < MOST:
        raise ValueError(f"{text} records")
    return int(text)


def _whole(kind: str) -> np.dtype[np.generic]:
    if kind[1] == "f":
        raise ValueError("the length of a list is no whole number")
    return np.dtype(kind)


def _binary(path: Path, layout: Layout) -> Values:
    start, count = layout.start + sum(e.count * e.dtype.itemsize for e in layout.before), layout.vertex.count
    have = (path.stat().st_size - start) // layout.dtype.itemsize
    if have < count:
        raise _truncated(path, count, max(have, 0))
    with path.open("rb") as file:
        file.seek(start)
        for at in range(0, count, SIZE):
            values = np.fromfile(file, layout.dtype, min(SIZE, count - at))
            yield values, (at + len(values)) / count


def _binary_lists(path: Path, layout: Layout) -> Values:
    """Where records differ in length, each is looked for behind the one before it."""
    from segmentation.io.ply_lists import walk  # numba takes half a second, which other files need not wait for

    content = np.memmap(path, np.uint8, "r")
    big = layout.encoding == "binary_big_endian"
    at, none = layout.start, np.empty((0, 0), np.int64)
    for element in layout.before:
        at = walk(content, at, element.count, *_sizes(element), big, none)
        if at < 0:
            raise _truncated(path, layout.vertex.count, 0)
    vertex = layout.vertex
    plain = [k for k, p in enumerate(vertex.properties) if p.length is None]
    for first in range(0, vertex.count, SIZE):
        number = min(SIZE, vertex.count - first)
        if number > len(content) - at:  # no record is shorter than a byte
            raise _truncated(path, vertex.count, first)
        offsets = np.empty((number, len(vertex.properties)), np.int64)
        at = walk(content, at, number, *_sizes(vertex), big, offsets)
        if at < 0:
            raise _truncated(path, vertex.count, first)
        values = np.empty(number, layout.dtype)
        for name, k in zip(layout.dtype.names or (), plain, strict=True):
            kind = vertex.properties[k].kind
            values[name] = content[offsets[:, k, None] + np.arange(kind.itemsize)].view(kind)[:, 0]
        yield values, (first + number) / vertex.count


def _sizes(element: Element) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Bytes of a value of each property, and of the number before it, 0 where there is none."""
    sizes = [p.kind.itemsize for p in element.properties]
    lengths = [0 if p.length is None else p.length.itemsize for p in element.properties]
    return np.array(sizes, np.int64), np.array(lengths, np.int64)


def _ascii(path: Path, layout: Layout) -> Values:
    count, skip = layout.vertex.count, sum(e.count for e in layout.before)
    rows = Rows(path, len(layout.dtype.names or ()), start=layout.start, skip=skip, limit=count)
    have = 0
    for table in rows:
        have += len(table)
        yield from_table(table, layout.dtype), have / count
    if have < count:
        raise _truncated(path, count, have)


def _ascii_lists(path: Path, layout: Layout) -> Values:
    """Where rows differ in length, each is taken apart word by word."""
    vertex, have = layout.vertex, 0
    rows: list[list[float]] = []
    with opened(path) as file:
        file.seek(layout.start)
        for _ in range(sum(e.count for e in layout.before)):
            if not file.readline():
                raise _truncated(path, vertex.count, 0)
        while have < vertex.count:
            line = file.readline()
            if not line:
                raise _truncated(path, vertex.count, have)
            if not line.strip():
                continue
            row = _row(line.split(), vertex.properties)
            if row is None:
                shown = line[:40].decode("latin-1").encode("unicode_escape").decode()
                raise ReadError(path, f"vertex {have} is no row of its properties ('{shown}'), or truncated", WAY_OUT)
            rows.append(row)
            have += 1
            if len(rows) == SIZE or have == vertex.count:
                yield from_table(np.array(rows).reshape(len(rows), -1), layout.dtype), have / vertex.count
                rows = []


def _row(words: list[bytes], properties: tuple[Property, ...]) -> list[float] | None:
    """The values of a record that are in no list; None if the words are none."""
    values: list[float] = []
    at = 0
    try:
        for p in properties:
            if p.length is None:
                values.append(float(words[at]))
                at += 1
            else:
                at += 1 + _count(words[at].decode("latin-1"))
    except (ValueError, IndexError):
        return None
    return values if at == len(words) else None


def _truncated(path: Path, promised: int, have: int) -> ReadError:
    return ReadError(path, f"is truncated: {have} of {promised} points are there", "copy it again from where it comes")

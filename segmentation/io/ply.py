"""PLY (Turk 1994), ascii and binary: the vertices, with any properties; faces are left alone."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.chunk import SIZE, Chunk
from segmentation.io.facts import Facts
from segmentation.io.numbers import number_of, whole_of
from segmentation.io.ply_header import WAY_OUT, Element, PlyLayout, Property, layout_of
from segmentation.io.records import chunk_of, from_table
from segmentation.io.rest import tell_bytes, tell_damaged, tell_lines, tell_unended, truncated
from segmentation.io.table import Rows, has_end, opened, rest_of

Values = Iterator[tuple[NDArray[np.void], float]]


def read_ply(path: Path, facts: Facts) -> Iterator[Chunk]:
    """The vertices with normals, colour, intensity and classification where there are such properties; no lists.

    What follows the vertices is compared with the header, and what differs is told.
    Raises ReadError if the header makes no sense or vertices are missing.
    """
    layout = layout_of(path, facts)
    for values, done in vertices(path, layout, facts):
        yield chunk_of(values, done)


def vertices(path: Path, layout: PlyLayout, facts: Facts) -> Values:
    """Vertices as a structured array, chunk by chunk, each with the share of the file that is read then."""
    if layout.encoding == "ascii":
        return _ascii_lists(path, layout, facts) if layout.vertex.has_lists else _ascii(path, layout, facts)
    if layout.vertex.has_lists or any(e.has_lists for e in layout.before):
        return _binary_lists(path, layout, facts)
    return _binary(path, layout, facts)


def _binary(path: Path, layout: PlyLayout, facts: Facts) -> Values:
    start, count = layout.start + sum(e.count * e.dtype.itemsize for e in layout.before), layout.vertex.count
    have = (path.stat().st_size - start) // layout.dtype.itemsize
    if have < count:
        raise truncated(path, count, max(have, 0))
    with path.open("rb") as file:
        file.seek(start)
        for at in range(0, count, SIZE):
            values = np.fromfile(file, layout.dtype, min(SIZE, count - at))
            yield values, (at + len(values)) / count
    _tell_rest(path, layout, start + count * layout.dtype.itemsize, facts)


def _binary_lists(path: Path, layout: PlyLayout, facts: Facts) -> Values:
    """Where records differ in length, each is looked for behind the one before it."""
    from segmentation.io.ply_lists import walk  # numba takes half a second, which other files need not wait for

    content = np.memmap(path, np.uint8, "r")
    big = layout.encoding == "binary_big_endian"
    at, none = layout.start, np.empty((0, 0), np.int64)
    for element in layout.before:
        at = walk(content, at, element.count, *_sizes(element), big, none)
        if at < 0:
            raise truncated(path, layout.vertex.count, 0)
    vertex = layout.vertex
    plain = [k for k, p in enumerate(vertex.properties) if p.length is None]
    for first in range(0, vertex.count, SIZE):
        number = min(SIZE, vertex.count - first)
        if number > len(content) - at:  # no record is shorter than a byte
            raise truncated(path, vertex.count, first)
        offsets = np.empty((number, len(vertex.properties)), np.int64)
        at = walk(content, at, number, *_sizes(vertex), big, offsets)
        if at < 0:
            raise truncated(path, vertex.count, first)
        values = np.empty(number, layout.dtype)
        for name, k in zip(layout.dtype.names or (), plain, strict=True):
            kind = vertex.properties[k].kind
            values[name] = content[offsets[:, k, None] + np.arange(kind.itemsize)].view(kind)[:, 0]
        yield values, (first + number) / vertex.count
    _tell_rest(path, layout, at, facts)


def _tell_rest(path: Path, layout: PlyLayout, at: int, facts: Facts) -> None:
    """Compare what follows the vertices, from byte `at` on, with the elements that the header promises."""
    big = layout.encoding == "binary_big_endian"
    size = path.stat().st_size
    content = np.memmap(path, np.uint8, "r") if layout.after else np.empty(0, np.uint8)
    for element in layout.after:
        if element.count * element.shortest(layout.encoding) > size - at:
            at = -1
        elif (alike := _alike(content, at, element)) > 0:
            at += element.count * alike
        else:
            from segmentation.io.ply_lists import walk

            at = walk(content, at, element.count, *_sizes(element), big, np.empty((0, 0), np.int64))
        if at < 0:
            tell_damaged(facts, f"it ends before the {element.count:,} records of {element.name!r} that follow")
            return
    tell_bytes(path, facts, at)


def _alike(content: NDArray[np.uint8], at: int, element: Element) -> int:
    """Bytes of a record from byte `at` on, if all have lists of the same lengths, as triangles have; else 0."""
    places, size = [], 0
    for p in element.properties:
        if p.length is None:
            size += p.kind.itemsize
            continue
        width = p.length.itemsize
        if at + size + width > len(content):
            return 0
        places.append(slice(size, size + width))
        size += width + max(int(content[at + size :][:width].view(p.length)[0]), 0) * p.kind.itemsize
    if at + element.count * size > len(content):
        return 0
    records = content[at : at + element.count * size].reshape(element.count, size)
    return size if all((records[:, place] == records[0, place]).all() for place in places) else 0


def _sizes(element: Element) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Bytes of a value of each property, and of the number before it, 0 where there is none."""
    sizes = [p.kind.itemsize for p in element.properties]
    lengths = [0 if p.length is None else p.length.itemsize for p in element.properties]
    return np.array(sizes, np.int64), np.array(lengths, np.int64)


def _ascii(path: Path, layout: PlyLayout, facts: Facts) -> Values:
    count, skip = layout.vertex.count, sum(e.count for e in layout.before)
    rows = Rows(path, len(layout.dtype.names or ()), start=layout.start, skip=skip, limit=count)
    have = 0
    for table in rows:
        have += len(table)
        yield from_table(table, layout.dtype, facts), have / count
    if have < count:
        raise truncated(path, count, have)
    _tell_lines(layout, rows.beyond, rows.ended, facts)


def _tell_lines(layout: PlyLayout, beyond: int, ended: bool, facts: Facts) -> None:
    tell_lines(facts, beyond, sum(e.count for e in layout.after), "the vertices")
    if not ended:
        tell_unended(facts)


def _ascii_lists(path: Path, layout: PlyLayout, facts: Facts) -> Values:
    """Where rows differ in length, each is taken apart word by word."""
    vertex, have, ended = layout.vertex, 0, True
    rows: list[list[float]] = []
    with opened(path) as file:
        file.seek(layout.start)
        for _ in range(sum(e.count for e in layout.before)):
            if not file.readline():
                raise truncated(path, vertex.count, 0)
        while have < vertex.count:
            line = file.readline()
            if not line:
                raise truncated(path, vertex.count, have)
            if not line.strip():
                continue
            row = _row(line.split(), vertex.properties)
            if row is None:
                shown = line[:40].decode("latin-1").encode("unicode_escape").decode()
                raise ReadError(path, f"vertex {have} is no row of its properties ('{shown}'), or truncated", WAY_OUT)
            rows.append(row)
            have += 1
            if len(rows) == SIZE or have == vertex.count:
                yield from_table(np.array(rows).reshape(len(rows), -1), layout.dtype, facts), have / vertex.count
                rows = []
                ended = has_end(line)
        _tell_lines(layout, *rest_of(file, ended), facts)


def _row(words: list[bytes], properties: tuple[Property, ...]) -> list[float] | None:
    """The values of a record that are in no list; None if the words are none."""
    values: list[float] = []
    at = 0
    try:
        for p in properties:
            if p.length is None:
                values.append(number_of(words[at]))
                at += 1
            else:
                at += 1 + whole_of(words[at])
    except (ValueError, IndexError):
        return None
    return values if at == len(words) else None

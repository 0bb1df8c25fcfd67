"""PCD of the Point Cloud Library, versions 0.6 and 0.7: ascii, binary and binary_compressed."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.chunk import SIZE, Chunk
from segmentation.io.facts import Facts
from segmentation.io.numbers import number_of, whole_of
from segmentation.io.records import PACKED, XYZ, chunk_of, from_table, tell_order, unique
from segmentation.io.rest import tell_bytes, tell_lines, tell_unended, truncated
from segmentation.io.table import Rows

KINDS = {
    **{f"F{size}": f"f{size}" for size in (4, 8)},
    **{f"{kind}{size}": f"{kind.lower()}{size}" for kind in "IU" for size in (1, 2, 4, 8)},
}
"""Types of values, by TYPE and SIZE."""
DENSEST = 88
"""Bytes that a byte of LZF may become: three that are copied make 264."""
PAGE = 65536
"""Zero bytes that older versions of the library leave behind the points at most: what fills a page of memory."""
HOME = [0.0, 0.0, 0.0]
WAY_OUT = "export the scan again as PCD, E57, LAZ or PLY"


@dataclass(frozen=True)
class PcdLayout:
    """What the header says. viewpoint: where the scanner stood [m], None where it stood in the origin."""

    dtype: np.dtype[np.void]
    count: int
    encoding: str
    start: int
    viewpoint: NDArray[np.float64] | None


Values = Iterator[tuple[NDArray[np.void], float]]


def read_pcd(path: Path, facts: Facts) -> Iterator[Chunk]:
    """The points with normals, colour (packed or not), intensity; the viewpoint's position, if set, as station.

    Raises ReadError if the header makes no sense or points are missing.
    """
    layout = _layout(path, facts)
    stations = layout.viewpoint
    for values, done in DECODERS[layout.encoding](path, layout, facts):
        yield replace(chunk_of(values, done, _color(values)), stations=stations)
        stations = None


def _layout(path: Path, facts: Facts) -> PcdLayout:
    header: dict[str, list[str]] = {}
    with path.open("rb") as file:
        while "DATA" not in header:
            line = file.readline(100_000)
            if not line or len(header) > 20:
                raise ReadError(path, "has no whole PCD header", WAY_OUT)
            words = line.decode("latin-1").split() or [""]
            if words[0].startswith("#"):
                facts.listen(" ".join(words))
            elif words[0].upper() in header:
                raise ReadError(path, f"its PCD header makes no sense (two lines {words[0][:20]!r})", WAY_OUT)
            elif words[0]:
                header[words[0].upper()] = words[1:]
        start = file.tell()
    try:
        names, counts = unique(header["FIELDS"]), [1] * len(header["FIELDS"])
        if "COUNT" in header:
            counts = [whole_of(word) for word in header["COUNT"]]
        kinds = [KINDS[kind + size] for kind, size in zip(header["TYPE"], header["SIZE"], strict=True)]
        if not names or min(counts) < 1:
            raise ValueError(f"COUNT {' '.join(header['COUNT'])}")
        width = sum(n * int(kind[1]) for n, kind in zip(counts, kinds, strict=True))
        if width > path.stat().st_size:
            raise ValueError(f"points of {width} bytes")
        fields: list[Any] = [
            (name, f"<{kind}", *([(n,)] if n != 1 else [])) for name, kind, n in zip(names, kinds, counts, strict=True)
        ]
        dtype = np.dtype(fields)
        beams = (
            whole_of(_one(header["WIDTH"])) * whole_of(_one(header.get("HEIGHT", ["1"]))) if "WIDTH" in header else None
        )
        count = whole_of(_one(header["POINTS"])) if "POINTS" in header or beams is None else beams
        if beams not in (None, count):
            raise ValueError(f"WIDTH x HEIGHT = {beams}, POINTS {count}")
        place = [number_of(v.encode("latin-1")) for v in header.get("VIEWPOINT", ["0"] * 3)[:3]]
        encoding = _one(header["DATA"]).lower()
    except (KeyError, ValueError, IndexError, TypeError) as error:
        raise ReadError(path, f"its PCD header makes no sense ({error})", WAY_OUT) from error
    if encoding not in DECODERS:
        raise ReadError(path, f"its PCD data is {encoding!r}, known are {', '.join(DECODERS)}", WAY_OUT)
    if len(place) != 3 or not np.isfinite(place).all():
        raise ReadError(path, f"its viewpoint {' '.join(header['VIEWPOINT'])} is no place", WAY_OUT)
    if set(XYZ) <= set(names) and any(dtype[axis].shape for axis in XYZ):
        raise ReadError(path, "has several values in x, y or z", WAY_OUT)
    if not set(XYZ) <= set(names):
        raise ReadError(path, "has no fields x, y and z", WAY_OUT)
    tell_order(facts, names)
    return PcdLayout(dtype, count, encoding, start, None if place == HOME else np.array([place]))


def _one(words: list[str]) -> str:
    """The one word of a line. Raises ValueError if there are others."""
    (word,) = words
    return word


def _ascii(path: Path, layout: PcdLayout, facts: Facts) -> Values:
    width = sum(int(np.prod(layout.dtype[name].shape, dtype=int)) for name in layout.dtype.names or ())
    have = 0
    rows = Rows(path, width, start=layout.start, limit=layout.count)
    for table in rows:
        have += len(table)
        yield from_table(table, layout.dtype, facts), have / layout.count
    if have < layout.count:
        raise truncated(path, layout.count, have)
    tell_lines(facts, rows.beyond, 0)
    if not rows.ended:
        tell_unended(facts)


def _binary(path: Path, layout: PcdLayout, facts: Facts) -> Values:
    have = (path.stat().st_size - layout.start) // layout.dtype.itemsize
    if have < layout.count:
        raise truncated(path, layout.count, have)
    with path.open("rb") as file:
        file.seek(layout.start)
        for at in range(0, layout.count, SIZE):
            values = np.fromfile(file, layout.dtype, min(SIZE, layout.count - at))
            yield values, (at + len(values)) / layout.count
    tell_bytes(path, facts, layout.start + layout.count * layout.dtype.itemsize, PAGE)


def _compressed(path: Path, layout: PcdLayout, facts: Facts) -> Values:
    """Two lengths, then all values of the first field, all of the second, …, compressed together."""
    from segmentation.io.lzf import unpack  # numba takes half a second, which other files need not wait for

    with path.open("rb") as file:
        file.seek(layout.start)
        lengths = np.fromfile(file, "<u4", 2)
        room = path.stat().st_size - file.tell()
        packed = np.fromfile(file, np.uint8, min(int(lengths[0]), room) if len(lengths) == 2 else 0)
    whole = layout.count * layout.dtype.itemsize
    if len(lengths) < 2 or len(packed) < lengths[0] or lengths[1] != whole or whole > DENSEST * len(packed):
        raise truncated(path, layout.count, 0)
    plain = np.zeros(whole, np.uint8)
    if unpack(packed, plain) != whole:
        raise ReadError(path, "its compressed data is damaged", WAY_OUT)
    values = np.empty(layout.count, layout.dtype)
    at = 0
    for name in layout.dtype.names or ():
        length = layout.count * layout.dtype[name].itemsize
        values[name] = plain[at : at + length].view(layout.dtype[name].base).reshape(-1, *layout.dtype[name].shape)
        at += length
    yield values, 1.0
    tell_bytes(path, facts, layout.start + lengths.nbytes + len(packed), PAGE)


DECODERS: dict[str, Callable[[Path, PcdLayout, Facts], Values]] = {
    "ascii": _ascii,
    "binary": _binary,
    "binary_compressed": _compressed,
}


def _color(values: NDArray[np.void]) -> NDArray[np.uint8] | None:
    """Red, green and blue (k, 3) out of a packed field; None if there is none."""
    name = next((n for n in PACKED if n in (values.dtype.names or ())), None)
    if name is None or values.dtype[name].itemsize != 4:
        return None
    packed = np.ascontiguousarray(values[name]).view(np.uint32)
    return np.stack([(packed >> shift & 255).astype(np.uint8) for shift in (16, 8, 0)], axis=1)

"""XYZ, TXT, ASC, PTS and CSV: columns of numbers, told apart by their names or by what they hold."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.chunk import Chunk
from segmentation.io.table import Dialect, Rows

HEAD = 1 << 16
"""Bytes of the file that are looked at to find out its columns."""
BOM = b"\xef\xbb\xbf"
ROW = re.compile(rb"\s*[\"]?([-+.,;\d]|na|nu|none)", re.IGNORECASE)
"""How a line begins that holds numbers, or words for missing ones."""
NAMES = {
    "x": {"x", "easting", "east"}, "y": {"y", "northing", "north"}, "z": {"z", "elevation", "height"},
    "r": {"r", "red"}, "g": {"g", "green"}, "b": {"b", "blue"},
    "nx": {"nx", "normalx", "normal_x"}, "ny": {"ny", "normaly", "normal_y"}, "nz": {"nz", "normalz", "normal_z"},
    "intensity": {"i", "intensity", "scalar_intensity", "reflectance"},
    "classification": {"classification", "scalar_classification", "class"},
}  # fmt: skip
WAY_OUT = "export the scan as plain columns x y z, or as E57, LAZ or PLY"


@dataclass(frozen=True)
class Layout:
    """How a text is to be read. start, skip: bytes and lines before the first row.

    columns: how many. at: column of each name of NAMES that is there.
    """

    dialect: Dialect
    start: int
    skip: int
    columns: int
    at: dict[str, int]
    promised: int | None
    """How many points a count line before the first row promises."""


def read_text(path: Path) -> Iterator[Chunk]:
    """The rows as points, with intensity, colour and normals where there are such columns.

    Columns are taken by the names in a header line; without one as x y z, then intensity, if the others are not
    threes, then threes of colour or (unit vectors) normals. White space, commas, semicolons and decimal commas are
    recognised; a line with a count, as PTS has it, is checked against the rows.
    Raises ReadError if there are no rows of numbers, a line is none, or rows are missing.
    """
    layout = _layout(path)
    rows = Rows(path, layout.columns, start=layout.start, skip=layout.skip, dialect=layout.dialect)
    have = 0
    for table in rows:
        have += len(table)
        yield _chunk(table, layout.at, rows.done)
    promised = None if layout.promised is None else layout.promised + sum(rows.counts)
    if promised is not None and have < promised:
        raise ReadError(
            path, f"is truncated: {have} of {promised} points are there", "copy it again from where it comes"
        )


def _chunk(table: NDArray[np.float64], at: dict[str, int], done: float) -> Chunk:
    def columns(*names: str) -> NDArray[np.float64] | None:
        return table[:, [at[n] for n in names]] if all(n in at for n in names) else None

    xyz, classes = columns("x", "y", "z"), columns("classification")
    assert xyz is not None
    return Chunk(
        xyz=xyz,
        normals=columns("nx", "ny", "nz"),
        color=columns("r", "g", "b"),
        intensity=table[:, at["intensity"]].copy() if "intensity" in at else None,
        classification=None if classes is None else np.nan_to_num(classes[:, 0]).astype(np.uint8),
        done=done,
    )


def _layout(path: Path) -> Layout:
    with path.open("rb") as file:
        head = file.read(HEAD)
    start = len(BOM) if head.startswith(BOM) else 0
    lines = head[start:].splitlines()
    if len(head) == HEAD:
        lines.pop()
    dialect = _dialect(lines)
    rows = [(k, row) for k, row in enumerate(_numbers(line, dialect) for line in lines) if row is not None]
    first = next((k for k, row in rows if len(row) >= 3), None)
    if first is None:
        raise ReadError(path, "has no line with three numbers", WAY_OUT)
    before = [row for k, row in rows if k < first]
    counts = [int(row[0]) for row in before if len(row) == 1 and row[0].is_integer()]
    sample = [row for k, row in rows if k >= first]
    width = len(sample[0])
    table = np.array([row for row in sample if len(row) == width])
    at = _named(lines[:first], width) or _guessed(table)
    return Layout(dialect, start, first, width, at, counts[-1] if counts else None)


def _numbers(line: bytes, dialect: Dialect) -> list[float] | None:
    """The row of numbers, or None if it is none."""
    try:
        return [float(word) for word in dialect.plain(line).split()] or None
    except ValueError:
        return None


def _dialect(lines: list[bytes]) -> Dialect:
    """A comma between blanks is a decimal one: `1,5 2,5 3`, but `1.5, 2.5, 3` and `1.5,2.5,3`."""
    rows = [line.split() for line in lines if ROW.match(line)]
    commas = [words for words in rows if any(b"," in word for word in words)]
    if any(b";" in word for words in rows for word in words):
        return Dialect(b";", decimal_comma=bool(commas))
    if commas and all(len(w) >= 3 and all(re.fullmatch(rb"[^,]*,?[^,]+", word) for word in w) for w in commas):
        return Dialect(decimal_comma=True)
    return Dialect(b"," if commas else b"")


def _named(header: list[bytes], width: int) -> dict[str, int] | None:
    """Columns by the last header line that names as many as there are, x, y and z among them; else None."""
    for line in reversed(header):
        words = re.split(r"[\s,;]+", re.sub(r"[\"'/#]", " ", line.decode("latin-1")).strip().lower())
        at = {name: k for name, known in NAMES.items() for k, word in enumerate(words) if word in known}
        if len(words) == width and {"x", "y", "z"} <= at.keys():
            return at
    return None


def _guessed(table: NDArray[np.float64]) -> dict[str, int]:
    """Columns by their place and what the first rows hold. PTS has intensity before the colour, others after it."""
    at = {"x": 0, "y": 1, "z": 2}
    left = [c for c in range(3, table.shape[1]) if not np.isnan(table[:, c]).all()]
    for k in reversed(left[:-2]):
        if {k + 1, k + 2} <= set(left) and _are_normals(table[:, k : k + 3]):
            at |= {"nx": k, "ny": k + 1, "nz": k + 2}
            left = [c for c in left if not k <= c < k + 3]
            break
    starts = (1, 0) if len(left) > 3 else (0,)
    color = next((left[s : s + 3] for s in starts if len(left) >= 3 and _are_colors(table[:, left[s : s + 3]])), [])
    at |= dict(zip("rgb", color, strict=False))
    rest = [c for c in left if c not in color]
    return at | ({"intensity": rest[0]} if rest else {})


def _are_normals(columns: NDArray[np.float64]) -> bool:
    return bool(np.allclose(np.linalg.norm(columns, axis=1), 1, atol=0.01))


def _are_colors(columns: NDArray[np.float64]) -> bool:
    whole = np.array_equal(columns, np.round(columns))
    return bool(columns.min() >= 0 and (whole or columns.max() <= 1))

"""XYZ, TXT, ASC, PTS and CSV: columns of numbers, told apart by their names or by what they hold."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.chunk import Chunk
from segmentation.io.facts import Facts
from segmentation.io.guess import AmbiguousError, check_northing_first, guessed
from segmentation.io.header import Header, NotUnderstoodError, names_of, swapped, understood, units_of
from segmentation.io.numbers import MISSING, number_of, whole_of
from segmentation.io.place import FAR
from segmentation.io.ranges import class8
from segmentation.io.rest import tell_damaged, tell_unended, truncated
from segmentation.io.table import COMMENTS, HEAD, Dialect, Rows, opened
from segmentation.units import UNITS

NUMBER = re.compile(rb"(?<![A-Za-z\d_.])[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?(?![A-Za-z\d_])")
WORDS = 0.1
"""Share of the rows in which a column has words from which on it is one of words, and no damage."""
WAY_OUT = "export the scan as plain columns x y z, or as E57, LAZ or PLY"
COLUMNS = (
    "say what each column is, as --columns x,y,z,- (names x y z r g b nx ny nz intensity classification, - for none)"
)


@dataclass(frozen=True)
class TextLayout:
    """How a text is to be read. skip: lines before the first row.

    columns: how many. words: those that hold words. at: column of each thing that is there.
    """

    dialect: Dialect
    skip: int
    columns: int
    words: frozenset[int]
    at: dict[str, int]
    promised: int | None
    """How many points a count line before the first row promises."""


def read_text(path: Path, facts: Facts, columns: str | None = None) -> Iterator[Chunk]:
    """The rows as points, with intensity, colour and normals where there are such columns.

    Columns are taken as `columns` says ("y,x,z,-"), else by the names in a header line, in the languages of header.py;
    without one by their place and what they hold, which `facts` is told. White space, commas, semicolons and decimal
    commas are recognised; a line with a count, as PTS has it, is checked against the rows.
    Raises ReadError if there are no rows of numbers, a line is none, rows are missing, or it is not clear which columns
    are x, y and z.
    """
    layout = _layout(path, facts, columns)
    rows = Rows(path, layout.columns, skip=layout.skip, dialect=layout.dialect, words=layout.words)
    have = 0
    for table in rows:
        have += len(table)
        yield _chunk(table, layout.at, rows.done)
    if not rows.ended:
        tell_unended(facts)
    if layout.promised is None and not rows.counts:
        return
    promised = (layout.promised or 0) + sum(rows.counts)
    if have < promised:
        raise truncated(path, promised, have)
    if have > promised:
        tell_damaged(facts, f"its lines of counts promise {promised:,} points, {have:,} are there")


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
        classification=None if classes is None else class8(classes[:, 0]),
        done=done,
    )


def _layout(path: Path, facts: Facts, said: str | None) -> TextLayout:
    with opened(path) as file:
        head = file.read(HEAD)
    lines = head.splitlines()
    if len(head) == HEAD:
        lines.pop()
    dialect = _dialect(lines)
    cells = [[] if line.lstrip().startswith(COMMENTS) else dialect.cells(line) for line in lines]
    numbers = [sum(map(_is_number, row)) for row in cells]
    widths = Counter(len(row) for row, n in zip(cells, numbers, strict=True) if n >= 3)
    if not widths:
        raise ReadError(path, "has no line with three numbers", WAY_OUT)
    first = next(
        k
        for k, n in enumerate(numbers)
        if n >= 3 and (len(cells[k]) == widths.most_common(1)[0][0] or n == len(cells[k]))
    )
    width = len(cells[first])
    sample = [row for row in cells[first:] if len(row) == width]
    words = frozenset(k for k in range(width) if sum(not _is_number(row[k]) for row in sample) > WORDS * len(sample))
    if width - len(words) < 3:
        words = frozenset()
    table = np.array([[_value(word) for word in row] for row in sample])
    before = [row for row in cells[:first] if len(row) == 1 and row[0].isdigit()]
    header, unit_line = _header(path, lines[:first], width, dialect, said)
    _tell_unit(path, facts, lines[:first], header, unit_line, dialect)
    at = _named(path, facts, header, table, words, said) if header else _placed(path, facts, table, words)
    if words & {at["x"], at["y"], at["z"]}:
        raise ReadError(path, f"has words where its header {header and header.line!r} has coordinates", COLUMNS)
    try:
        promised = whole_of(before[-1][0]) if before else None
    except ValueError as error:
        raise ReadError(path, f"before its first row {error} of points", WAY_OUT) from None
    return TextLayout(dialect, first, width, words, at, promised)


def _is_number(word: bytes) -> bool:
    try:
        number_of(word)
    except ValueError:
        return False
    return True


def _value(word: bytes) -> float:
    return number_of(word) if _is_number(word) else float("nan")


def _numbers_in(line: bytes) -> int:
    """How many numbers, or words for missing ones, are in a line, whatever stands between them."""
    missing = sum(word.lower() in MISSING for word in re.split(rb"[\s,;\"]+", line))
    return len(NUMBER.findall(line)) + missing


def _dialect(lines: list[bytes]) -> Dialect:
    """A comma between blanks or in quotes is a decimal one: `1,5 2,5 3`, `"1,5","2,5"`, but `1.5, 2.5, 3`."""
    rows = [line for line in lines if _numbers_in(line) >= 3 and not line.lstrip().startswith(COMMENTS)]
    if any(re.search(rb"\"[-+]?\d+,\d+\"", line) for line in rows):
        mark = next((m for m in (b";", b"\t") if any(m in line for line in rows)), b",")
        return Dialect(mark, quoted_comma=True)
    split = [line.split() for line in rows]
    commas = [words for words in split if any(b"," in word for word in words)]
    if any(b";" in line for line in rows):
        return Dialect(b";", decimal_comma=bool(commas))
    plain = all(len(w) >= 3 and all(re.fullmatch(rb"[^,]*,?[^,]+", word) for word in w) for w in commas)
    if rows and all(b"\t" in line for line in rows):
        tabs, blanks = {line.count(b"\t") + 1 for line in rows}, {len(words) for words in split}
        if len(tabs) == 1 and tabs != blanks and min(tabs) >= 3:  # names with blanks in them, or empty cells
            return Dialect(b"\t", decimal_comma=bool(commas) and plain)
    if commas and plain:
        return Dialect(decimal_comma=True)
    return Dialect(b"," if commas else b"")


def _header(
    path: Path, lines: list[bytes], width: int, dialect: Dialect, said: str | None
) -> tuple[Header | None, str]:
    """What names the columns: the user, or the last line above the rows that does; and a line of units under it.

    Raises ReadError, with the line, if one that is no comment, or a comment that names coordinates, is not understood.
    """
    if said is not None:
        try:
            header = names_of(said)
        except NotUnderstoodError as error:
            raise ReadError(path, f"--columns {said}: {error}", COLUMNS) from None
        if len(header.kinds) != width:
            wrong = f"--columns {said} names {len(header.kinds)} columns where there are {width}"
            raise ReadError(path, wrong, COLUMNS)
        return header, ""
    units = ""
    for raw in reversed(lines):
        line = raw.decode("utf-8", errors="replace")
        if "\ufffd" in line:
            line = raw.decode("latin-1")
        if not line.strip(" \t\r#/;") or line.strip().isdigit():
            continue
        if units_of(line, dialect.delimiter.decode()) is not None:
            units = units or line
            continue
        try:
            header_ = understood(line, width, dialect.delimiter.decode())
        except NotUnderstoodError as error:
            way_out = "transform the scan into metres" if "degrees" in str(error) else COLUMNS
            raise ReadError(path, f"its header {line.strip()[:80]!r} is not understood: {error}", way_out) from None
        if header_ is not None:
            return header_, units
        if not raw.lstrip().startswith(COMMENTS):
            raise ReadError(path, f"its line {line.strip()[:80]!r} is no header that is understood", COLUMNS)
    return None, units


def _tell_unit(
    path: Path, facts: Facts, lines: list[bytes], header: Header | None, unit_line: str, dialect: Dialect
) -> None:
    """Tell the unit that the header states, or a line above the rows."""
    said = dict(header.units) if header else {}
    units = units_of(unit_line, dialect.delimiter.decode()) if header and unit_line else None
    if header and units:
        if len(units) == len(header.kinds):
            said |= {axis: unit for axis in "xyz" if (unit := units[header.at[axis]]) is not None}
        elif len(only := set(filter(None, units))) == 1:
            said |= dict.fromkeys("xyz", only.pop())
        else:
            wrong = f"its line of units {unit_line.strip()[:80]!r} does not fit the columns"
            raise ReadError(path, wrong, "say the unit, as --unit ft, and leave that line out")
    for line in lines:
        facts.listen(line.decode("latin-1"))
    flat, height = said.get("x") or said.get("y"), said.get("z")
    if flat is not None or height is not None:
        facts.unit = UNITS[flat or height or "m"]
        facts.height_unit = UNITS[height or flat or "m"]
        facts.stated_by = "its header"


def _named(
    path: Path, facts: Facts, header: Header, table: NDArray[np.float64], words: frozenset[int], said: str | None
) -> dict[str, int]:
    """Columns by a header; tells how it was understood where it is no plain x y z."""
    at = header.at
    if said is not None:
        facts.tell("columns", f"columns: {header.order}, as asked")
        return at
    far = np.nan_to_num(np.abs(table[:, [at["x"], at["y"]]])).max(initial=0) > FAR
    if header.bare and far and not header.units:
        try:
            check_northing_first(table[:, [at["x"], at["y"], at["z"]]])
        except AmbiguousError as error:
            raise ReadError(path, f"under its header {header.line[:80]!r} {error}", COLUMNS) from None
    if swapped(at) and header.bare and far:
        why = "has y before x, which may point north; as east it would mirror the scan"
        wrong = f"its header {header.line[:80]!r} {why}"
        raise ReadError(path, wrong, COLUMNS)
    if [word.casefold() for word in re.findall(r"\w+", header.line)] != list(header.kinds):
        facts.tell("columns", f"columns: {header.order}, by the header {header.line[:80]!r}")
    return {name: k for name, k in at.items() if k not in words or name in "xyz"}


def _placed(path: Path, facts: Facts, table: NDArray[np.float64], words: frozenset[int]) -> dict[str, int]:
    """Columns by their place, where no header names them; tells how they are taken."""
    try:
        kinds = guessed(table, words, pts=path.suffix.lower() == ".pts")
    except AmbiguousError as error:
        raise ReadError(path, f"has no header, and {error}", COLUMNS) from None
    header = Header(kinds, {}, "")
    facts.tell(
        "columns", f"columns: {header.order}, by their place, for no header names them; --columns says otherwise"
    )
    return header.at

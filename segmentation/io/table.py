"""Rows of numbers in a text, read block by block at the speed of numpy's parser."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError

BLOCK = 1 << 24
"""Bytes read at once: about 400,000 rows."""
LINE = 1 << 16
"""Bytes that a line may have."""
MISSING = {b"nan", b"-nan", b"-nan(ind)", b"nan(ind)", b"1.#qnan", b"-1.#ind", b"na", b"n/a", b"null", b"none", b"-"}
COMMENTS = (b"#", b"//")
WAY_OUT = "export the scan as plain columns of numbers, or as E57, LAZ or PLY"


@dataclass(frozen=True)
class Dialect:
    """What stands between the numbers of a row: white space always, and `delimiter` too if it is not empty."""

    delimiter: bytes = b""
    decimal_comma: bool = False

    def plain(self, text: bytes) -> bytes:
        """The text with white space between the numbers, points in them, and nan for what is left empty."""
        d = self.delimiter
        if d and (
            text[:1] == d or text[-1:] == d or any(gap in text for gap in (d + d, b"\n" + d, d + b"\n", d + b"\r"))
        ):
            text = re.sub(rb"(?m)^(?=%b)|(?<=%b)(?=[%b\r\n]|\Z)" % (d, d, d), b"nan", text)
        swap = bytes.maketrans(self.delimiter, b" " * len(self.delimiter))
        if self.decimal_comma:
            swap = swap[: ord(",")] + b"." + swap[ord(",") + 1 :]
        return text.translate(swap, delete=b'"')


@dataclass
class Rows:
    """Iterates over the rows of a text file as float64 tables (k, columns).

    start: byte at which to begin. skip: lines to leave out from there. limit: rows after which to stop, None for all.
    counts: filled while reading with whole numbers that stand alone in a line, as PTS has them before each scan.
    Blank lines and comments are passed over. Raises ReadError that names the line which is no row.
    """

    path: Path
    columns: int
    start: int = 0
    skip: int = 0
    limit: int | None = None
    dialect: Dialect = field(default_factory=Dialect)
    counts: list[int] = field(default_factory=list)
    done: float = 0.0
    """Share of the file read so far."""

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        left = self.limit
        size = self.path.stat().st_size
        with self.path.open("rb") as file:
            line = file.read(self.start).count(b"\n") + self.skip
            for _ in range(self.skip):
                file.readline()
            while left != 0:
                block = file.read(BLOCK) + file.readline(LINE)
                if not block:
                    return
                self.done = file.tell() / size
                table = self._table(block, line, left)
                line += block.count(b"\n")
                if left is not None:
                    table = table[:left]
                    left -= len(table)
                if len(table):
                    yield table

    def _table(self, block: bytes, line: int, left: int | None) -> NDArray[np.float64]:
        lines = block.count(b"\n") + (not block.endswith(b"\n"))
        if left is None or lines <= left:
            try:
                numbers = np.fromstring(self.dialect.plain(block), sep=" ")
                if len(numbers) == lines * self.columns:
                    return numbers.reshape(-1, self.columns)
            except ValueError:
                pass  # the slow way tells which line it is
        return self._line_by_line(block, line, left)

    def _line_by_line(self, block: bytes, line: int, left: int | None) -> NDArray[np.float64]:
        table: list[list[float]] = []
        for number, text in enumerate(block.splitlines(), line + 1):
            if len(table) == left:
                break
            words = self.dialect.plain(text).split()
            if not words or text.lstrip().startswith(COMMENTS):
                continue
            if len(words) == 1 and self.columns > 1 and words[0].isdigit():
                self.counts.append(int(words[0]))
                continue
            try:
                row = [float("nan") if word.lower() in MISSING else float(word) for word in words]
            except ValueError:
                shown = text[:40].decode("latin-1").encode("unicode_escape").decode()
                raise ReadError(self.path, f"line {number} is no row of numbers ('{shown}')", WAY_OUT) from None
            if len(row) != self.columns:
                wrong = (
                    f"line {number} has {len(row)} numbers where others have {self.columns}, or the file is truncated"
                )
                raise ReadError(self.path, wrong, WAY_OUT)
            table.append(row)
        return np.array(table).reshape(-1, self.columns)

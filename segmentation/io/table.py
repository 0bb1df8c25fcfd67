"""Rows of numbers in a text, read block by block at the speed of numpy's parser."""

import codecs
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.numbers import number_of, whole_of

BLOCK = 1 << 24
"""Bytes read at once: about 400,000 rows."""
LINE = 1 << 16
"""Bytes that a line may have."""
COMMENTS = (b"#", b"//")
HEAD = 1 << 16
"""Bytes at the beginning that tell how a text is encoded, and what its columns are."""
WIDE = {codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16", codecs.BOM_UTF8: "utf-8-sig"}
"""What a text begins with that has two bytes a digit, or something before the first; and how it is to be read."""
WAY_OUT = "export the scan as plain columns of numbers, or as E57, LAZ or PLY"


QUOTED = re.compile(rb"\"([-+]?\d*),(\d+(?:[eE][-+]?\d+)?)\"")
"""A number in quotes with a decimal comma."""


def lines_in(block: bytes) -> int:
    """How many lines of whole lines of a text have something in them."""
    if b"\n\n" in block or b"\r" in block or block[:1].isspace():
        return sum(1 for line in block.splitlines() if line.strip())
    return block.count(b"\n") + (not block.endswith(b"\n") and bool(block.strip()))


def has_end(block: bytes) -> bool:
    """Whether the last line of a text has its end; blanks that follow it are none."""
    return not block[max(block.rfind(b"\n"), block.rfind(b"\r")) + 1 :].strip()


def rest_of(file: BinaryIO, had_end: bool) -> tuple[int, bool]:
    """How many lines with something in them follow, and whether the last one has its end; `had_end` if none follows."""
    lines = 0
    while block := file.read(BLOCK) + file.readline():
        lines += lines_in(block)
        had_end = has_end(block)
    return lines, had_end


def opened(path: Path) -> BinaryIO:
    """A text as bytes of UTF-8, without a mark at its beginning, its lines ended by line feeds.

    Most files are that already; one that is not is converted in memory.
    """
    with path.open("rb") as file:
        head = file.read(HEAD)
        encoding = next((name for mark, name in WIDE.items() if head.startswith(mark)), None)
        if encoding is None and head[1::2].count(0) > len(head) // 4:
            encoding = "utf-16-le"
        returns_only = b"\r" in head and b"\n" not in head
        if encoding is None and not returns_only:
            return path.open("rb")
        content = head + file.read()
    if encoding is not None:
        content = content.decode(encoding, errors="replace").encode()
    return io.BytesIO(re.sub(rb"\r(?!\n)", b"\n", content) if b"\r" in content[:HEAD] else content)


@dataclass(frozen=True)
class Dialect:
    """What stands between the numbers of a row: white space always, and `delimiter` too if it is not empty.

    quoted_comma: numbers stand in quotes, with a decimal comma, though commas stand between them: "1,5","2,5".
    """

    delimiter: bytes = b""
    decimal_comma: bool = False
    quoted_comma: bool = False

    def cells(self, text: bytes) -> list[bytes]:
        """What stands in the columns of a line, words or numbers, these with points."""
        text = QUOTED.sub(rb"\1.\2", text) if self.quoted_comma else text
        cells = text.strip(b" \r\n").split(self.delimiter) if self.delimiter else text.split()
        if self.decimal_comma:
            cells = [cell.replace(b",", b".") for cell in cells]
        return [cell.strip(b'" \t') or b"nan" for cell in cells]

    def plain(self, text: bytes) -> bytes:
        """The text with white space between the numbers, points in them, and nan for what is left empty."""
        d = self.delimiter
        if self.quoted_comma:
            text = QUOTED.sub(rb"\1.\2", text)
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
    words: columns that hold words, as names of points; they are read as nan.
    counts: filled while reading with whole numbers that stand alone in a line, as PTS has them before each scan.
    beyond: lines after the last row that is asked for, and ended: whether the last line of the file has its end; both
    are known once all rows are read.
    Blank lines and comments are passed over. Raises ReadError that names the line which is no row.
    """

    path: Path
    columns: int
    start: int = 0
    skip: int = 0
    limit: int | None = None
    dialect: Dialect = field(default_factory=Dialect)
    words: frozenset[int] = frozenset()
    counts: list[int] = field(default_factory=list)
    done: float = 0.0
    """Share of the file read so far."""
    beyond: int = 0
    ended: bool = True

    def __iter__(self) -> Iterator[NDArray[np.float64]]:
        left = self.limit
        with opened(self.path) as file:
            size = file.seek(0, io.SEEK_END)
            file.seek(0)
            line = file.read(self.start).count(b"\n") + self.skip
            for _ in range(self.skip):
                if not file.readline():
                    return
            while left != 0:
                block = file.read(BLOCK) + file.readline(LINE)
                if not block:
                    return
                self.done = file.tell() / size
                self.ended = has_end(block)
                table = self._table(block, line, left)
                line += block.count(b"\n")
                if left is not None:
                    table = table[:left]
                    left -= len(table)
                if len(table):
                    yield table
            lines, self.ended = rest_of(file, self.ended)
            self.beyond += lines

    def _table(self, block: bytes, line: int, left: int | None) -> NDArray[np.float64]:
        lines = block.count(b"\n") + (not block.endswith(b"\n"))
        if not self.words and (left is None or lines <= left):
            try:
                numbers = np.fromstring(self.dialect.plain(block), sep=" ")
                if len(numbers) == lines * self.columns:
                    return numbers.reshape(-1, self.columns)
            except ValueError:
                pass  # the slow way tells which line it is
        return self._line_by_line(block, line, left)

    def _line_by_line(self, block: bytes, line: int, left: int | None) -> NDArray[np.float64]:
        table: list[list[float]] = []
        lines = block.splitlines()
        for number, text in enumerate(lines, line + 1):
            if len(table) == left:
                self.beyond += sum(1 for rest in lines[number - line - 1 :] if rest.strip())
                break
            words = self._row(text)
            if not words or text.lstrip().startswith(COMMENTS):
                continue
            try:
                if len(words) == 1 and self.columns > 1 and words[0].isdigit():
                    self.counts.append(whole_of(words[0]))
                    continue
                row = [number_of(word) for word in words]
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

    def _row(self, text: bytes) -> list[bytes]:
        """The numbers of a line as they stand there, nan for words in their columns."""
        if not self.words:
            return self.dialect.plain(text).split()
        if not text.strip():
            return []
        return [b"nan" if k in self.words else cell for k, cell in enumerate(self.dialect.cells(text))]

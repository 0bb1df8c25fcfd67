"""PTX of Leica Cyclone: scans one after the other, each a grid of beams with the matrix that places it."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.chunk import Chunk
from segmentation.io.facts import Facts
from segmentation.io.numbers import number_of, whole_of
from segmentation.io.rest import tell_damaged, tell_unended
from segmentation.io.table import has_end, opened

ROWS = 200_000
"""Lines that are read at once."""
LINE = 1 << 12
"""Bytes that a line of a header may have."""
WIDTHS = (4, 7)
"""Numbers of a row: x y z intensity, and red green blue."""
LENGTHS = (0.999, 1.001)
"""Of an axis of a matrix that is a motion."""
SAME = 1e-3
"""m; what a scanner's place may be rounded by."""
WAY_OUT = "export the scan again as PTX, E57 or LAZ"


@dataclass(frozen=True, eq=False)
class Station:
    """One scan: its beams, lines of its header, and motion into the file's frame: own @ rotation + translation."""

    beams: int
    lines: int
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]


def read_ptx(path: Path, facts: Facts) -> Iterator[Chunk]:
    """The points of all scans in the file's frame, with intensity, colour, and the scanners' positions.

    Beams that nothing sent back, which are written as 0 0 0, are no points.
    Raises ReadError if a header makes no sense, a matrix is no motion, or rows are missing.
    """
    size = path.stat().st_size
    number, line, ended = 0, 0, True
    with opened(path) as file:
        while (station := _station(path, file, number + 1, line, facts)) is not None:
            number, line = number + 1, line + station.lines
            left, width = station.beams, 0
            position: NDArray[np.float64] | None = station.translation[None]
            while left:
                lines = list(islice(file, min(left, ROWS)))
                if not lines:
                    wrong = f"is truncated: {left} of {station.beams} points of scan {number} are missing"
                    raise ReadError(path, wrong, "copy it again from where it comes")
                ended = has_end(lines[-1])
                width = width or len(lines[0].split())
                table = _table(path, lines, width, line)
                left, line = left - len(lines), line + len(lines)
                yield _chunk(table, station, position, file.tell() / size)
                position = None
    if number == 0:
        raise ReadError(path, "has no whole PTX header", WAY_OUT)
    if not ended:
        tell_unended(facts)


def _station(path: Path, file: BinaryIO, number: int, line: int, facts: Facts) -> Station | None:
    """The next header; None at the end of the file."""
    first, blank = file.readline(LINE), 0
    while first and not first.strip():
        first, blank = file.readline(LINE), blank + 1
    if not first:
        return None
    lines = [first, *(file.readline(LINE) for _ in range(9))]
    try:
        counts = [whole_of(text.strip()) for text in lines[:2]]
        rows = [[number_of(word) for word in text.split()] for text in lines[2:]]
        matrix = np.array(rows[4:], np.float64)
        if matrix.shape != (4, 4) or [len(row) for row in rows[:4]] != [3] * 4:
            raise ValueError
    except ValueError:
        wrong = f"has no whole PTX header of scan {number} in lines {line + blank + 1} to {line + blank + 10}"
        raise ReadError(path, wrong, WAY_OUT) from None
    rotation, translation = _motion(path, matrix, number, facts)
    _tell_other_place(facts, np.array(rows[0]), np.array(rows[1:4]), rotation, translation, number)
    return Station(counts[0] * counts[1], blank + len(lines), rotation, translation)


def _tell_other_place(
    facts: Facts,
    place: NDArray[np.float64],
    axes: NDArray[np.float64],
    rotation: NDArray[np.float64],
    translation: NDArray[np.float64],
    number: int,
) -> None:
    """Compare the scanner's place and axes, which stand before the matrix, with it; many programs leave them blank."""
    blank = not place.any(), not axes.any() or np.array_equal(axes, np.eye(3))
    other = not np.allclose(place, translation, atol=SAME), not np.allclose(axes, rotation, atol=SAME)
    if (other[0] and not blank[0]) or (other[1] and not blank[1]):
        what = f"the scanner of scan {number} stands elsewhere than its matrix says, which is taken"
        if np.array_equal(rotation, np.eye(3)) and not translation.any():  # some programs turn the points
            facts.tell("pose", what)
        else:
            tell_damaged(facts, what)


def _motion(
    path: Path, matrix: NDArray[np.float64], number: int, facts: Facts
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Rotation (3, 3) and translation (3,) of a matrix (4, 4) for rows; of one for columns too, which some write."""
    if matrix[:3, 3].any() and not matrix[3, :3].any():
        matrix = matrix.T
    rotation, translation = matrix[:3, :3], matrix[3, :3]
    if not rotation.any():
        facts.tell("pose", f"the matrix of scan {number} is zero: the scan is taken without a rotation")
        return np.eye(3), translation
    lengths = np.linalg.norm(rotation, axis=1)
    motion = np.isfinite(matrix).all() and (lengths > LENGTHS[0]).all() and (lengths < LENGTHS[1]).all()
    if not motion or np.linalg.det(rotation) < LENGTHS[0] ** 3:
        rows = "; ".join(" ".join(f"{v:g}" for v in row) for row in matrix)
        raise ReadError(path, f"the matrix of scan {number} is no motion ({rows})", "export the scan again, registered")
    return rotation, translation


def _table(path: Path, lines: list[bytes], width: int, line: int) -> NDArray[np.float64]:
    """Rows (k, width) of lines that follow line number `line`."""
    if width in WIDTHS:
        try:
            numbers = np.fromstring(b" ".join(lines), sep=" ")
            if len(numbers) == width * len(lines):
                return numbers.reshape(-1, width)
        except ValueError:
            pass
    for k, text in enumerate(lines, line + 1):
        words = text.split()
        try:
            bad = len(words) != width or width not in WIDTHS or not [number_of(word) for word in words]
        except ValueError:
            bad = True
        if bad:
            shown = text[:40].strip().decode("latin-1").encode("unicode_escape").decode()
            wrong = (
                f"line {k} is no row of {' or '.join(map(str, WIDTHS))} numbers ('{shown}'), or the file is truncated"
            )
            raise ReadError(path, wrong, WAY_OUT)
    return np.array([[number_of(word) for word in text.split()] for text in lines])


def _chunk(table: NDArray[np.float64], station: Station, position: NDArray[np.float64] | None, done: float) -> Chunk:
    own = np.where(np.isfinite(table[:, :3]), table[:, :3], np.nan)
    return Chunk(
        xyz=own @ station.rotation + station.translation,
        color=table[:, 4:7].copy() if table.shape[1] == 7 else None,
        intensity=table[:, 3].copy(),
        valid=np.asarray(own.any(axis=1)),
        stations=position,
        done=done,
    )

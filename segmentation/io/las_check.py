"""What of a LAS or LAZ file is looked at before its header is believed: every count against the size of the file.

The layout follows the LAS specification 1.4 R15 (ASPRS 2019), 2.4.
"""

from __future__ import annotations

import os
import struct
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import COPY_AGAIN, ReadError
from segmentation.io.facts import Facts
from segmentation.io.rest import tell_damaged
from segmentation.io.sample import corners_of
from segmentation.io.suspicions import tell_lost

SHORTEST = {0: 227, 1: 227, 2: 227, 3: 235, 4: 375}  # bytes of the header by minor version
RECORD, LONG_RECORD = 54, 60  # bytes before each variable length record, and before each extended one
SMALLEST = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)  # bytes of a point by its format
PACKED = 0x80  # bit of the point format of compressed files
RETURNS = 16  # that a pulse may have, counted from 0
SLACK = 2.0  # steps of the coordinates that a box may be rounded by
KINDS = 0x3F  # bits of the point format that tell it
VARIABLE = 2**32 - 1  # points in a chunk of compressed files whose chunks differ
FILLED = 0.9  # of the sides of their box that points fill, as it is to be theirs
SECTOR = 512  # bytes that a disk loses at least
LAYERED, USUAL = 6, 50_000  # point formats from here on have layers, in which so many points make up to 428 zero bytes
DENSEST = 50  # points that a byte of a compressed file can hold at most; scans have less than one


class Kept:
    """Whether the points that come keep what the header promises: their box, and how many there are of each return."""

    def __init__(self, header: Any) -> None:
        """With the header, as laspy has it."""
        self.header = header
        self.low, self.high = np.full(3, np.inf), np.full(3, -np.inf)
        self.returns = np.zeros(RETURNS, np.int64)
        self.zeros = 0  # points whose coordinates are zero in the file, which is their offset

    def count(self, xyz: NDArray[np.floating[Any]], returns: NDArray[np.integer[Any]]) -> None:
        """Take points (n, 3) and which return of its pulse each is (n,)."""
        low, high = corners_of(xyz)
        self.low, self.high = np.minimum(self.low, low), np.maximum(self.high, high)
        offsets = self.header.offsets
        # Points in 0, 0, 0 are looked for in all formats.
        if offsets.any() and (low <= offsets).all() and (offsets <= high).all():
            there = np.flatnonzero(xyz[:, 0] == offsets[0])
            self.zeros += int((xyz[there] == offsets).all(axis=1).sum())
        self.returns += np.bincount(returns, minlength=RETURNS)

    def tell(self, facts: Facts) -> None:
        """Say what is not as promised."""
        if self.has_box():
            off = np.maximum(self.header.mins - self.low, self.high - self.header.maxs)
            over = np.maximum(self.low - self.header.mins, self.header.maxs - self.high).max()
            if (off > SLACK * np.abs(self.header.scales)).any():
                tell_other_points(facts, f"points lie outside their box by up to {off.max():.3g}")
            elif (self.high - self.low < FILLED * (self.header.maxs - self.header.mins)).any():
                larger = f"the box in its header is larger than its points by up to {over:.3g} of its units"
                facts.tell("box", f"{larger}: cropped, or points are lost")
        else:
            facts.tell("unchecked", "the header has no box of the points: whether they are whole is not checked")
        promised = np.asarray(self.header.number_of_points_by_return, np.int64)
        there, early = self.returns[1 : len(promised) + 1], self.returns[: len(promised)]
        if promised.any() and (promised != there).any() and (promised != early).any():  # pylas counted from 0 on
            k = int(np.flatnonzero(promised != there)[0])
            tell_other_points(facts, f"of return {k + 1} there are {there[k]:,} points, not {promised[k]:,}")
        tell_lost(facts, self.zeros, f"{' '.join(f'{v:.10g}' for v in self.header.offsets)}, the offset of the file")

    def has_box(self) -> bool:
        """Whether the header has a box; one of zeros was never filled in."""
        box = np.array([self.header.mins, self.header.maxs], np.float64)
        return bool(np.isfinite(box).all() and box.any())


def tell_other_points(facts: Facts, what: str) -> None:
    """Say what points the header promises, and are not there."""
    tell_damaged(facts, f"its header promises other points ({what})")


def contradictions(path: Path, header: Any, packing: bytes) -> str:
    """What in the file contradicts the count of points in its header, in words; empty if nothing does.

    header: as laspy has it. packing: the record of a LAZ file that says how its points are packed, else empty.
    """
    with path.open("rb") as file:
        (legacy,) = struct.unpack_from("<I", file.read(SHORTEST[0]), 107)
        if packing:
            return _of_chunks(file, header, packing)
    found = []
    if legacy not in (0, header.point_count):
        found.append(f"it has two counts of points, {legacy:,} and {header.point_count:,}")
    size = path.stat().st_size
    ends = [size, header.start_of_first_evlr, header.start_of_waveform_data_packet_record]
    start, length = header.offset_to_point_data, header.point_format.size
    more = (min(end for end in ends if end >= start) - start) // length - header.point_count
    if more > 0:
        found.append(f"behind its points is room for {more:,} others")
    return "; ".join(found)


def _of_chunks(file: BinaryIO, header: Any, packing: bytes) -> str:
    """The same for the chunks of a LAZ file, which all but the last hold as many points as its record says.

    Looked for are lost sectors, too: of the layers that a chunk has, those of colours and intensities are unpacked to
    something, whatever they are.
    """
    start = header.offset_to_point_data
    file.seek(start)
    place = file.read(8)
    table = struct.unpack("<q", place)[0] if len(place) == 8 else 0
    size = file.seek(0, os.SEEK_END)
    end = table if start < table <= size else min(header.start_of_first_evlr or size, size)
    found = []
    (most,) = struct.unpack_from("<I", packing, 12)
    if header.point_format.id >= LAYERED and most <= USUAL and (lost := _zero_sectors(file, start, end)):
        found.append(f"of what they are packed in, {lost * SECTOR:,} bytes are zero")
    if most not in (0, VARIABLE) and start <= table <= size - 8:
        file.seek(table)
        (number,) = struct.unpack("<4xI", file.read(8))
        if number != (chunks := -(-header.point_count // most)):
            found.append(f"its points need {chunks:,} chunks of {most:,}, and {number:,} are there")
    return "; ".join(found)


def _zero_sectors(file: BinaryIO, start: int, end: int) -> int:
    """How many sectors between two places of a file have zero bytes alone."""
    at, end = -(-start // SECTOR) * SECTOR, end // SECTOR * SECTOR
    if end <= at:
        return 0
    words = np.memmap(file, np.uint64, "r", at, ((end - at) // SECTOR, SECTOR // 8))
    suspects = np.flatnonzero(words[:, 0] == 0)
    return sum(not words[k].any() for k in suspects)


def check_las(path: Path) -> None:
    """Refuse a header that cannot be.

    Raises:
        ReadError: counts or places in it cannot be.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(SHORTEST[4])
    if len(head) < SHORTEST[0]:
        raise ReadError(path, "is no whole LAS or LAZ file (it ends within its header)", COPY_AGAIN)
    minor = head[25]
    header_size, start, records = struct.unpack_from("<HII", head, 94)
    point_format, kind = head[104], head[104] & KINDS
    (length,) = struct.unpack_from("<H", head, 105)
    (count,) = struct.unpack_from("<I", head, 107)
    scales = np.frombuffer(head, "<f8", 6, 131)
    extended = (0, 0)
    if minor >= 4 and len(head) >= SHORTEST[4]:
        extended = struct.unpack_from("<QI", head, 235)
        count = struct.unpack_from("<Q", head, 247)[0] or count
    packed = bool(point_format & PACKED)
    most = (size - start) * DENSEST if packed else max(size - start, 0) // max(length, 1)
    wrong = {
        f"a header of {header_size} bytes": header_size < SHORTEST.get(minor, SHORTEST[0]) or header_size > size,
        f"points from byte {start} on": not header_size <= start <= size,
        f"{records:,} records before the points": records * RECORD > start - header_size,
        f"{extended[1]:,} records after the points": extended[1] > 0 and not _fits(extended, start, size),
        f"points of {length} bytes in format {kind}": kind >= len(SMALLEST) or length < SMALLEST[kind],
        "scales or offsets that cannot be": not (np.isfinite(scales).all() and (scales[:3] > 0).all()),
    }
    for what, cannot in wrong.items():
        if cannot:
            raise ReadError(path, f"is no whole LAS or LAZ file (its header tells of {what})", COPY_AGAIN)
    if count > most:
        raise ReadError(path, f"is truncated or damaged: its header promises {count} points", COPY_AGAIN)


def _fits(extended: tuple[int, int], start: int, size: int) -> bool:
    """Whether so many records from there on lie in the file."""
    at, number = extended
    return start <= at <= size and number * LONG_RECORD <= size - at

"""What of a LAS or LAZ file is looked at before its header is believed: every count against the size of the file.

The layout follows the LAS specification 1.4 R15 (ASPRS 2019), 2.4.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError

Array = NDArray[np.float64]

SHORTEST = {0: 227, 1: 227, 2: 227, 3: 235, 4: 375}  # bytes of the header by minor version
RECORD, LONG_RECORD = 54, 60  # bytes before each variable length record, and before each extended one
SMALLEST = 20  # bytes of a point
PACKED = 0x80  # bit of the point format of compressed files
SLACK = 2.0  # steps of the coordinates that a box may be rounded by
DENSEST = 200  # points that a byte of a compressed file can hold at most; scans have less than one
WAY_OUT = "copy it again from where it comes from, or export the scan again"


@dataclass(frozen=True)
class Promise:
    """What the header says of the points: how many, of each return (r,), and their box (2, 3) in its unit."""

    count: int
    returns: tuple[int, ...]
    box: Array


class Kept:
    """Whether the points that come keep what the header promises."""

    def __init__(self, promise: Promise) -> None:
        """With what is promised."""
        self.promise = promise
        self.low, self.high = np.full(3, np.inf), np.full(3, -np.inf)
        self.returns = np.zeros(16, np.int64)

    def count(self, xyz: NDArray[np.floating], returns: NDArray[np.integer]) -> None:
        """Take points (n, 3) and which return of its pulse each is (n,)."""
        for k in range(3):
            self.low[k] = min(self.low[k], xyz[:, k].min())
            self.high[k] = max(self.high[k], xyz[:, k].max())
        self.returns += np.bincount(returns, minlength=16)

    def broken(self, scales: Array) -> str:
        """What is not as promised, in words; empty if all is, or nothing was promised."""
        found = []
        low, high = self.promise.box
        if np.isfinite(self.promise.box).all() and (low <= high).all() and (low < high).any():
            off = float(np.maximum(low - self.low, self.high - high).max())
            if off > SLACK * float(np.max(scales)):
                found.append(f"points lie outside their box by up to {off:.3g}")
        promised = np.zeros(16, np.int64)
        promised[1 : len(self.promise.returns) + 1] = self.promise.returns
        known = slice(1, len(self.promise.returns) + 1)
        if promised.sum() == self.promise.count and (promised != self.returns)[known].any():
            k = int(np.flatnonzero((promised != self.returns)[known])[0]) + 1
            found.append(f"of return {k} there are {self.returns[k]:,} points, not {promised[k]:,}")
        return "; ".join(found)


def check_las(path: Path) -> Promise:
    """What the header promises.

    Raises:
        ReadError: counts or places in it cannot be.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(SHORTEST[4])
    if len(head) < SHORTEST[0]:
        raise ReadError(path, "is no whole LAS or LAZ file (it ends within its header)", WAY_OUT)
    minor = head[25]
    header_size, start, records = struct.unpack_from("<HII", head, 94)
    point_format = head[104]
    (length,) = struct.unpack_from("<H", head, 105)
    count, *returns = struct.unpack_from("<6I", head, 107)
    scales = np.frombuffer(head, "<f8", 6, 131)
    x1, x0, y1, y0, z1, z0 = struct.unpack_from("<6d", head, 179)
    extended = (0, 0)
    if minor >= 4 and len(head) >= SHORTEST[4]:
        extended = struct.unpack_from("<QI", head, 235)
        whole, *long_returns = struct.unpack_from("<16Q", head, 247)
        if whole:
            count, returns = whole, long_returns
    packed = bool(point_format & PACKED)
    most = (size - start) * DENSEST if packed else max(size - start, 0) // max(length, 1)
    wrong = {
        f"a header of {header_size} bytes": header_size < SHORTEST.get(minor, SHORTEST[0]) or header_size > size,
        f"points from byte {start} on": not header_size <= start <= size,
        f"{records:,} records before the points": records * RECORD > start - header_size,
        f"{extended[1]:,} records after the points": extended[1] > 0 and not _fits(extended, start, size),
        f"points of {length} bytes": length < SMALLEST,
        "scales or offsets that are no numbers": not np.isfinite(scales).all() or not scales[:3].all(),
    }
    for what, cannot in wrong.items():
        if cannot:
            raise ReadError(path, f"is no whole LAS or LAZ file (its header tells of {what})", WAY_OUT)
    if count > most:
        raise ReadError(path, f"is truncated or damaged: its header promises {count} points", WAY_OUT)
    return Promise(count, tuple(returns), np.array([[x0, y0, z0], [x1, y1, z1]]))


def _fits(extended: tuple[int, int], start: int, size: int) -> bool:
    """Whether so many records from there on lie in the file."""
    at, number = extended
    return start <= at <= size and number * LONG_RECORD <= size - at

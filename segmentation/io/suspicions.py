"""What points themselves tell of a file that is damaged though nothing contradicts it, in any format."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Floats
from segmentation.io.chunk import Chunk, Mask
from segmentation.io.facts import Facts
from segmentation.notes import count

FEWEST_ZEROS = 4
"""Points in 0, 0, 0 that no scan has; a lost sector of a disk makes more of them."""
RUN = 16
"""Points in succession that have one coordinate 0: none that is measured and has many digits does."""
BLOCK = 1 << 13
"""Normals that are looked at at once."""
UNIT = 0.02
"""What the length of a normal may be off 1, as those are that are kept in bytes."""


def tell_zeros(facts: Facts, parts: Sequence[Floats], taken: Sequence[Mask], corners: NDArray[np.float64]) -> None:
    """Say how many of the points (k, 3) that take part are 0, 0, 0 in the file, if it is more than a few.

    corners: (2, 3) of those that take part.
    """
    if (corners[0] > 0).any() or (corners[1] < 0).any():
        return
    zeros = 0
    for part, used in zip(parts, taken, strict=True):
        there = np.flatnonzero(part[:, 0] == 0)
        zeros += int((used[there] & (part[there, 1:] == 0).all(axis=1)).sum())
    tell_lost(facts, zeros, "0, 0, 0")


def tell_lost(facts: Facts, zeros: int, place: str) -> None:
    """Say how many points are zero bytes, which is a place where no scan has many."""
    if zeros >= FEWEST_ZEROS:
        facts.tell("zeros", f"{count(zeros, 'point')} in {place}: bytes lost from the file, or beams without an answer")


def run_of_zeros(values: NDArray[np.floating[Any]]) -> int:
    """The most values (k,) in succession that are 0; 0 if none are RUN."""
    if not (values[:: RUN // 2] == 0).any():  # of which a run has one at least
        return 0
    zero = values == 0
    others = np.concatenate([[-1], np.flatnonzero(~zero), [len(zero)]])
    longest = int(np.diff(others).max()) - 1
    return longest if longest >= RUN else 0


def unit_normals(facts: Facts, parts: Sequence[Chunk]) -> list[Floats | None]:
    """The normals (k, 3) of each chunk, of unit length, zero where there is none; tells how many had to be changed."""
    found: list[Floats | None] = []
    none = scaled = 0
    for part in parts:
        normals = part.normals
        if normals is not None:
            if normals.dtype.kind != "f":  # whole numbers, whose squares they could not hold
                normals = normals.astype(np.float32)
            off = _off(normals)
            if off is not None:
                normals, bad = _scaled(normals, off)
                none, scaled = none + bad, scaled + int(off.sum()) - bad
        found.append(normals)
    if none:
        facts.tell("normals", f"{count(none, 'normal')} of the file that are NaN or infinite: left out")
    if scaled:
        facts.tell("normals", f"{count(scaled, 'normal')} of the file not of unit length: taken as directions")
    return found


def _off(normals: Floats) -> Mask | None:
    """Which normals (k, 3) are neither of unit length nor zero, NaN among them; None if none, as is usual."""
    ones = np.ones(3, normals.dtype)
    blocks = (normals[k : k + BLOCK] for k in range(0, len(normals), BLOCK))  # of which each stays in the cache
    squares = [(block * block) @ ones for block in blocks]
    if all(s.min() >= 1 - 2 * UNIT and s.max() <= 1 + 2 * UNIT for s in squares):
        return None
    lengths = np.concatenate(squares)
    off: Mask = ~(np.abs(lengths - 1) <= 2 * UNIT) & (normals != 0).any(axis=1)
    return off if off.any() else None


def _scaled(normals: Floats, off: NDArray[np.bool_]) -> tuple[Floats, int]:
    """The normals with those of a mask made unit vectors, or zero if they are none, and how many are none."""
    changed = normals.astype(np.float64)
    those = changed[off]
    those[~np.isfinite(those).all(axis=1)] = 0
    largest = np.abs(those).max(axis=1, keepdims=True)
    those /= np.where(largest == 0, 1, largest)  # lest squares overflow
    length = np.linalg.norm(those, axis=1, keepdims=True)
    changed[off] = those / np.where(length == 0, 1, length)
    return changed.astype(np.float32), int((largest == 0).sum())

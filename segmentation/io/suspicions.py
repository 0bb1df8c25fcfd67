"""What points themselves tell of a file that is damaged though nothing contradicts it, in any format."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Floats
from segmentation.io.chunk import Chunk, Mask
from segmentation.io.facts import Facts
from segmentation.notes import count

FEWEST = 4
"""Points in 0, 0, 0 that no scan has; a lost sector of a disk makes more of them."""
UNIT = 0.02
"""What the length of a normal may be off 1, as those are that are kept in bytes."""


def tell_zeros(facts: Facts, parts: Sequence[Floats], taken: Sequence[Mask]) -> None:
    """Say how many of the points (k, 3) that take part are 0, 0, 0 in the file, if it is more than a few."""
    zeros = 0
    for part, used in zip(parts, taken, strict=True):
        there = np.flatnonzero(part[:, 0] == 0)
        zeros += int((used[there] & (part[there, 1:] == 0).all(axis=1)).sum())
    if zeros >= FEWEST:
        facts.tell("zeros", f"{count(zeros, 'point')} in 0, 0, 0: bytes lost from the file, or beams without an answer")


def unit_normals(facts: Facts, parts: Sequence[Chunk]) -> list[Floats | None]:
    """The normals (k, 3) of each chunk, of unit length, zero where there is none; tells how many had to be changed."""
    found: list[Floats | None] = []
    none = scaled = 0
    for part in parts:
        normals = part.normals
        if normals is not None:
            squares = np.einsum("ij,ij->i", normals, normals, dtype=np.float64)
            off = ~(np.abs(squares - 1) <= 2 * UNIT) & (squares != 0)  # NaN is off too
            if off.any():
                normals, bad = _scaled(normals, off)
                none, scaled = none + bad, scaled + int(off.sum()) - bad
        found.append(normals)
    if none:
        facts.tell("normals", f"{count(none, 'normal')} of the file that are NaN or infinite: left out")
    if scaled:
        facts.tell("normals", f"{count(scaled, 'normal')} of the file not of unit length: taken as directions")
    return found


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

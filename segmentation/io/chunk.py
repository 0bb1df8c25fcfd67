"""From the runs of points that a reader yields to one Cloud: invalid points dropped, Z up, shifted, ranges unified."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud, Floats, Up, turn
from segmentation.errors import ReadError
from segmentation.io.ranges import color16, intensity16

Progress = Callable[[float], object]
Numbers = NDArray[np.integer[Any]] | Floats

SIZE = 1_000_000
"""Points in a chunk: large enough to keep the cores busy, small beside a scan."""
FAR = 10_000.0
"""Beyond this [m] coordinates are projected ones, and are shifted."""
FLOAT32_REACH = 800.0
"""Up to here [m] float32 rounds by 0.03 mm at most."""
MINIMUM = 4
"""With fewer points there is neither a scan nor any shape."""


@dataclass(frozen=True, eq=False)
class Chunk:
    """A run of k points as the file has them, in its own axes, coordinates and ranges.

    xyz: (k, 3); normals: (k, 3); color: (k, 3) and intensity: (k,) in any range; classification: (k,).
    valid: (k,) bool, or None where all are. stations: (j, 3) scanner positions. done: share of the file read so far.
    """

    xyz: Floats
    normals: Floats | None = None
    color: Numbers | None = None
    intensity: Numbers | None = None
    classification: NDArray[np.uint8] | None = None
    valid: NDArray[np.bool_] | None = None
    stations: NDArray[np.float64] | None = None
    done: float = 0.0


def assemble(chunks: Iterable[Chunk], path: Path, *, up: Up, progress: Progress | None) -> Cloud:
    """One Cloud of all chunks in their order. Raises ReadError if fewer than MINIMUM points are valid."""
    parts, masks = [], []
    for chunk in chunks:
        finite = np.isfinite(chunk.xyz)
        mask = np.ones(len(finite), np.bool_) if finite.all() else np.logical_and.reduce(finite, axis=1)
        if chunk.valid is not None:
            mask &= chunk.valid
        parts.append(_prepared(chunk, mask, up))
        masks.append(mask)
        if progress is not None:
            progress(chunk.done)
    kept = np.concatenate(masks) if masks else np.zeros(0, np.bool_)
    n = int(kept.sum())
    _check_count(path, total=len(kept), valid=n)
    stations = np.concatenate([p.stations for p in parts if p.stations is not None] or [np.zeros((0, 3))])

    low = np.min([p.xyz.min(axis=0) for p in parts if len(p.xyz)], axis=0).astype(np.float64)
    high = np.max([p.xyz.max(axis=0) for p in parts if len(p.xyz)], axis=0).astype(np.float64)
    origin = np.floor(low) if max(np.abs(low).max(), np.abs(high).max()) > FAR else np.zeros(3)
    reach = max(np.abs(low - origin).max(), np.abs(high - origin).max())

    normals = _joined([p.normals for p in parts], [len(p.xyz) for p in parts])
    color = _joined([p.color for p in parts], [len(p.xyz) for p in parts])
    intensity = _joined([p.intensity for p in parts], [len(p.xyz) for p in parts])
    classification = _joined([p.classification for p in parts], [len(p.xyz) for p in parts])
    return Cloud(
        xyz=_shifted(parts, n, origin, np.float32 if reach < FLOAT32_REACH else np.float64),
        origin=origin,
        normals=None if normals is None else normals.astype(np.float32, copy=False),
        color=None if color is None else color16(color),
        intensity=None if intensity is None else intensity16(intensity),
        classification=None if classification is None else classification.astype(np.uint8, copy=False),
        stations=stations - origin,
        source=path,
        up=up,
        dropped=len(kept) - n,
        kept=None if n == len(kept) else kept,
    )


def _prepared(chunk: Chunk, mask: NDArray[np.bool_], up: Up) -> Chunk:
    """The valid points of a chunk, Z up."""

    def valid(values: Any) -> Any:
        return values if values is None or mask.all() else values[mask]

    return Chunk(
        xyz=turn(valid(chunk.xyz), up),
        normals=None if chunk.normals is None else turn(valid(chunk.normals), up),
        color=valid(chunk.color),
        intensity=valid(chunk.intensity),
        classification=valid(chunk.classification),
        stations=None if chunk.stations is None else turn(chunk.stations, up),
    )


def _joined(arrays: list[Any], lengths: list[int]) -> Any:
    """The arrays in one, zeros where a part has none; None if no part has any."""
    first = next((a for a in arrays if a is not None), None)
    if first is None:
        return None
    zeros = (np.zeros((n, *first.shape[1:]), first.dtype) for n in lengths)
    return np.concatenate([z if a is None else a for a, z in zip(arrays, zeros, strict=True)])


def _shifted(parts: list[Chunk], n: int, origin: NDArray[np.float64], dtype: type[np.floating[Any]]) -> Floats:
    """Coordinates of all parts minus origin. Empties `parts`, so that the two never stand side by side in full."""
    xyz = np.empty((n, 3), dtype)
    parts.reverse()
    at = 0
    while parts:
        part = parts.pop().xyz
        xyz[at : at + len(part)] = part - origin if origin.any() else part
        at += len(part)
    return xyz


def _check_count(path: Path, *, total: int, valid: int) -> None:
    if total == 0:
        raise ReadError(path, "holds no points", "export the scan again with its points")
    if valid == 0:
        raise ReadError(path, f"all {total} points are NaN, infinite or marked invalid", "export the scan again")
    if valid < MINIMUM:
        raise ReadError(path, f"holds {valid} valid point(s), needed are {MINIMUM}", "give a whole scan")

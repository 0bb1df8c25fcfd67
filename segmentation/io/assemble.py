"""From the runs of points that a reader yields to one Cloud.

What is no point is dropped; what is marked or far from all else is set aside; up is Z, lengths are metres, coordinates
are local, colours and intensities have one range.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud, Floats, Up, turn
from segmentation.errors import ReadError
from segmentation.io.chunk import Chunk, Mask, Progress
from segmentation.io.facts import Facts
from segmentation.io.place import origin_of
from segmentation.io.precision import check_precision
from segmentation.io.ranges import color16, intensity16
from segmentation.io.sample import box_of, corners_of, sample
from segmentation.io.scale import scale_of
from segmentation.io.specks import far_specks
from segmentation.io.suspicions import tell_zeros, unit_normals
from segmentation.notes import count

FLOAT32_REACH = 800.0
"""Up to here [m] float32 rounds by 0.03 mm at most."""
HUGE = 1e12
"""Coordinates beyond this are no lengths on earth in any unit; they are taken for infinite."""
LARGE = 1e9
"""Beside coordinates beyond this, those beyond HUGE are no beams without an answer but points of the scan."""
MINIMUM = 4
"""With fewer points there is neither a scan nor any shape."""


def assemble(
    chunks: Iterable[Chunk],
    path: Path,
    facts: Facts,
    *,
    up: Up,
    unit: str | None = None,
    origin: NDArray[np.float64] | None = None,
    keep_marked: bool = False,
    progress: Progress | None = None,
) -> Cloud:
    """One Cloud of all chunks in their order; see `segmentation.io.read` for the keywords.

    Raises ReadError if fewer than MINIMUM points are valid and unmarked, or the coordinates can be no scan's.
    """
    parts: list[Chunk] = []
    points: list[Mask] = []  # which points of the file are points
    taken: list[Mask] = []  # which of those take part
    ends: list[NDArray[np.float64]] = []  # corners of those that do
    marked: Counter[str] = Counter()
    reach = 0.0  # of finite coordinates
    for chunk in chunks:
        mask, part, used, corners = _sorted(chunk, marked, keep_marked)
        if not mask.all():
            reach = max(reach, float(np.abs(np.where(np.isfinite(chunk.xyz), chunk.xyz, 0.0)).max(initial=0)))
        points.append(mask)
        taken.append(used)
        parts.append(part)
        ends.append(corners)
        if progress is not None:
            progress(chunk.done)
    n = sum(int(used.sum()) for used in taken)
    _check_place(path, reach, ends)
    _check_count(path, total=sum(map(len, points)), valid=sum(len(p.xyz) for p in parts), unmarked=n)

    corners = box_of(ends)
    specks = far_specks([p.xyz for p in parts], taken, corners)
    if specks is not None:
        taken = [used & ~speck for used, speck in zip(taken, specks, strict=True)]
        n = sum(int(used.sum()) for used in taken)
        corners = box_of([corners_of(p.xyz[used]) for p, used in zip(parts, taken, strict=True)])
    few = sample([p.xyz for p in parts], taken)
    scale = scale_of(path, facts, few, n, asked=unit, up=up)
    if specks is not None:
        _tell_specks(facts, parts, specks, corners, scale)
    check_precision(path, facts, few, scale)
    where = origin_of(path, facts, np.sort(turn(corners * scale, up), axis=0), asked=origin)
    _tell_marked(facts, marked, keep_marked)
    _tell_dropped(facts, sum(map(len, points)) - sum(len(p.xyz) for p in parts), sum(map(len, points)))
    tell_zeros(facts, [p.xyz for p in parts], taken, corners)
    parts = [replace(p, normals=normals) for p, normals in zip(parts, unit_normals(facts, parts), strict=True)]

    places = np.concatenate(points)
    if n == len(places):
        return _cloud(parts, path, facts, up=up, scale=scale, origin=where, corners=corners, kept=None, dropped=0)
    mine, others = places.copy(), places.copy()
    mine[places], others[places] = (used := np.concatenate(taken)), ~used
    dropped = len(places) - int(places.sum())
    aside = None
    if n < len(used):
        rest = [p.only(~used) for p, used in zip(parts, taken, strict=True)]
        around = box_of([corners_of(p.xyz) for p in rest])
        parts = [p.only(used) for p, used in zip(parts, taken, strict=True)]
        aside = _cloud(
            rest, path, Facts(), up=up, scale=scale, origin=where, corners=around, kept=others, dropped=0, like=parts
        )
    return _cloud(
        parts, path, facts, up=up, scale=scale, origin=where, corners=corners, kept=mine, dropped=dropped, aside=aside
    )


def _sorted(chunk: Chunk, marked: Counter[str], keep_marked: bool) -> tuple[Mask, Chunk, Mask, NDArray[np.float64]]:
    """Which points of a chunk are points, those points, which of them take part, their corners; counts the marked."""
    corners = corners_of(chunk.xyz)
    mask = np.ones(len(chunk.xyz), np.bool_)
    whole = bool((np.abs(corners) < HUGE).all())  # never true of NaN
    if not whole:
        mask &= np.logical_and.reduce(np.abs(chunk.xyz) < HUGE, axis=1)
    if chunk.valid is not None:
        mask &= chunk.valid
        whole = whole and bool(chunk.valid.all())
    used = np.ones(len(mask), np.bool_)
    for name, those in chunk.marks.items():
        marked[name] += int((those & used & mask).sum())
        used &= ~those
    part = chunk.only(mask)
    used = np.ones(len(part.xyz), np.bool_) if keep_marked else used[mask]
    if not (whole and used.all()):
        corners = corners_of(part.xyz[used])
    return mask, part, used, corners


def _cloud(
    parts: list[Chunk],
    path: Path,
    facts: Facts,
    *,
    up: Up,
    scale: NDArray[np.float64],
    origin: NDArray[np.float64],
    corners: NDArray[np.float64],
    kept: Mask | None,
    dropped: int,
    aside: Cloud | None = None,
    like: Sequence[Chunk] = (),
) -> Cloud:
    """The Cloud of chunks without a point that is none; `like`: others that tell its ranges. Empties `parts`."""
    lengths = [len(p.xyz) for p in parts]
    normals = _joined([p.normals for p in parts], lengths)
    color = _joined([p.color for p in parts], lengths)
    intensity = _joined([p.intensity for p in parts], lengths)
    classification = _joined([p.classification for p in parts], lengths)
    stations = np.concatenate([p.stations for p in parts if p.stations is not None] or [np.zeros((0, 3))])
    reach = float(np.abs(turn(corners * scale, up) - origin).max())
    return Cloud(
        xyz=_shifted(parts, scale, up, origin, np.float32 if reach < FLOAT32_REACH else np.float64),
        origin=origin,
        normals=None if normals is None else turn(normals.astype(np.float32, copy=False), up),
        color=None if color is None else color16(color, _like("color", like)),
        intensity=None if intensity is None else intensity16(intensity, _like("intensity", like)),
        classification=None if classification is None else classification.astype(np.uint8, copy=False),
        stations=turn(stations * scale, up) - origin,
        source=path,
        up=up,
        dropped=dropped,
        kept=kept,
        aside=aside,
        scale=scale,
        crs=facts.crs,
        notes=facts.told(),
    )


def _like(name: str, parts: Sequence[Chunk]) -> Any:
    """That attribute of the chunks that have it, in one; None if none has."""
    found = [values for part in parts if (values := getattr(part, name)) is not None and len(values)]
    return np.concatenate(found) if found else None


def _joined(arrays: list[Any], lengths: list[int]) -> Any:
    """The arrays in one, zeros where a part has none; None if no part has any."""
    first = next((a for a in arrays if a is not None), None)
    if first is None:
        return None
    zeros = (np.zeros((n, *first.shape[1:]), first.dtype) for n in lengths)
    return np.concatenate([z if a is None else a for a, z in zip(arrays, zeros, strict=True)])


def _shifted(
    parts: list[Chunk],
    scale: NDArray[np.float64],
    up: Up,
    origin: NDArray[np.float64],
    dtype: type[np.floating[Any]],
) -> Floats:
    """Coordinates of all parts in metres, Z up, minus origin. Empties `parts`, lest the two stand side by side."""
    xyz = np.empty((sum(len(p.xyz) for p in parts), 3), dtype)
    at = 0
    parts.reverse()
    while parts:
        part = parts.pop().xyz
        rows = part if (scale == 1).all() else part * scale
        rows = turn(rows, up)
        xyz[at : at + len(part)] = rows - origin if origin.any() else rows
        at += len(part)
    return xyz


def _check_place(path: Path, reach: float, ends: list[NDArray[np.float64]]) -> None:
    """See that coordinates, finite ones of which reach so far, and the valid ones to these corners, are on earth."""
    corners = box_of(ends)
    if reach >= HUGE and not (np.abs(corners) < LARGE).all():
        wrong = f"has coordinates up to {reach:.2g}, which are no lengths on earth"
        raise ReadError(path, wrong, "export it again in metres, or with a shift taken off the coordinates")


def _check_count(path: Path, *, total: int, valid: int, unmarked: int) -> None:
    if total == 0:
        raise ReadError(path, "holds no points", "export the scan again with its points")
    if valid == 0:
        raise ReadError(path, f"all {total} points are NaN, infinite or marked invalid", "export the scan again")
    if unmarked < MINIMUM <= valid:
        wrong = f"all but {unmarked} of its {valid:,} points are marked as noise, withheld or invalid"
        raise ReadError(path, wrong, "say --keep-marked to use them all the same")
    if valid < MINIMUM:
        raise ReadError(path, f"holds {valid} valid point(s), needed are {MINIMUM}", "give a whole scan")


def _tell_marked(facts: Facts, marked: Counter[str], kept: bool) -> None:
    told = ", ".join(f"{n:,} {name}" for name, n in marked.items() if n)
    if told and kept:
        facts.tell("marked", f"points that the file marks are used, as asked: {told}")
    elif told:
        facts.tell("marked", f"left out as the file marks them: {told}; --keep-marked uses them")


def _tell_dropped(facts: Facts, dropped: int, total: int) -> None:
    if dropped:
        what = f"{count(dropped, 'point')} of the file that are NaN, infinite or empty beams"
        share = 100 * dropped / total
        said = "less than 0.1" if share < 0.1 else "more than 99" if share > 99 else f"{share:.2g}"
        facts.tell("dropped", f"{what}, {said}% of all: dropped")


def _tell_specks(
    facts: Facts,
    parts: Sequence[Chunk],
    specks: Sequence[Mask],
    corners: NDArray[np.float64],
    scale: NDArray[np.float64],
) -> None:
    """Say how many points were set aside, and how far they are from the box of all others."""
    far = 0.0
    for part, speck in zip(parts, specks, strict=True):
        if speck.any():
            off = np.maximum(np.maximum(corners[0] - part.xyz[speck], part.xyz[speck] - corners[1]), 0.0)
            far = max(far, float(np.linalg.norm(off * scale, axis=1).max()))
    number = sum(int(speck.sum()) for speck in specks)
    facts.tell("specks", f"{count(number, 'point')} far from all others, by up to {far:,.0f} m: set aside")

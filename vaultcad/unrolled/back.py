"""Lines drawn on a sheet, on the vault as it stands: on the ideal surface, moved by what was measured there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vaultcad.coordinates import Coordinates, placed
from vaultcad.errors import ExportError
from vaultcad.labelled_scan import LabelledScan
from vaultcad.one_thread import one_thread
from vaultcad.unrolled.drawn_lines import DrawnLine, LiftedLine
from vaultcad.unrolled.raster import LaidScan, lay_scan

STEP = 0.02  # [m] between points of a line in space, which follows the surface
CELL = 0.02  # [m] over which the deviation is taken, with the cells around
Array = NDArray[np.float64]


@one_thread
def lift_lines(
    scan: LabelledScan, number: int, lines: Sequence[DrawnLine], coordinates: Coordinates = "file"
) -> tuple[list[LiftedLine], list[str]]:
    """Lines on the sheet of a vault, by its 1-based number, in those coordinates; and what to know.

    A line that crosses from one part of the sheet to another is cut between them. Where the scan saw nothing it lies
    on the ideal surface.

    Raises:
        NoSuchVaultError: there is no such vault.
        ExportError: a point that was drawn lies off all parts; names line, point and place.
    """
    scan.model.check_number(number)
    laid = lay_scan(scan, number)
    measured = _Measured(laid)
    found, unseen, cut = [], 0, 0
    for line in lines:
        parts = list(_on_parts(laid, line))
        cut += len(parts) - 1
        for st, leaf in parts:
            xyz, _ = laid.sheet.lift(st)
            deviation = measured.at(st)
            unseen += int(np.isnan(deviation).sum())
            off = np.nan_to_num(deviation)
            stone = xyz + off[:, None] * laid.sheet.normals(xyz)
            name = laid.sheet.leaves[leaf].name
            there = placed(scan.model, in_scan(scan, number, stone), coordinates)
            found.append(LiftedLine(line.name, name, there, st, off))
    notes = []
    if cut:
        notes.append(f"lines that cross from part to part were cut there, {cut} times")
    if unseen:
        notes.append(f"{unseen} points are on the ideal surface, for the scan saw nothing there")
    return found, notes


def in_scan(scan: LabelledScan, number: int, xyz: Array) -> Array:
    """Points (n, 3) [m] of a vault's frame where the scan has them, z up."""
    place = scan.model.vaults[number - 1].pose.placement()
    there: Array = xyz @ place[:3, :3].T + place[:3, 3] + scan.model.origin
    return there


def _on_parts(laid: LaidScan, line: DrawnLine) -> Iterator[tuple[Array, int]]:
    """The stretches of a line that are on one part of the sheet each, with points every `STEP`, and the part."""
    _, leaf = laid.sheet.lift(line.points)
    if (off := np.flatnonzero(leaf < 0)).size:
        s, t = line.points[off[0]]
        raise ExportError(
            f"{line.name}, point {off[0] + 1} at ({s:.3f}, {t:.3f}) lies off all parts of the sheet of vault "
            f"{laid.number}; draw within the outlines"
        )
    points = _followed(line.points)
    _, leaf = laid.sheet.lift(points)
    ends = np.flatnonzero(np.diff(leaf)) + 1
    for run in np.split(np.arange(len(points)), ends):
        if leaf[run[0]] >= 0:
            yield points[run], int(leaf[run[0]])


def _followed(points: Array) -> Array:
    """A line with further points (n, 2), none farther than `STEP` from the next."""
    rows = [points[:1]]
    for a, b in pairwise(points):
        count = max(1, int(np.ceil(np.hypot(*(b - a)) / STEP)))
        rows.append(a + (b - a) * np.linspace(0, 1, count + 1)[1:, None])
    return np.concatenate(rows)


class _Measured:
    """The mean deviation of a scan's points about places of a sheet."""

    def __init__(self, laid: LaidScan) -> None:
        self._corner = laid.corner
        s0, t0, s1, t1 = laid.sheet.bounds
        self._shape = int((s1 - s0) / CELL) + 3, int((t1 - t0) / CELL) + 3
        deviation = laid.scan.deviation[laid.which].astype(np.float64)
        at = np.ravel_multi_index(self._cells(laid.place).T, self._shape, mode="clip")
        size = self._shape[0] * self._shape[1]
        self._sums = np.bincount(at, deviation, size).reshape(self._shape)
        self._counts = np.bincount(at, minlength=size).reshape(self._shape)

    def _cells(self, place: NDArray[np.floating]) -> NDArray[np.int64]:
        cells: NDArray[np.int64] = (place / CELL).astype(np.int64) + 1
        return cells

    def at(self, st: Array) -> Array:
        """At places (n, 2) [m]; NaN where there are no points."""
        x, y = self._cells(st - self._corner).T
        total, count = np.zeros(len(st)), np.zeros(len(st))
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                here = np.clip(x + i, 0, self._shape[0] - 1), np.clip(y + j, 0, self._shape[1] - 1)
                total += self._sums[here]
                count += self._counts[here]
        mean: Array = np.divide(total, count, out=np.full(len(st), np.nan), where=count > 0)
        return mean

"""What a scan shows of a vault on its unrolled sheet: the mean of its points in each pixel."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import ceil, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families.unrolled.sheet import Sheet, unrolled
from segmentation.threads import threads
from vaultcad.errors import ExportError
from vaultcad.labelled_scan import LabelledScan
from vaultcad.unrolled.gaps import filled

CHUNK = 1 << 17  # points that a thread takes at once
PIXELS = (0.001, 0.002, 0.003, 0.004, 0.005)  # m, of which the first is chosen that points fill
LARGER = (0.01, 0.02, 0.05)  # m, where the sheet is too large for these
MOST_PIXELS = 30_000_000  # of a sheet whose pixel is chosen
MOST_ASKED = 250_000_000  # and of one whose pixel is asked for
WHAT = ("deviation", "height", "intensity", "colour")


@dataclass(frozen=True, eq=False)
class LaidScan:
    """The points of one vault on its sheet. which: (n,) of the scan; place: (n, 2) float32 from the sheet's corner."""

    scan: LabelledScan
    number: int
    sheet: Sheet
    which: NDArray[np.int64]
    place: NDArray[np.float32]

    @property
    def spacing(self) -> float:
        """How far apart points lie on the mean [m]."""
        area = sum(leaf.chart.surface for leaf in self.sheet.leaves)
        return sqrt(area / max(len(self.which), 1))

    @cached_property
    def corner(self) -> NDArray[np.float64]:
        """The sheet's lower left corner (2,) [m]."""
        return np.array(self.sheet.bounds[:2])

    def values(self, what: str) -> NDArray[Any] | None:
        """Of each point (n,), or its colours (n, 3); None where the scan has none."""
        match what:
            case "deviation":
                found: NDArray[Any] | None = self.scan.deviation
            case "height":
                found = self.scan.xyz[:, 2]
            case "intensity":
                found = self.scan.intensity
            case _:
                found = self.scan.color if self.scan.color is not None and self.scan.color.any() else None
        return None if found is None else found[self.which]


def lay_scan(scan: LabelledScan, number: int) -> LaidScan:
    """The points of a vault, by its 1-based number, where they lie on its sheet."""
    fitted = scan.model.vaults[number - 1]
    sheet, mine = unrolled(fitted.vault), scan.of(number)
    place = np.empty((len(mine), 2), np.float32)
    corner = np.array(sheet.bounds[:2])

    def lay(start: int) -> None:
        part = mine[start : start + CHUNK]
        found, _ = sheet.lay(scan.in_frame(fitted, part), scan.component[part])
        place[start : start + CHUNK] = found - corner

    with threads() as pool:
        list(pool.map(lay, range(0, len(mine), CHUNK)))
    known = np.isfinite(place[:, 0])
    return LaidScan(scan, number, sheet, mine[known], place[known])


@dataclass(frozen=True, eq=False)
class Raster:
    """Pixels of a sheet, the first row at its top. counts: (n, m) of points. channels: by name (n, m) or (3, n, m).

    pixel: side of a pixel [m]. left, top: of the first pixel's corner on the sheet [m]. Where nothing was seen: NaN.
    """

    pixel: float
    left: float
    top: float
    counts: NDArray[np.uint32]
    channels: dict[str, NDArray[np.float32]]


def pixel_for(laid: LaidScan) -> float:
    """The smallest of the usual sides of a pixel [m] that points fill; a larger one where the sheet is too large."""
    s0, t0, s1, t1 = laid.sheet.bounds
    dense = next((p for p in PIXELS if p >= laid.spacing), PIXELS[-1])
    least = sqrt((s1 - s0) * (t1 - t0) / MOST_PIXELS)
    return next((p for p in (*PIXELS, *LARGER) if p >= max(dense, least)), LARGER[-1])


def raster(laid: LaidScan, pixel: float, what: Iterable[str]) -> Raster:
    """The means of what is asked for in each pixel, gaps between points closed.

    Raises:
        ExportError: it would be of more than `MOST_ASKED` pixels; says which pixel would do.
    """
    s0, t0, s1, t1 = laid.sheet.bounds
    wide, tall = ceil((s1 - s0) / pixel), ceil((t1 - t0) / pixel)
    if wide * tall > MOST_ASKED:
        least = sqrt((s1 - s0) * (t1 - t0) / MOST_ASKED)
        raise ExportError(
            f"--pixel {pixel:g}: the sheet of vault {laid.number} would have {wide} x {tall} pixels; "
            f"give {ceil(1e4 * least) / 1e4:g} or more"
        )
    x = np.clip((laid.place[:, 0] / np.float32(pixel)).astype(np.int64), 0, wide - 1)
    y = np.clip((laid.place[:, 1] / np.float32(pixel)).astype(np.int64), 0, tall - 1)
    at = (tall - 1 - y) * wide + x
    counts = np.bincount(at, minlength=wide * tall).astype(np.uint32)
    shape, names, rows = (tall, wide), [], []
    for name in what:
        if (values := laid.values(name)) is not None:
            for column in values.T if values.ndim == 2 else (values,):
                names.append(name)
                rows.append(_means(at, column, counts).reshape(shape))
    closed = filled(np.stack(rows), counts.reshape(shape)) if rows else np.zeros((0, *shape), np.float32)
    channels = {name: closed[[k for k, own in enumerate(names) if own == name]] for name in dict.fromkeys(names)}
    channels = {name: rows if len(rows) > 1 else rows[0] for name, rows in channels.items()}
    return Raster(pixel, s0, t0 + tall * pixel, counts.reshape(shape), channels)


def _means(at: NDArray[np.int64], values: NDArray[Any], counts: NDArray[np.uint32]) -> NDArray[np.float32]:
    sums = np.bincount(at, weights=values, minlength=len(counts))
    with np.errstate(invalid="ignore"):
        found: NDArray[np.float32] = (sums / counts).astype(np.float32)
    return found

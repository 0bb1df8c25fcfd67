"""What a scan shows of a vault on its unrolled sheet: the mean of its points in each pixel."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import ceil, sqrt
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from families.unrolled.sheet import Sheet, unrolled
from segmentation.threads import threads
from vaultcad.errors import ExportError
from vaultcad.labelled_scan import LabelledScan
from vaultcad.unrolled.gaps import fill

CHUNK = 1 << 17  # points that a thread takes at once
PIXELS = (0.001, 0.002, 0.003, 0.004, 0.005)  # m, of which the first is chosen that points fill
LARGER = (0.01, 0.02, 0.05)  # m, where the sheet is too large for these
MOST_PIXELS = 20_000_000  # of a sheet whose pixel is chosen
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
    at = _pixels(laid.place, pixel, wide, tall)
    counts = np.bincount(at, minlength=wide * tall).astype(np.uint32)
    known = {name: values for name in what if (values := laid.values(name)) is not None}
    columns = [(name, row) for name, values in known.items() for row in (values.T if values.ndim == 2 else (values,))]
    means = np.zeros((len(columns), tall * wide), np.float32)
    for mean, (_, row) in zip(means, columns, strict=True):
        _add(at, row, counts, mean)
    means[:, counts == 0] = np.nan
    shape = (tall, wide)
    closed, counted = means.reshape(len(columns), *shape), counts.reshape(shape)
    fill(closed, counted)
    names = [name for name, _ in columns]
    channels = {name: closed[names.index(name) :][: names.count(name)] for name in known}
    channels = {name: rows if len(rows) > 1 else rows[0] for name, rows in channels.items()}
    return Raster(pixel, s0, t0 + tall * pixel, counted, channels)


def _pixels(place: NDArray[np.float32], pixel: float, wide: int, tall: int) -> NDArray[np.int32]:
    """The pixel (n,) in which each point is, counted along rows from the top."""
    x, y = (
        np.clip((place[:, k] / np.float32(pixel)).astype(np.int32), 0, most - 1) for k, most in enumerate((wide, tall))
    )
    found: NDArray[np.int32] = (tall - 1 - y) * np.int32(wide) + x
    return found


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator,unused-ignore]
def _add(at: NDArray[np.int32], values: NDArray[Any], counts: NDArray[np.uint32], mean: NDArray[np.float32]) -> None:
    """Add to the mean of each pixel its points' shares; in single precision, as a sheet of all channels is large."""
    for k in range(len(at)):
        mean[at[k]] += values[k] / counts[at[k]]

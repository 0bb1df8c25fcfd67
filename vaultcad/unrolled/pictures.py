"""Rasters as pictures: PNG with a world file for the eye and for GIS, GeoTIFF with the values themselves."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from families.drawing.deviation_colours import limit_of, shades
from families.drawing.height_colours import height_shades
from vaultcad.unrolled.raster import Raster

if TYPE_CHECKING:
    from PIL.Image import Image

LEVELS = 255  # shades of a palette; the one before them is clear
CLEAR = 0
THINNED = 7  # one of so many pixels tells where shades end
STRETCHED = (0.02, 0.98)  # between which shares of the pixels intensities and heights are stretched
PACKED = 3  # of zlib's levels: twice as fast as its usual one, and a tenth larger
SCALE, TIEPOINT, KEYS, NO_DATA = 33550, 33922, 34735, 42113  # tags of GeoTIFF (OGC 19-008r4) and of GDAL
PREDICTOR, FLOATING = 317, 3  # a tag of TIFF, and its value: numbers by their neighbours' (Adobe's Technical Note 3)
# Version 1.1.0, two keys: a model of one's own projected system, whose pixels are areas.
LOCAL = (1, 1, 0, 2, 1024, 0, 1, 32767, 1025, 0, 1, 1)
MEASURED = ("deviation", "height")  # whose values are written, too


def write_picture(found: Raster, what: str, path: Path) -> None:
    """A channel as PNG, clear where nothing was seen, and its world file beside it."""
    picture = _picture(found.channels[what], what)
    picture.save(path, "PNG", compress_level=PACKED)
    write_world(found, path)


def write_world(found: Raster, path: Path) -> None:
    """The world file of a picture: its pixel, and the middle of its first one on the sheet [m]."""
    half = found.pixel / 2
    numbers = (found.pixel, 0.0, 0.0, -found.pixel, found.left + half, found.top - half)
    path.with_suffix(".pgw").write_text("".join(f"{number:.9f}\n" for number in numbers), encoding="ascii")


def write_values(found: Raster, what: str, path: Path, raised: float = 0.0) -> None:
    """A channel [m] as GeoTIFF of 32-bit numbers, `raised` added; NaN where nothing was seen."""
    from PIL import Image
    from PIL.TiffImagePlugin import ImageFileDirectory_v2

    tags = ImageFileDirectory_v2()
    for tag, kind, value in (
        (SCALE, 12, (found.pixel, found.pixel, 0.0)),
        (TIEPOINT, 12, (0.0, 0.0, 0.0, found.left, found.top, 0.0)),
        (KEYS, 3, LOCAL),
        (NO_DATA, 2, "nan"),
        (PREDICTOR, 3, FLOATING),
    ):
        tags.tagtype[tag] = kind
        tags[tag] = value
    picture = Image.fromarray((found.channels[what] + np.float32(raised)).astype(np.float32))
    picture.save(path, "TIFF", compression="tiff_lzw", tiffinfo=tags)


def _picture(values: NDArray[np.float32], what: str) -> Image:
    from PIL import Image

    if values.ndim == 3:
        known = np.isfinite(values[0])
        opaque = np.where(known, 255, 0).astype(np.uint8)
        rgb = [(np.where(known, channel, 0.0) / 257 + 0.5).astype(np.uint8) for channel in values]
        return Image.fromarray(np.dstack([*rgb, opaque]), "RGBA")
    low, high = _ends(values, what)
    share = (values - np.float32(low)) * np.float32((LEVELS - 1) / (high - low))
    index = np.where(np.isfinite(share), 1 + np.clip(share + 0.5, 0, LEVELS - 1), CLEAR).astype(np.uint8)
    picture = Image.fromarray(index, "P")
    picture.putpalette([0, 0, 0, *_palette(what, np.linspace(low, high, LEVELS), high).ravel().tolist()])
    picture.info["transparency"] = CLEAR
    return picture


def _ends(values: NDArray[np.float32], what: str) -> tuple[float, float]:
    """The values of the first and of the last shade."""
    known = values[np.isfinite(values)][::THINNED]
    if what == "deviation":
        limit = limit_of(known)
        return -limit, limit
    low, high = np.quantile(known, STRETCHED).tolist() if len(known) else (0.0, 1.0)
    return low, max(high, low + 1e-6)


def _palette(what: str, values: NDArray[np.float64], limit: float) -> NDArray[np.uint8]:
    """The colours (n, 3) of values (n,)."""
    if what == "deviation":
        return shades(values, limit)
    share = np.linspace(0, 1, len(values))
    if what == "height":
        return height_shades(share)
    return np.rint(255 * np.repeat(share[:, None], 3, axis=1)).astype(np.uint8)

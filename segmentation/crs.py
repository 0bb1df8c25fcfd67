"""The coordinate reference system that a file declares: its name, its EPSG code, its units."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Any, Literal

from segmentation.units import UNITS, unit_of

if TYPE_CHECKING:
    from pyproj import CRS

Kind = Literal["projected", "geographic", "geocentric", "other"]

# Keys of GeoTIFF 1.1 (OGC 19-008r4), annex B
MODEL, GEOGRAPHIC, PROJECTED, LINEAR, LINEAR_SIZE, VERTICAL, VERTICAL_UNITS = 1024, 2048, 3072, 3076, 3077, 4096, 4099
MODELS: Mapping[int, Kind] = {1: "projected", 2: "geographic", 3: "geocentric"}
USER_DEFINED = 32767


@dataclass(frozen=True)
class Crs:
    """What a file says of its coordinates.

    name: of the system. epsg: code of its horizontal part, None where it has none. kind: what its x and y are.
    unit, height_unit: metres in a unit of x and y, and of z; None where that is not said.
    """

    name: str
    epsg: int | None
    kind: Kind
    unit: float | None
    height_unit: float | None

    @property
    def title(self) -> str:
        """The code if there is one, else the name."""
        return self.name if self.epsg is None else f"EPSG:{self.epsg}"


def of_wkt(text: str) -> Crs | None:
    """The system that a well-known text describes, or another that PROJ reads, as EPSG:2056; None if it is none."""
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    text = text.strip("\0 \n\r\t")
    try:
        return _of(CRS.from_user_input(text)) if text else None
    except CRSError:
        return _by_its_words(text)


def of_geokeys(keys: Mapping[int, float]) -> Crs | None:
    """The system of GeoTIFF keys, their values by number; None if they say nothing. Explicit units go before a code's.

    Source: OGC GeoTIFF 1.1; ASPRS LAS 1.4, 3.1.
    """
    horizontal = of_code(keys.get(PROJECTED) or keys.get(GEOGRAPHIC))
    vertical = of_code(keys.get(VERTICAL))
    keys = {key: value for key, value in keys.items() if isfinite(value)}
    kind = MODELS.get(int(keys.get(MODEL, 0))) or (horizontal.kind if horizontal else "other")
    linear = _length_of(keys.get(LINEAR)) or keys.get(LINEAR_SIZE)
    unit = linear or (horizontal.unit if horizontal else None)
    height = _length_of(keys.get(VERTICAL_UNITS)) or (vertical.unit if vertical else None)
    if horizontal is None and unit is None and height is None and kind == "other":
        return None
    name = horizontal.name if horizontal else "a system of GeoTIFF keys"
    return Crs(name, horizontal.epsg if horizontal else None, kind, unit, height)


def _length_of(code: float | None) -> float | None:
    """Metres in EPSG's unit of length of that code; None if there is none."""
    from pyproj.database import get_units_map

    if not code or int(code) == USER_DEFINED:
        return None
    units = get_units_map(auth_name="EPSG", category="linear").values()
    size = next((unit.conv_factor for unit in units if unit.code == str(int(code))), None)
    exact = None if size is None else unit_of(size)
    return size if exact is None else UNITS[exact]


def of_code(code: float | None) -> Crs | None:
    """The system of an EPSG code; None if there is none."""
    from pyproj import CRS
    from pyproj.exceptions import CRSError

    if not code or int(code) == USER_DEFINED:
        return None
    try:
        return _of(CRS.from_epsg(int(code)))
    except CRSError:
        return None


def _of(crs: CRS) -> Crs:
    parts: Sequence[Any] = crs.sub_crs_list if crs.is_compound else [crs]
    vertical = next((part for part in parts if part.is_vertical), None)
    flat: Any = next((part for part in parts if not part.is_vertical), crs)
    if flat.is_bound:
        flat = flat.source_crs
    kind: Kind = (
        "geographic" if flat.is_geographic else "geocentric" if flat.is_geocentric else
        "projected" if flat.is_projected else "other"
    )  # fmt: skip
    lengths = [axis.unit_conversion_factor for axis in flat.axis_info if axis.direction not in ("up", "down")]
    up = [a.unit_conversion_factor for a in (vertical or flat).axis_info if a.direction in ("up", "down")]
    unit = lengths[0] if lengths and kind != "geographic" else None
    if vertical is flat:  # heights alone: nothing is known of x and y
        unit = up[0] if up else None
    return Crs(crs.name, flat.to_epsg(), kind, unit, up[0] if up else None)


def _by_its_words(text: str) -> Crs | None:
    """What can be told of a text that is no whole one: its first word, name, and last unit of length."""
    start = re.match(r"(\w+)\s*\[\s*\"([^\"]*)\"", text)
    if not start:
        return None
    flat, _, upright = text.partition("VERT")
    kind: Kind = "projected" if re.search(r"PROJC|LOCAL_CS|ENGC", flat) else "other"
    if kind == "other" and re.search(r"GEOGC|GEODC", flat):
        kind = "geographic"
    if kind == "other" and "GEOCCS" in flat:
        kind = "geocentric"
    unit = _first_length(flat) if kind == "projected" else None
    return Crs(start[2], None, kind, unit, _first_length(upright))


def _first_length(text: str) -> float | None:
    """The first unit of length [m] in a part of a well-known text."""
    found = re.findall(r"(?:LENGTH)?UNIT\s*\[\s*\"[^\"]*\"\s*,\s*(\d+\.?\d*(?:[eE][-+]?\d+)?)", text)
    return next((float(size) for size in found if float(size) > 0 and unit_of(float(size))), None)

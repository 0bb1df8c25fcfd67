"""Metres in the units of a file: as it states, as the user says, or as no room contradicts."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Up, turn
from segmentation.errors import ReadError
from segmentation.io.facts import Facts
from segmentation.units import NAMES, UNITS, unit_of

BULK = (0.01, 0.99)
"""Shares of the points between which a scan's size is measured."""
TALLEST = 90.0
"""m; no interior under vaults is as high but one, and there the user may say so."""
WIDEST = 1000.0
"""m; no survey of rooms is wider."""
SMALLEST = 0.3
"""m, diagonal; less is no scan of a room, nor of a part of one."""
SPARSEST = 2.0
"""m between points; fewer tell no vault."""
FEWEST_FOR_SIZE = 1000
"""Points from which on their size is judged; no vault is looked for in fewer."""
ROOM_HEIGHT, ROOM_WIDTH = (0.5, 40.0), (1.0, 500.0)
"""m; sizes of what is likely a scan of rooms under vaults, for the hint."""
FEW_FOR_DEGREES = 100
"""Points with which degrees are told from lengths."""
CELLS = 50
"""Cells along the diagonal, by whose number the surface is measured."""
DEGREES = 0.05, 20.0
"""Extent of longitudes and latitudes of one building, at most; heights beside them, at least so many times as much."""
WAY_OUT = "say --unit with one of " + ", ".join(UNITS)


def scale_of(
    path: Path, facts: Facts, points: NDArray[np.float64], number: int, *, asked: str | None, up: Up
) -> NDArray[np.float64]:
    """Metres in a unit along each axis (3,) of the file; tells what was assumed or converted.

    points: (k, 3) a sample of those that take part, in the file's unit; number: how many they stand for. asked: one of
    UNITS that the user says.
    Raises ReadError if the file's coordinates are no lengths in space, or no scan of a room could have their size.
    """
    _check_kind(path, facts)
    _check_degrees(path, facts, points, asked)
    if asked is not None:
        return _as_asked(facts, asked)
    flat = facts.unit or facts.height_unit or UNITS[facts.format_unit or "m"]  # one that is said is that of all
    scale = np.array([flat, flat, facts.height_unit or flat])
    _check_size(path, facts, turn(points * scale, up), scale, number=number)
    _tell(facts, scale)
    return scale


def _as_asked(facts: Facts, asked: str) -> NDArray[np.float64]:
    size = UNITS[asked]
    stated = facts.unit
    if stated is not None and stated != size:
        facts.tell("unit", f"unit: {NAMES[asked]}, as asked, though {_name(stated)} is stated by {facts.stated_by}")
    else:
        facts.tell("unit", f"unit: {NAMES[asked]}, as asked{_factor(size)}")
    return np.full(3, size)


def _tell(facts: Facts, scale: NDArray[np.float64]) -> None:
    flat, height = float(scale[0]), float(scale[2])
    if facts.unit is None and facts.height_unit is None:
        why = "as E57 prescribes" if facts.format_unit else "which is assumed, for the file states none"
        facts.tell("unit-assumed", f"unit: metre, {why}; --unit says otherwise")
        return
    heights = "" if flat == height else f", of heights {_name(height)}{_factor(height)}"
    facts.tell("unit", f"unit: {_name(flat)}{_factor(flat)}{heights}, as stated by {facts.stated_by}")


def _name(size: float) -> str:
    unit = unit_of(size)
    return NAMES[unit] if unit else f"{size:.9g} m"


def _plural(size: float) -> str:
    name = _name(size)
    return {"inch": "inches", "foot": "feet", "US survey foot": "US survey feet"}.get(name, f"{name}s")


def _factor(size: float) -> str:
    return "" if size == 1 else f" (coordinates times {size:.9g})"


def _check_kind(path: Path, facts: Facts) -> None:
    if facts.crs is None or facts.crs.kind not in ("geographic", "geocentric"):
        return
    what = {"geographic": "longitude and latitude in degrees", "geocentric": "geocentric, with no axis up"}
    raise ReadError(
        path,
        f"its coordinates are {what[facts.crs.kind]} ({facts.crs.title})",
        "transform the scan into projected or local coordinates in metres",
    )


def _check_degrees(path: Path, facts: Facts, points: NDArray[np.float64], asked: str | None) -> None:
    """Degrees that nothing in the file names: a building's longitudes differ by nothing beside its height."""
    if asked is not None or facts.unit is not None or len(points) < FEW_FOR_DEGREES:
        return
    x, y, z = np.ptp(np.quantile(points, BULK, axis=0), axis=0)
    within = np.abs(points[:, 0]).max() <= 360 and np.abs(points[:, 1]).max() <= 360
    if within and 0 < max(x, y) < DEGREES[0] and z > DEGREES[1] * max(x, y):
        raise ReadError(
            path,
            f"x and y look like longitude and latitude in degrees: they range over {x:.2g} and {y:.2g}, z over {z:.2g}",
            "transform the scan into projected or local coordinates in metres, or say --unit m if they are lengths",
        )


def _check_size(
    path: Path, facts: Facts, points: NDArray[np.float64], scale: NDArray[np.float64], *, number: int
) -> None:
    """Whether points (n, 3) [m] that stand for `number` could be a scan of rooms."""
    x, y, z = (float(v) for v in np.ptp(np.quantile(points, BULK, axis=0), axis=0))
    if number < FEWEST_FOR_SIZE or max(x, y, z) == 0:
        return
    size = f"{x:,.4g} × {y:,.4g} × {z:,.4g} m"
    small = bool(np.linalg.norm((x, y, z)) < SMALLEST)
    spacing = 0.0 if small else _spacing(points, number)
    if z > TALLEST or max(x, y) > WIDEST:
        gap = _gap(points)
        if gap:
            raise ReadError(path, f"is of parts {gap:,.0f} m apart", "crop it to one building")
        wrong = f"would be {size} large"
    elif small:
        wrong = f"would be {size} small"
    elif spacing > SPARSEST:
        wrong = f"would be {size} large, with {spacing:.2g} m between its points"
    else:
        return
    likely = [
        f"{unit} for {x * f:.1f} × {y * f:.1f} × {z * f:.1f} m"
        for unit, f in ((u, m / float(scale[0])) for u, m in UNITS.items())
        if ROOM_HEIGHT[0] <= z * f <= ROOM_HEIGHT[1]
        and ROOM_WIDTH[0] <= min(x, y) * f
        and max(x, y) * f <= ROOM_WIDTH[1]
        and spacing * f <= SPARSEST
        and f != 1
    ]
    source = f"as stated by {facts.stated_by}" if facts.unit else "which is assumed, for the file states none"
    way_out = f"say --unit {', or '.join(likely)}" if likely else WAY_OUT
    raise ReadError(path, f"in {_plural(float(scale[0]))}, {source}, the scan {wrong}", way_out + "; --unit m if it is")


def _gap(points: NDArray[np.float64]) -> float:
    """The gap [m] between two parts of the points (n, 3) that alone are no larger than a building; 0 if none is."""
    for values, most in zip(np.sort(points, axis=0).T, (WIDEST, WIDEST, TALLEST), strict=True):
        extent, gap = float(values[-1] - values[0]), float(np.diff(values).max())
        if extent > most and extent - gap <= most:
            return gap
    return 0.0


def _spacing(points: NDArray[np.float64], number: int) -> float:
    """Distance [m] between `number` points on the surface that the points (n, 3) show."""
    low, high = np.quantile(points, BULK, axis=0)
    cell = float(np.linalg.norm(high - low)) / CELLS
    inside = points[((points >= low) & (points <= high)).all(axis=1)]
    occupied = len(np.unique(np.floor((inside - low) / cell).astype(np.int64) @ np.array([1, 1 << 10, 1 << 20])))
    return float(cell * np.sqrt(occupied / 1.5 / number))  # a slanting surface meets about 1.5 cells a square

"""Columns by name out of a structured array, for the formats whose points are records (PLY, PCD)."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.io.chunk import Chunk
from segmentation.io.facts import Facts
from segmentation.io.ranges import class8
from segmentation.io.rest import tell_damaged

XYZ = ("x", "y", "z")
NORMALS = (("nx", "ny", "nz"), ("normal_x", "normal_y", "normal_z"))
COLORS = (("red", "green", "blue"), ("diffuse_red", "diffuse_green", "diffuse_blue"), ("r", "g", "b"))
INTENSITIES = tuple((name,) for name in ("intensity", "scalar_intensity", "reflectance", "scalar_reflectance"))
CLASSES = tuple((name,) for name in ("classification", "scalar_classification"))
PACKED = ("rgb", "rgba")
"""Fields of PCD that hold red, green and blue in the bytes of one number."""
USED = {name for names in ((XYZ,), NORMALS, COLORS, INTENSITIES, CLASSES, (PACKED,)) for own in names for name in own}


def unique(names: Iterable[str]) -> list[str]:
    """Names in small letters, as programs differ in that; one that comes again gets its place added."""
    found: list[str] = []
    for k, name in enumerate(map(str.lower, names)):
        found.append(f"{name}#{k}" if name in found else name)
    return found


def tell_order(facts: Facts, names: Iterable[str]) -> None:
    """Say in which order x, y and z stand, if it is another."""
    order = tuple(name for name in names if name in XYZ)
    if order != XYZ:
        facts.tell("columns", f"coordinates stand in the order {' '.join(order)}, by the header of the file")


def chunk_of(values: NDArray[np.void], done: float, color: NDArray[Any] | None = None) -> Chunk:
    """A chunk of the records (k,), which have at least x, y and z. color: (k, 3), where it is no plain column."""
    xyz, classes, intensity = _first(values, (XYZ,)), _first(values, CLASSES), _first(values, INTENSITIES)
    assert xyz is not None
    return Chunk(
        xyz=xyz if np.issubdtype(xyz.dtype, np.floating) else xyz.astype(np.float64),
        normals=_first(values, NORMALS),
        color=_first(values, COLORS) if color is None else color,
        intensity=None if intensity is None else intensity[:, 0],
        classification=None if classes is None else class8(classes[:, 0]),
        done=done,
    )


def from_table(table: NDArray[np.float64], dtype: np.dtype[np.void], facts: Facts) -> NDArray[np.void]:
    """Records of the columns of a table, in order; a field that is an array takes as many columns.

    Told is what a field of whole numbers that is used cannot hold, as the columns may be others than the header says.
    NaN becomes 0; -1 becomes the most that an unsigned number can be, as it is in programs.
    """
    values = np.empty(len(table), dtype)
    at = 0
    for name in dtype.names or ():
        width = int(np.prod(dtype[name].shape, dtype=int))
        columns = table[:, at : at + width]
        if not np.issubdtype(dtype[name].base, np.floating):
            kind = np.iinfo(dtype[name].base)
            columns = np.where(np.isnan(columns), 0.0, columns)
            if kind.min == 0:
                columns[columns == -1] = kind.max
            whole: NDArray[np.float64] = np.clip(np.round(columns), kind.min, kind.max)
            if name in USED and not np.array_equal(whole, columns):
                tell_damaged(facts, f"its {name!r} is to hold whole numbers up to {kind.max:,}, and holds others")
            columns = whole
        values[name] = columns.reshape(-1, *dtype[name].shape)
        at += width
    return values


def _first(values: NDArray[np.void], choices: tuple[tuple[str, ...], ...]) -> NDArray[Any] | None:
    """The first choice of columns that is there, (k, columns) in the machine's byte order; None if none is."""
    have = set(values.dtype.names or ())
    found = next((c for c in choices if have.issuperset(c)), None)
    if found is None:
        return None
    native = np.result_type(*(values.dtype[c] for c in found)).newbyteorder("=")
    return np.stack([values[c].astype(native) for c in found], axis=1)

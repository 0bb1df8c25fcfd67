"""The labels of a cloud back out of its file: the extra dimension or property of a name."""

import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.facts import Facts
from segmentation.io.formats import reader_of
from segmentation.io.las import las_points, open_las
from segmentation.io.ply import vertices
from segmentation.io.ply_header import layout_of

Labels = NDArray[np.integer[Any]]


def read_labels(path: Path | str, name: str = "component") -> Labels:
    """The whole numbers (n,) under that name of every point in the file, in its order.

    path: LAS, LAZ or PLY with such a dimension or property, or .npz with such an array.
    Raises ReadError if the file is missing, damaged, of another kind, or has no such numbers.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SOURCES:
        raise ReadError(path, f"labels cannot be read from {suffix!r} files", f"use one of {', '.join(SOURCES)}")
    if suffix != ".npz":
        reader_of(path)
    values = SOURCES[suffix](path, name)
    if values.ndim != 1 or not np.issubdtype(values.dtype, np.integer):
        raise ReadError(path, f"its {name!r} are no whole numbers, one a point", "name a file with labels")
    return values


def _las(path: Path, name: str) -> NDArray[Any]:
    with open_las(path) as reader:
        names = list(reader.header.point_format.dimension_names)
        if name not in names:
            raise _lacking(path, name, names)
        return np.concatenate([np.array(points[name]) for points in las_points(path, reader)])


def _ply(path: Path, name: str) -> NDArray[Any]:
    layout = layout_of(path, Facts())
    names = list(layout.dtype.names or ())
    if name.lower() not in names:
        raise _lacking(path, name, names)
    chunks = (values[name.lower()] for values, _ in vertices(path, layout, Facts()))
    return np.concatenate([np.empty(0, layout.dtype[name.lower()]), *chunks])


def _npz(path: Path, name: str) -> NDArray[Any]:
    try:
        with path.open("rb") as file, np.load(file) as arrays:
            if name not in arrays:
                raise _lacking(path, name, list(arrays))
            return np.asarray(arrays[name])
    except FileNotFoundError:
        raise ReadError(path, "no such file", "check the path") from None
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        if isinstance(error, ReadError):
            raise
        raise ReadError(path, f"is no whole .npz file ({error})", "make it again") from error


def _lacking(path: Path, name: str, names: list[str]) -> ReadError:
    return ReadError(path, f"has no {name!r}, only {', '.join(names)}", "name a file with labels")


SOURCES: dict[str, Callable[[Path, str], NDArray[Any]]] = {".las": _las, ".laz": _las, ".npz": _npz, ".ply": _ply}

"""LAS and LAZ, read in chunks by laspy."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.chunk import SIZE, Chunk

NORMALS = ("NormalX", "NormalY", "NormalZ")
"""Extra dimensions for normals, named as CloudCompare does."""
WAY_OUT = "copy it again from where it comes from, or export the scan again"


def read_las(path: Path) -> Iterator[Chunk]:
    """The points of a LAS or LAZ file with colour, intensity, classification and, as extra dimensions, normals.

    Raises ReadError if the file is damaged or holds fewer points than its header promises. LAZ has no checksums: damage
    amid compressed points may pass unnoticed.
    """
    with open_las(path) as reader:
        total = reader.header.point_count
        done = 0
        for points in las_points(path, reader):
            done += len(points)
            yield _chunk(points, reader.header, done / total)


def open_las(path: Path) -> Any:
    """A laspy reader that decompresses in parallel. Raises ReadError if the header makes no sense or points lack."""
    import laspy

    # laspy logs what it also raises; without a handler that would reach standard error
    logging.getLogger("laspy").addHandler(logging.NullHandler())
    try:
        reader = laspy.open(path, laz_backend=laspy.LazBackend.LazrsParallel)
    except Exception as error:
        raise ReadError(path, f"is no whole LAS or LAZ file ({error})", WAY_OUT) from error
    header = reader.header
    whole = header.offset_to_point_data + header.point_count * header.point_format.size
    if not header.are_points_compressed and path.stat().st_size < whole:
        reader.close()
        raise _truncated(path, header.point_count)
    return reader


def las_points(path: Path, reader: Any) -> Iterator[Any]:
    """The point records of the file, chunk by chunk. Raises ReadError if there are fewer than the header promises."""
    total = reader.header.point_count
    done = 0
    try:
        for points in reader.chunk_iterator(SIZE):
            done += len(points)
            yield points
    except Exception as error:
        raise _truncated(path, total) from error
    if done < total:
        raise _truncated(path, total)


def _chunk(points: Any, header: Any, done: float) -> Chunk:
    names = set(points.point_format.dimension_names)
    xyz = np.empty((len(points), 3))
    for k, axis in enumerate("XYZ"):
        xyz[:, k] = points[axis] * header.scales[k] + header.offsets[k]
    return Chunk(
        xyz=xyz,
        normals=_columns(points, NORMALS) if names.issuperset(NORMALS) else None,
        color=_columns(points, ("red", "green", "blue")) if "red" in names else None,
        intensity=np.array(points["intensity"]),
        classification=np.array(points["classification"]),
        done=done,
    )


def _columns(points: Any, names: tuple[str, ...]) -> NDArray[Any]:
    return np.stack([np.asarray(points[name]) for name in names], axis=1)


def _truncated(path: Path, total: int) -> ReadError:
    return ReadError(path, f"is truncated or damaged: its header promises {total} points", WAY_OUT)

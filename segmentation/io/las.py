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
        reader.decompression_selection = _needed(reader.header)
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


def _needed(header: Any) -> Any:
    """What of the points is decompressed; the other dimensions of point formats 6 to 10 are passed over."""
    from laspy import DecompressionSelection as Part

    parts = Part.XY_RETURNS_CHANNEL | Part.Z | Part.CLASSIFICATION | Part.INTENSITY | Part.RGB
    return parts | Part.ALL_EXTRA_BYTES if _has_normals(header.point_format) else parts


def _has_normals(point_format: Any) -> bool:
    """Whether there are extra dimensions for normals."""
    return set(NORMALS) <= set(point_format.dimension_names)


def _chunk(points: Any, header: Any, done: float) -> Chunk:
    xyz = np.empty((len(points), 3))
    for k, axis in enumerate("XYZ"):
        xyz[:, k] = points[axis] * header.scales[k] + header.offsets[k]
    return Chunk(
        xyz=xyz,
        normals=_columns(points, NORMALS) if _has_normals(points.point_format) else None,
        color=_columns(points, ("red", "green", "blue")) if "red" in points.array.dtype.names else None,
        intensity=np.array(points["intensity"]),
        classification=np.array(points["classification"]),
        done=done,
    )


def _columns(points: Any, names: tuple[str, ...]) -> NDArray[Any]:
    return np.stack([np.asarray(points[name]) for name in names], axis=1)


def _truncated(path: Path, total: int) -> ReadError:
    return ReadError(path, f"is truncated or damaged: its header promises {total} points", WAY_OUT)

"""LAS 1.4 and LAZ: normals and extras as extra dimensions."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud, turn_back
from segmentation.io.chunk import SIZE
from segmentation.io.columns import corners
from segmentation.io.las import NORMALS
from segmentation.io.stamp import stamp

SCALE = 1e-4
"""Coordinates are rounded to 0.1 mm, that is by 0.05 mm at most."""
WIDEST = 2**31 * 0.99
"""What a coordinate can be as a whole number."""
TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")
"""The numbers that extra dimensions can be."""


def write_las(path: Path, cloud: Cloud, extra: Mapping[str, NDArray[Any]]) -> None:
    """The cloud in point format 6, or 7 if it has colour; compressed if the suffix is .laz."""
    import laspy

    extras = dict(extra)
    if cloud.normals is not None:
        extras |= zip(NORMALS, turn_back(cloud.normals, cloud.up).T, strict=True)
    header = laspy.LasHeader(version="1.4", point_format=6 if cloud.color is None else 7)
    low, high = corners(cloud)
    header.creation_date = stamp().date()
    header.offsets = np.floor(low)
    header.scales = np.maximum(SCALE, (high - header.offsets) / WIDEST)
    add_extras(header, extras)
    with open_writer(path, header) as writer:
        for at in range(0, len(cloud), SIZE):
            run = slice(at, at + SIZE)
            xyz = cloud.in_file(cloud.xyz[run])
            points = laspy.ScaleAwarePointRecord.zeros(len(xyz), header=header)
            whole = np.round((xyz - header.offsets) / header.scales).astype(np.int32)
            for k, axis in enumerate("XYZ"):
                points.array[axis] = whole[:, k]
            points["return_number"][:] = points["number_of_returns"][:] = 1
            if cloud.color is not None:
                for k, name in enumerate(("red", "green", "blue")):
                    points.array[name] = cloud.color[run, k]
            if cloud.intensity is not None:
                points.array["intensity"] = cloud.intensity[run]
            if cloud.classification is not None:
                points.array["classification"] = cloud.classification[run]
            for name, values in extras.items():
                points.array[name] = values[run]
            writer.write_points(points)


def add_extras(header: Any, extra: Mapping[str, NDArray[Any]]) -> None:
    """Extra dimensions of those names and types on a laspy header; one of the same name is replaced.

    Raises ValueError for a name that LAS itself has, that is too long, or for a type that LAS cannot hold.
    """
    import laspy

    for name, values in extra.items():
        if name in header.point_format.standard_dimension_names:
            raise ValueError(f"{name!r} is a dimension of LAS itself: give the extra another name")
        if len(name.encode()) > 32:
            raise ValueError(f"{name!r} is longer than the 32 bytes that LAS has for a name")
        if values.dtype.str[1:] not in TYPES:
            raise ValueError(
                f"{name!r} is of type {values.dtype}, which LAS cannot hold: use one of {', '.join(TYPES)}"
            )
    known = set(header.point_format.extra_dimension_names)
    header.remove_extra_dims([name for name in extra if name in known])
    header.add_extra_dims([laspy.ExtraBytesParams(name, values.dtype) for name, values in extra.items()])


def open_writer(path: Path, header: Any) -> Any:
    """A laspy writer that compresses in parallel if the suffix is .laz."""
    import laspy

    compress = path.suffix.lower() == ".laz"
    return laspy.open(path, mode="w", header=header, do_compress=compress, laz_backend=laspy.LazBackend.LazrsParallel)

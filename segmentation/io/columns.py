"""A cloud as runs of named columns, for the formats whose points are records."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud, turn_back
from segmentation.io.chunk import SIZE
from segmentation.io.ranges import BYTE

Columns = dict[str, NDArray[Any]]


def corners(cloud: Cloud) -> NDArray[np.float64]:
    """Lowest and highest corner (2, 3) in the file's coordinates; zeros for an empty cloud.

    Raises ValueError if a point is not finite.
    """
    if len(cloud) == 0:
        return np.zeros((2, 3))
    # Axis by axis: numpy takes several times as long over many rows of three.
    ends = np.array([[axis.min() for axis in cloud.xyz.T], [axis.max() for axis in cloud.xyz.T]])
    ends = np.sort(cloud.in_file(ends), axis=0)
    if not np.isfinite(ends).all():
        raise ValueError("xyz holds NaN or infinite points: leave them out, or write PLY or XYZ")
    return ends


def columns_of(cloud: Cloud, extra: Mapping[str, NDArray[Any]]) -> Iterator[Columns]:
    """Runs in the file's coordinates: x, y, z (float64), nx …, red … (uint8), intensity, classification, extras."""
    for at in range(0, max(len(cloud), 1), SIZE):
        run = slice(at, at + SIZE)
        columns: Columns = dict(zip("xyz", cloud.in_file(cloud.xyz[run]).T, strict=True))
        if cloud.normals is not None:
            columns |= zip(("nx", "ny", "nz"), turn_back(cloud.normals[run], cloud.up).T, strict=True)
        if cloud.color is not None:
            rgb = np.round(cloud.color[run] / BYTE).astype(np.uint8)
            columns |= zip(("red", "green", "blue"), rgb.T, strict=True)
        if cloud.intensity is not None:
            columns["intensity"] = cloud.intensity[run]
        if cloud.classification is not None:
            columns["classification"] = cloud.classification[run]
        yield columns | {name: values[run] for name, values in extra.items()}

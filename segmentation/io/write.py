"""Writing clouds: a table of writers by suffix, and `write_cloud`."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud, Floats
from segmentation.io.ranges import BYTE
from segmentation.io.whole import replacing
from segmentation.io.write_e57 import write_e57
from segmentation.io.write_las import write_las
from segmentation.io.write_ply import write_ply
from segmentation.io.write_text import write_text

Extra = Mapping[str, NDArray[Any]]
WRITERS: dict[str, Callable[[Path, Cloud, Extra], None]] = {
    ".e57": write_e57,
    ".las": write_las,
    ".laz": write_las,
    ".ply": write_ply,
    ".txt": write_text,
    ".xyz": write_text,
}


def write_cloud(
    path: Path | str,
    xyz: Floats,
    *,
    origin: NDArray[np.float64] | None = None,
    normals: Floats | None = None,
    color: NDArray[np.uint8] | NDArray[np.uint16] | None = None,
    intensity: NDArray[np.uint16] | None = None,
    classification: NDArray[np.uint8] | None = None,
    extra: Extra | None = None,
) -> None:
    """Points (n, 3) [m], `origin` added, to a file whose suffix is in WRITERS; it appears whole or not at all.

    color: (n, 3) over the full range of its type. extra: numbers (n,) under their names.
    LAS and LAZ round coordinates to 0.1 mm, and hold normals and extras as extra dimensions; E57 holds them under the
    public extension for normals and one of ours; PLY and E57 hold colour with eight bits.
    Raises ValueError for an unknown suffix, for arrays of the wrong length, and for points that are not finite where
    the format cannot hold them (LAS, LAZ, E57); OSError if the file cannot be written.

    >>> import tempfile
    >>> from segmentation import read
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_cloud(f"{folder}/four.ply", np.eye(4, 3))
    ...     read(f"{folder}/four.ply", unit="m").xyz.tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]
    """
    path = Path(path)
    if path.suffix.lower() not in WRITERS:
        raise ValueError(f"{path}: unknown suffix {path.suffix!r}; name one of {', '.join(WRITERS)}")
    cloud = Cloud(
        xyz=xyz,
        origin=np.zeros(3) if origin is None else np.asarray(origin, np.float64),
        normals=None if normals is None else normals.astype(np.float32, copy=False),
        color=None if color is None else _full_range(color),
        intensity=intensity,
        classification=classification,
    )
    write(path, cloud, extra or {})


def _full_range(color: NDArray[np.uint8] | NDArray[np.uint16]) -> NDArray[np.uint16]:
    full: NDArray[np.uint16] = color.astype(np.uint16) * np.uint16(BYTE if color.dtype == np.uint8 else 1)
    return full


def write(path: Path, cloud: Cloud, extra: Extra) -> None:
    """A Cloud, in the coordinates and axes of the file that it came from, with extras; see write_cloud."""
    shapes = {
        "xyz": (cloud.xyz, (len(cloud), 3)),
        "normals": (cloud.normals, (len(cloud), 3)),
        "color": (cloud.color, (len(cloud), 3)),
        "intensity": (cloud.intensity, (len(cloud),)),
        "classification": (cloud.classification, (len(cloud),)),
        **{name: (values, (len(cloud),)) for name, values in extra.items()},
    }
    for name, (values, shape) in shapes.items():
        if values is not None and values.shape != shape:
            raise ValueError(f"{name} has the shape {values.shape}, expected is {shape}")
    with replacing(path) as beside:
        WRITERS[path.suffix.lower()](beside, cloud, extra)

"""E57: one scan without a pose, coordinates in double precision."""

import os
import re
import uuid
from collections.abc import Mapping
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud
from segmentation.io.columns import columns_of, corners
from segmentation.io.e57 import CARTESIAN, COLOR, NORMALS
from segmentation.io.ranges import TOP

NORMALS_URI = "http://www.libe57.org/E57_NOR_surface_normals.txt"
OURS, OURS_URI = "vaultcad", "urn:vaultcad:e57"
"""Prefix of the fields for extras, which other readers are to pass over."""
FIELDS = {
    **dict(zip("xyz", CARTESIAN, strict=True)),
    **dict(zip(("nx", "ny", "nz"), NORMALS, strict=True)),
    **dict(zip(("red", "green", "blue"), COLOR, strict=True)),
    "intensity": "intensity",
}
ENDS = ("Minimum", "Maximum")


def write_e57(path: Path, cloud: Cloud, extra: Mapping[str, NDArray[Any]]) -> None:
    """The cloud as one scan. The classification and extras are fields `vaultcad:NAME`, which other readers pass over.

    Raises ValueError for an extra whose name is no XML name.
    """
    from pye57 import libe57

    if len(cloud) == 0:
        raise ValueError("the cloud is empty, and E57 cannot hold it: write points or another format")
    bad = next((name for name in extra if not re.fullmatch(r"[A-Za-z_][\w.-]*", name, re.ASCII)), None)
    if bad is not None:
        raise ValueError(f"{bad!r} cannot name a field of E57: use letters, digits, '_', '-' and '.'")
    image = libe57.ImageFile(os.fsencode(path), "w")
    try:
        runs = columns_of(cloud, extra)
        first = next(runs)
        arrays = {name: np.empty(len(values), _buffer(values)) for name, values in first.items()}
        prototype, buffers = libe57.StructureNode(image), libe57.VectorSourceDestBuffer()
        points = _scan(image, cloud, prototype)
        for name, array in arrays.items():
            field = FIELDS.get(name, f"{OURS}:{name}")
            prototype.set(field, _node(image, first[name], extra.get(name)))
            buffers.append(libe57.SourceDestBuffer(image, field, array, len(array), True, True))
        writer = points.writer(buffers)
        for columns in chain([first], runs):
            for name, values in columns.items():
                arrays[name][: len(values)] = values
            writer.write(len(columns["x"]))
        writer.close()
    finally:
        image.close()


def _scan(image: Any, cloud: Cloud, prototype: Any) -> Any:
    """The file's header with one scan in it, whose points are of the prototype; gives the points' node."""
    from pye57 import libe57

    def structure(parent: Any, name: str, values: Mapping[str, Any]) -> None:
        node = libe57.StructureNode(image)
        for key, value in values.items():
            node.set(key, libe57.FloatNode(image, float(value)))
        parent.set(name, node)

    def text(parent: Any, name: str, value: str) -> None:
        parent.set(name, libe57.StringNode(image, value))

    ends = corners(cloud)
    # named by the content, so that the same cloud gives the same bytes
    guid = f"{{{uuid.uuid5(uuid.NAMESPACE_OID, f'{len(cloud)} {ends.tolist()}')}}}"
    for prefix, uri in (("", libe57.E57_V1_0_URI), ("nor", NORMALS_URI), (OURS, OURS_URI)):
        image.extensionsAdd(prefix, uri)
    root = image.root()
    text(root, "formatName", "ASTM E57 3D Imaging Data File")
    text(root, "guid", guid)
    root.set("versionMajor", libe57.IntegerNode(image, libe57.E57_FORMAT_MAJOR))
    root.set("versionMinor", libe57.IntegerNode(image, libe57.E57_FORMAT_MINOR))
    text(root, "e57LibraryVersion", libe57.E57_LIBRARY_ID)
    text(root, "coordinateMetadata", "")
    scans = libe57.VectorNode(image, True)
    root.set("data3D", scans)
    root.set("images2D", libe57.VectorNode(image, True))
    scan = libe57.StructureNode(image)
    text(scan, "guid", guid)
    text(scan, "name", "cloud")
    bounds = {f"{axis}{end}": ends[k, a] for a, axis in enumerate("xyz") for k, end in enumerate(ENDS)}
    structure(scan, "cartesianBounds", bounds)
    if cloud.intensity is not None:
        structure(scan, "intensityLimits", dict(zip((f"intensity{end}" for end in ENDS), (0, TOP), strict=True)))
    if cloud.color is not None:
        limits = {f"{c}{end}": value for c in COLOR for end, value in zip(ENDS, (0, 255), strict=True)}
        structure(scan, "colorLimits", limits)
    points = libe57.CompressedVectorNode(image, prototype, libe57.VectorNode(image, True))
    scan.set("points", points)
    scans.append(scan)
    return points


def _buffer(values: NDArray[Any]) -> type[np.float64] | type[np.longlong]:
    """What a column is handed over as. numpy's int64 the library would take for 32 bits, longlong it takes for 64."""
    return np.longlong if values.dtype.kind in "iu" and values.dtype != np.uint64 else np.float64


def _node(image: Any, values: NDArray[Any], whole: NDArray[Any] | None) -> Any:
    """The node that describes a field: whole numbers in their bounds, or real ones of single or double precision."""
    from pye57 import libe57

    if _buffer(values) is np.float64:
        return libe57.FloatNode(image, 0.0, libe57.E57_SINGLE if values.dtype == np.float32 else libe57.E57_DOUBLE)
    kind = np.iinfo(values.dtype)
    low, high = (kind.min, kind.max) if whole is None else (int(whole.min()), int(whole.max()))
    return libe57.IntegerNode(image, low, low, high)

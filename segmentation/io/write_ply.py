"""PLY, binary and little-endian, coordinates in double precision."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud
from segmentation.io.columns import columns_of

NAMES = {
    "i1": "char", "u1": "uchar", "i2": "short", "u2": "ushort", "i4": "int", "u4": "uint",
    "f4": "float", "f8": "double",
}  # fmt: skip


def write_ply(path: Path, cloud: Cloud, extra: Mapping[str, NDArray[Any]]) -> None:
    """The cloud as vertices; what PLY has no type for (64-bit integers) becomes double."""
    with path.open("wb") as file:
        dtype = None
        for columns in columns_of(cloud, extra):
            if dtype is None:
                kinds = {name: values.dtype.str[1:] for name, values in columns.items()}
                dtype = np.dtype([(name, "<" + (kind if kind in NAMES else "f8")) for name, kind in kinds.items()])
                properties = [f"property {NAMES.get(kind, 'double')} {name}" for name, kind in kinds.items()]
                header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(cloud)}", *properties]
                file.write("\n".join([*header, "end_header", ""]).encode())
            values = np.empty(len(columns["x"]), dtype)
            for name, column in columns.items():
                values[name] = column
            values.tofile(file)

"""XYZ and TXT: columns with a line of names, as CloudCompare reads and writes them."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud
from segmentation.io.columns import columns_of


def write_text(path: Path, cloud: Cloud, extra: Mapping[str, NDArray[Any]]) -> None:
    """Coordinates with five decimals (0.01 mm), other real numbers with six digits."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        for k, columns in enumerate(columns_of(cloud, extra)):
            if k == 0:
                file.write("//" + " ".join(columns) + "\n")
            row = " ".join(_format(name, values) for name, values in columns.items()) + "\n"
            file.writelines(map(row.__mod__, zip(*(values.tolist() for values in columns.values()), strict=True)))


def _format(name: str, values: NDArray[Any]) -> str:
    if name in ("x", "y", "z"):
        return "%.5f"
    return "%.6g" if np.issubdtype(values.dtype, np.floating) else "%d"

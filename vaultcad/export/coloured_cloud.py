"""The points of vaults and arches in the colours of their deviations, for viewers that show colours alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families.drawing.deviation_colours import limit_of, shades
from segmentation.cloud import Cloud
from segmentation.io.write import write
from vaultcad.fit.label import Labels
from vaultcad.labelled_scan import LABELS

FULL = 257  # 255 times this is the full range of 16 bits


def write_coloured(cloud: Cloud, labels: Labels, path: Path) -> None:
    """Write them to PLY, LAZ or any other suffix of `segmentation.io.WRITERS`, in the scan's own coordinates.

    Red is into the stone, blue into the room, as in all drawings; their deviation [m], vault, component and arch go
    along as further columns.
    """
    on = np.flatnonzero(np.isfinite(labels.deviation))
    deviation = labels.deviation[on]
    shown = replace(
        cloud,
        xyz=cloud.xyz[on],
        normals=None,
        color=shades(deviation, limit_of(deviation)).astype(np.uint16) * FULL,
        intensity=None if cloud.intensity is None else cloud.intensity[on],
        classification=None,
        kept=None,
        aside=None,
    )
    extra: dict[str, NDArray[Any]] = {name: getattr(labels, name)[on] for name in LABELS}
    write(path, shown, extra)

"""A run of points as a reader has them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Floats

Progress = Callable[[float], object]
Numbers = NDArray[np.integer[Any]] | Floats
Mask = NDArray[np.bool_]

SIZE = 1_000_000
"""Points in a chunk: large enough to keep the cores busy, small beside a scan."""


@dataclass(frozen=True, eq=False)
class Chunk:
    """A run of k points as the file has them, in its own axes, coordinates and ranges.

    xyz: (k, 3); normals: (k, 3); color: (k, 3) and intensity: (k,) in any range; classification: (k,).
    valid: (k,) bool, or None where all are points: no beam that nothing sent back. marks: (k,) bool by what the file
    calls the points: "withheld", "noise". stations: (j, 3) scanner positions. done: share of the file read so far.
    """

    xyz: Floats
    normals: Floats | None = None
    color: Numbers | None = None
    intensity: Numbers | None = None
    classification: NDArray[np.uint8] | None = None
    valid: Mask | None = None
    marks: Mapping[str, Mask] = field(default_factory=dict)
    stations: NDArray[np.float64] | None = None
    done: float = 0.0

    def only(self, mask: Mask) -> "Chunk":
        """The points of a mask (k,), without their marks."""

        def cut(values: Any) -> Any:
            return values if values is None or mask.all() else values[mask]

        return Chunk(
            cut(self.xyz),
            cut(self.normals),
            cut(self.color),
            cut(self.intensity),
            cut(self.classification),
            stations=self.stations,
            done=self.done,
        )

"""Whether the points of an E57 scan lie within the bounds that it promises."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.io.sample import box_of, corners_of

ROUNDED = 0.01  # m; what bounds may be rounded by
ENDS = ("Minimum", "Maximum")
Box = NDArray[np.float64]  # (2, 3), lowest and highest corner


class ScanBounds:
    """The box of a scan, and that of its points so far: in the scan's own frame, and in the file's."""

    def __init__(self, scan: Any, rotation: NDArray[np.float64], translation: NDArray[np.float64]) -> None:
        """With the scan, as the library has it, and its pose."""
        self.promised = _box(scan)
        self.rotation, self.translation = rotation, translation
        self.own: list[Box] = []
        self.placed: list[Box] = []

    def count(self, own: NDArray[np.float64], placed: NDArray[np.float64], valid: NDArray[np.bool_] | None) -> None:
        """Take points (k, 3) in both frames, those that are valid."""
        if self.promised is None:
            return
        for boxes, points in ((self.own, own), (self.placed, placed)):
            if points is own and boxes is self.placed:  # no pose: the two are one
                boxes.append(self.own[-1])
                continue
            corners = corners_of(points)
            if valid is not None or not np.isfinite(corners).all():
                mask = np.isfinite(points).all(axis=1)
                corners = corners_of(points[mask if valid is None else mask & valid])
            boxes.append(corners)

    def broken(self) -> float:
        """How far points lie outside [m]; 0 if none do, or nothing was promised.

        The standard has bounds in the scan's own frame. Some programs write them in the file's, others turn the two
        corners alone (pye57): all of these are right.
        """
        if self.promised is None:
            return 0.0
        own = box_of(self.own)
        if not np.isfinite(own).all():
            return 0.0
        boxes = (own, box_of(self.placed), own @ self.rotation.T + self.translation)
        off = min(float(np.maximum(self.promised[0] - box[0], box[1] - self.promised[1]).max()) for box in boxes)
        return off if off > ROUNDED else 0.0


def _box(scan: Any) -> Box | None:
    """The scan's cartesian bounds; None if it has none, or they were never filled in."""
    if not scan.isDefined("cartesianBounds"):
        return None
    bounds = scan["cartesianBounds"]
    names = [[f"{axis}{end}" for axis in "xyz"] for end in ENDS]
    if not all(bounds.isDefined(name) for row in names for name in row):
        return None
    box = np.array([[float(bounds[name].value()) for name in row] for row in names])
    return box if np.isfinite(box).all() and box.any() else None

"""Projected coordinates kept in single precision, whose points stand on a grid of centimetres to half metres."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.facts import Facts

COARSE = 0.02
"""m; steps from which on a scan is no use."""
FEWEST_FOR_PRECISION = 100
"""Points; fewer may all be in single precision by chance."""
ROUNDED = 0.05
"""Share of single precision's steps that coordinates may have been rounded off by since."""
SAID = 0.002
"""m; steps that are pointed out."""


def check_precision(path: Path, facts: Facts, points: NDArray[np.float64], scale: NDArray[np.float64]) -> None:
    """See that coordinates (k, 3) are finer than masonry is rough; scale: (3,) metres in the file's units.

    Raises ReadError if they come in steps of `COARSE` or more.
    """
    if len(points) < FEWEST_FOR_PRECISION:
        return
    # Coordinates that single precision holds to the last bit have been through it,
    # but for what was rounded off since, as LAS and texts do.
    gaps = np.spacing(np.abs(points).astype(np.float32)).astype(np.float64)
    single = (np.abs(points - points.astype(np.float32)) <= ROUNDED * gaps).all(axis=0)
    largest, widest = np.abs(points).max(axis=0), gaps.max(axis=0)
    steps = np.where(single, widest, 0.0)
    steps = np.minimum(steps, [_step(c, ROUNDED * gap) for c, gap in zip(points.T, widest, strict=True)]) * scale
    axis = int(np.argmax(steps))
    if steps[axis] < SAID:
        return
    near, step = f"{largest[axis]:,.0f}", _length(steps[axis])
    said = f"its coordinates are in single precision: near {near} they come in steps of {step}"
    if steps[axis] >= COARSE:
        raise ReadError(path, said, "export it again in double precision, or with a shift taken off the coordinates")
    facts.tell("precision", said)


def _step(values: NDArray[np.float64], same: float) -> float:
    """The least step between values (n,) that differ by more than what is the same; 0 if none do."""
    steps = np.diff(np.unique(values))
    steps = steps[steps > 2 * same]
    return float(steps.min()) if len(steps) else 0.0


def _length(metres: float) -> str:
    return f"{metres:.2g} m" if metres >= 0.1 else f"{1000 * metres:.2g} mm"

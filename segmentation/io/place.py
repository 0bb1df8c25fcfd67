"""Where the local frame of a cloud lies: the same for all rooms of a survey, whichever is read."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.errors import ReadError
from segmentation.io.facts import Facts

FAR = 10_000.0
"""Beyond this [m] coordinates are projected ones, and are shifted."""
ROUND = 1000.0
"""m; the origin lies on a whole multiple of this."""


def origin_of(
    path: Path, facts: Facts, corners: NDArray[np.float64], *, asked: NDArray[np.float64] | None
) -> NDArray[np.float64]:
    """The origin (3,) [m] for points between two corners (2, 3) [m], Z up; tells where it is.

    If a coordinate exceeds `FAR`: the middle of the plan, rounded to whole kilometres, so that rooms of one survey have
    the same unless one of them lies right between two; heights stay as they are. Else zero.
    Raises ReadError if the origin that is asked for is farther than `FAR` from the points.
    """
    middle = corners.mean(axis=0)
    if asked is not None:
        far = float(np.abs(corners - asked).max())
        if far > FAR:
            wrong = f"lies {far / 1000:,.0f} km from --origin {' '.join(f'{v:.10g}' for v in asked)}"
            nearest = " ".join(f"{v:.10g}" for v in _rounded(middle))
            raise ReadError(path, wrong, f"give an origin within {FAR / 1000:g} km of the points, as {nearest}")
        facts.tell("origin", f"origin: {_said(asked)}, as asked")
        return asked.astype(np.float64) + 0.0
    if np.abs(corners).max() <= FAR:
        return np.zeros(3)
    origin = _rounded(middle)
    facts.tell(
        "origin",
        f"origin: {_said(origin)}, the nearest whole kilometres; --origin X Y Z sets one for all rooms of a survey",
    )
    return origin


def _rounded(middle: NDArray[np.float64]) -> NDArray[np.float64]:
    origin: NDArray[np.float64] = np.round(middle / ROUND) * ROUND + 0.0
    if abs(middle[2]) <= FAR:
        origin[2] = 0.0
    return origin


def _said(origin: NDArray[np.float64]) -> str:
    return " ".join(f"{v:,.10g}".replace(",", "") for v in origin) + " m"

"""Points parted in two that lie side by side all over a surface: those that make it, and those that measure it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SQUARE = 0.25  # [m], side of the cubes


def on_black(points: NDArray[np.floating]) -> NDArray[np.bool_]:
    """Which of points (n, 3) [m] lie in the black ones of cubes that part space like a chessboard."""
    black: NDArray[np.bool_] = np.floor(points / SQUARE).astype(np.int64).sum(axis=1) % 2 == 0
    return black

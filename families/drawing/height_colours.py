"""One colour for each height, where maps show heights: dark is low, bright is high, as the colour-blind see it, too."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SCALE = "viridis"  # of matplotlib, even in brightness (van der Walt and Smith 2015)


def height_shades(share: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Red, green, blue (n, 3) of heights as shares (n,) of the way from the lowest, 0, to the highest, 1."""
    from matplotlib import colormaps

    found: NDArray[np.uint8] = np.rint(255 * colormaps[SCALE](share)[:, :3]).astype(np.uint8)
    return found

"""How high the room stands over places of the plan, found on the numeric surface alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.declaration.vault import Vault

Array = NDArray[np.float64]
HALVINGS = 40  # of the height, in which a surface is looked for


def heights(vault: Vault, xy: Array, depth: float = 0.0) -> Array:
    """Heights (n,) [m] over places (n, 2) at which the stone is `depth` [m] deep, by halving from the springing up."""
    low, high = np.zeros(len(xy)), np.full(len(xy), vault.derived_values()["rise"] + 2 * depth + 1.0)
    while (vault.distance(np.column_stack([xy, high])) < depth).any():  # a ramp is higher than its rise
        high *= 2
    for _ in range(HALVINGS):
        z = (low + high) / 2
        below = vault.distance(np.column_stack([xy, z])) < depth
        low, high = np.where(below, z, low), np.where(below, high, z)
    return low

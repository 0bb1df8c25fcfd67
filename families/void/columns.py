"""How high the room stands over places of the plan, found on the numeric surface alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families.declaration.vault import IDENTITY, Vault
from families.void import body_table, kernel

Array = NDArray[np.float64]
HALVINGS = 40  # of the height, in which a surface is looked for


def heights(vault: Vault, xy: Array, thickness: float = 0.0) -> Array:
    """Heights (n,) [m] of the intrados over places (n, 2), or of the extrados with all radii larger by `thickness` [m].

    By halving from the springing up.
    """
    table = body_table.pack(tuple(piece.grown(thickness) for piece in vault.pieces()), vault.components)

    def beyond(z: Array) -> NDArray[np.bool_]:
        found: Array = kernel.distances(np.column_stack([xy, z]), IDENTITY, table, body_table.NO_WALLS)
        return found >= 0

    low, high = np.zeros(len(xy)), np.full(len(xy), vault.top + 2 * thickness + 1.0)
    while not beyond(high).all():  # an extrados rises more than the thickness where arcs meet at an angle
        high *= 2
    for _ in range(HALVINGS):
        z = (low + high) / 2
        above = beyond(z)
        low, high = np.where(above, low, z), np.where(above, z, high)
    return low

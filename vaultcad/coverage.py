"""The share of each component that the scan really saw."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families import Vault

Array = NDArray[np.float64]
SAMPLES = 8000  # of the whole intrados; a share is then known to about 1 %


def coverage(vault: Vault, points: Array, reach: float, rng: np.random.Generator) -> tuple[dict[str, float], float]:
    """Share, by component and over all, of the intrados that has a point within `reach` [m].

    Args:
        vault: the vault.
        points: (n, 3) of the scan on it, in the vault's frame [m].
        reach: a little more than the points' spacing and their distance from the model [m].
        rng: shifts the places that are asked.
    """
    from scipy.spatial import cKDTree

    asked = vault.sample(SAMPLES, rng)
    seen = (
        cKDTree(points).query(asked.xyz, distance_upper_bound=reach)[0] < np.inf if len(points) else np.zeros(1, bool)
    )
    seen = np.broadcast_to(seen, len(asked))
    shares = {}
    for k, name in enumerate(vault.components, 1):
        mine = asked.component == k
        shares[name] = float(seen[mine].mean()) if mine.any() else 0.0
    return shares, float(seen.mean())

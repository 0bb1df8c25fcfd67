"""What makes a family, and an arch: a vault that has lost it is another's, which says the same of it, and better."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families import Elliptical, Stilted, Vault
from vaultcad.fit.solve import Placed

SHOWN = 0.005  # share of the stone near a vault that its components but one must have together
STEEP = 0.9  # rise / span above which nobody draws an ellipse or stilts an arch: the rest of it is wall


def is_its_family(vault: Vault) -> bool:
    """Whether a vault has what makes its family, and arches such as are built."""
    arches = [arch for arch in vault.profiles.values() if isinstance(arch, Elliptical | Stilted)]
    return all(arch.rise_ratio <= STEEP for arch in arches) and vault.itself


def shows_its_family(placed: Placed, points: NDArray[np.float64], near: float) -> bool:
    """Whether the stone (n, 3) [m] within `near` [m] of a vault lies on several of its components, if it has several.

    A barrel with lunettes of which not one is seen is a barrel, whatever its lunettes may be.
    """
    if not is_its_family(placed.vault) or len(placed.vault.components) == 1:
        return is_its_family(placed.vault)
    here = placed.vault.evaluate(points, frame=placed.pose.frame())
    counts = np.bincount(here.component[(here.component > 0) & (np.abs(here.distance) < near)], minlength=1)
    return bool(counts.max() <= (1 - SHOWN) * counts.sum())

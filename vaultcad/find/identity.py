"""What makes a family, and an arch: a vault that has lost it is another's, which says the same of it, and better."""

from __future__ import annotations

from families import Elliptical, Stilted, Vault

STEEP = 0.9  # rise / span above which nobody draws an ellipse or stilts an arch: the rest of it is wall


def is_its_family(vault: Vault) -> bool:
    """Whether a vault has what makes its family, and arches such as are built."""
    arches = [arch for arch in vault.profiles.values() if isinstance(arch, Elliptical | Stilted)]
    return all(arch.rise_ratio <= STEEP for arch in arches) and vault.itself

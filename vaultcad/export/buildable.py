"""A vault that OpenCASCADE can build, no farther from a fitted one than a scan can tell."""

from __future__ import annotations

from dataclasses import replace

from families import Vault
from vaultcad.errors import ExportError
from vaultcad.export.geometry import bodies, masonry
from vaultcad.model import Model

NUDGES = (0.0, 1e-5, -1e-5, 3e-5, -3e-5)  # of the first parameter, twice that of the second, and so on


def buildable(model: Model) -> Model:
    """The model with vaults that can be built: where surfaces touch just so that they cannot, they are nudged.

    Raises:
        ExportError: a vault cannot be built even so.
    """
    return replace(model, vaults=tuple(replace(f, vault=_nudged(f.vault, model.thickness_of(f))) for f in model.vaults))


def _nudged(vault: Vault, thickness: float) -> Vault:
    ranges = {p.name: p.range for p in vault.parameters() if not p.integer}
    values = vault.values()
    for nudge in NUDGES:
        # Each by its own amount, so that two which were almost equal no longer are.
        moved = {
            name: min(max(values[name] * (1 + k * nudge), limits.low), limits.high)
            for k, (name, limits) in enumerate(ranges.items(), 1)
        }
        trial = vault.replaced(moved) if nudge else vault
        try:
            masonry(trial, thickness)
            bodies(trial, thickness)
        except ValueError:  # ExportError is one
            continue
        return trial
    raise ExportError(
        f"OpenCASCADE cannot build this {vault.title} with walls of {thickness:g} m; try another --thickness"
    )

"""A vault that OpenCASCADE can build, no farther from the one that is asked for than a scan can tell."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TypeVar

import numpy as np

from families import Profile, Ribs, Semicircular, Vault
from segmentation.notes import Note
from vaultcad.export.as_built import solid_of
from vaultcad.export.component_bodies import cut
from vaultcad.export.geometry import exact, masonry, rib_bodies
from vaultcad.model import Assembly, FittedVault, PlacedVault

NUDGES = (0.0, 1e-5, -1e-5, 3e-5, -3e-5)  # of the first parameter, twice that of the second, and so on
FURTHER = (1e-4, -1e-4, 3e-4, -3e-4, 1e-3, -1e-3)  # where that is not enough: some millimetres
ROUND = 2e-3  # of the span, that the rise of an arch which is taken for a semicircle may be off
PLACES = 2000  # at which two vaults are compared
Placed = TypeVar("Placed", bound=Assembly)
WITHOUT = "model.step is without it; the meshes of the other files follow it, but at edges are up to 4 cm off"


def buildable(model: Placed) -> Placed:
    """The same with vaults that can be built, and notes on those that had to be changed for it.

    Where surfaces touch just so that they cannot be, sizes are nudged; arches that all but are semicircles become them.
    A vault that cannot be built even so stays as it is, without a solid.
    """
    notes = list(model.notes)

    def built(placed: PlacedVault, which: str) -> PlacedVault:
        thickness = model.thickness_of(placed)
        vault = _built(placed.vault, thickness)
        if vault is None:
            notes.append(Note("unbuilt", f"{which}: {refusal(placed.vault, thickness)}; {WITHOUT}"))
            return replace(placed, solid=False)
        if vault is not placed.vault:
            off = 1000 * _apart(placed.vault, vault)
            why = f"off the fitted {vault.title}, which cannot be built just so"
            notes.append(Note("nudged", f"{which}: its body is up to {off:.2g} mm {why}"))
        if placed.ribs is not None and (why := _ribless(vault, placed.ribs)):
            notes.append(Note("ribs", f"{which} is without ribs: {why}"))
            placed = replace(placed, ribs=None)
        placed = replace(placed, vault=vault)
        try:
            for surface in model.surfaces(placed):
                solid_of(vault, thickness, surface)
        except ValueError as error:
            assert isinstance(placed, FittedVault)  # of others there are ideal bodies alone, which were built
            notes.append(Note("ideal", f"{which}: files have its ideal body alone, for {error}"))
            placed = replace(placed, surface=None)
        return placed

    several = len(model.vaults) > 1
    vaults = tuple(built(placed, f"vault {k}" if several else "vault") for k, placed in enumerate(model.vaults, 1))
    arches = tuple(built(arch, f"arch {k}") for k, arch in enumerate(model.arches, 1))
    return replace(model, vaults=vaults, arches=arches, notes=tuple(notes))


def _ribless(vault: Vault, ribs: Ribs) -> str:
    """Why no such ribs can hang under a vault; empty if they can."""
    try:
        rib_bodies(vault, ribs)
    except ValueError as error:
        return str(error)
    return ""


def refusal(vault: Vault, thickness: float) -> str:
    """Why a vault has no solid."""
    return f"OpenCASCADE cannot build this {vault.title} with walls of {thickness:g} m; another --thickness may do"


def _built(vault: Vault, thickness: float) -> Vault | None:
    """The vault, or the nearest that can be built; None if none can."""
    for trial in _trials(vault):
        try:
            masonry(trial, thickness)
            cut(trial, exact(trial, thickness))
        except ValueError:  # ExportError is one
            continue
        return trial
    return None


def _trials(vault: Vault) -> Iterator[Vault]:
    """The vault, then others as near to it as may be."""
    yield from (_moved(vault, nudge) for nudge in NUDGES)
    rounded = _rounded(vault)
    if rounded is not None:
        yield from (_moved(rounded, nudge) for nudge in NUDGES)
    yield from (_moved(vault if rounded is None else rounded, nudge) for nudge in FURTHER)


def _moved(vault: Vault, nudge: float) -> Vault:
    """The vault with each size changed by its own amount, so that two which were almost equal no longer are."""
    if not nudge:
        return vault
    ranges = {p.name: p.range for p in vault.parameters() if not p.integer}
    values = vault.values()
    return vault.replaced(
        {
            name: min(max(values[name] * (1 + k * nudge), limits.low), limits.high)
            for k, (name, limits) in enumerate(ranges.items(), 1)
        }
    )


def _rounded(vault: Vault) -> Vault | None:
    """The vault with semicircles in place of arches that all but are; None if there are none."""
    near: dict[str, Profile] = {
        name: Semicircular()
        for name, arch in vault.profiles.items()
        if not isinstance(arch, Semicircular) and abs(arch.rise(0.5) - 0.5) < ROUND
    }
    return vault.with_arches(near) if near else None


def _apart(vault: Vault, other: Vault) -> float:
    """How far two vaults are from each other at most [m]."""
    places = vault.sample(PLACES, np.random.default_rng(0)).xyz
    return float(np.abs(other.distance(places)).max())

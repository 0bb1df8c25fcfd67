"""Bodies of vaults from all over the ranges of all parameters: sound and of the right volume, or refused by a line."""

from __future__ import annotations

import numpy as np
import pytest

from families import FAMILIES, Vault
from families.solid import brep
from families.solid.mesh import mesh
from families.solid.occ.shapes import volume
from fuzz.bodies import BOX, integral_of, stone_of, volume_of
from fuzz.vaults import anywhere

T = 0.15
VAULTS = 40  # of each family


@pytest.mark.parametrize("seed", range(VAULTS))
@pytest.mark.parametrize("family", FAMILIES, ids=lambda cls: cls.id)
def test_void_and_masonry_are_sound_and_as_large_as_the_numeric_surface_says(family: type[Vault], seed: int) -> None:
    vault = anywhere(family, seed)
    stone = brep.masonry(vault, T)  # which OpenCASCADE finds no fault in
    size, deviation = volume_of(vault, stone_of(vault, T), T, BOX[:200_000])
    assert abs(volume(stone) / 1e9 - size) < 6 * deviation
    room, (size, _) = brep.void(vault), integral_of(vault)
    assert volume(room) / 1e9 == pytest.approx(size, rel=1e-4)
    assert np.abs(vault.distance(mesh(vault).vertices)).max() < 1e-6

"""Vaults from all over the ranges: the body is sound, as large as the numeric surface says, and lies on it."""

from __future__ import annotations

import numpy as np
import pytest

from families import FAMILIES, Vault
from families.solid import brep
from families.solid.mesh import mesh
from families.solid.occ.shapes import volume
from fuzz.bodies import integral_of
from fuzz.vaults import anywhere

SEEDS = 1  # fuzz/test_bodies.py draws more


@pytest.mark.parametrize("seed", range(SEEDS))
@pytest.mark.parametrize("family", FAMILIES, ids=lambda cls: cls.id)
def test_the_void_is_what_the_numeric_surface_says(family: type[Vault], seed: int) -> None:
    vault = anywhere(family, seed)
    size, over = integral_of(vault)
    assert volume(brep.void(vault)) / 1e9 == pytest.approx(size, rel=1e-4)
    assert over < vault.plan.area * (1 + 1e-9)
    assert np.abs(vault.distance(mesh(vault).vertices)).max() < 1e-6

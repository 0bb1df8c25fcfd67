"""Where a vault without end walls ends is told by its stone, not by the floor that goes on before it."""

from __future__ import annotations

import numpy as np
import pytest

from families import Barrel
from vaultcad.survey.thinned_scan import Thin, find_site

SPAN, LENGTH, HEIGHT = 3.4, 8.0, 3.0


@pytest.mark.parametrize("beyond", [0.0, 0.2, 4.0])
def test_a_passage_is_as_long_as_its_vault_though_the_floor_goes_on(beyond: float) -> None:
    rng = np.random.default_rng(2)
    vault = Barrel(SPAN, LENGTH).sample(16_000, rng)
    walls = rng.uniform(-1, 1, (16_000, 3)) * [0, LENGTH / 2, HEIGHT / 2] - [0, 0, HEIGHT / 2]
    walls[:, 0] = np.where(np.arange(len(walls)) % 2, SPAN, -SPAN) / 2
    count = round(300 * (LENGTH + 2 * beyond) * SPAN)
    floor = rng.uniform(-1, 1, (count, 3)) * [SPAN / 2, LENGTH / 2 + beyond, 0] - [0, 0, HEIGHT]
    aside, up = np.sign(walls) * [1, 0, 0], np.tile([0.0, 0.0, 1.0], (count, 1))
    xyz = np.concatenate([vault.xyz, walls, floor]) + 0.003 * rng.standard_normal((32_000 + count, 3))
    thin = Thin(xyz, np.concatenate([vault.normals, aside, up]), np.ones(len(xyz)), 0.05)
    site = find_site(thin, xyz)
    along = int(np.argmax(site.spans))
    assert site.walled[1 - along].all()
    assert not site.walled[along].any()
    ends = np.sort(np.abs(site.ends[:, 1]))
    assert np.median(ends) == pytest.approx(LENGTH / 2, abs=0.04)
    assert ends[int(0.95 * len(ends))] < LENGTH / 2 + 0.1

"""Ways in which a vault may have been built, as its finer blocks judge them."""

import numpy as np
import pytest

from vaultcad.change.motion import Places, Trend, Waves
from vaultcad.change.reading import borne_out


@pytest.mark.parametrize(("off", "left"), [(0.0, 2), (0.001, 2), (0.1, 1)])
def test_a_way_that_fine_blocks_rule_out_does_not_count_however_likely_it_was_on_coarse_ones(off, left):
    rng = np.random.default_rng(4)
    place = rng.uniform([-2.5, -2, -1], [2.5, 2, 2], (120, 3))
    normal = rng.normal(size=(120, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    waves = Waves.of(place, normal, Places(np.zeros(1, np.int64), place[:1], normal[:1]), 5.0)
    trend = Trend(rng.normal(size=(120, 4)), np.full(4, 400.0), np.zeros(4), np.zeros((1, 4)))
    known = np.zeros((120, 0)), np.zeros(0), np.zeros(0)
    rest = 0.02 * trend.slopes[:, 0] + rng.normal(0, 0.001, 120)
    stone = rest.copy()
    stone[:6] += off  # an edge that lies elsewhere, seen by a few blocks
    kept = borne_out([(0.3, rest, known), (0.7, stone, known)], trend, waves)
    assert len(kept) == left
    assert kept[0][1] is rest

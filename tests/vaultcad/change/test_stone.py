"""Blocks of stone of which a reading is made."""

import numpy as np
import pytest

from families import FAMILIES
from vaultcad.change.stone import BLOCKS, LAYERS
from vaultcad.fit.settlement import Partition
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose


@pytest.mark.parametrize("family", FAMILIES, ids=lambda cls: cls.id)
def test_blocks_of_walls_are_lower_than_long_so_that_they_tell_how_a_movement_fades(family):
    vault, rng = family(), np.random.default_rng(5)
    edge = vault.plan.outline()
    wall = np.column_stack([edge[rng.integers(len(edge), size=4000)], rng.uniform(-2.5, -0.05, 4000)])
    points = np.concatenate([vault.sample(4000, rng=rng).xyz, wall])
    placed = Placed(vault, Pose(0.0, 0.0, 0.0, 0.0))
    below = np.arange(len(points)) >= 4000

    def heights(layers: float) -> float:
        block = Partition.of(placed, points, np.ones(len(points)), BLOCKS, layers).block
        assert block.max() < BLOCKS
        whole = [np.ptp(points[(block == one) & below, 2]) for one in np.unique(block[below])]
        return float(np.median(whole))

    assert heights(LAYERS) < 0.75 * heights(1.0)

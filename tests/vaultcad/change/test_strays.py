import numpy as np
import pytest

from vaultcad.change.strays import with_most, without_strays
from vaultcad.fit.settlement import Partition


@pytest.mark.parametrize("seed", range(5))
def test_points_before_the_stone_move_no_block_and_a_corner_of_few_points_is_none(seed):
    rng = np.random.default_rng(seed)
    count, each = 40, 50
    block = np.repeat(np.arange(count), each)
    moved = rng.normal(0, 0.005, count)
    residuals = moved[block] + rng.normal(0, 0.003, len(block))
    cord = rng.random(len(block)) < 0.15
    residuals[cord] -= rng.uniform(0.01, 0.05, int(cord.sum()))
    block, residuals = np.append(block, [count] * 3), np.append(residuals, [0.02, 0.03, 0.025])
    blocks = Partition(block, np.ones(len(block)), np.zeros((count + 1, 3)), np.zeros((count + 1, 3)))
    cleaned = without_strays(blocks, residuals)
    assert cleaned.weight[-1] == 0
    assert (cleaned.weight[:-1] > each / 2).all()

    def off(parts: Partition) -> float:
        return float(np.sqrt(np.mean((parts.means(residuals[:, None])[:-1, 0] - moved) ** 2)))

    assert off(cleaned) < 0.0008
    assert off(blocks) > 0.004


def test_blocks_of_a_sparse_scan_are_kept():
    block = np.repeat(np.arange(30), 2)
    blocks = Partition(block, np.ones(60), np.zeros((30, 3)), np.zeros((30, 3)))
    assert (without_strays(blocks, np.random.default_rng(0).normal(0, 0.002, 60)).weight > 0).mean() > 0.9


def test_a_step_in_the_distance_of_a_few_points_moves_no_block_and_leaves_none_empty():
    """Beside the foot of a web the distance to a vault that is a little narrower is that to its wall arch."""
    rng = np.random.default_rng(2)
    count, each = 30, 8
    block = np.repeat(np.arange(count), each)
    residuals = rng.normal(0, 0.002, len(block))
    stepped = rng.random(len(block)) < 0.1
    blocks = Partition(block, np.ones(len(block)), np.zeros((count, 3)), np.zeros((count, 3)))
    told = with_most(blocks, residuals + 0.25 * stepped)
    assert (told.weight > each / 3).all()
    off = told.means((residuals + 0.25 * stepped)[:, None])
    assert np.abs(off).max() < 0.003
    assert np.abs(blocks.means((residuals + 0.25 * stepped)[:, None])).max() > 0.03

"""What all points of a site say of the places that a fit rests on."""

import numpy as np
import pytest

from families import FAMILIES
from vaultcad.change.stonework import NEAR, Stonework
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose

NOISE = 0.004  # m


@pytest.mark.parametrize("family", FAMILIES, ids=lambda cls: cls.id)
def test_all_points_about_a_place_tell_how_far_the_stone_is_off_with_less_noise(family):
    vault, rng = family(), np.random.default_rng(7)
    sample = vault.sample(60_000, rng=rng)
    bulge = 0.01 * np.sin(sample.xyz[:, 0])
    noisy = bulge + rng.normal(0, NOISE, len(bulge))
    some = rng.permutation(len(bulge))[:3000]
    told = Stonework(sample.xyz, sample.component, noisy).told(sample.xyz[some], sample.component[some], noisy[some])
    assert np.std(told - bulge[some]) < 0.6 * NOISE
    assert abs(np.mean(told - bulge[some])) < 0.1 * NOISE


def test_what_has_no_stone_about_it_is_taken_as_it_is_and_each_component_for_itself():
    at = np.array([[0.51, 0.51, 2.51], [0.52, 0.52, 2.52], [3.0, 0.5, 2.5], [0.51, 0.51, 2.51]])
    component = np.array([1, 2, 1, 0])
    own = np.array([0.05, 0.06, 0.07, 0.08])
    whole = Stonework(np.tile(at[0], (6, 1)), np.array([1, 1, 1, 2, 2, 2]), np.array([1.0, 1, 9, 2, 2, 9]) / 1000)
    assert whole.told(at, component, own) == pytest.approx([0.001, 0.002, 0.07, 0.08])
    nothing = Stonework(np.empty((0, 3)), np.empty(0, np.uint16), np.empty(0))
    assert nothing.told(at, component, own) == pytest.approx(own)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda cls: cls.id)
def test_only_stone_near_the_vault_counts_and_no_walls(family):
    vault, rng = family(), np.random.default_rng(7)
    stone = vault.sample(2000, rng=rng).xyz
    placed = Placed(vault, Pose(1.0, 2.0, 3.0, 0.4))
    there = (
        np.concatenate([stone, stone - [0.0, 0.0, 1.0], stone - [0.0, 0.0, 20.0]]) @ placed.pose.placement()[:3, :3].T
    )
    shown = Stonework.about(placed, there + placed.pose.placement()[:3, 3])
    assert len(shown.points) > 0.8 * len(stone)
    assert (shown.component > 0).all()
    assert np.abs(shown.deviation).max() < NEAR
    assert (shown.points[:, 2] > 3 - NEAR).all()

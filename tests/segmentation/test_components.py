"""Components of one primitive: what a strip joins is one, what touches in a point or a line is two."""

from functools import lru_cache

import numpy as np
import pytest

from families import Dome, Groin, Lunette, Semicircular
from families.void.sampling import GOLDEN, sample
from segmentation import PRESETS, Settings, compare, detect

SETTINGS = {"automatic": None, "preset": PRESETS["lunette-ideal"], "beta": Settings(beta=0.1)}
R, SMALL, SPRINGING, COUNT = 3.0, 1.4, 1.0, 3  # [m] radii of barrel and lunettes, their springing, and how many a side


@lru_cache(maxsize=1)  # for each of the settings in turn
def haunched(neck, points, noise=0.0, seed=1):
    """Barrel with lunettes that cut it above their springing alone: necks [m] between them hold crown and haunches
    together. About so many points, normals, labels.
    """
    rng, pitch = np.random.default_rng(seed), 2.0 * SMALL + neck
    centre = (np.arange(COUNT) - (COUNT - 1) / 2.0) * pitch
    depth = R - np.sqrt(R**2 - (SPRINGING + SMALL) ** 2)
    barrel, webs = R * COUNT * pitch, 2.0 * COUNT * SMALL * depth  # areas over pi
    many = np.array([barrel, webs]) / (barrel + webs) * points
    i = np.arange(int(many[0]))  # a lattice of the golden ratio leaves no gaps by chance
    angle, y = np.pi * (i + 0.5) / len(i), COUNT * pitch * ((i * GOLDEN) % 1.0 - 0.5)
    one = np.column_stack((R * np.cos(angle), y, R * np.sin(angle)))
    along = np.abs(y[:, None] - centre).min(axis=1)
    cut = (one[:, 2] > SPRINGING) & (np.hypot(one[:, 2] - SPRINGING, along) < SMALL)
    turn, side = np.pi * rng.random(int(many[1])), rng.choice([-1.0, 1.0], int(many[1]))
    k = rng.integers(0, COUNT, int(many[1]))
    x = side * rng.uniform(R - depth, R, int(many[1]))
    two = np.column_stack((x, centre[k] + SMALL * np.cos(turn), SPRINGING + SMALL * np.sin(turn)))
    outside = np.hypot(two[:, 0], two[:, 2]) > R
    xyz = np.concatenate((one[~cut], two[outside]))
    first = np.column_stack((np.cos(angle), np.zeros_like(y), np.sin(angle)))[~cut]
    second = np.column_stack((np.zeros_like(turn), np.cos(turn), np.sin(turn)))[outside]
    label = np.concatenate((np.ones(len(first), dtype=np.int64), (2 + 2 * k + (side > 0.0))[outside]))
    some = rng.permutation(len(xyz))
    return xyz[some] + noise * rng.normal(size=(len(some), 3)), np.concatenate((first, second))[some], label[some]


@pytest.mark.parametrize(
    ("settings", "neck", "points"),
    [
        *((name, 0.05, 1_000_000) for name in SETTINGS),
        *(("automatic", neck, points) for neck, points in ((0.1, 500_000), (0.2, 200_000), (0.3, 200_000))),
        *((name, 0.5, 200_000) for name in SETTINGS),
    ],
)
def test_haunches_hang_together_by_necks(settings, neck, points):
    xyz, normals, truth = haunched(neck, points)
    for seed, given in enumerate((normals, None)):
        found = detect(xyz, given, SETTINGS[settings], np.random.default_rng(seed))
        assert len(found) == truth.max()
        assert compare(found.labels, truth).least_iou > 0.98


@pytest.mark.parametrize(("neck", "points"), [(0.2, 150_000), (0.3, 60_000)])
def test_noisy_and_sparse_points_resolve_wider_necks(neck, points):
    xyz, _, truth = haunched(neck, points, noise=0.003)
    found = detect(xyz)
    assert len(found) == truth.max()
    assert compare(found.labels, truth).least_iou > 0.9


@pytest.mark.parametrize("springing", [0.0, 1.0])
@pytest.mark.parametrize("neck", [0.05, 0.2])
def test_strips_between_lunettes_belong_to_the_barrel(neck, springing):
    pitch = 2.0 * SMALL + neck
    vault = Lunette(6.0, 3.0 * pitch, Semicircular(), 3, 1.0, 0.0, 2.0 * SMALL / min(pitch, 3.0), springing / 1.6)
    made = sample(vault, 600_000, np.random.default_rng(1))
    found = detect(made.xyz, made.normals)
    assert len(found) == 7
    assert compare(found.labels, made.component).least_iou > 0.95


@pytest.mark.parametrize("noise", [0.0, 0.003])
@pytest.mark.parametrize("points", [100_000, 500_000])
@pytest.mark.parametrize("vault", [Groin(6.0, 6.0), Dome(5.0)], ids=["groin", "dome"])
def test_webs_and_pendentives_touch_in_a_point(vault, points, noise):
    made = sample(vault, points, np.random.default_rng(1))
    xyz = made.xyz + noise * np.random.default_rng(2).normal(size=made.xyz.shape)
    for seed in range(2):
        assert len(detect(xyz, rng=np.random.default_rng(seed))) == made.component.max()


def test_webs_above_lower_ones_are_joined_by_a_strip_at_the_crown():
    made = sample(Groin(6.0, 4.0), 300_000, np.random.default_rng(1))  # crowns at 3 m and at 2 m
    higher = np.where(np.isin(made.component, (1, 2)), 1, made.component - 1)
    found = detect(made.xyz, made.normals)
    assert len(found) == 3
    assert compare(found.labels, higher).least_iou > 0.98

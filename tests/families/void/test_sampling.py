import numpy as np
import pytest
from scipy.spatial import cKDTree

from families import Barrel, Groin, Lunette, Sail, Semicircular
from families.void.sampling import sample, sample_spacing


def test_points_lie_on_the_surface_within_the_plan(any_vault):
    points = sample(any_vault, 5000, np.random.default_rng(1))
    there = any_vault.evaluate(points.xyz)
    assert len(points) == 5000
    assert np.abs(there.distance).max() < 1e-8
    assert (points.component == there.component).all()
    assert set(points.component) == set(range(1, len(any_vault.components) + 1))
    assert (np.abs(points.xyz[:, :2]) <= [any_vault.plan.half_x, any_vault.plan.half_y]).all()
    assert (points.xyz[:, 2] >= 0).all()


def test_normals_have_length_one_and_point_into_the_room(any_even_vault):
    points = sample(any_even_vault, 3000, np.random.default_rng(2))
    assert np.linalg.norm(points.normals, axis=1) == pytest.approx(1.0)
    inside = any_even_vault.distance(points.xyz + 1e-4 * points.normals)
    assert (inside < 0).mean() > 0.995
    assert (any_even_vault.distance(points.xyz - 1e-4 * points.normals) > 0).all()


def test_points_are_evener_than_chance(default_vault):
    count = 8000
    points = sample(default_vault, count, np.random.default_rng(3)).xyz
    nearest = cKDTree(points).query(points, k=2)[0][:, 1]
    area = len(points) * sample_area(default_vault)
    # Clark and Evans 1954: mean distance to the nearest over that of points at random, 1 by chance, 2.15 at most.
    ratio = nearest.mean() / (0.5 * np.sqrt(area / count / count))
    assert ratio > 1.6
    assert np.quantile(nearest, 0.05) > 0.5 * nearest.mean()


def sample_area(vault):
    """Area of the intrados [m²] for each of the points, by a count at a known spacing."""
    points = sample_spacing(vault, 0.05, np.random.default_rng(4))
    return len(points) * 0.05**2 / 8000


def test_no_part_of_the_surface_goes_without(even_vault):
    rng = np.random.default_rng(5)
    points, probes = sample(even_vault, 20_000, rng).xyz, sample(even_vault, 3000, rng).xyz
    gaps = cKDTree(points).query(probes)[0]
    spacing = np.sqrt(sample_area(even_vault) * 8000 / 20_000)
    assert gaps.max() < 2.2 * spacing


@pytest.mark.parametrize("cut", [0.3, 1.7, 3.1])
def test_counts_follow_areas(cut):
    vault = Barrel(4.0, 8.0, Semicircular())
    points = sample(vault, 100_000, np.random.default_rng(6)).xyz
    assert (points[:, 1] < cut).mean() == pytest.approx((cut + 4) / 8, abs=2e-4)
    angle = np.arctan2(points[:, 2], points[:, 0])
    assert (angle < cut).mean() == pytest.approx(min(cut / np.pi, 1), abs=2e-4)


def test_a_domical_barrel_has_more_points_where_it_is_steep():
    vault = Groin(4.0, 4.0, crown_rise_ratio=0.3)
    points = sample(vault, 200_000, np.random.default_rng(7))
    x, y, _ = points.xyz.T
    narrow = (np.abs(x) < 0.2) & (np.abs(y) > 0.5)
    counts, edges = np.histogram(np.abs(y[narrow]), bins=10, range=(0.5, 2.0))
    middle = (edges[1:] + edges[:-1]) / 2
    slope = 2 * vault.crown_rise * middle / 4
    expected = np.sqrt(1 + slope**2)
    assert counts / counts.mean() == pytest.approx(expected / expected.mean(), rel=0.02)


def test_a_seed_gives_the_same_points_to_the_bit_and_another_seed_others():
    one, same, other = (sample(Lunette(), 3000, np.random.default_rng(seed)) for seed in (8, 8, 9))
    assert one.xyz.tobytes() == same.xyz.tobytes()
    assert one.normals.tobytes() == same.normals.tobytes()
    assert one.component.tobytes() == same.component.tobytes()
    assert one.xyz.tobytes() != other.xyz.tobytes()


@pytest.mark.parametrize("count", [1, 2, 17])
def test_few_points_are_fine(count):
    assert len(sample(Lunette(), count, np.random.default_rng(10))) == count


def test_a_spacing_gives_its_count_by_area():
    vault = Barrel(4.0, 8.0)
    points = sample_spacing(vault, 0.05, np.random.default_rng(11))
    assert len(points) == pytest.approx(np.pi * 2 * 8 / 0.05**2, rel=1e-3)
    assert len(sample_spacing(Sail(), 0.1, np.random.default_rng(11))) == pytest.approx(3170.7, rel=0.01)


def test_what_cannot_be_sampled_is_refused():
    rng = np.random.default_rng(12)
    with pytest.raises(ValueError, match="0 points"):
        sample(Barrel(), 0, rng)
    with pytest.raises(ValueError, match=r"spacing = -1"):
        sample_spacing(Barrel(), -1.0, rng)

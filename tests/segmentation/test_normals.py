import numpy as np
import pytest

from segmentation.normals import estimate


def sphere(n: int, rng: np.random.Generator) -> np.ndarray:
    v = rng.normal(size=(n, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_normals_of_a_plane_are_its_normal(dtype):
    rng = np.random.default_rng(1)
    normal = np.array([1.0, 2.0, -2.0]) / 3
    xyz = rng.uniform(-5, 5, (500, 3))
    xyz -= (xyz @ normal)[:, None] * normal
    found = estimate(xyz.astype(dtype), 10)
    np.testing.assert_allclose(np.abs(found @ normal), 1, atol=1e-5)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1, atol=1e-6)


def test_normals_of_a_sphere_point_through_its_centre():
    unit = sphere(20_000, np.random.default_rng(2))
    found = estimate(unit * 4 + [100, -50, 3])
    assert np.degrees(np.arccos(np.clip(np.abs((found * unit).sum(1)), 0, 1))).max() < 5


def test_normals_agree_with_the_eigenvectors_of_the_neighbours():
    from scipy.spatial import cKDTree

    xyz = np.random.default_rng(3).normal(size=(300, 3)) * [1, 1, 0.2]
    found = estimate(xyz, 12)
    nearest = cKDTree(xyz).query(xyz, 12)[1]
    for normal, neighbours in zip(found, xyz[nearest], strict=True):
        vector = np.linalg.eigh(np.cov(neighbours.T))[1][:, 0]
        assert abs(vector @ normal) == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize(
    "xyz",
    [
        np.linspace(0, 1, 50)[:, None] * [1.0, 2.0, 3.0],
        np.ones((50, 3)),
        np.full((50, 3), np.nan),
        np.zeros((0, 3)),
        np.zeros((2, 3)),
    ],
    ids=["line", "one place", "nan", "none", "two"],
)
def test_points_without_a_plane_get_nan(xyz):
    found = estimate(xyz, 10)
    assert found.shape == xyz.shape
    assert np.isnan(found).all()


def test_points_that_are_not_finite_get_nan_and_disturb_none():
    xyz = np.random.default_rng(4).uniform(size=(200, 3)) * [1, 1, 0]
    holed = np.insert(xyz, [0, 77, 200], np.nan, axis=0)
    found = estimate(holed)
    gone = np.isnan(holed).any(1)
    assert np.isnan(found[gone]).all()
    np.testing.assert_array_equal(found[~gone], estimate(xyz))


def test_fewer_points_than_neighbours_are_all_taken():
    np.testing.assert_allclose(np.abs(estimate(np.eye(3), 20)), 1 / np.sqrt(3), atol=1e-6)


def test_too_few_neighbours_are_named():
    with pytest.raises(ValueError, match="neighbours = 2"):
        estimate(np.eye(3), 2)

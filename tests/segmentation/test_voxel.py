import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from segmentation.voxel import thin

CLOUDS = arrays(np.float64, st.tuples(st.integers(1, 200), st.just(3)), elements=st.floats(-50, 50, width=32))


def reference(xyz: np.ndarray, size: float) -> dict[tuple[int, ...], np.ndarray]:
    cells: dict[tuple[int, ...], list[np.ndarray]] = {}
    for p in xyz:
        cells.setdefault(tuple(np.floor(p * (1 / size)).astype(int)), []).append(p)
    return {k: np.array(v) for k, v in cells.items()}


@settings(max_examples=40, deadline=None)
@given(CLOUDS, st.sampled_from([0.01, 0.3, 7.0, 1000.0]), st.sampled_from([np.float32, np.float64]))
def test_cells_hold_what_a_dictionary_would(xyz, size, dtype):
    xyz = xyz.astype(dtype)
    thinned = thin(xyz, size, inverse=True)
    cells = reference(xyz.astype(np.float64), size)
    assert thinned.xyz.dtype == dtype
    assert thinned.count.tolist() == [len(c) for c in cells.values()]
    np.testing.assert_allclose(thinned.xyz, [c.mean(0) for c in cells.values()], rtol=1e-5, atol=1e-6)
    assert (np.bincount(thinned.inverse) == thinned.count).all()
    np.testing.assert_array_equal(thinned.inverse[thinned.first], np.arange(len(thinned)))
    first = np.unique(thinned.inverse, return_index=True)[1]
    np.testing.assert_array_equal(thinned.first, first)
    np.testing.assert_allclose(thinned.mean(xyz), thinned.xyz, rtol=1e-5, atol=1e-6)


def test_many_cells_outgrow_the_first_table():
    rng = np.random.default_rng(5)
    xyz = rng.uniform(0, 100, (200_000, 3))
    thinned = thin(xyz, 0.5, inverse=True)
    keys, count = np.unique(np.floor(xyz * 2).astype(int), axis=0, return_counts=True)
    assert len(thinned) == len(keys)
    assert sorted(thinned.count) == sorted(count)
    assert (np.abs(xyz - thinned.xyz[thinned.inverse]) <= 0.5).all()


def test_the_result_does_not_hang_on_the_number_of_cores(monkeypatch):
    xyz = np.random.default_rng(6).normal(size=(50_000, 3)).astype(np.float32)
    many = thin(xyz, 0.1, inverse=True)
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    one = thin(xyz, 0.1, inverse=True)
    for a, b in zip(vars(many).values(), vars(one).values(), strict=True):
        assert a.tobytes() == b.tobytes()


def test_points_that_are_not_finite_are_passed_over():
    xyz = np.array([[0, 0, 0], [np.nan, 0, 0], [0.1, 0.1, 0.1], [np.inf, 1, 1], [1, -np.inf, 1]])
    thinned = thin(xyz, 1.0, inverse=True)
    np.testing.assert_allclose(thinned.xyz, [[0.05, 0.05, 0.05]])
    assert thinned.inverse.tolist() == [0, -1, 0, -1, -1]
    np.testing.assert_allclose(thinned.mean(np.arange(5.0)), [1.0])


@pytest.mark.parametrize("xyz", [np.zeros((0, 3)), np.full((9, 3), np.nan)], ids=["none", "nan"])
def test_no_points_give_no_cells(xyz):
    thinned = thin(xyz, 0.1, inverse=True)
    assert len(thinned) == 0
    assert thinned.xyz.shape == (0, 3)


def test_duplicates_count():
    assert thin(np.ones((1000, 3), np.float32), 0.01).count.tolist() == [1000]


def test_a_crop_falls_into_the_same_cells():
    xyz = np.random.default_rng(7).uniform(-3, 3, (5000, 3))
    whole, crop = thin(xyz, 0.5), thin(xyz[xyz[:, 0] > 1], 0.5)
    inner = {tuple(p) for p in np.round(crop.xyz, 9)}
    assert inner <= {tuple(p) for p in np.round(whole.xyz, 9)}


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, np.inf])
def test_a_size_that_is_not_positive_is_named(size):
    with pytest.raises(ValueError, match="size = "):
        thin(np.zeros((1, 3)), size)


def test_a_size_too_small_for_the_cloud_is_named():
    with pytest.raises(ValueError, match="too small"):
        thin(np.array([[0.0, 0, 0], [3000, 0, 0]]), 0.001)


def test_means_without_inverse_are_refused():
    with pytest.raises(ValueError, match="inverse=True"):
        thin(np.zeros((1, 3)), 1.0).mean(np.zeros(1))

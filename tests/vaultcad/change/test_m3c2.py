import numpy as np
import pytest

from vaultcad.change.m3c2 import FEWEST, Sheet, m3c2


def patch(rng, count, shift=0.0, noise=0.002):
    """Points of a level plane of 2 × 2 m, and where the plane is."""
    xy = rng.uniform(-1, 1, (count, 2))
    return np.column_stack([xy, np.full(count, shift)]), rng.normal(0, noise, count)


def sheet(rng, count, shift=0.0, noise=0.002):
    flat, offset = patch(rng, count, 0.0, noise)
    return Sheet(flat, offset + shift)


STEPS = np.linspace(-0.8, 0.8, 12)
CORES = np.stack(np.meshgrid(STEPS, STEPS, 0.0), axis=-1).reshape(-1, 3)


def test_what_has_not_moved_is_significant_in_five_of_a_hundred():
    shares = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        shares.append(m3c2(CORES, sheet(rng, 20_000), sheet(rng, 14_000), 0.1).significant.mean())
    assert 0.03 < np.mean(shares) < 0.08


def test_a_shift_is_found_with_its_sign_and_size():
    rng = np.random.default_rng(1)
    found = m3c2(CORES, sheet(rng, 20_000), sheet(rng, 20_000, -0.004), 0.1)
    assert found.significant.all()
    assert found.change.mean() == pytest.approx(-0.004, abs=1e-4)


def test_a_rod_across_one_scan_moves_nothing():
    rng = np.random.default_rng(2)
    before, after = sheet(rng, 20_000), sheet(rng, 20_000)
    rod = np.column_stack([rng.uniform(-1, 1, 400), rng.uniform(-0.01, 0.01, 400), np.zeros(400)])
    clear = m3c2(CORES, before, after, 0.1)
    crossed = m3c2(CORES, before, Sheet(np.vstack([after.foot, rod]), np.append(after.offset, np.full(400, -0.2))), 0.1)
    assert np.abs(crossed.change - clear.change).max() < 2e-4


def test_where_either_scan_has_few_points_nothing_is_said():
    rng = np.random.default_rng(3)
    few = Sheet(CORES[:1] + np.zeros((FEWEST - 1, 3)), np.zeros(FEWEST - 1))
    found = m3c2(CORES, sheet(rng, 20_000), few, 0.1)
    assert np.isnan(found.change).all()
    assert not found.significant.any()


def test_what_is_common_to_a_cylinder_widens_the_level_of_detection():
    rng = np.random.default_rng(4)
    before, after = sheet(rng, 20_000), sheet(rng, 20_000)
    lod = m3c2(CORES, before, after, 0.1, 0.003**2).lod
    assert (lod > 1.96 * 0.003).all()
    assert lod.max() < 1.96 * 0.0035


def test_on_a_plane_it_is_what_py4dgeo_finds(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # it keeps a log where it is
    py4dgeo = pytest.importorskip("py4dgeo", reason="the extra `change` is not installed")
    rng = np.random.default_rng(5)
    # Noise with an end: of other noise ours leaves out what is beyond three scatters.
    before, after = (
        Sheet(patch(rng, count)[0], rng.uniform(-0.003, 0.003, count) + shift)
        for count, shift in ((20_000, 0.0), (15_000, 0.003))
    )
    clouds = [py4dgeo.Epoch(np.column_stack([one.foot[:, :2], one.offset])) for one in (before, after)]
    known = py4dgeo.M3C2(
        epochs=tuple(clouds),
        corepoints=CORES,
        corepoint_normals=np.tile([0.0, 0.0, 1.0], (len(CORES), 1)),
        cyl_radius=0.1,
        max_distance=0.3,
        registration_error=0.0,
    )
    change, uncertainty = known.run()
    found = m3c2(CORES, before, after, 0.1)
    assert np.abs(found.change - change).max() < 1e-9
    assert np.abs(found.lod - uncertainty["lodetection"]).max() < 1e-6

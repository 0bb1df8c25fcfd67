"""A scan that leans is fitted upright and its vaults lean with it; what stands upright stays as it is."""

import numpy as np
import pytest

from families import Barrel, Groin, Segmental, Vault
from segmentation.cloud import Cloud
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.pose import Pose, tilted
from vaultcad.survey.lean import Lean, lean_of
from vaultcad.survey.thinned_scan import Thin, thin_scan

VAULTS: tuple[Vault, ...] = (Barrel(4.0, 6.0), Groin(4.6, 5.4, Segmental(1.5 / 4.6), Segmental(1.5 / 5.4)))


def room(vault: Vault, *, floor: bool = True, slope: float = 0.0, walls: bool = True) -> np.ndarray:
    """Points (n, 3) of a vault 3 m above its floor, with 2 mm of noise."""
    rng = np.random.default_rng(4)
    a, b = vault.plan.half_x, vault.plan.half_y
    parts = [vault.sample(20_000, rng).xyz]
    for axis, side in [(0, -1), (0, 1), (1, -1), (1, 1)] if walls else []:
        points = rng.uniform(-1, 1, (6000, 3)) * [a, b, 1.5] - [0, 0, 1.5]
        points[:, axis] = side * (a, b)[axis]
        parts.append(points)
    if floor:
        points = rng.uniform(-1, 1, (8000, 3)) * [a, b, 0] - [0, 0, 3]
        points[:, 2] += np.tan(slope) * points[:, 0]
        parts.append(points)
    xyz = np.concatenate(parts)
    return xyz + 0.002 * rng.standard_normal(xyz.shape) + [2.0, 1.0, 3.0]


def thin_of(xyz: np.ndarray) -> Thin:
    return thin_scan(Cloud(xyz.astype(np.float32)))


@pytest.mark.parametrize("degrees", [0.5, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("towards", [0.0, 100.0, 220.0])
@pytest.mark.parametrize("floor", [True, False], ids=["floor", "no floor"])
def test_the_lean_is_measured(degrees: float, towards: float, floor: bool) -> None:
    vector = np.radians(degrees) * np.array([np.cos(np.radians(towards)), np.sin(np.radians(towards))])
    lean, notes = lean_of(thin_of(room(VAULTS[0], floor=floor) @ tilted(tuple(vector)).T))
    if not floor and degrees < 0.7:
        assert lean is None
        return
    assert lean is not None
    assert np.degrees(np.hypot(*(lean.vector - vector))) < (0.05 if floor else 0.3)
    assert [note.code for note in notes] == ["tilt"]
    assert "leans by" in notes[0].text


@pytest.mark.parametrize("floor", [True, False])
@pytest.mark.parametrize("slope", [0.0, 2.0])
def test_what_stands_upright_is_left_alone(floor: bool, slope: float) -> None:
    lean, notes = lean_of(thin_of(room(VAULTS[1], floor=floor, slope=np.radians(slope))))
    assert lean is None
    assert [note.code for note in notes] == (["floor"] if floor and slope else [])
    assert all("slopes by 2.0" in note.text and "35 mm in a metre, down at 180°" in note.text for note in notes)


def test_more_than_rooms_lean_is_said() -> None:
    lean, notes = lean_of(thin_of(room(VAULTS[1]) @ tilted((np.radians(10.0), 0.0)).T))
    assert lean is None
    assert "walls lean by 10°" in notes[0].text


def test_where_only_a_floor_tells_it_is_said() -> None:
    lean, notes = lean_of(thin_of(room(VAULTS[1], walls=False, slope=np.radians(2.0))))
    assert lean is None
    assert "the floor slopes by 2.0°, and no walls" in notes[0].text


@pytest.mark.parametrize("vault", VAULTS, ids=lambda v: v.id)
def test_a_leaning_scan_gives_the_same_vault(vault: Vault) -> None:
    vector = (np.radians(1.2), np.radians(-1.6))
    settings = FitSettings(families=(type(vault),))
    leaning = room(vault) @ tilted(vector).T
    result = fit_scan(Cloud(leaning.astype(np.float32)), settings)
    (fitted,) = result.model.vaults
    true = vault.values() | vault.derived_values()
    for name, estimate in fitted.parameters.items():
        if estimate.unit == "m":
            assert estimate.value == pytest.approx(true[name], abs=0.015), name
    assert np.degrees(fitted.pose.lean) == pytest.approx(np.degrees(vector), abs=0.05)
    assert np.degrees(fitted.pose.tilt) == pytest.approx(2.0, abs=0.05)
    # The pose takes the points of the scan as they are into the vault's frame.
    on = result.points[result.vault == 1] @ fitted.pose.frame()[:, :3].T + fitted.pose.frame()[:, 3]
    assert np.sqrt(np.mean(fitted.vault.distance(on) ** 2)) < 0.004


def test_poses_and_points_lean_together() -> None:
    lean = Lean((0.02, -0.03), np.array([5.0, 4.0, 3.0]))
    points = np.random.default_rng(0).uniform(-3, 3, (50, 3))
    there = (points - lean.centre) @ lean.matrix.T + lean.centre
    np.testing.assert_allclose(lean.levelled(there), points, atol=1e-12)
    level = Pose(1.0, 2.0, 3.0, 0.4)
    leaning = lean.pose(level)
    frames = (level.frame(), leaning.frame())
    here, same = (p @ f[:, :3].T + f[:, 3] for p, f in zip((points, there), frames, strict=True))
    np.testing.assert_allclose(here, same, atol=1e-12)
    np.testing.assert_allclose(leaning.placement()[:3] @ np.append(same[0], 1), there[0], atol=1e-12)

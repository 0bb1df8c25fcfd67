"""What speaks against the best model: an octagon seen as a circle is of none of the families that were tried."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import Barrel, Cloister, Dome, Groin, Rotunda, Sail, Semicircular, Trough, Vault
from vaultcad.errors import NoVaultError
from vaultcad.find.misfit import DOUBTFUL, FITS, REFUSED, Misfit, refuse_strangers
from vaultcad.find.refine import Refined, settled
from vaultcad.fit.evidence import Evidence
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.scanner.waves import draw_waves
from vaultcad.survey.thinned_scan import Site

SETTLED = 0.012  # m, along each axis
OCTAGON = Cloister(8, 3.0, Semicircular())


def fitted(vault: Vault, start: Vault, sill: float = 0.0, rough: float = 0.0) -> Refined:
    """A family fitted to a vault that has settled in long waves.

    sill: how far something on it stands out [m]. rough: of short waves all over it [m], rms.
    """
    rng = np.random.default_rng(3)
    sample = vault.sample(6_000, rng)
    xyz = sample.xyz + SETTLED * np.sin(sample.xyz[:, [1, 2, 0]] * np.pi / vault.plan.width)
    xyz += rng.normal(0, 0.003, xyz.shape)
    low = (np.abs(xyz[:, 2] - 1.0) < 0.3) & (xyz[:, 0] > 1.0)
    xyz[low] -= sill * sample.normals[low]
    xyz += rough * draw_waves(12, 0.8, 3.0, rng)(sample.xyz)[:, None] * sample.normals
    kept = [c for c in start.constraints if c.rare]
    return settled(Placed(start, Pose(0, 0, 0, 0)), kept, Evidence(xyz, np.ones(len(xyz)), -1.0), 0.02)


@pytest.fixture(scope="module")
def octagon_as_circle() -> Misfit:
    return Misfit.of(fitted(OCTAGON, Rotunda(3.1)))


def test_settlement_and_noise_are_no_misfit() -> None:
    for vault in (Barrel(4.0, 6.0), OCTAGON):
        misfit = Misfit.of(fitted(vault, vault))
        assert misfit.chance < 0.05
        assert misfit.reason == ""


@pytest.mark.parametrize("vault", [Barrel(4.0, 6.0), OCTAGON, Rotunda(3.1), Groin(5.0, 4.5)], ids=lambda v: v.id)
def test_rough_stone_of_the_right_family_is_believed(vault: Vault) -> None:
    for rough in (0.01, 0.02):
        misfit = Misfit.of(fitted(vault, vault, rough=rough))
        assert misfit.off > 0.8 * rough
        assert misfit.chance < (0.05 if rough == 0.01 else DOUBTFUL)


def test_vaults_that_explain_less_than_half_of_a_scan_are_doubted_the_more_the_less_it_is() -> None:
    doubted = [FITS.with_share(share) for share in (1.0, 0.5, 0.45, 0.35, 0.26, 0.1)]
    chances = [misfit.chance for misfit in doubted]
    assert chances == sorted(chances)
    assert chances[1] == 0.0
    assert chances[-1] < 1.0
    assert doubted[3].reason == "65% of what is bent over the rooms of the scan is not explained"
    assert not doubted[0].reason


def test_what_is_wrong_on_both_sides_alike_is_a_stranger() -> None:
    misfit = Misfit.of(fitted(Sail(5.0, 4.0, 0.8), Groin(5.0, 4.0)))
    assert misfit.chance > 0.9


def test_what_leans_on_a_vault_is_no_misfit() -> None:
    assert Misfit.of(fitted(OCTAGON, OCTAGON, sill=0.08)).chance < 0.05


def test_an_octagon_seen_as_a_circle_is_a_stranger_in_eight_waves(octagon_as_circle: Misfit) -> None:
    assert octagon_as_circle.chance > 0.9
    assert octagon_as_circle.waves == 8
    assert "cm off it in 8 waves round the axis, more than settlement explains" in octagon_as_circle.reason


def test_a_stranger_is_refused_with_the_nearest_and_the_reason(octagon_as_circle: Misfit) -> None:
    refuse_strangers(FITS, Dome())
    refuse_strangers(replace(octagon_as_circle, certain=REFUSED), Dome())
    with pytest.raises(NoVaultError, match=r"none of these families: nearest is a dome.*, but .* 8 waves"):
        refuse_strangers(replace(octagon_as_circle, certain=1.0), Dome())


@pytest.mark.parametrize("axis", [0, 1])
def test_ridges_all_over_are_corrugated_sheet_and_no_masonry(axis: int) -> None:
    vault = Barrel(4.0, 6.0)
    sample = vault.sample(6_000, np.random.default_rng(3))
    wave = np.sin(sample.xyz[:, axis] * 2 * np.pi / 0.25)[:, None] * sample.normals
    for deep, refused in ((0.04, True), (0.008, False)):  # the second are the boards of a centring
        misfit = FITS.with_ridges(Placed(vault, Pose(0, 0, 0, 0)), sample.xyz + deep / 2 * wave)
        assert (misfit.certain > REFUSED) == refused
        assert ("ridges 25 cm apart and 3." in misfit.reason) == refused


def test_much_stone_beside_a_vault_speaks_against_it() -> None:
    """The webs of a trough vault are those of a barrel, its heads are not."""
    trough = Trough(4.0, 6.0)
    sample = trough.sample(8_000, np.random.default_rng(3))
    none = np.zeros(2)
    site = Site(
        sample.xyz, sample.normals, np.ones(8_000), 0.0, none, none, none > 0, -2.0, 2.0, 0.05, none, np.ones(8_000)
    )
    right, wrong = (
        FITS.with_stone_beside(Placed(vault, Pose(0, 0, 0, 0)), site) for vault in (trough, Barrel(4.0, 6.0))
    )
    assert right == FITS
    assert wrong.chance > 0.5
    assert wrong.certain == 0.0  # it may be the vault, with something else under it
    assert "% of the stone over its plan is more than 15 cm off it" in wrong.reason


def test_lamps_and_rods_under_a_vault_that_is_seen_over_them_say_nothing_against_it() -> None:
    vault, rng = Trough(4.0, 6.0), np.random.default_rng(3)
    stone = vault.sample(8_000, rng)
    on_rod = rng.uniform(0, 2 * np.pi, 3_000)
    normals = np.stack([np.cos(on_rod), np.zeros(3_000), np.sin(on_rod)], axis=1)
    rods = 0.03 * normals + np.stack(
        [rng.uniform(-1.5, 1.5, 3_000).round(), rng.uniform(-2, 2, 3_000), np.full(3_000, 0.6)], 1
    )
    none, count = np.zeros(2), 11_000
    points, facing = np.concatenate([stone.xyz, rods]), np.concatenate([stone.normals, normals])
    site = Site(points, facing, np.ones(count), 0.0, none, none, none > 0, -2.0, 2.0, 0.05, none, np.ones(count))
    assert FITS.with_stone_beside(Placed(vault, Pose(0, 0, 0, 0)), site) == FITS
    hidden = points[:, 2] < np.where(np.abs(points[:, 0]) < 1.7, 0.7, 9.0)  # the vault over the rods was not seen
    ones = np.ones(hidden.sum())
    site = replace(site, points=points[hidden], normals=facing[hidden], weights=ones, counts=ones)
    assert FITS.with_stone_beside(Placed(vault, Pose(0, 0, 0, 0)), site).chance > 0.5


def test_strays_of_a_dense_scan_are_no_stone_beside() -> None:
    """A place on the stone holds many points, one on the way from an edge to what is behind it a few."""
    rng, trough, none = np.random.default_rng(3), Trough(4.0, 6.0), np.zeros(2)
    sample = trough.sample(16_000, rng)
    seen = np.flatnonzero(np.abs(sample.xyz[:, 0]) > 1.1)[:8_000]  # where it is seen over them strays say nothing
    strays = np.column_stack([rng.uniform(-1, 1, 1_500), rng.uniform(-2, 2, 1_500), rng.uniform(0.1, 0.5, 1_500)])
    points = np.concatenate([sample.xyz[seen], strays])
    normals = np.concatenate([sample.normals[seen], np.tile([0.6, 0.0, 0.8], (1_500, 1))])
    counts = np.where(np.arange(9_500) < 8_000, 20.0, 1.0)
    site = Site(points, normals, np.ones(9_500), 0.0, none, none, none > 0, -2.0, 2.0, 0.05, none, counts)
    assert FITS.with_stone_beside(Placed(trough, Pose(0, 0, 0, 0)), site).reason == ""
    even = replace(site, counts=np.ones(9_500))
    assert "of the stone over its plan" in FITS.with_stone_beside(Placed(trough, Pose(0, 0, 0, 0)), even).reason


def test_a_small_vault_is_refused_where_a_large_one_is_doubted() -> None:
    rough = Misfit(chance=0.9, off=0.02, certain=0.5)
    refuse_strangers(rough, Trough(3.0, 2.5))
    with pytest.raises(NoVaultError, match="none of these families: nearest is a trough"):
        refuse_strangers(rough, Trough(1.5, 1.4))
    refuse_strangers(replace(rough, chance=0.5), Trough(1.5, 1.4))


def test_few_points_say_nothing() -> None:
    few = fitted(Barrel(4.0, 6.0), Barrel(4.0, 6.0))
    points = few.points[:30]
    evidence = replace(few.evidence, points=points, weights=few.evidence.weights[:30])
    solution = replace(few.solution, residuals=np.full(30, 0.1))
    assert Misfit.of(replace(few, evidence=evidence, solution=solution)) == FITS

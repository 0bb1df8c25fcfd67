"""Lunettes that a model lacks are places in which stone goes back behind it."""

from dataclasses import replace

import numpy as np
import pytest

from families import Barrel, Dome, Lunette, Segmental, Vault
from vaultcad.find.misfit import FITS
from vaultcad.find.pockets import pockets_behind
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.survey.thinned_scan import Site

LUNETTES = Lunette(5.0, 9.0, Segmental(0.45), 3, width_ratio=0.6, springing_ratio=0.3)


def site_of(vault: Vault, settled: float = 0.0, open_ends: bool = False) -> Site:
    sample = vault.sample(40_000, np.random.default_rng(1))
    xyz = sample.xyz + settled * np.sin(sample.xyz[:, [1, 2, 0]])
    none, one, half = np.zeros(2), np.ones(len(xyz)), np.array(vault.plan.half)
    walled = np.array([[True, True], [not open_ends] * 2])
    return Site(xyz, sample.normals, one, 0.0, -half, half, walled, -2.0, 2.0, 0.04, none, one)


@pytest.mark.parametrize(
    ("seen_as", "pockets"), [(LUNETTES, 0), (Barrel(5.0, 9.0, Segmental(0.45)), 6)], ids=["lunettes", "barrel"]
)
def test_each_lunette_that_a_model_lacks_is_a_pocket(seen_as: Vault, pockets: int) -> None:
    assert len(pockets_behind(Placed(seen_as, Pose(0, 0, 0, 0)), site_of(LUNETTES))) == pockets


def test_what_goes_up_at_an_open_end_is_the_next_vault() -> None:
    barrel = Barrel(5.0, 9.0, Segmental(0.45))
    next_one = site_of(Barrel(5.4, 9.0, Segmental(0.5)), open_ends=True)
    over = np.abs(next_one.points[:, 1]) > 4.1
    assert pockets_behind(Placed(barrel, Pose(0, 0, 0, 0)), replace(next_one, **_only(next_one, over))) == []
    walled = replace(next_one, walled=np.ones((2, 2), np.bool_))
    assert pockets_behind(Placed(barrel, Pose(0, 0, 0, 0)), replace(walled, **_only(next_one, over)))


def _only(site: Site, mask: np.ndarray) -> dict[str, np.ndarray]:
    return {name: getattr(site, name)[mask] for name in ("points", "normals", "weights", "counts")}


def test_settlement_makes_no_pockets() -> None:
    for vault in (Barrel(5.0, 9.0), Dome(2.5)):
        assert pockets_behind(Placed(vault, Pose(0, 0, 0, 0)), site_of(vault, 0.05)) == []


def test_several_pockets_are_doubted_and_said_one_is_not() -> None:
    none, one, five = (FITS.with_pockets(count) for count in (0, 1, 5))
    assert none == FITS
    assert 0.0 < one.chance < 0.2 < five.chance
    assert (one.reason, five.certain) == ("", 0.0)
    assert five.reason == "the stone goes back behind it in 5 places, as lunettes do that it does not have"


@pytest.mark.parametrize("vault", [Barrel(5.0, 9.0), Dome(2.5), LUNETTES], ids=["barrel", "dome", "lunettes"])
def test_the_back_of_a_vault_that_is_seen_is_no_pocket(vault: Vault) -> None:
    site = site_of(vault)
    back = np.concatenate([site.points, site.points + 0.25 * np.sign(site.normals[:, 2:]) * site.normals])
    doubled = {name: np.concatenate([getattr(site, name)] * 2) for name in ("normals", "weights", "counts")}
    assert pockets_behind(Placed(vault, Pose(0, 0, 0, 0)), replace(site, points=back, **doubled)) == []

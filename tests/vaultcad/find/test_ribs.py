"""Ribs in scans are found under the vault that they hang under, with their section and how sure it is."""

from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from families import Groin, Mirror, Pointed, Rib
from families.declaration.ribs import DIAGONAL, WALL
from vaultcad.find.arches import FoundArch
from vaultcad.find.findings import told_apart
from vaultcad.find.found import Found
from vaultcad.find.ribs import ribs_under
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.scanner import ScannerSettings, scan
from vaultcad.survey.soffits import Soffit

BARE = ScannerSettings(points=200_000, noise=0.003, settlement=0.02)
VAULTS = (Groin(5, 5), Rib(4.5, 5, Pointed(0.75), Pointed(0.68)))


def under(vault, **ribs):
    """What is seen in a scan of it, and that scan."""
    settings = ScannerSettings(points=BARE.points, noise=BARE.noise, settlement=BARE.settlement, **ribs)
    virtual = scan(vault, settings, rng=np.random.default_rng(5))
    return ribs_under(Placed(vault, Pose(0.0, 0.0, settings.wall_height, 0.0)), virtual.xyz), virtual


@pytest.mark.parametrize("vault", VAULTS, ids=lambda vault: vault.id)
def test_ribs_are_found_with_their_section(vault):
    found, virtual = under(vault, rib_width=0.25, rib_depth=0.2, rib_kinds=("diagonal", "wall"))
    assert [rib.kind for rib in found] == ["diagonal"] * 2 + ["wall"] * 4
    for rib in found:
        width, off = (0.25, 0.012) if rib.kind == "diagonal" else (0.125, 0.03)  # where walls hide the other edge
        assert rib.soffit.width == pytest.approx(width, abs=off)
        assert rib.depth == pytest.approx(0.2, abs=0.02)
        assert 0.0005 < rib.depth_std < 0.02
        assert abs(rib.soffit.width - width) < 3 * rib.soffit.width_std < 0.12
    own = virtual.xyz[virtual.arch > 0]
    assert np.any([rib.holds(own) for rib in found], axis=0).mean() > 0.9


@pytest.mark.parametrize("vault", VAULTS, ids=lambda vault: vault.id)
def test_no_ribs_are_made_up(vault):
    assert under(vault)[0] == ()


def test_what_hangs_at_two_heights_under_a_line_is_no_rib():
    placed = Placed(Groin(5, 5), Pose(0.0, 0.0, 0.0, 0.0))
    along = np.linspace(-2.5, 2.5, 1000)
    height = np.sqrt(np.maximum(2.5**2 - along**2, 0.0))
    rafters = np.concatenate([np.column_stack([along, along, height - depth]) for depth in (0.15, 0.3)])
    assert ribs_under(placed, rafters) == ()


def test_strays_between_the_edge_of_an_arch_and_the_web_behind_it_are_no_rib():
    vault, edge, rng = Groin(5, 5), 0.2, np.random.default_rng(3)
    across = 0.3 * rng.random(2000)  # m from the wall's face, and how far strays are below the web there
    along = rng.uniform(-2.2, 2.2, 2000)
    height = np.sqrt(2.5**2 - along**2)
    strays = np.column_stack([along, across - 2.5, height - edge * (1 - across / 0.3)])
    web = vault.sample(100_000, rng).xyz
    placed = Placed(vault, Pose(0.0, 0.0, 0.0, 0.0))
    assert ribs_under(placed, np.concatenate([web, strays])) == ()


def test_vaults_without_four_straight_sides_have_none_looked_for():
    from families import Rotunda

    assert ribs_under(Placed(Rotunda(), Pose(0.0, 0.0, 0.0, 0.0)), np.zeros((10, 3))) == ()
    assert ribs_under(Placed(Mirror(), Pose(0.0, 0.0, 0.0, 0.0)), np.zeros((0, 3))) == ()


def strip(y: float, width: float, line: str = "", yaw: float = 0.0) -> FoundArch:
    """An arch over 2.4 m along x, or a rib, where it lies; of what it is fitted with nothing is asked."""
    soffit = Soffit(np.array([0.0, y]), yaw, 2.4, width, np.array([[-1.2, 2.0], [0.0, 2.7], [1.2, 2.0]]))
    return FoundArch(soffit, cast(Found, None), np.full(2, 0.2), np.full(2, 0.01), line)


def test_the_edge_of_an_arch_under_a_vault_that_reaches_over_it_is_no_rib():
    arch, wide = strip(0.0, 0.44), strip(10.0, 1.2)
    edges = [strip(0.17, 0.1, WALL), strip(10.6, 0.15, WALL, np.pi)]
    alone = strip(3.0, 0.15, WALL)
    assert told_apart([arch, wide], [*edges, alone]) == ([arch, wide], [alone])


def test_faces_of_an_arch_beside_which_no_vault_is_seen_are_those_of_arches_like_it() -> None:
    unseen = replace(strip(0.0, 0.44), depth=np.full(2, np.nan))
    like, wide = replace(strip(5.0, 0.46), depth=np.array([np.nan, 0.15])), replace(strip(9.0, 0.9), depth=np.ones(2))
    assert unseen.faces([unseen, wide, like]).tolist() == [0.15, 0.15]
    assert np.isnan(unseen.faces([unseen, wide])).all()
    assert strip(0.0, 0.44).faces([like, wide]).tolist() == [0.2, 0.2]


def test_a_diagonal_rib_is_no_arch():
    arch, rib = strip(0.0, 0.25), strip(0.02, 0.25, DIAGONAL)
    assert told_apart([arch], [rib]) == ([], [rib])

"""Ground that is no rectangle: told by normals, and the families over it recognised in small virtual rooms."""

from __future__ import annotations

from dataclasses import replace
from math import pi, remainder

import numpy as np
import pytest

from families import (
    FAMILIES,
    Annular,
    Barrel,
    Cloister,
    Conch,
    Dome,
    Groin,
    Pointed,
    Rotunda,
    Sail,
    Segmental,
    Trough,
    Vault,
)
from families.declaration.footprint import DISC, GORED, HALF_DISC, POLYGON, SECTOR
from segmentation import compare
from segmentation.cloud import Cloud
from vaultcad.find.findings import find_vaults
from vaultcad.fit.label import label
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.pose import Pose
from vaultcad.scanner import ScannerSettings, VirtualScan, scan
from vaultcad.survey.footprints import grounds_of
from vaultcad.survey.lean import lean_of
from vaultcad.survey.thinned_scan import STEEP, Site, survey, thin_scan

YAW = 0.4
SETTINGS = ScannerSettings(points=50_000, stations=2, noise=0.003, settlement=0.02, yaw=YAW)
PIERS = replace(SETTINGS, walls="piers")
NEAREST = (Cloister, Trough, Dome, Sail)  # to a cloister vault on piers, of which many parts are tried


def scanned(vault: Vault, settings: ScannerSettings = SETTINGS) -> VirtualScan:
    return scan(vault, settings, rng=np.random.default_rng(4))


def site_of(vault: Vault) -> Site:
    return survey(Cloud(scanned(vault).xyz.astype(np.float32)))


@pytest.mark.parametrize("vault", [Groin(), Barrel(), Trough(), Sail(), Dome()], ids=lambda vault: vault.id)
def test_over_a_rectangle_nothing_else_is_looked_for(vault: Vault) -> None:
    assert not site_of(vault).grounds


@pytest.mark.parametrize(
    ("vault", "shapes"),
    [
        (Rotunda(2.5), {DISC}),
        (Conch(2.5), {HALF_DISC}),
        (Annular(5.0, 0.5, 2.0), {SECTOR}),
        (Annular(5.0, 0.5, 2 * pi), {SECTOR}),
        (Cloister(6, 2.5), {POLYGON}),
        (Cloister(8, 2.5, Segmental(0.4), 0.3, crossing=1), {POLYGON}),
    ],
    ids=lambda value: getattr(value, "id", ""),
)
def test_normals_tell_footprint_place_and_turn(vault: Vault, shapes: set[str]) -> None:
    grounds = site_of(vault).grounds
    assert set(grounds) == shapes
    (ground,) = grounds[min(shapes)]
    c, s = np.cos(YAW), np.sin(YAW)
    centre = np.array([[c, -s], [s, c]]) @ vault.plan.centre
    assert np.hypot(*(centre - [ground.x, ground.y])) < 0.1
    if isinstance(vault, Cloister):
        turn = pi / 2 if vault.crossing else 2 * pi / vault.sides
        assert ground.footprint.sides == vault.webs
        assert ground.footprint.diagonal == pytest.approx(1.3 if vault.crossing else 1.0, abs=0.1)
        assert ground.footprint.radius == pytest.approx(vault.radius, abs=0.2)
    else:
        turn = 2 * pi
        assert ground.footprint.angle == pytest.approx(vault.angle if isinstance(vault, Annular) else 2 * pi, abs=0.1)
    if not vault.plan.turns:
        assert remainder(ground.yaw - YAW, turn) == pytest.approx(0, abs=0.06)


@pytest.mark.parametrize(
    ("vault", "settings"),
    [
        (Rotunda(2.2, Pointed(0.7)), SETTINGS),
        (Conch(2.2), SETTINGS),
        (Annular(4.0, 0.6, pi / 2), SETTINGS),
        (Cloister(8, 2.2), SETTINGS),
        (Cloister(12, 2.2, Segmental(0.4)), SETTINGS),
        (Cloister(8, 2.5, Segmental(0.4), 0.3, crossing=1), PIERS),
        (Barrel(3.0, 5.0, Segmental(0.3), slope=0.35), SETTINGS),
        (Barrel(3.0, 3.0, Segmental(0.3), splay=-0.3), SETTINGS),
    ],
    ids=lambda value: getattr(value, "id", ""),
)
def test_a_vault_over_other_ground_is_recognised(vault: Vault, settings: ScannerSettings) -> None:
    virtual = scanned(vault, settings)
    families = FAMILIES if settings is SETTINGS else NEAREST
    xyz = virtual.xyz.astype(np.float32)
    (found,) = find_vaults(thin_scan(Cloud(xyz)), xyz, families, np.random.default_rng(0)).vaults
    fitted = found.placed.vault
    assert type(fitted) is type(vault)
    labels = label(xyz, [(found.placed, found.tolerance)])
    assert compare(labels.component, virtual.component).mean_iou > 0.95
    assert fitted.values() == pytest.approx(vault.values(), abs=0.06)


@pytest.mark.parametrize("seed", [4, 5])
def test_deep_windows_in_a_small_apse_do_not_hide_that_it_is_round(seed: int) -> None:
    """Their reveals go a seventh of the radius farther, in a third of all directions."""
    vault = Conch(1.9, profile=Segmental(0.33))
    settings = replace(SETTINGS, openings=4, walls="walls", points=80_000)
    scanned_ = scan(vault, settings, rng=np.random.default_rng(seed))
    (ground,) = survey(Cloud(scanned_.xyz.astype(np.float32))).grounds[HALF_DISC]
    assert ground.footprint.span_x == pytest.approx(3.8, abs=0.08)


def test_stone_about_a_rim_alone_has_no_waves() -> None:
    """A room of which little but a rim was left stopped a fit with numpy's own words."""
    angle = np.random.default_rng(1).uniform(0, 2 * np.pi, 2000)
    rim = np.column_stack([3 * np.cos(angle), 3 * np.sin(angle), np.full(2000, 2.0)])
    slanting = np.column_stack([np.cos(angle), np.sin(angle), np.ones(2000)]) / np.sqrt(2)
    assert GORED not in grounds_of(rim, slanting, STEEP)


@pytest.mark.parametrize("vault", [Trough(), Annular(5.5, 0.5, 2.3)], ids=lambda vault: vault.id)
def test_haunches_alone_do_not_lean(vault: Vault) -> None:
    cloud = Cloud(vault.sample(100_000, np.random.default_rng(3)).xyz.astype(np.float32))
    assert lean_of(thin_scan(cloud)) == (None, ())


@pytest.mark.parametrize(("length", "splay"), [(7.0, 0.15), (2.5, 0.3)])
def test_a_splay_without_walls_is_found_as_long_and_as_wide_as_it_is(length: float, splay: float) -> None:
    barrel, turn = Barrel(4.0, length, Segmental(0.4), splay=splay), Pose(0.7, -0.2, 3.0, YAW).placement()
    xyz = barrel.sample(150_000, np.random.default_rng(3)).xyz @ turn[:3, :3].T + turn[:3, 3]
    (fitted,) = fit_scan(Cloud(xyz.astype(np.float32)), FitSettings((Barrel, Trough))).model.vaults
    assert fitted.vault.values() == pytest.approx(barrel.values(), abs=0.005)

"""Scans without a vault are refused, whatever stands in them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from families import (
    FAMILIES,
    Barrel,
    Dome,
    Groin,
    Lunette,
    Mirror,
    Sail,
    Segmental,
    Semicircular,
    Trough,
    Vault,
)
from segmentation.cloud import Cloud
from vaultcad.errors import NoVaultError, OtherThingError
from vaultcad.find.arches import find_arch
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.scanner import ScannerSettings, scan
from vaultcad.scanner.barren import SCENES, draw_barren
from vaultcad.survey.soffits import Soffit
from vaultcad.survey.thinned_scan import Thin

Points = NDArray[np.float64]


def plane(rng: np.random.Generator) -> Points:
    return rng.uniform(-3, 3, (20_000, 3)) * [1, 1, 0]


def wall(rng: np.random.Generator) -> Points:
    return plane(rng)[:, [0, 2, 1]]


def flat_room(rng: np.random.Generator) -> Points:
    sides = []
    for axis in range(3):
        for side in (0, 1):
            face = rng.uniform(0, 1, (8000, 3))
            face[:, axis] = side
            sides.append(face * [5, 7, 3])
    return np.concatenate(sides)


def ball_on_a_floor(rng: np.random.Generator) -> Points:
    ball = rng.standard_normal((20_000, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    return np.concatenate([ball, plane(rng) - [0, 0, 1]])


def noise(rng: np.random.Generator) -> Points:
    return rng.uniform(0, 4, (8000, 3))


@pytest.mark.parametrize(
    ("scene", "family"),
    [
        (plane, Sail),
        (wall, Trough),
        *((flat_room, family) for family in FAMILIES),
        (ball_on_a_floor, Dome),
        (noise, Sail),
    ],
    ids=lambda value: value.__name__,
)
def test_what_is_no_vault_is_refused(scene: Callable[[np.random.Generator], Points], family: type[Vault]) -> None:
    rng = np.random.default_rng(0)
    xyz = scene(rng)
    xyz += 0.002 * rng.standard_normal(xyz.shape)
    with pytest.raises(NoVaultError, match="no vault found"):
        fit_scan(Cloud(xyz.astype(np.float32)), FitSettings(families=(family,)))


@pytest.mark.parametrize(
    ("kind", "seed", "families"),
    [
        ("facade", 508, FAMILIES),
        ("facade", 518, (Mirror, Groin, Barrel)),
        ("roof", 517, (Barrel, Lunette, Trough)),
        ("roof", 9128, FAMILIES),
        ("office", 510, (Mirror, Groin)),
        ("corridor", 10, FAMILIES),
    ],
    ids=lambda value: str(value) if isinstance(value, str | int) else "",
)
def test_scenes_that_were_taken_for_vaults_are_refused(kind: str, seed: int, families: tuple[type[Vault], ...]) -> None:
    """Those that hang together in many parts by the families alone that come nearest to one of these."""
    xyz = draw_barren(kind, np.random.default_rng(seed), 60_000)
    with pytest.raises(NoVaultError, match="no vault found"):
        fit_scan(Cloud(xyz.astype(np.float32)), FitSettings(families=families))


def test_every_kind_of_scene_can_be_drawn() -> None:
    for kind in SCENES:
        xyz = draw_barren(kind, np.random.default_rng(3), 4000)
        assert len(xyz) == pytest.approx(4000, rel=0.35), kind
        assert np.isfinite(xyz).all()
        again = draw_barren(kind, np.random.default_rng(3), 4000)
        assert xyz.tobytes() == again.tobytes()


def test_a_surface_that_is_too_rough_is_named() -> None:
    rng = np.random.default_rng(0)
    vault = Barrel(4.0, 6.0)
    walls = np.concatenate(
        [[s * 2.0, y, z] for s in (-1, 1) for y in np.arange(-3, 3, 0.1) for z in np.arange(-2, 0, 0.1)]
    )
    rough = vault.sample(12_000, rng).xyz
    rough = rough + 0.06 * rng.standard_normal((len(rough), 1)) * [0, 0, 1]
    cloud = Cloud(np.concatenate([rough, walls.reshape(-1, 3)]).astype(np.float32))
    with pytest.raises(NoVaultError, match="too rough for a vault"):
        fit_scan(cloud, FitSettings(families=(Barrel,)))


def hemisphere(rng: np.random.Generator, *, oculus: float = 0.0, walls: float = 0.0) -> Points:
    """A dome of 3 m radius over a round plan, with an opening at its crown, on a round wall."""
    angle, height = rng.uniform(0, 2 * np.pi, 30_000), rng.uniform(0, 1, 30_000)
    flat = np.sqrt(1 - height**2)
    dome = 3 * np.stack([flat * np.cos(angle), flat * np.sin(angle), height], 1)
    parts = [dome[np.hypot(dome[:, 0], dome[:, 1]) > oculus]]
    if walls:
        around = rng.uniform(0, 2 * np.pi, 20_000)
        wall = [3 * np.cos(around), 3 * np.sin(around), -walls * rng.uniform(0, 1, 20_000)]
        ground = 3 * np.sqrt(rng.uniform(0, 1, 10_000))
        turn = rng.uniform(0, 2 * np.pi, 10_000)
        parts += [
            np.stack(wall, 1),
            np.stack([ground * np.cos(turn), ground * np.sin(turn), np.full(10_000, -walls)], 1),
        ]
    return np.concatenate(parts) + 0.003 * rng.standard_normal((sum(map(len, parts)), 3))


@pytest.mark.parametrize(
    ("family", "shape"),
    [(Sail, {}), (Sail, {"oculus": 0.6}), (Dome, {"walls": 4.0}), (Dome, {"walls": 4.0, "oculus": 0.6})],
    ids=["alone", "with an oculus", "rotunda", "rotunda with an oculus"],
)
def test_a_dome_over_a_round_plan_gets_no_corners(family: type[Vault], shape: dict[str, float]) -> None:
    xyz = hemisphere(np.random.default_rng(1), **shape)
    with pytest.raises(NoVaultError, match=r"(3\.00|3\.01|2\.99) m radius.*is a rotunda"):
        fit_scan(Cloud(xyz.astype(np.float32)), FitSettings(families=(family,)))


@pytest.mark.parametrize("shape", [{}, {"oculus": 0.6}, {"walls": 4.0}, {"walls": 4.0, "oculus": 0.6}], ids="-".join)
def test_a_dome_over_a_round_plan_is_a_rotunda(shape: dict[str, float]) -> None:
    (fitted,) = fit_scan(Cloud(hemisphere(np.random.default_rng(1), **shape).astype(np.float32))).model.vaults
    # Without a crown other arches do as well, from springings a little higher, and are told.
    loose = "oculus" in shape
    assert "semicircular" in (fitted.arches["profile"] if loose else fitted.vault.kinds["profile"])
    values, rise = fitted.vault.values(), fitted.vault.derived_values()["rise"]
    assert (values["radius"], values["drum_ratio"]) == pytest.approx((3.0, 0.0), abs=0.005)
    assert (fitted.pose.x, fitted.pose.y, fitted.pose.yaw) == pytest.approx((0, 0, 0), abs=0.02)
    assert fitted.pose.z + rise == pytest.approx(3.0, abs=0.02)
    assert fitted.pose.z == pytest.approx(0.0, abs=0.07 if loose else 0.02)


def test_reveals_that_go_far_up_do_not_hide_a_vault() -> None:
    rng = np.random.default_rng(2)
    vault = Groin(4.6, 5.4, Segmental(1.5 / 4.6), Segmental(1.5 / 5.4))
    xyz = scan(vault, ScannerSettings(points=60_000, settlement=0.01), rng=rng).xyz
    shaft = rng.uniform(0, 1, (5000, 3)) * [0.33, 1.6, 6.0] + [1.95, -1.0, 6.0]
    shaft[::2, 0] = 1.95 + 0.33 * (np.arange(2500) % 2)
    result = fit_scan(Cloud(np.concatenate([xyz, shaft]).astype(np.float32)), FitSettings(families=(Groin,)))
    (fitted,) = result.model.vaults
    assert fitted.parameters["rise"].value == pytest.approx(1.5, abs=0.08)


@pytest.mark.parametrize("walled", [False, True], ids=["lining", "room"])
def test_a_cylinder_that_goes_on_below_its_springing_is_no_vault_of_a_room(walled: bool) -> None:
    rng = np.random.default_rng(3)
    turn, along = rng.uniform(-0.5, np.pi + 0.5, 40_000), rng.uniform(-6, 6, 40_000)
    xyz = np.column_stack([2.8 * np.cos(turn), along, 2.8 * np.sin(turn)]) + rng.normal(0, 0.003, (40_000, 3))
    if walled:
        below = xyz[:, 2] < 0
        xyz[below, 0] = 2.8 * np.sign(xyz[below, 0])
    floor = rng.uniform([-2.4, -6, -1.35], [2.4, 6, -1.34], (8_000, 3))
    tunnel, settings = Cloud(np.concatenate([xyz, floor]).astype(np.float32)), FitSettings(families=(Barrel,))
    if walled:
        assert fit_scan(tunnel, settings).model.vaults[0].parameters["span"].value == pytest.approx(5.6, abs=0.01)
        return
    with pytest.raises(OtherThingError, match=r"2\.80 m radius that goes on below its springing, .* tunnel"):
        fit_scan(tunnel, settings)


def test_the_lintel_of_a_door_is_no_arch() -> None:
    along = np.arange(-0.55, 0.6, 0.1)
    level = Soffit(np.zeros(2), 0.0, 1.2, 0.5, np.column_stack([along, 2.1 + 0.005 * (np.arange(len(along)) % 3)]))
    nothing = Thin(np.empty((0, 3)), np.empty((0, 3)), np.empty(0), 0.05)
    with pytest.raises(NoVaultError, match=r"a soffit 1\.2 m long is level"):
        find_arch(level, nothing, np.empty((0, 3)), np.random.default_rng(0))


@pytest.mark.parametrize("slope", [0.0, -0.58])
def test_a_lining_is_one_up_a_ramp_too_whatever_stands_within(slope: float) -> None:
    rng, radius, tolerance = np.random.default_rng(4), 3.2, 0.03
    turn, along = rng.uniform(-0.5, np.pi + 0.5, 20_000), rng.uniform(-8, 8, 20_000)
    lining = np.column_stack([radius * np.cos(turn), along, radius * np.sin(turn)])
    room = np.column_stack([np.clip(1.2 * lining[:, 0], -radius, radius), along, np.minimum(lining[:, 2], 0.0)])
    stairs = np.column_stack(
        [rng.choice([-2.2, 2.2], 9_000), rng.uniform(-8, 8, 9_000), rng.uniform(-1.6, -1.0, 9_000)]
    )
    vault = Barrel(2 * radius, 16.0, Semicircular(), slope)
    for walls, refused in ((lining, True), (room, False)):
        points = np.concatenate([lining[turn % np.pi == turn], walls[turn % np.pi != turn], stairs])
        points[:, 2] += slope * points[:, 1] + vault.lift
        why = vault.contradiction(points, points[: int((turn % np.pi == turn).sum())], tolerance)
        assert ("lining of a tunnel" in why) == refused


@pytest.mark.parametrize("height", [1.5, 2.2, 2.9, 3.4])
def test_a_room_is_no_tunnel_where_the_feet_of_its_walls_lie_on_the_circle_of_its_vault(height: float) -> None:
    rng, vault, tolerance = np.random.default_rng(4), Barrel(5.2, 8.0, Segmental(0.295)), 0.07
    own = vault.sample(20_000, rng).xyz
    walls = rng.uniform(-1, 1, (20_000, 3)) * [0, 4, height / 2] - [0, 0, height / 2]
    walls[:, 0] = 2.6 * (1 - 2 * (np.arange(len(walls)) % 2))
    assert vault.contradiction(np.concatenate([own, walls]), own, tolerance) == ""

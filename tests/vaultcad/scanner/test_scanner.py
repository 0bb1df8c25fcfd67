import dataclasses
import json
import sys
from functools import cache
from math import cos, radians, sin

import numpy as np
import pytest

import segmentation
from families import FAMILIES, Barrel, Groin, Lunette, Mirror, Sail, Vault
from vaultcad.errors import MissingLibraryError
from vaultcad.scanner import ScannerSettings, VirtualScan, beams, draw, read_truth, scan, vault_of, write_scan
from vaultcad.scanner.room import GAP, TOLERANCE
from vaultcad.scanner.shoot import FLYING
from vaultcad.scanner.triangles import box, split

EXACT = ScannerSettings(
    points=20_000,
    stations=1,
    noise=0,
    ranging_error=0,
    angle_noise=0,
    mixed=0,
    dropout=0,
    registration_shift=0,
    registration_turn=0,
    relief=0,
    settlement=0,
    openings=0,
    tie_rods=0,
    furniture=0,
    lamp=False,
    yaw=0.4,
)
FURNISHED = dataclasses.replace(EXACT, tie_rods=3, furniture=4, lamp=True, scaffold=True, cornice=True, openings=4)
MESH = 2 * TOLERANCE  # the mesher keeps about its tolerance
EACH = pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.id)


@cache
def scanned(vault: Vault, settings: ScannerSettings, seed: int = 3) -> VirtualScan:
    return scan(vault, settings, rng=np.random.default_rng(seed))


def changed(settings: ScannerSettings, **values: object) -> ScannerSettings:
    return dataclasses.replace(settings, **values)  # type: ignore[arg-type]


def in_vault_frame(virtual: VirtualScan, xyz: np.ndarray) -> np.ndarray:
    yaw = radians(virtual.truth["pose"]["yaw_deg"])
    moved = xyz + virtual.origin - virtual.truth["pose"]["origin"]
    return moved @ np.array([[cos(yaw), -sin(yaw), 0], [sin(yaw), cos(yaw), 0], [0, 0, 1]])


def ranges(virtual: VirtualScan) -> np.ndarray:
    return np.linalg.norm(virtual.xyz - virtual.stations[virtual.station], axis=1)


@EACH
def test_exact_rays_end_on_the_numeric_surface_or_on_the_walls_around_it(family: type[Vault]) -> None:
    vault = family()
    virtual = scanned(vault, EXACT)
    local = in_vault_frame(virtual, virtual.xyz)
    shown = virtual.component > 0
    assert set(np.unique(virtual.component)) == set(range(len(vault.components) + 1))
    assert np.abs(vault.distance(local[shown])).max() < MESH
    on_floor = np.abs(local[:, 2] + EXACT.wall_height) < 1e-5
    wall = vault.evaluate(local[~shown & ~on_floor], walls=True)
    assert np.abs(wall.distance).max() < 2 * GAP


@EACH
def test_labels_are_the_components_of_the_numeric_surface_but_on_the_edges(family: type[Vault]) -> None:
    vault = family()
    virtual = scanned(vault, EXACT)
    shown = virtual.component > 0
    local, label = in_vault_frame(virtual, virtual.xyz)[shown], virtual.component[shown]
    other = vault.evaluate(local).component != label
    assert other.mean() < 0.01
    steps = 0.02 * np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
    around = np.array([vault.evaluate(local[other] + step).component for step in steps])
    assert (around == label[other]).any(0).all()


def test_a_station_stands_in_the_room_at_its_height() -> None:
    settings = changed(EXACT, stations=4, station_height=1.6, points=2000)
    for vault in (Groin(), Mirror()):
        virtual = scanned(vault, settings)
        local = in_vault_frame(virtual, virtual.stations)
        assert len(local) == 4
        assert vault.distance(local, walls=True).max() < -0.3
        assert np.abs(virtual.stations[:, 2] - 1.6).max() <= 0.05


@pytest.mark.parametrize("points", [5000, 60_000])
def test_about_as_many_points_come_as_were_asked_for(points: int) -> None:
    for settings in (FURNISHED, changed(FURNISHED, stations=3, crop=True, holes=0.2)):
        assert len(scanned(Groin(), changed(settings, points=points))) == pytest.approx(points, rel=0.1)


def test_room_and_stations_stay_when_more_points_are_asked_for() -> None:
    few, many = (scanned(Groin(), changed(FURNISHED, points=n)) for n in (5000, 20_000))
    assert np.array_equal(few.stations, many.stations)
    assert len(many) > 3 * len(few)


def test_range_noise_is_as_declared() -> None:
    settings = changed(EXACT, noise=0.004)
    noisy, exact = scanned(Groin(), settings), scanned(Groin(), EXACT)
    error = ranges(noisy) - ranges(exact)
    local = in_vault_frame(exact, exact.xyz)
    shown = exact.component > 0
    normal = Groin().evaluate(local[shown]).normal
    beam = local[shown] - in_vault_frame(exact, exact.stations)[0]
    cosine = np.abs((normal * beam).sum(1)) / np.linalg.norm(beam, axis=1)
    scaled = error[shown] / beams.range_sigma(ranges(exact)[shown], cosine, 0.004)
    assert scaled.mean() == pytest.approx(0, abs=0.05)
    assert scaled.std() == pytest.approx(1, abs=0.05)


def test_noise_is_the_declared_one_at_ten_metres_and_grows_with_range_and_slant() -> None:
    distance, cosine = np.array([10.0, 25, 10]), np.array([1.0, 1, 0.5])
    at_ten, far, slanted = beams.range_sigma(distance, cosine, 0.0006)
    assert at_ten == pytest.approx(0.0006)
    assert far > at_ten
    assert slanted == pytest.approx(2 * at_ten)


def test_a_station_s_systematic_range_error_is_one_scale_within_its_limit() -> None:
    ratio = ranges(scanned(Groin(), changed(EXACT, ranging_error=0.01))) / ranges(scanned(Groin(), EXACT))
    assert np.ptp(ratio) < 1e-9
    assert 0 < abs(ratio.mean() - 1) <= 0.01 / 25


def test_registration_moves_every_further_station_rigidly_and_leaves_the_first() -> None:
    two = changed(EXACT, stations=2)
    moved = scanned(Groin(), changed(two, registration_shift=0.01, registration_turn=0.002))
    still = scanned(Groin(), two)
    first, second = still.station == 0, still.station == 1
    assert np.array_equal(moved.xyz[first], still.xyz[first])
    assert 0.001 < np.abs(moved.stations[1] - still.stations[1]).max() < 0.05
    assert ranges(moved) == pytest.approx(ranges(still), abs=1e-9)
    arms = [(v.xyz - v.stations[1])[second] for v in (still, moved)]
    turn, *_ = np.linalg.lstsq(*arms, rcond=None)
    assert turn.T @ turn == pytest.approx(np.eye(3), abs=1e-9)
    assert np.abs(arms[0] @ turn - arms[1]).max() < 1e-9


def test_mixed_points_fly_between_near_and_far_and_show_no_component() -> None:
    settings = changed(FURNISHED, openings=0)
    clean, half, whole = (scanned(Groin(), changed(settings, mixed=share)) for share in (0, 0.5, 1))
    moved = [np.abs(ranges(v) - ranges(clean)) > 1e-9 for v in (half, whole)]
    assert moved[0].sum() == pytest.approx(moved[1].sum() / 2, rel=0.15)
    assert 0.002 < moved[1].mean() < 0.2
    shift = np.abs(ranges(whole) - ranges(clean))
    assert (whole.component[shift > FLYING] == 0).all()
    assert np.array_equal(whole.component[shift <= FLYING], clean.component[shift <= FLYING])
    assert shift.max() < np.ptp(ranges(clean))


def test_beams_are_lost_where_the_return_is_weak() -> None:
    rng = np.random.default_rng(1)
    assert beams.lost(np.full(20_000, 0.1), 0.1, rng).mean() == pytest.approx(np.exp(-1), abs=0.02)
    assert beams.lost(np.full(20_000, 0.6), 0.02, rng).mean() == 0
    assert not beams.lost(np.zeros(10), 0, rng).any()
    frontal, slanted, distant = beams.intensity(np.array([0.6, 0.1, 0.6]), np.array([2.0, 2, 30]), rng)
    assert frontal > slanted
    assert frontal > distant


def test_settlement_shows_in_the_scan_by_no_more_than_its_amplitude() -> None:
    virtual = scanned(Mirror(), changed(EXACT, settlement=0.04))
    shown = virtual.component > 0
    off = np.abs(Mirror().distance(in_vault_frame(virtual, virtual.xyz[shown])))
    assert off.mean() > 0.005
    assert off.max() < 0.04 + MESH


def test_holes_take_the_declared_share_of_the_vault_and_nothing_else() -> None:
    def odds(virtual: VirtualScan) -> float:
        return float((virtual.component > 0).sum() / (virtual.component == 0).sum())

    whole, holed = scanned(Groin(), EXACT), scanned(Groin(), changed(EXACT, holes=0.25))
    assert odds(holed) == pytest.approx(0.75 * odds(whole), rel=0.03)


def test_a_cropped_scan_keeps_the_vault_and_its_margin() -> None:
    settings = changed(FURNISHED, crop=True, crop_margin=0.3, origin=(512_345.25, 4_712_345.5, 88.75))
    virtual = scanned(Groin(), settings)
    local = in_vault_frame(virtual, virtual.xyz)
    assert local[:, 2].min() == pytest.approx(-0.3, abs=0.02)
    assert np.abs(local[:, :2]).max() < 2.5 + 0.3
    assert (virtual.component > 0).mean() > 0.5


def test_a_bay_on_piers_is_open_on_all_sides() -> None:
    virtual = scanned(Groin(), changed(EXACT, walls="piers"))
    local = in_vault_frame(virtual, virtual.xyz)
    shown = virtual.component > 0
    assert np.abs(local[shown, :2]).max() < 2.5 + 1e-5
    low = local[~shown & (local[:, 2] < -0.5)]
    assert all(((low * side)[:, axis] > 4).any() for axis in (0, 1) for side in (-1, 1))
    assert not (
        (np.abs(low[:, 0]) < 2) & (np.abs(low[:, 1]) > 2.4) & (np.abs(low[:, 1]) < 2.6) & (low[:, 2] > -2.9)
    ).any()


def test_occluders_hide_some_of_the_vault() -> None:
    bare, furnished = scanned(Barrel(), EXACT), scanned(Barrel(), FURNISHED)
    assert (furnished.component > 0).mean() < 0.97 * (bare.component > 0).mean()


@pytest.mark.parametrize("suffix", [".ply", ".laz", ".e57"])
def test_truth_lies_beside_the_scan_and_holds_all_in_the_order_of_the_file(suffix: str, tmp_path) -> None:
    settings = changed(FURNISHED, stations=2, origin=(512_345.25, 4_712_345.5, 88.75), holes=0.1)
    vault = Lunette(count=2, lunette_profile=Groin().profile_x)
    virtual = scanned(vault, settings)
    beside = write_scan(virtual, tmp_path / f"a.room{suffix}")
    assert beside == tmp_path / "a.room.truth.npz"
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([f"a.room{suffix}", "a.room.truth.npz"])
    cloud = segmentation.read(tmp_path / f"a.room{suffix}")
    component, told = read_truth(tmp_path / f"a.room{suffix}")
    assert np.abs((cloud.xyz + cloud.origin) - (virtual.xyz + virtual.origin)).max() < 2e-4
    assert np.array_equal(component, virtual.component)
    assert cloud.intensity is not None
    assert np.corrcoef(cloud.intensity, virtual.intensity)[0, 1] > 0.999
    assert vault_of(told) == vault
    assert told == json.loads(json.dumps(virtual.truth))
    assert told["components"] == list(vault.components)
    assert told["derived"] == vault.derived_values()
    assert told["points"] == len(cloud)
    of_json = {name: tuple(v) if isinstance(v, list) else v for name, v in told["settings"].items()}
    assert ScannerSettings(**of_json) == settings
    local = in_vault_frame(virtual, cloud.xyz + cloud.origin - virtual.origin)[component > 0]
    assert np.abs(vault.distance(local)).max() < MESH + 2e-4


def test_the_same_seed_gives_the_same_bytes_and_another_does_not(tmp_path) -> None:
    vault, settings = draw("mirror", np.random.default_rng(8))
    settings = changed(settings, points=10_000)
    files = []
    for k, seed in enumerate((1, 1, 2)):
        folder = tmp_path / str(k)
        folder.mkdir()
        truth = write_scan(scan(vault, settings, rng=np.random.default_rng(seed)), folder / "room.laz")
        files.append(((folder / "room.laz").read_bytes(), truth.read_bytes()))
    assert files[0] == files[1]
    assert files[0][0] != files[2][0]
    assert files[0][1] != files[2][1]


def test_a_missing_open3d_is_named_with_the_way_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "open3d", None)
    with pytest.raises(MissingLibraryError, match=r'needs open3d: pip install "vaultcad\[scanner\]"'):
        scan(Sail(), EXACT, rng=np.random.default_rng(0))


def test_splitting_keeps_area_and_leaves_no_crack() -> None:
    whole = box([0, 0, 0], [1, 0.3, 2.5], 0.5)
    fine = split(whole, 0.11)

    def areas(mesh):
        a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2

    sides = np.concatenate([fine.triangles[:, [0, 1]], fine.triangles[:, [1, 2]], fine.triangles[:, [2, 0]]])
    _, uses = np.unique(np.sort(sides, 1), axis=0, return_counts=True)
    assert (uses == 2).all()
    assert np.linalg.norm(np.diff(fine.vertices[sides], axis=1), axis=-1).max() <= 0.11
    assert areas(fine).sum() == pytest.approx(areas(whole).sum())


def test_a_later_visit_scans_the_same_room_from_elsewhere():
    room = changed(EXACT, openings=2, settlement=0.02, relief=0.002)
    first, again = scanned(Groin(), room), scanned(Groin(), changed(room, visit=1))
    assert not np.allclose(first.stations, again.stations, atol=0.05)
    still = scan(Groin(), changed(room, visit=1), rng=np.random.default_rng(3))
    assert np.array_equal(still.xyz, again.xyz)

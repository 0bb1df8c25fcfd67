"""Whole buildings of the virtual scanner: what stands where, what its truth says, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache
from math import atan2, pi
from pathlib import Path

import numpy as np
import pytest

from families import Barrel, Conch, Groin, Sail, Segmental, Semicircular
from vaultcad.errors import VaultcadError
from vaultcad.scanner import ScannerSettings, vault_of
from vaultcad.scanner.building import (
    Arch,
    Bay,
    Building,
    BuildingScan,
    Door,
    Pier,
    Place,
    Style,
    draw_building,
    read_building,
    scan_building,
    write_building,
)
from vaultcad.scanner.building.build import build
from vaultcad.scanner.building.draw import KINDS
from vaultcad.scanner.building.labels import Kind
from vaultcad.scanner.building.rows import beside, in_row

EXACT = ScannerSettings(
    points=30_000,
    stations=3,
    noise=0,
    ranging_error=0,
    angle_noise=0,
    mixed=0,
    registration_shift=0,
    registration_turn=0,
    relief=0,
    settlement=0,
)
MESH = 0.0015  # m, by which chords of arches and vaults stay off them
CHURCH = Path(__file__).parents[3] / "examples" / "church.toml"
GROIN = Groin(4, 3.5, Semicircular(), Segmental(0.4))


def nave(gap: float = 0.5, count: int = 2, **more: float) -> tuple[Bay, ...]:
    places = in_row([GROIN] * count, Place(1, 2, 3, 0.2), gap)
    return tuple(Bay(GROIN, place, **more) for place in places)


@cache
def scanned() -> BuildingScan:
    """Two bays and an apse, turned and far away."""
    bays = nave()
    conch = Conch(1.6)
    apse = beside(GROIN, bays[-1].place, "north", conch, 0.4, enter="1")
    building = Building("two bays", (*bays, Bay(conch, apse)), yaw=0.7, origin=(1e5, 2e5, 30), settings=EXACT)
    return scan_building(building, rng=np.random.default_rng(5))


def local(scan: BuildingScan, place: tuple[float, float, float], yaw_deg: float) -> np.ndarray:
    """All points in the frame of an element of the truth."""
    return Place(*place, np.radians(yaw_deg)).into(scan.xyz + scan.origin)


def test_points_of_vaults_lie_on_the_vaults_of_the_truth_and_in_their_components():
    scan = scanned()
    assert [v["family"] for v in scan.case["vaults"]] == ["groin", "groin", "conch"]
    for number, told in enumerate(scan.case["vaults"], 1):
        own = scan.vault == number
        xyz = local(scan, (*told["centre"], told["springing"]), told["yaw_deg"])[own]
        vault = vault_of(told)
        found = vault.evaluate(xyz)
        assert len(xyz) > 1000
        assert np.abs(found.distance).max() < MESH
        assert (found.component == scan.component[own]).mean() > 0.99
        assert vault.plan.distance(xyz[:, :2]).max() < MESH
        assert (scan.kind[own] == Kind.VAULT).all()
        corners = Place(*told["centre"], 0, np.radians(told["yaw_deg"])).out(vault.plan.outline())
        assert np.allclose(told["plan"], corners)


def test_points_of_arches_lie_on_the_arches_of_the_truth():
    scan = scanned()
    assert len(scan.case["arches"]) == 2
    for number, told in enumerate(scan.case["arches"], 1):
        x, y, z = local(scan, tuple(told["place"]), told["yaw_deg"])[scan.arch == number].T
        assert len(x) > 100
        assert (scan.kind[scan.arch == number] == Kind.ARCH).all()
        assert np.abs(y).max() < told["width"] / 2 + 2 * MESH
        assert z.min() > -MESH
        assert z.max() < told["rise"] + told["thickness"] + 0.05
        # Under a semicircular or segmental edge the intrados is an ellipse or near it: no point is within it.
        soffit = np.abs(y) < told["width"] / 2 - 0.01
        crown = soffit & (np.abs(x) < 0.05)
        assert z[crown].max() == pytest.approx(told["rise"], abs=0.005)
        assert [x[soffit].min(), x[soffit].max()] == pytest.approx([-told["span"] / 2, told["span"] / 2], abs=0.05)
        assert np.abs(np.median(x[soffit])) < 0.2 * told["span"]


def test_floors_are_level_and_nothing_else_is_said_of_what_shows_no_vault():
    scan = scanned()
    assert np.abs(scan.xyz[scan.kind == Kind.FLOOR, 2]).max() < MESH
    assert ((scan.vault > 0) == (scan.component > 0)).all()
    assert ((scan.kind == Kind.VAULT) == (scan.vault > 0)).all()
    assert ((scan.kind == Kind.ARCH) == (scan.arch > 0)).all()
    assert set(np.unique(scan.kind)) == {Kind.VAULT, Kind.WALL, Kind.PIER, Kind.FLOOR, Kind.ARCH}


def test_noise_and_settlement_move_points_by_as_much_as_was_asked_for():
    settings = replace(EXACT, noise=0.002, settlement=0.02, mixed=0.3, registration_shift=0.002)
    scan = scan_building(Building("settled", nave(), settings=settings), rng=np.random.default_rng(1))
    for number, told in enumerate(scan.case["vaults"], 1):
        xyz = local(scan, (*told["centre"], told["springing"]), told["yaw_deg"])[scan.vault == number]
        off = np.abs(vault_of(told).distance(xyz))
        assert 0.001 < np.median(off) < 0.02
        assert off.max() < 0.06
    assert (scan.kind == Kind.CLUTTER).any()


def test_the_same_seed_gives_the_same_bytes(tmp_path):
    building = Building("nave", nave(), rods=True, pews=3, settings=ScannerSettings(points=5_000))
    paths = [tmp_path / "a.laz", tmp_path / "b.laz"]
    for path in paths:
        write_building(scan_building(building, rng=np.random.default_rng(2)), path)
    assert paths[0].read_bytes() == paths[1].read_bytes()
    first, second = (dict(np.load(path.with_suffix(".truth.npz"))) for path in paths)
    assert first.keys() == {"vault", "component", "arch", "kind", "station", "case"}
    assert all(np.array_equal(first[key], second[key]) for key in first)
    assert json.loads(str(first["case"]))["name"] == "nave"


def test_bays_that_touch_are_open_to_each_other_without_an_arch():
    scan = scan_building(Building("touching", nave(0.0), settings=EXACT), rng=np.random.default_rng(1))
    assert scan.case["arches"] == []
    told = scan.case["vaults"][0]
    x, y, _ = local(scan, (*told["centre"], told["springing"]), told["yaw_deg"]).T
    between = (np.abs(y - GROIN.plan.half_y) < 0.05) & (np.abs(x) < GROIN.plan.half_x - 0.05)
    assert set(scan.kind[between]) == {Kind.VAULT, Kind.FLOOR}
    assert (scan.vault == 2).sum() > 1000


def test_a_closed_side_is_a_wall():
    first, second = nave()
    built = build(Building("closed", (replace(first, closed=("north",)), second)))
    assert built.arches == ()


@pytest.mark.parametrize("kind", ["jambs", "square", "round"])
def test_a_pier_stands_where_four_arches_meet(kind):
    sail = Sail(3, 3, 0.6)
    places = [p for x in (0, 3.4) for p in in_row([sail] * 2, Place(x, 0, 2), 0.4)]
    bays = tuple(Bay(sail, place, style=Style(0.15, kind), windows=False) for place in places)
    built = build(Building("grid", bays))
    assert len(built.arches) == 4
    standing = {False: [(1.7, 3.2)], True: []}[kind == "jambs"]
    assert [(round(p.place.x, 6), round(p.place.y, 6)) for p in built.piers] == standing
    assert all(p.top == pytest.approx(2) for p in built.piers)


def test_arches_of_two_storeys_do_not_share_a_pier():
    sail = Sail(3, 3, 0.6)
    bays = tuple(
        Bay(sail, replace(p, z=floor + 2), floor, Style(0.15, "round"), windows=False)
        for floor in (0.0, 4.2)
        for x in (0.0, 3.4)
        for p in in_row([sail] * 2, Place(x, 0), 0.4)
    )
    built = build(Building("storeys", bays))
    assert sorted(p.top for p in built.piers) == pytest.approx([2, 6.2])


def test_floor_and_ceiling_of_stairs_climb_together():
    flight = Barrel(2, 4, slope=0.5)
    built = build(Building("stairs", (Bay(flight, Place(0, 0, 2.2), windows=False),)))
    kind = built.labels.columns()[0][built.mesh.component]
    low = built.mesh.vertices[built.mesh.triangles[kind == Kind.FLOOR]].reshape(-1, 3)
    vault = built.mesh.vertices[built.mesh.triangles[kind == Kind.VAULT]].reshape(-1, 3)
    assert 0 < low[:, 2].min() < 0.18  # on the first step
    assert low[:, 2].max() == pytest.approx(2.0, abs=0.01)
    assert vault[:, 2].max() == pytest.approx(2.2 + 1 + 2, abs=MESH)
    assert len(np.unique(np.round(low[:, 2], 3))) == 12


def test_doors_and_declared_arches_and_piers_stand_where_they_are_put():
    barrel = Barrel(3, 4)
    bays = (Bay(barrel, Place(0, 0, 2.5), windows=False), Bay(barrel, Place(4, 0, 2.5), windows=False))
    arch = Arch.of(Semicircular(), 1.2, Place(2, 1, 1.5, pi / 2), 1.0, 0.2, 0.0)
    pier = Pier(Place(0, 1), 2.0, "round", 0.4)
    building = Building("put", bays, (arch,), (pier,), (Door(Place(2, -1, 0, pi / 2), 1.1, 0.9, 2.0),), settings=EXACT)
    scan = scan_building(building, rng=np.random.default_rng(1))
    between = (np.abs(scan.xyz[:, 0] - 2) < 0.4) & (scan.xyz[:, 2] > 0.1)
    door, archway = between & (scan.xyz[:, 1] < 0), between & (scan.xyz[:, 1] > 0)
    assert scan.xyz[door, 2].max() < 2.0 + MESH
    assert scan.xyz[archway, 2].max() == pytest.approx(1.5 + 0.6, abs=0.01)
    column = scan.xyz[(scan.kind == Kind.PIER) & (scan.xyz[:, 0] < 1) & (scan.xyz[:, 2] < 1.8)]
    assert np.hypot(column[:, 0], column[:, 1] - 1).max() == pytest.approx(0.2, abs=0.005)


def test_a_bay_stands_before_the_side_it_is_put_to():
    there = beside(GROIN, Place(0, 0), "east", Conch(1), 0.5, enter="1")
    assert (there.x, there.y) == pytest.approx((2 + 0.5 + 0.5, 0))
    assert atan2(*there.axes[1][::-1]) == pytest.approx(0)  # its apse to the east


@pytest.mark.parametrize("kind", KINDS)
def test_buildings_of_every_kind_can_be_drawn_and_raised(kind):
    building = draw_building(np.random.default_rng(0), kind)
    assert building.name == kind
    built = build(building)
    shown = built.labels.columns()[:, built.mesh.component]
    assert set(shown[1][shown[1] > 0]) == set(range(1, len(building.bays) + 1))
    a, b, c = (built.mesh.vertices[built.mesh.triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    upright = (shown[0] == Kind.WALL) | (shown[0] == Kind.PIER)
    slanted = (np.abs(normal[:, 2]) > 0.01 * area) & (np.abs(normal[:, 2]) < 0.99 * area) & (area > 2e-3)
    assert not (upright & slanted).any()


def test_the_church_of_the_examples_is_as_its_file_declares_it():
    church = read_building(CHURCH)
    assert [bay.name for bay in church.bays][:5] == ["nave 1", "nave 2", "nave 3", "nave 4", "aisle 1"]
    assert [bay.vault.id for bay in church.bays] == [*["groin"] * 8, "barrel", "conch", "mirror"]
    built = build(church)
    assert len(built.arches) == 3 + 3 + 4 + 2  # across nave and aisle, between them, at both ends of the choir
    assert len(built.piers) == 3


ROW = '[[row]]\nfamily = "groin"\nbays = 2\n'
BAD = {
    "x": "is no TOML file",
    "": "the file has no [[row]] and no [[vault]]",
    "[rom]\nx = 1": "the file has no 'rom'; it may have arch, building",
    "building = 3": "building = 3 is no table; write [building]",
    "[row]\nbays = 2": "row is no list of tables; write [[row]]",
    "[[row]]\nbays = 2": "row 1 has no family",
    '[[row]]\nfamily = "tent"': "row 1: no vault family is called 'tent'; there are sail",
    ROW + "spanx = 3": "row 1 has no 'spanx'; it may have",
    ROW + "span_x = 99": "row 1: span_x = 99 lies outside [0.5, 40] m",
    '[[row]]\nfamily = "groin"\nbays = 2.5': "row 1: bays = 2.5 is no whole number; give 1 to 100",
    ROW + "springing = true": "row 1: springing = True is no number; give 1 to 60",
    ROW + 'piers = "steel"': "row 1: piers = 'steel' is not one of jambs, square, round",
    ROW + 'closed = ["up"]': "row 1: closed has 'up', which is not one of south, east, north, west",
    ROW + "at = [1]": "row 1: at = [1] must be 2 numbers within ±10000",
    ROW + 'beside = "nave"': "row 1: beside = 'nave' is no vault; there are none before it",
    ROW + 'windows = "no"': "row 1: windows = 'no' is neither true nor false",
    ROW + '[[vault]]\nfamily = "rotunda"\nbeside = "row 1"': "vault 1: a dome over a round room has no straight side",
    ROW + "[scanner]\nnoise = 1": "scanner: noise = 1 lies outside [0, 0.05] m",
    ROW + "[scanner]\nlamp = true": "scanner has no 'lamp'; it may have angle_noise",
    ROW + "[[arch]]\nspan = 1": "arch 1 has no at; give it 2 coordinates",
    ROW + "[[arch]]\nat = [0, 0]\nspan = 1\nrise = 3": "arch 1: rise = 3 over a span of 1 m is no semicircular arch",
}


@pytest.mark.parametrize("text", BAD)
def test_a_file_that_cannot_be_is_refused_in_a_sentence(tmp_path, text):
    path = tmp_path / "church.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(VaultcadError) as refused:
        read_building(path)
    assert BAD[text] in str(refused.value)
    assert str(path) in str(refused.value)


def test_bays_in_each_other_and_arches_without_room_are_refused():
    first, second = nave(-0.3)
    with pytest.raises(VaultcadError, match=r"vault 1 and vault 2 stand in each other by 0.30 m"):
        build(Building("overlapping", (first, second)))
    with pytest.raises(VaultcadError, match="the arch between vault 1 and vault 2 has no room"):
        build(Building("thick", tuple(replace(bay, style=Style(1.0)) for bay in nave())))
    inside = Building("in the wall", nave(), settings=EXACT, stations=((1, 2, 1.6),))
    with pytest.raises(VaultcadError, match=r"the station at 1, 2, 1\.6 is 0\.00 m from the next wall"):
        scan_building(inside, rng=np.random.default_rng(1))

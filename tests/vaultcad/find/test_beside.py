"""A vault beside another one that no valley, arch or wall parts from it, as an apse behind its choir."""

import numpy as np

from families import Barrel, Conch, Lunette, Segmental, Trough
from segmentation.cloud import Cloud
from vaultcad.find.search import _is_soffit, under_one_ceiling
from vaultcad.fit.freedom import NONE
from vaultcad.scanner import ScannerSettings
from vaultcad.scanner.building import Bay, Building, Place, scan_building
from vaultcad.scanner.building.rows import beside
from vaultcad.survey.thinned_scan import thin_scan

SETTINGS = ScannerSettings(points=60_000, stations=3, noise=0.002, settlement=0.01, mixed=0, registration_shift=0)


def test_an_apse_is_found_behind_its_choir() -> None:
    choir, apse, here = Barrel(9.0, 6.0), Conch(3.9), Place(0, 0, 5.0, 0.2)
    bays = Bay(choir, here), Bay(apse, beside(choir, here, "north", apse, 0.05, enter="1"))
    xyz = scan_building(Building("choir", bays, settings=SETTINGS), rng=np.random.default_rng(3)).xyz.astype(np.float32)
    found = under_one_ceiling(thin_scan(Cloud(xyz)), xyz, (Barrel, Conch), np.random.default_rng(0), NONE, part=True)
    assert [one.placed.vault.id for one in found] == ["barrel", "conch"]
    assert abs(found[0].placed.vault.values()["length"] - 6.0) < 0.05
    assert abs(found[1].placed.vault.values()["radius"] - 3.9) < 0.03


def test_a_nave_and_its_apse_of_one_radius_are_two() -> None:
    radius, length, rng = 2.5, 4.0, np.random.default_rng(2)
    turns = rng.uniform(0, np.pi, 40_000)
    along = rng.uniform(-length, 0, 40_000)
    nave = np.stack([radius * np.cos(turns), along, radius * np.sin(turns)], axis=1)
    sphere = rng.normal(size=(30_000, 3))
    apse = radius * np.abs(sphere) / np.linalg.norm(sphere, axis=1)[:, None]
    apse[::2, 0] *= -1
    down = rng.uniform(-2.4, 0, 15_000)
    sides = np.stack([rng.choice([-radius, radius], 15_000), along[:15_000], down], axis=1)
    round_it = np.stack([radius * np.cos(turns[:15_000]), radius * np.sin(turns[:15_000]), down], axis=1)
    end = np.stack([rng.uniform(-radius, radius, 15_000), np.full(15_000, -length), down], axis=1)
    scan = np.concatenate([nave, apse, sides, round_it, end])
    scan = (scan + rng.normal(0, 0.002, scan.shape)).astype(np.float32)
    found = under_one_ceiling(thin_scan(Cloud(scan)), scan, (Barrel, Conch, Trough), np.random.default_rng(0), NONE)
    assert [one.placed.vault.id for one in found] == ["barrel", "conch"]
    assert abs(found[0].placed.vault.values()["length"] - length) < 0.4
    assert abs(found[1].placed.vault.values()["radius"] - radius) < 0.03
    assert all(len(one.site.guessed) == 1 for one in found)


def test_a_ramp_is_found_between_the_level_barrels_over_its_landings() -> None:
    span, slope, rng = 1.8, 0.55, np.random.default_rng(1)
    flight, landing = Barrel(span, 4.0, slope=slope), Barrel(span, 1.6)
    rooms = (flight, -2.0, 0.0), (landing, -3.6, 0.0), (landing, 2.0, 4.0 * slope)
    xyz = []
    for vault, start, base in rooms:
        count = int(vault.length / 0.004)
        along, around = rng.uniform(0, vault.length, 2 * count), rng.uniform(0, np.pi, 2 * count)
        xyz.append(np.stack([span / 2 * np.cos(around), start + along, base + span / 2 * np.sin(around)], axis=1))
        walls = np.stack(
            [rng.choice([-span / 2, span / 2], count), start + along[:count], base - rng.uniform(0, 1.6, count)]
        )
        xyz.append(walls.T)
        for sheet in xyz[-2:]:
            sheet[:, 2] += vault.slope * (sheet[:, 1] - start)
    ends = rng.choice([-3.6, 3.6], 3000)
    across, up = rng.uniform(-span / 2, span / 2, 3000), rng.uniform(-1.6, span / 2, 3000)
    up = np.minimum(up, np.sqrt(span**2 / 4 - across**2))
    xyz.append(np.stack([across, ends, up + 4.0 * slope * (ends > 0)], axis=1))
    scan = (np.concatenate(xyz) + rng.normal(0, 0.002, (sum(map(len, xyz)), 3))).astype(np.float32)
    found = under_one_ceiling(thin_scan(Cloud(scan)), scan, (Barrel,), np.random.default_rng(0), NONE)
    found = sorted(found, key=lambda one: one.placed.pose.y)
    slopes = [abs(one.placed.vault.values()["slope"]) for one in found]
    assert np.allclose(slopes, [0.0, slope, 0.0], atol=0.01)
    assert np.allclose([one.placed.vault.values()["length"] for one in found], [1.6, 4.0, 1.6], atol=0.25)


def test_lower_barrels_that_meet_a_wide_one_are_found_as_its_arms() -> None:
    main = Lunette(
        4.2,
        7.0,
        Segmental(0.4),
        1,
        pitch_ratio=0.6,
        width_ratio=0.5,
        springing_ratio=0.2,
        lunette_profile=Segmental(0.4),
    )
    rng, half, arm = np.random.default_rng(1), main.lunette_span / 2, 2.6
    curve = Segmental(0.4).curve(half)
    xyz = [main.sample(14_000, rng).xyz]
    for side in (-1.0, 1.0):
        y = rng.uniform(-half, half, 5_000)
        x = side * rng.uniform(2.1, 2.1 + arm, 5_000)
        xyz.append(np.stack([x, y, main.lunette_springing + np.array([curve.height(abs(k)) for k in y])], axis=1))
        walls = rng.choice([-half, half], 4_000), rng.uniform(-1.5, main.lunette_springing, 4_000)
        xyz.append(np.stack([side * rng.uniform(2.1, 2.1 + arm, 4_000), *walls], axis=1))
        y, z = rng.uniform(-3.5, 3.5, 6_000), rng.uniform(-1.5, 0.0, 6_000)
        xyz.append(np.stack([np.full(6_000, side * 2.1), y, z], axis=1)[np.abs(y) > half])
        x, z = rng.uniform(-2.1, 2.1, 3_000), rng.uniform(-1.5, 0.5, 3_000)
        xyz.append(np.stack([x, np.full(3_000, side * 3.5), z], axis=1))
    scan = np.concatenate(xyz)
    scan = (scan + rng.normal(0, 0.002, scan.shape)).astype(np.float32)
    found = under_one_ceiling(thin_scan(Cloud(scan)), scan, (Barrel,), np.random.default_rng(0), NONE)
    assert found[0].misfit.pockets == 2  # its lunettes, as no such family was tried
    assert np.allclose([one.placed.vault.values()["span"] for one in found], [4.2, 2 * half, 2 * half], atol=0.1)
    assert [round(one.placed.pose.x / (2.1 + arm / 2)) for one in found] == [0, -1, 1]


def test_a_barrel_that_sank_in_its_middle_is_one_and_doubted_not_two() -> None:
    rng, vault = np.random.default_rng(4), Barrel(5.2, 8.0, Segmental(0.31))
    xyz = vault.sample(40_000, rng).xyz
    xyz[:, 2] -= 0.25 * np.exp(-((xyz[:, 1] / 2) ** 2) - xyz[:, 0] ** 2)
    walls = rng.uniform(-1, 1, (24_000, 3)) * [2.6, 4.0, 1.4] - [0, 0, 1.4]
    walls[::2, 0], walls[1::2, 1] = 2.6 * np.sign(walls[::2, 0]), 4.0 * np.sign(walls[1::2, 1])
    scan = np.concatenate([xyz, walls])
    scan = (scan + rng.normal(0, 0.003, scan.shape)).astype(np.float32)
    (found,) = under_one_ceiling(thin_scan(Cloud(scan)), scan, (Barrel,), np.random.default_rng(0), NONE)
    assert abs(found.placed.vault.values()["length"] - 8.0) < 0.1
    assert found.confidence[0] < 0.8
    assert "more than settlement explains" in found.doubt


def test_the_head_of_a_window_is_no_vault() -> None:
    assert _is_soffit(Barrel(3.0, 0.9))
    assert not _is_soffit(Barrel(9.0, 4.0))  # a bay of a nave
    assert not _is_soffit(Barrel(1.2, 6.0))  # a corridor

"""A vault beside another one that no valley, arch or wall parts from it, as an apse behind its choir."""

import numpy as np

from families import Barrel, Conch, Trough
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
    found = under_one_ceiling(thin_scan(Cloud(scan)), scan, (Barrel, Trough), np.random.default_rng(0), NONE)
    found = sorted(found, key=lambda one: one.placed.pose.z)
    slopes = [abs(one.placed.vault.values()["slope"]) for one in found]
    assert np.allclose(slopes, [0.0, slope, 0.0], atol=0.01)
    assert np.allclose([one.placed.vault.values()["length"] for one in found], [1.6, 4.0, 1.6], atol=0.25)


def test_the_head_of_a_window_is_no_vault() -> None:
    assert _is_soffit(Barrel(3.0, 0.9))
    assert not _is_soffit(Barrel(9.0, 4.0))  # a bay of a nave
    assert not _is_soffit(Barrel(1.2, 6.0))  # a corridor

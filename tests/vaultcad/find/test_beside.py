"""A vault beside another one that no valley, arch or wall parts from it, as an apse behind its choir."""

import numpy as np

from families import Barrel, Conch
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


def test_the_head_of_a_window_is_no_vault() -> None:
    assert _is_soffit(Barrel(3.0, 0.9))
    assert not _is_soffit(Barrel(9.0, 4.0))  # a bay of a nave
    assert not _is_soffit(Barrel(1.2, 6.0))  # a corridor

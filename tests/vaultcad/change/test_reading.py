import json
from dataclasses import asdict

import numpy as np
import pytest

from families import Pointed, Rib
from segmentation.cloud import Cloud
from vaultcad.change.reading import CAUTION, HINTS
from vaultcad.deformation import deformation_of
from vaultcad.export.movements import plain_deformation
from vaultcad.export.report_deformation import deformation_section
from vaultcad.model_file import fitted_vault, plain_vault
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.scanner import ScannerSettings, scan


@pytest.fixture
def read(settled):
    deformation = settled.vaults[0].deformation
    assert deformation is not None
    return deformation


def test_a_settlement_is_read_back_within_its_limits_and_3_mm(read):
    built = read.of("built")
    for name, true in (("crown settlement", 0.030), ("spread along x", 0.020)):
        found = built.movement(name)
        assert found.certain, name
        assert abs(found.value - true) < min(found.limit, 0.003), (name, found)
    assert built.movement("crown settlement").direction == "down"
    assert built.movement("spread along x").direction == "apart"
    assert not built.movement("spread along y").certain
    assert not built.movement("twist").certain


def test_the_walls_that_carry_lean_outwards(read, settled):
    rotated = [m for m in read.of("built").movements if m.name.startswith("rotation") and m.certain]
    assert len(rotated) == 2
    bearings = sorted(m.azimuth for m in rotated)
    assert bearings[1] - bearings[0] == pytest.approx(180, abs=1)
    for one in rotated:
        assert one.direction.startswith("outwards")
        assert 0.01 / 1.5 - one.limit < one.value < 0.01 / 1.5 + one.limit


def test_it_resembles_spreading_abutments_and_says_what_it_cannot_tell(read):
    assert read.resembles[0].mechanism == "spreading of the abutments"
    assert sum(one.odds for one in read.resembles) == pytest.approx(1)
    assert "cannot tell" in read.verdict
    assert read.caution


def test_the_fit_has_taken_part_of_the_settlement(read):
    for against in read.against:
        assert all(np.isfinite([m.value, m.limit]).all() and m.limit > 0 for m in against.movements)
    assert [one.id for one in read.against][:2] == ["built", "fitted"]


def test_a_vault_that_has_not_moved_shows_nothing_certain_that_is_large(visits):
    built = visits.model.vaults[0].deformation.of("built")
    spreads = [m for m in built.movements if m.name.startswith(("spread", "twist", "differential", "crown"))]
    assert all(not m.certain or m.value < 0.004 for m in spreads), spreads


def test_a_reading_survives_files(read, settled):
    vault = settled.vaults[0]
    assert deformation_of(json.loads(json.dumps(asdict(read)))) == read
    assert fitted_vault(json.loads(json.dumps(plain_vault(vault)))).deformation == read
    told = plain_deformation(read)
    crown = told["references"][0]["movements"][0]
    assert crown["unit"] == "mm"
    assert crown["value"] == pytest.approx(1000 * read.of("built").movements[0].value, abs=0.01)
    page = deformation_section(vault)
    assert page.count("<details") == len(read.against)
    assert "spreading of the abutments" in page


def test_what_was_held_wrongly_makes_limits_wide_and_is_said():
    """A rib vault whose ridges are bent, fitted with straight ones: stone lies off whatever moves."""
    vault = Rib(6.6, 5.5, Pointed(0.57), Pointed(0.68), ridge_bow=0.5)
    settings = ScannerSettings(points=25_000, settlement=0.0, crown_fall=0.03, openings=0, furniture=0)
    cloud = Cloud(scan(vault, settings, rng=np.random.default_rng(1)).xyz.astype(np.float32))
    fix = {**vault.kinds, "springing": settings.wall_height, "ridge_bow": 0.0}
    found = fit_scan(cloud, FitSettings(families=(Rib,), fix=fix)).model.vaults[0].deformation
    crown = found.of("built").movement("crown settlement")
    assert abs(crown.value - 0.03) < crown.limit
    assert any("of another kind" in line for line in found.caution)
    assert found.verdict == HINTS  # of any vault of such webs
    assert not found.resembles


def test_what_fits_is_not_doubted(read):
    assert read.caution == CAUTION

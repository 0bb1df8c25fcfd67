"""What there is to choose from, what is installed, and the primitives of a scan."""

import laspy
import numpy as np
import pytest

from families import FAMILIES, PROFILES
from segmentation import read
from segmentation.io.labels import read_labels
from vaultcad import doctor
from vaultcad.cli.options import span, with_unit
from vaultcad.doctor import Finding


def test_families_lists_families_and_profiles(run):
    told = run("families").out
    for cls in (*FAMILIES, *PROFILES):
        assert f" {cls.id} " in told


@pytest.mark.parametrize("cls", FAMILIES, ids=lambda c: c.id)
def test_a_family_is_told_with_names_components_parameters_and_ranges(run, cls):
    told = run("families", next(iter(cls.aliases["it"]))).out
    vault = cls()
    for name in (*vault.components, *(alias for names in cls.aliases.values() for alias in names)):
        assert name in told
    values = vault.values()
    for p in vault.parameters():
        row = next(line.split("  ") for line in told.splitlines() if line.split()[:1] == [p.name])
        assert {with_unit(values[p.name], p.range.unit), span(p.range)} <= {cell.strip() for cell in row}


def test_an_unknown_family_is_refused(run):
    assert "'igloo'; there are sail" in run("families", "igloo").complaint


@pytest.mark.parametrize(("optional", "code"), [(True, 0), (False, 1)])
def test_the_doctor_names_the_remedy_and_fails_only_for_what_is_needed(run, monkeypatch, optional, code):
    findings = [
        Finding("numpy", "2.4", "ok", "arrays", ""),
        Finding("open3d", "0.20", "broken", "libusb is missing", "apt-get install libusb-1.0-0", optional),
    ]
    monkeypatch.setattr(doctor, "examine", lambda: findings)
    told = run("doctor")
    assert (told.code, told.err) == (code, "")
    assert "open3d: apt-get install libusb-1.0-0" in told.out


def test_segment_writes_every_point_with_the_shape_that_it_lies_on(run, cube, tmp_path, assumed):
    told = run("segment", cube, "-o", tmp_path / "out.laz", "--primitives", "plane")
    assert (told.code, told.err) == (0, assumed)
    labels = read_labels(tmp_path / "out.laz")
    xyz = read(cube).xyz
    assert labels.dtype == np.uint16
    assert np.bincount(labels)[1:] == pytest.approx([5_000] * 6, rel=0.05)
    assert np.allclose(laspy.read(tmp_path / "out.laz").xyz, xyz, atol=1e-4)
    assert told.out.count(" plane ") == 6


def test_segment_can_write_what_it_reads(run, cube, tmp_path):
    out = tmp_path / "out.ply"
    assert run("segment", cube, "-o", out, "--preset", "mirror-ideal", "--epsilon", 0.02, "--up", "y").code == 0
    assert np.allclose(read(out).xyz, read(cube).xyz, atol=1e-4)
    assert read_labels(out).max() >= 4

from dataclasses import replace

import laspy
import numpy as np
import pytest

from families import Barrel, Semicircular
from vaultcad.scanner import ScannerSettings, scan, write_scan

ROOM = ScannerSettings(points=30_000, settlement=0.0, noise=0.002, openings=1, furniture=0, tie_rods=0)


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Files of two scans of one room; its crown sank in between."""
    folder = tmp_path_factory.mktemp("pair")
    vault = Barrel(span=4.4, length=5.0, profile=Semicircular())
    for name, settings in (("before", ROOM), ("after", replace(ROOM, visit=1, crown_fall=0.015))):
        write_scan(scan(vault, settings, rng=np.random.default_rng(5)), folder / f"{name}.laz")
    return folder / "before.laz", folder / "after.laz"


def test_a_crown_that_sank_is_told_in_words_and_files(run, pair, tmp_path):
    told = run("compare-scans", *pair, "-o", tmp_path / "out")
    assert told.code == 0, told.err
    assert "the crown went down by" in told.out
    assert told.out.rstrip().endswith("change.json, change.laz, change.png, change.svg")
    assert (tmp_path / "out" / "change.json").is_file()


def test_folders_of_fits_are_read_in_place_of_scans_and_texts_as_they_are_said_to_be(run, pair, tmp_path):
    assert run("fit", pair[0], "-o", tmp_path / "fit", "--family", "barrel").code == 0
    x, y, z = 1000 * np.asarray(laspy.read(pair[1]).xyz).T
    np.savetxt(tmp_path / "after.csv", np.column_stack([z, -y, x]), fmt="%.1f", delimiter=",")
    how = ("--registered", "--up", "y", "--unit", "mm", "--columns", "y,z,x")
    told = run("compare-scans", tmp_path / "fit", tmp_path / "after.csv", "-o", tmp_path / "text", *how)
    assert told.code == 0, told.err
    words = told.out.splitlines()[0]
    assert "the crown went down by" in words
    told = run("compare-scans", tmp_path / "fit", pair[1], "-o", tmp_path / "out", "--registered")
    assert told.code == 0, told.err
    assert told.out.splitlines()[0] == words
    refused = run("compare-scans", tmp_path / "fit", pair[1], "-o", tmp_path / "fit")
    assert "name another folder" in refused.complaint
    refused = run("compare-scans", tmp_path / "fit", tmp_path / "fit", "-o", tmp_path / "none", "--unit", "mm")
    assert "--unit: says how a scan is read" in refused.complaint


def test_what_is_missing_or_in_the_way_is_refused(run, pair, tmp_path):
    missing = run("compare-scans", tmp_path / "none.laz", pair[1], "-o", tmp_path / "out")
    assert "none.laz" in missing.complaint
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "own.txt").write_text("own")
    assert "holds other files" in run("compare-scans", *pair, "-o", tmp_path / "mine").complaint
    assert not (tmp_path / "out").exists()

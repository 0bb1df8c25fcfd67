import json
from dataclasses import replace

import laspy
import numpy as np
import pytest

from families.drawing.deviation_colours import UNKNOWN
from vaultcad.change.two_dates import compare_scans
from vaultcad.change.words import in_words
from vaultcad.errors import VaultcadError
from vaultcad.export.change_files import NAMES, write_change


def turned(xyz, yaw=0.015, shift=(0.04, -0.03, 0.02)):
    c, s = np.cos(yaw), np.sin(yaw)
    return xyz @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T + shift


@pytest.fixture(scope="module")
def sunk(visits):
    return compare_scans(visits.model, visits.first.xyz, turned(visits.sunk.xyz))


def test_two_scans_of_a_vault_that_stands_still_show_no_change(visits):
    change = compare_scans(visits.model, visits.first.xyz, turned(visits.again.xyz))
    assert not change.vaults[0].changed
    assert change.vaults[0].cells.detectable < 0.006
    assert in_words(change)[0].startswith("no change larger than")
    assert not any(m.certain and m.value > 0.004 for m in change.vaults[0].movements)


def test_a_crown_that_sank_by_a_centimetre_is_found(sunk):
    one = sunk.vaults[0]
    assert one.changed
    crown = next(m for m in one.movements if m.name == "crown settlement")
    assert crown.certain
    assert abs(crown.value - 0.01) < crown.limit < 0.004
    assert "the crown went down by" in in_words(sunk)[0]
    at = one.cells.place[np.argmax(np.abs(one.cells.change))]
    assert np.linalg.norm(at[:2]) < 1.2


def test_scans_in_one_system_are_compared_as_they_lie(visits):
    apart = compare_scans(visits.model, visits.first.xyz, visits.again.xyz + [0, 0, 0.02], registered=0.001)
    assert apart.given
    assert apart.vaults[0].changed
    wide = compare_scans(visits.model, visits.first.xyz, visits.again.xyz + [0, 0, 0.02], registered=0.02)
    assert not wide.vaults[0].changed


def test_a_scan_in_another_frame_is_found_by_where_its_vaults_stand(visits):
    yaw, shift = 2.0, np.array([300.0, -40.0, 7.0])
    pose = visits.model.vaults[0].pose
    there = turned(np.array([[pose.x, pose.y, pose.z]]), yaw, shift)[0]
    poses = [replace(pose, x=there[0], y=there[1], z=there[2], yaw=pose.yaw + yaw)]
    change = compare_scans(visits.model, visits.first.xyz, turned(visits.again.xyz, yaw, shift), poses=lambda: poses)
    assert not change.vaults[0].changed


def test_scans_of_different_places_are_refused(visits):
    with pytest.raises(VaultcadError, match="two scans of the same"):
        compare_scans(visits.model, visits.first.xyz, visits.again.xyz + [500, 0, 0])
    with pytest.raises(VaultcadError, match="no part of a vault"):
        compare_scans(visits.model, visits.first.xyz, visits.again.xyz + [500, 0, 0], registered=0.002)


def test_files_say_what_was_found(sunk, tmp_path):
    out = tmp_path / "change"
    write_change(sunk, out, after="second.laz")
    assert {path.name for path in out.iterdir()} >= {*NAMES}
    told = json.loads((out / "change.json").read_text(encoding="utf-8"))
    one = told["vaults"][0]
    assert one["changed"]
    assert one["largest"]["change_mm"] < -6
    assert told["says"] == in_words(sunk)
    cloud = laspy.read(out / "change.laz")
    change = np.array(cloud["change"])
    assert np.nanmin(change) == pytest.approx(np.nanmin(sunk.vaults[0].distances.change), abs=1e-6)
    known = np.isfinite(change)
    assert (np.array(cloud["significant"])[known] == (np.abs(change) > cloud["lod"])[known]).all()
    assert UNKNOWN.hex in (out / "change.svg").read_text(encoding="utf-8")
    again = tmp_path / "again"
    write_change(sunk, again, after="second.laz")
    assert all((out / name).read_bytes() == (again / name).read_bytes() for name in NAMES)
    write_change(sunk, out, after="third.laz")
    assert json.loads((out / "change.json").read_text(encoding="utf-8"))["after"] == "third.laz"

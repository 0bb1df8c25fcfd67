"""Scans as people have them, through the program: fitted right, or refused with the reason."""

import json
import resource
import subprocess
import sys
from pathlib import Path

import laspy
import numpy as np
import pytest

from families import family
from families.declaration.profiles import Segmental
from segmentation import read, write_cloud
from vaultcad.scanner import ScannerSettings, scan

BARREL = {"span": 4.6, "length": 5.4, "rise": 1.5}


@pytest.fixture(scope="module")
def barrel():
    """A virtual scan (n, 3) [m] of a small room under a barrel vault."""
    vault = family("barrel")(4.6, 5.4, Segmental(1.5 / 4.6))
    settings = ScannerSettings(points=25_000, tie_rods=0, furniture=0, settlement=0.0, noise=0.001, yaw=0.3)
    return np.asarray(scan(vault, settings, rng=np.random.default_rng(5)).xyz, float)


def fitted(run, path, out, *options):
    """The report of a fit of a barrel vault, what was said, and that its sizes are right."""
    told = run("fit", path, "-o", out, "--family", "barrel", *options)
    assert told.code == 0, told.err
    report = json.loads((out / "report.json").read_text())
    (vault,) = report["vaults"]
    for name, value in BARREL.items():
        assert vault["parameters"][name]["value"] == pytest.approx(value, abs=0.02), name
    said = [line.removeprefix("vaultcad: ") for line in told.err.splitlines()]
    assert said == [note["text"] for note in report["notes"]]
    return report, said


def test_northing_first(run, barrel, tmp_path):
    far = barrel + [500_000, 4_700_000, 100]
    np.savetxt(tmp_path / "a.csv", far[:, [1, 0, 2]], fmt="%.4f", delimiter=",", header="N,E,Z", comments="")
    report, said = fitted(run, tmp_path / "a.csv", tmp_path / "out")
    assert report["vaults"][0]["pose"]["origin"] == pytest.approx([500_000, 4_700_000, 103], abs=0.05)
    assert report["origin"] == [500_000, 4_700_000, 0]
    assert any("y x z, by the header 'N,E,Z'" in line for line in said)
    labelled = laspy.read(tmp_path / "out" / "segments.laz")
    np.testing.assert_allclose(labelled.xyz, far, atol=1e-3)


def test_centimetres_once_the_user_says_so(run, barrel, tmp_path):
    write_cloud(tmp_path / "a.ply", barrel * 100)
    assert "--unit cm for" in run("fit", tmp_path / "a.ply", "-o", tmp_path / "out").complaint
    assert not (tmp_path / "out").exists()
    fitted(run, tmp_path / "a.ply", tmp_path / "out", "--unit", "cm")
    labelled = laspy.read(tmp_path / "out" / "segments.laz")
    np.testing.assert_allclose(labelled.xyz, barrel * 100, atol=1e-3)


def test_las_1_0_is_fitted_and_written(run, barrel, tmp_path):
    path = tmp_path / "a.las"
    header = laspy.LasHeader(version="1.2", point_format=1)
    header.scales = [1e-4] * 3
    data = laspy.LasData(header)
    data.x, data.y, data.z = barrel.T
    data.write(path)
    old = bytearray(path.read_bytes())
    old[25] = 0  # the minor version
    path.write_bytes(old)
    fitted(run, path, tmp_path / "out")
    labelled = laspy.read(tmp_path / "out" / "segments.laz")
    assert str(labelled.header.version) == "1.2"
    assert len(labelled) == len(barrel)


def test_a_copy_marked_as_noise_does_no_harm(run, barrel, tmp_path):
    header = laspy.LasHeader(version="1.4", point_format=6)
    header.scales = [1e-4] * 3
    data = laspy.LasData(header)
    data.x, data.y, data.z = np.concatenate([barrel, barrel + [0.1, 0.1, 0.2]]).T
    data.classification = np.repeat([0, 7], len(barrel)).astype(np.uint8)
    data.write(tmp_path / "a.laz")
    _, said = fitted(run, tmp_path / "a.laz", tmp_path / "out")
    assert any(f"{len(barrel):,} noise (class 7)" in line for line in said)


def test_rooms_of_one_survey_stand_side_by_side(run, barrel, tmp_path):
    import trimesh

    centres = []
    for k, shift in enumerate([[499_998.0, 4_700_000, 100], [500_006.0, 4_700_002, 101]]):
        write_cloud(tmp_path / f"{k}.laz", barrel + shift)
        fitted(run, tmp_path / f"{k}.laz", tmp_path / f"out{k}")
        x, y, z = trimesh.load(tmp_path / f"out{k}" / "model.glb", force="scene").bounds.mean(axis=0)
        centres.append(np.array([x, -z, y]))
    assert centres[1] - centres[0] == pytest.approx([8, 2, 1], abs=0.01)


def test_an_origin_of_the_users(run, barrel, tmp_path):
    write_cloud(tmp_path / "a.laz", barrel + [500_000, 4_700_000, 100])
    report, _ = fitted(run, tmp_path / "a.laz", tmp_path / "out", "--origin", 499_900, 4_699_900, 100)
    assert report["origin"] == [499_900, 4_699_900, 100]
    assert (
        run("fit", tmp_path / "a.laz", "-o", tmp_path / "b", "--origin", 0, 0, 0).complaint.count("from --origin") == 1
    )
    assert (
        "no place on earth" in run("fit", tmp_path / "a.laz", "-o", tmp_path / "b", "--origin", "nan", 0, 0).complaint
    )


def test_where_no_vault_is_found_the_assumptions_are_named(run, cube, tmp_path):
    assert "metre, which is assumed" in run("fit", cube, "-o", tmp_path / "out", "--family", "barrel").complaint


def test_options_that_do_not_suit(run, cube, tmp_path):
    assert "--columns" in run("fit", cube, "-o", tmp_path / "out", "--columns", "x,y,z").complaint
    assert "furlong" in run("fit", cube, "-o", tmp_path / "out", "--unit", "furlong").complaint


@pytest.mark.parametrize("suffix", [".laz", ".ply"])
def test_segment_writes_what_it_set_aside(run, tmp_path, suffix):
    rng = np.random.default_rng(0)
    wall = np.column_stack([rng.uniform(0, 5, (9000, 2)), np.zeros(9000)])[:, [0, 2, 1]]
    write_cloud(tmp_path / "a.ply", np.concatenate([[[900.0, 0, 0]], wall]))
    told = run("segment", tmp_path / "a.ply", "-o", tmp_path / f"out{suffix}")
    assert told.code == 0, told.err
    assert "1 point far from all others" in told.err
    whole = read(tmp_path / f"out{suffix}").whole()
    assert len(whole) == 9001


LIMIT = 60_000  # bytes that a file may have in the next test
FULL = f"""
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, ({LIMIT}, {LIMIT}))
from vaultcad.cli import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.skipif(not hasattr(resource, "RLIMIT_FSIZE"), reason="needs limits on files")
@pytest.mark.parametrize(
    "command",
    [
        ["ideal", "groin", "--points", "40000", "-o", "{}/a.laz"],
        ["ideal", "groin", "--points", "40000", "-o", "{}/a.las"],
        ["ideal", "groin", "--points", "40000", "-o", "{}/a.e57"],
        ["ideal", "groin", "--points", "40000", "-o", "{}/a.ply"],
        ["ideal", "groin", "--points", "40000", "-o", "{}/a.xyz"],
        ["fit", "{scan}", "-o", "{}/out", "--family", "barrel"],
    ],
    ids=lambda c: Path(c[-1]).name,
)
def test_a_full_disk_is_one_line_that_names_the_file(run, barrel, tmp_path, command):
    (tmp_path / "results").mkdir()
    write_cloud(tmp_path / "scan.laz", barrel)
    if command[0] == "fit":  # so that nothing is left to be compiled, which is kept in files too
        fitted(run, tmp_path / "scan.laz", tmp_path / "before")
    arguments = [word.format(tmp_path / "results", scan=tmp_path / "scan.laz") for word in command]
    done = subprocess.run(
        [sys.executable, "-c", FULL, *arguments], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("\n") == 1
    assert "could not be written" in done.stderr
    assert "results/" in done.stderr
    assert list((tmp_path / "results").iterdir()) == []

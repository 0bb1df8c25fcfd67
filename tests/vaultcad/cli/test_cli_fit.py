"""From a scan to a folder with a model, through the program."""

import json
import shutil
import subprocess

import laspy
import numpy as np
import pytest

from families.drawing.deviation_colours import limit_of, shades
from segmentation import read
from vaultcad import pipeline
from vaultcad.cli import main
from vaultcad.cli.fit import STAGES
from vaultcad.drawings.bundle import CAD, PAGES
from vaultcad.export.bundle import REVIEW, WRITERS
from vaultcad.export.marker import MARKER
from vaultcad.labelled_scan import SEGMENTS
from vaultcad.scanner import read_truth

USUAL = {MARKER, SEGMENTS, *WRITERS}
FOLDERS = {"sections": "sections", "unrolled": "unroll"}  # and the commands that write the same
FILES = {*USUAL, REVIEW, CAD, PAGES, "deviation.ply", *FOLDERS}


@pytest.fixture(scope="module")
def fitted(room, without_extras, tmp_path_factory, assumed):
    """The folder of a fit that a process of its own made without any extra, and what it said."""
    out = tmp_path_factory.mktemp("fit") / "new" / "sail"
    arguments = ["fit", room, "-o", out, "--family", "volta a vela", "--seed", "1", "--thickness", "0.2", "--review"]
    arguments += ["--correlations", "--sections", "--unrolled", "--drawings", "--coloured", "ply"]
    done = subprocess.run(
        [*without_extras, *map(str, arguments)], capture_output=True, text=True, timeout=500, check=False
    )
    assert (done.returncode, done.stderr) == (0, assumed)
    return out, done.stdout


def test_the_bar_knows_the_stages_of_the_pipeline():
    assert STAGES[1:-1] == pipeline.STAGES


def test_without_extras_all_files_are_there_and_nothing_else(fitted):
    out, _ = fitted
    assert {path.name for path in out.iterdir()} == FILES
    assert [path.name for path in out.parent.iterdir()] == [out.name]
    assert all(path.stat().st_size > 0 for path in out.iterdir())


@pytest.mark.parametrize("name", FOLDERS)
def test_folders_of_a_fit_hold_what_the_commands_write(fitted, tmp_path, name):
    out, _ = fitted
    assert main([FOLDERS[name], str(out), "-o", str(tmp_path / name)]) == 0
    made = {path.name for path in (tmp_path / name).iterdir()} - {MARKER}
    assert {path.name for path in (out / name).iterdir()} == made
    told, again = (json.loads((folder / name / f"{name}.json").read_text()) for folder in (out, tmp_path))
    assert {*told} == {*again}
    assert {f"{name}/{file}" for file in made} <= {*json.loads((out / MARKER).read_text())["files"]}


def test_the_report_holds_the_vault_and_the_settings(fitted, room):
    out, _ = fitted
    report = json.loads((out / "report.json").read_text())
    _, case = read_truth(room)
    (vault,) = report["vaults"]
    assert vault["family"] == "sail"
    for name in ("span_x", "span_y"):
        assert vault["parameters"][name]["value"] == pytest.approx(case["parameters"][name], abs=0.05)
    assert report["scan"]["points"] == case["points"]
    assert report["settings"]["seed"] == 1
    assert report["thickness"] == 0.2
    assert vault["parameters"]["span_x"]["seen"] > 0.5
    assert vault["correlations"]["names"][:4] == ["x", "y", "z", "yaw"]
    assert len(vault["correlations"]["matrix"]) == len(vault["correlations"]["names"])


def test_every_point_of_the_scan_is_labelled_where_it_was(fitted, room):
    out, _ = fitted
    found, scan = laspy.read(out / SEGMENTS), laspy.read(room)
    assert np.array_equal(found.xyz, scan.xyz)
    assert np.array_equal(found.intensity, scan.intensity)
    assert [found[n].dtype.str[1:] for n in ("component", "vault", "deviation")] == ["u2", "u2", "f4"]
    component = np.asarray(found.component)
    assert np.array_equal(component > 0, np.isfinite(found.deviation))
    assert np.array_equal(component > 0, np.asarray(found.vault) == 1)
    truth, _ = read_truth(room)
    assert np.mean((component > 0) == (truth > 0)) > 0.97


def test_points_in_colours_are_the_vaults_own(fitted, room):
    out, _ = fitted
    labelled, coloured = laspy.read(out / SEGMENTS), read(out / "deviation.ply", unit="m")
    on = np.isfinite(labelled.deviation)
    assert len(coloured) == on.sum()
    np.testing.assert_allclose(coloured.xyz + coloured.origin, labelled.xyz[on], atol=1e-4)
    deviation = np.asarray(labelled.deviation)[on]
    expected = shades(deviation, limit_of(deviation))
    np.testing.assert_array_equal(coloured.color // 257, expected)


@pytest.mark.parametrize(
    ("arguments", "files"),
    [
        (["drawings"], {"drawings.dxf", "drawings.pdf", "vault-1.svg"}),
        (["nurbs", "--net", "0.5"], {"nurbs.json", "nurbs.obj", "nurbs.step"}),
    ],
    ids=lambda given: given[0] if isinstance(given, list) else "",
)
def test_a_result_goes_on_to_further_commands(fitted, tmp_path, arguments, files):
    out, _ = fitted
    command, *options = arguments
    assert main([command, str(out), "-o", str(tmp_path / "more"), *options]) == 0
    assert files <= {path.name for path in (tmp_path / "more").iterdir()}


def test_the_summary_says_what_was_found(fitted):
    out, told = fitted
    for part in ("sail vault", "confidence", "span_x", " ± ", "deviation", "coverage", str(out), "model.ifc"):
        assert part in told


def test_an_earlier_result_is_replaced_and_can_be_printed_as_json(run, fitted, room, tmp_path, assumed):
    out = tmp_path / "again"
    shutil.copytree(fitted[0], out)
    (out / "model.step").write_text("old")
    (out / "notes.txt").write_text("mine")
    told = run("fit", room, "-o", out, "--family", "sail", "--json")
    assert told.code == 2
    assert "model.step was changed since it was written and would be lost" in told.err
    told = run("fit", room, "-o", out, "--family", "sail", "--json", "--force")
    assert (told.code, told.err) == (0, assumed)
    assert told.out == (out / "report.json").read_text()
    assert (out / "model.step").read_text() != "old"
    assert {path.name for path in out.iterdir()} == USUAL | {"notes.txt"}


@pytest.mark.parametrize("name", ["model.step", "model.ifc", "model.glb", "model.wld"])
def test_a_model_that_is_exported_again_is_the_same(run, fitted, tmp_path, name, assumed):
    told = run("export", fitted[0] / "model.json", "-o", tmp_path / name)
    assert (told.code, told.out, told.err) == (0, "", assumed)
    assert (tmp_path / name).read_bytes() == (fitted[0] / name).read_bytes()


def test_a_report_that_is_exported_again_is_the_same(run, fitted, tmp_path):
    assert run("export", fitted[0] / "model.json", "-o", tmp_path / "report.json").code == 0
    again, told = (json.loads((folder / "report.json").read_text()) for folder in (tmp_path, fitted[0]))
    for vault in told["vaults"]:
        del vault["correlations"]
    assert again == told


def test_an_edited_model_is_exported_with_its_edits(run, fitted, tmp_path):
    told = json.loads((fitted[0] / "model.json").read_text())
    told["vaults"][0]["parameters"]["span_x"] = 3.5
    told["vaults"][0]["shell"] = {"value": 0.22, "unit": "m", "std": 0.01, "meaning": "as if its back had been seen"}
    (tmp_path / "model.json").write_text(json.dumps(told))
    done = run("export", tmp_path / "model.json", "-o", tmp_path / "report.json", "--thickness", "0.3")
    assert "edited after the fit" in done.err
    report = json.loads((tmp_path / "report.json").read_text())
    assert (report["thickness"], report["vaults"][0]["parameters"]["span_x"]["value"]) == (0.3, 3.5)
    assert (report["vaults"][0]["thickness"], report["vaults"][0]["thickness_std"]) == (0.3, None)
    told["vaults"][0]["parameters"]["span_x"] = 99
    (tmp_path / "model.json").write_text(json.dumps(told))
    done = run("export", tmp_path / "model.json", "-o", tmp_path / "model.ifc")
    assert (done.code, "span_x = 99 lies outside [" in done.err) == (2, True)
    assert not (tmp_path / "model.ifc").exists()


@pytest.mark.parametrize(
    ("model", "out", "said"),
    [
        ("nothing.json", "a.step", "no such file; give the model.json"),
        ("model.json", "a.dwg", "unknown suffix '.dwg'"),
        ("model.json", "model.json", "is the file that is read"),
        ("model.step", "a.ifc", "is no JSON"),
    ],
)
def test_what_cannot_be_exported_is_told(run, fitted, tmp_path, model, out, said):
    for name in ("model.json", "model.step"):
        shutil.copy(fitted[0] / name, tmp_path)
    told = run("export", tmp_path / model, "-o", tmp_path / out)
    assert told.code == 2
    assert said in told.err
    assert told.err.count("\n") == 1


def test_labels_are_judged_by_the_truth(run, fitted, room):
    told = run("compare", fitted[0] / SEGMENTS, room.with_suffix(".truth.npz"), "--format", "json")
    assert json.loads(told.out)["mean_iou"] > 0.9
    assert run("compare", fitted[0] / SEGMENTS, room.with_suffix(".truth.npz"), "--format", "csv").out.count("\n") == 2


def test_a_scan_and_its_truth_are_what_the_options_ask_for(run, tmp_path):
    out = tmp_path / "room.ply"
    told = run(
        "scan", "vela", "--span-x", 4, "--points", 2e4, "--yaw", 30, "--no-lamp", "--origin", 10, 20, 30, "-o", out
    )
    assert (told.code, told.err) == (0, "")
    labels, case = read_truth(out)
    assert case["parameters"]["span_x"] == 4
    assert case["pose"]["yaw_deg"] == pytest.approx(30)
    assert case["pose"]["origin"][:2] == [10, 20]
    assert case["settings"]["lamp"] is False
    assert len(read(out)) == len(labels) == pytest.approx(2e4, rel=0.1)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--noise", "1"], "--noise 1: lies outside what can be; give 0 to 0.05 m"),
        (["--yaw", "720"], "--yaw 720: lies outside what can be; give -180 to 180°"),
        (["--walls", "tents"], "walls = 'tents' is not one of 'walls', 'piers'"),
        (["--origin", "1", "2", "x"], "--origin x: is no number; give -1e+08 to 1e+08 m"),
        (["--station-height", "3", "--wall-height", "1.2", "--rise", "0.9"], "station_height = 3 m"),
    ],
)
def test_a_scan_that_cannot_be_is_refused(run, tmp_path, untouched, arguments, said):
    assert untouched()
    assert said in run("scan", "sail", *arguments, "-o", tmp_path / "a.laz").complaint
    assert untouched()


def test_a_building_is_scanned_as_its_file_declares_it(run, tmp_path):
    path, out = tmp_path / "two.toml", tmp_path / "two.laz"
    path.write_text('[scanner]\npoints = 5000\n[[row]]\nfamily = "groin"\n', encoding="utf-8")
    told = run("scan", "-o", out, "--building", path, "--seed", 3)
    assert (told.code, told.err) == (0, "")
    assert "vaults: 2, arches: 1" in told.out
    truth = np.load(out.with_suffix(".truth.npz"))
    assert len(read(out)) == len(truth["arch"]) == pytest.approx(5000, rel=0.15)
    assert set(np.unique(truth["vault"])) == {0, 1, 2}


def test_a_building_that_cannot_be_is_refused(run, tmp_path, untouched):
    path = tmp_path / "two.toml"
    path.write_text('[[row]]\nfamily = "groin"\nspan_x = 99\n', encoding="utf-8")
    assert untouched()
    told = run("scan", f"--building={path}", "-o", tmp_path / "a.laz").complaint
    assert f"{path}: row 1: span_x = 99 lies outside [0.5, 40] m" in told
    assert "none.toml: No such file" in run("scan", "--building", "none.toml", "-o", tmp_path / "a.laz").complaint
    assert "--building" in run("scan", "--help").out
    assert "--seed" in run("scan", "--building", path, "--help").out
    assert untouched()

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from segmentation.errors import WriteError
from vaultcad.errors import ExportError
from vaultcad.export import bundle
from vaultcad.export.bundle import write_all
from vaultcad.export.marker import MARKER

NAMES = {
    "report.json",
    "model.json",
    "report.html",
    "model.step",
    "model.ifc",
    "model.glb",
    "model.wld",
    "plan.dxf",
    "segments.laz",
}


def segments(path):
    path.write_bytes(b"LASF")


def fails(path):
    path.write_bytes(b"LA")
    raise OSError(28, "No space left on device")


def tree(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


@pytest.fixture
def model(make_model):
    return make_model("barrel")


def test_all_files_are_there_and_nothing_else(model, tmp_path):
    told = []
    write_all(model, tmp_path / "deep" / "out", segments=segments, progress=told.append)
    assert {p.name for p in (tmp_path / "deep" / "out").iterdir()} == NAMES | {MARKER}
    assert set(told) == NAMES
    assert [p.name for p in (tmp_path / "deep").iterdir()] == ["out"]


def test_files_are_the_same_beside_a_scan_of_many_points(model, tmp_path, monkeypatch):
    write_all(model, tmp_path / "few", segments=segments)
    monkeypatch.setattr(bundle, "MANY", 0)
    told = []
    write_all(model, tmp_path / "many", segments=segments, progress=told.append)
    assert tree(tmp_path / "many") == tree(tmp_path / "few")
    assert set(told) == NAMES


def test_nothing_is_left_when_a_body_cannot_be_written_beside_many_points(model, tmp_path, monkeypatch):
    monkeypatch.setattr(bundle, "MANY", 0)
    monkeypatch.setitem(bundle.WRITERS, "model.glb", lambda model, path: fails(path))
    with pytest.raises(WriteError, match=r"model\.glb: could not be written \(No space left"):
        write_all(model, tmp_path / "out", segments=segments)
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_left_when_a_writer_fails(model, tmp_path):
    with pytest.raises(OSError, match="No space"):
        write_all(model, tmp_path / "deep" / "out", segments=fails)
    assert list(tmp_path.iterdir()) == []


def test_an_earlier_result_stays_when_a_writer_fails(model, tmp_path):
    write_all(model, tmp_path / "out", segments=segments)
    before = tree(tmp_path)
    with pytest.raises(OSError, match="No space"):
        write_all(model, tmp_path / "out", segments=fails)
    assert tree(tmp_path) == before


def test_an_earlier_result_is_replaced_and_what_else_is_there_stays(model, make_model, tmp_path):
    write_all(model, tmp_path / "out", segments=segments)
    (tmp_path / "out" / "notes.txt").write_text("mine")
    write_all(make_model("barrel", points=7), tmp_path / "out", segments=segments)
    assert json.loads((tmp_path / "out" / "report.json").read_text())["scan"]["points"] == 7
    assert {p.name for p in (tmp_path / "out").iterdir()} == NAMES | {MARKER, "notes.txt"}
    assert [p.name for p in tmp_path.iterdir()] == ["out"]


def test_a_result_that_was_changed_during_the_fit_does_not_cost_the_fit(model, make_model, tmp_path):
    write_all(model, tmp_path / "out", segments=segments)
    (tmp_path / "out" / "model.ifc").write_text("with a wall more")
    written = write_all(make_model("barrel", points=7), tmp_path / "out", segments=segments)
    assert (written.kept / "model.ifc").read_text() == "with a wall more"
    assert json.loads(written.report)["scan"]["points"] == 7
    assert "wall more" not in (tmp_path / "out" / "model.ifc").read_text()


def test_an_empty_folder_is_filled(model, tmp_path):
    (tmp_path / "out").mkdir()
    write_all(model, tmp_path / "out", segments=segments)
    assert {p.name for p in (tmp_path / "out").iterdir()} == NAMES | {MARKER}


@pytest.mark.parametrize(
    ("name", "content"), [("thesis.doc", "mine"), ("report.json", "{}"), ("report.json", "[1"), ("report.json", "[]")]
)
def test_a_folder_with_other_things_is_refused(model, tmp_path, name, content):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).write_text(content)
    with pytest.raises(ExportError, match="out holds other files"):
        write_all(model, tmp_path / "out", segments=segments)
    assert [p.name for p in (tmp_path / "out").iterdir()] == [name]


def test_a_file_is_refused(model, tmp_path):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(ExportError, match="out is a file"):
        write_all(model, tmp_path / "out", segments=segments)
    assert (tmp_path / "out").read_text() == "mine"


def test_a_folder_that_cannot_be_made_is_named(model, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ExportError, match="cannot be made"):
        write_all(model, tmp_path / "file" / "out", segments=segments)


def test_writers_see_no_folder_under_its_final_name(model, tmp_path):
    seen = []
    write_all(model, tmp_path / "out", segments=lambda path: (seen.append((tmp_path / "out").exists()), segments(path)))
    assert seen == [False]


AGAIN = """
import sys
sys.path.insert(0, sys.argv[1])
from conftest import make
from pathlib import Path
from vaultcad.export.bundle import write_all
write_all(make("groin"), Path(sys.argv[2]), segments=lambda path: path.write_bytes(b"LASF"))
"""


def test_another_process_writes_the_same_bytes(make_model, tmp_path):
    """All but the times, and whatever the hash seed is."""
    write_all(make_model("groin"), tmp_path / "here", segments=segments)
    subprocess.run(
        [sys.executable, "-c", AGAIN, str(Path(__file__).parents[1]), str(tmp_path / "there")],
        env={**os.environ, "PYTHONHASHSEED": "4711"},
        check=True,
    )
    assert tree(tmp_path / "here") == tree(tmp_path / "there")


def test_the_table_of_writers_names_the_contracts_files():
    assert {*bundle.WRITERS, bundle.SEGMENTS} == NAMES

"""Each example runs by itself and leaves what its docstring promises."""

import csv
import json
import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from families import FAMILIES, ideal
from segmentation import compare, read
from segmentation.io.labels import read_labels
from vaultcad.scanner import read_truth

EXAMPLES = Path(__file__).parents[1] / "examples"
ROOM = EXAMPLES / "room.laz"


def _ideal_vault(out: Path) -> None:
    from build123d import import_step

    solid = import_step(out / "groin.step")
    box = solid.bounding_box()
    # In mm: 6 m of clear span, the crown 3 m above the springing, 0.2 m of masonry.
    assert 6000 < box.size.X < 6500
    assert abs(box.max.Z - 3200) < 1
    assert solid.volume / 1e9 == pytest.approx(0.2 * (np.pi - 2) * 36, rel=0.05)


def _all_families(out: Path) -> None:
    for family in FAMILIES:
        vault, cloud = family(), read(out / f"{family.id}.ply")
        component = read_labels(out / f"{family.id}.ply")
        assert np.abs(vault.distance(cloud.xyz)).max() < 1e-5
        assert set(np.unique(component)) == set(range(1, len(vault.components) + 1))
        assert cloud.normals is not None


def _thinned(out: Path) -> None:
    cloud = read(out / "thinned.ply")
    assert 10_000 < len(cloud) < len(read(ROOM))
    assert read_labels(out / "thinned.ply", "count").sum() == len(read(ROOM))
    assert cloud.normals is not None
    assert np.linalg.norm(cloud.normals, axis=1) == pytest.approx(1.0, abs=1e-3)


def _segments(out: Path) -> None:
    labels, truth = (read_labels(out / "segments.ply", name) for name in ("component", "truth"))
    judged = compare(labels, truth)
    assert judged.mean_iou > 0.95
    rows = list(csv.DictReader((out / "figures.csv").read_text(encoding="utf-8").splitlines()))
    assert [float(row["iou"]) for row in rows] == pytest.approx([match.iou for match in judged.matches])


def _virtual_scan(out: Path) -> None:
    component, case = read_truth(out / "room.laz")
    assert case["family"] == "trough"
    assert len(component) == len(read(out / "room.laz")) == pytest.approx(100_000, rel=0.1)
    assert set(np.unique(component)) == {0, 1, 2, 3}


def _scan_to_model(out: Path) -> None:
    from build123d import import_step

    truth, _ = read_truth(ROOM)
    assert compare(read_labels(out / "segments.laz"), truth).mean_iou > 0.9
    vault = import_step(out / "vault.step").bounding_box()
    cloud = read(ROOM)
    crown = cloud.xyz[truth > 0, 2].max()
    assert abs(vault.max.Z / 1000 - crown - 0.15) < 0.1


def _sections(out: Path) -> None:
    report = json.loads((out / "model" / "report.json").read_text(encoding="utf-8"))
    assert report["vaults"][0]["family"] == "groin"
    # Written whole by matplotlib: the chunk that ends a PNG is there, and the picture is more than empty axes.
    picture = (out / "sections.png").read_bytes()
    assert picture.endswith(b"IEND\xaeB`\x82")
    assert len(picture) > 100_000


def _paper_tables(out: Path) -> None:
    rows = list(csv.DictReader((out / "tables.csv").read_text(encoding="utf-8").splitlines()))
    assert {row["vault"] for row in rows} == {"sail", "barrel", "lunette", "trough", "mirror", "groin", "dome"}
    assert all(float(row["mean_iou"]) > 0.9 for row in rows if row["walls"] == "no")
    assert all(float(row["ours"]) == pytest.approx(float(row["paper"]), abs=0.08) for row in rows if row["paper"])


def _room_under_a_vault(out: Path) -> None:
    from build123d import import_step

    vault = ideal("mirror", span_x=6, span_y=4.5, run_x=1.2, run_y=1.2, cove_rise=1.2)
    room, intrados = import_step(out / "room.step"), import_step(out / "intrados.step")
    air = 6 * 4.5 * 2.8 + vault.void().volume / 1e9 + 1.2 * 0.6 * 2.2 + 1.4 * 0.6 * 1.5
    assert room.volume / 1e9 == pytest.approx(7.2 * 5.7 * (2.8 + 1.2 + 0.4) - air, rel=1e-5)
    assert {part.label for part in intrados.descendants} >= set(vault.components)


def _nave(out: Path) -> None:
    from build123d import import_step

    nave = import_step(out / "nave.step")
    assert nave.label == "nave"
    assert [part.label for part in nave.children] == ["pier"] * 8 + ["bay"] * 3
    piers, bays = nave.children[:8], nave.children[8:]
    assert all(part.volume == pytest.approx(0.7**2 * 5 * 1e9) for part in piers)
    assert [part.bounding_box().center().Y for part in bays] == pytest.approx([0, 5000, 10_000], abs=1)
    assert all(part.is_valid for part in bays)


def _arcade(out: Path) -> None:
    from build123d import import_step

    wall, *bays = import_step(out / "arcade.step").children
    arch = ideal("barrel", span=3.2, length=0.6, profile="pointed", rise=2.6).void().volume
    stone = 20_000 * 600 * 6200 - 5 * (arch + 3200 * 600 * 2400)
    assert wall.volume == pytest.approx(stone, rel=1e-6)
    assert [bay.label for bay in bays] == [f"bay_{k}" for k in range(1, 6)]  # as build123d reads names
    bay = ideal("groin", span_x=4, span_y=3.6).solid(0.12).volume
    assert [part.volume for part in bays] == pytest.approx([bay] * 5, rel=1e-4)


def _church(out: Path) -> None:
    with np.load(out / "church.truth.npz") as truth:
        case = json.loads(str(truth["case"]))
        assert len(truth["vault"]) == len(read(out / "church.laz")) == pytest.approx(60_000, rel=0.1)
        assert set(np.unique(truth["vault"])) == set(range(len(case["vaults"]) + 1))
        assert set(np.unique(truth["arch"])) == set(range(len(case["arches"]) + 1))
    assert [vault["family"] for vault in case["vaults"]] == [*["groin"] * 8, "barrel", "conch", "mirror"]


PROMISED: dict[str, tuple[list[str], Callable[[Path], None]]] = {
    "01_ideal_vault": ([], _ideal_vault),
    "02_all_families": ([], _all_families),
    "03_read_thin_normals": ([], _thinned),
    "04_segment_primitives": ([], _segments),
    "05_virtual_scan": ([], _virtual_scan),
    "06_scan_to_model": ([], _scan_to_model),
    "07_sections": ([], _sections),
    "08_paper_tables": (["--points", "60000"], _paper_tables),
    "09_room_under_a_vault": ([], _room_under_a_vault),
    "10_nave": (["--bays", "3"], _nave),
    "11_arcade": ([], _arcade),
    "12_church": (["--points", "60000"], _church),
}


def test_no_example_is_left_untested() -> None:
    assert {path.stem for path in EXAMPLES.glob("[0-9]*.py")} == set(PROMISED)


@pytest.mark.parametrize("name", PROMISED)
def test_example(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As a script, but in this process, which has its libraries already."""
    arguments, check = PROMISED[name]
    script, out = EXAMPLES / f"{name}.py", tmp_path / "new" / "folder"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(script), str(out), *arguments])
    runpy.run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out
    check(out)

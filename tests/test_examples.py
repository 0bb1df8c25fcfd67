"""Each example runs alone and leaves what its docstring promises."""

import csv
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from families import FAMILIES
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


def _seven_families(out: Path) -> None:
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
    assert {row["vault"] for row in rows} == {family.id for family in FAMILIES}
    assert all(float(row["mean_iou"]) > 0.9 for row in rows if row["walls"] == "no")
    assert all(float(row["ours"]) == pytest.approx(float(row["paper"]), abs=0.08) for row in rows if row["paper"])


PROMISED: dict[str, tuple[list[str], Callable[[Path], None]]] = {
    "01_ideal_vault": ([], _ideal_vault),
    "02_seven_families": ([], _seven_families),
    "03_read_thin_normals": ([], _thinned),
    "04_segment_primitives": ([], _segments),
    "05_virtual_scan": ([], _virtual_scan),
    "06_scan_to_model": ([], _scan_to_model),
    "07_sections": ([], _sections),
    "08_paper_tables": (["--points", "100000"], _paper_tables),
}


def test_no_example_is_left_untested() -> None:
    assert {path.stem for path in EXAMPLES.glob("[0-9]*.py")} == set(PROMISED)


@pytest.mark.parametrize("name", PROMISED)
def test_example(name: str, tmp_path: Path) -> None:
    arguments, check = PROMISED[name]
    out = tmp_path / "new" / "folder"
    command = [sys.executable, str(EXAMPLES / f"{name}.py"), str(out), *arguments]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    check(out)

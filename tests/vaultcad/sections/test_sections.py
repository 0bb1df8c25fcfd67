"""Sections of a fitted scan: lines near the stone, files that say the same, and refusals."""

import json
from dataclasses import replace

import ezdxf
import numpy as np
import pytest

from families import FAMILIES, Barrel, Groin
from segmentation.cloud import Cloud
from vaultcad.cli import main
from vaultcad.errors import VaultcadError
from vaultcad.export.section_files import WRITERS, drawn_names, write_drawings
from vaultcad.fit.label import Labels
from vaultcad.labelled_scan import LabelledScan, labelled_scan
from vaultcad.pose import Pose
from vaultcad.scanner.settle import draw_settlement
from vaultcad.sections.cuts import sections
from vaultcad.sections.free_profile import free_profile

NOISE, SETTLED = 0.003, 0.02


def scanned(make_model, vault, points=60_000, settled=SETTLED):
    """A fitted scan of a vault that has settled and is known as it was built, and its displacement."""
    rng = np.random.default_rng(11)
    sample = vault.sample(points, rng)
    field = draw_settlement(sample.xyz[:2000], vault.plan, 1.5, settled, rng)
    local = sample.xyz + field(sample.xyz) + rng.normal(0, NOISE, points)[:, None] * sample.normals
    pose = Pose(4.0, 3.0, 2.5, 0.4)
    placement = pose.placement()
    model = make_model(vault.id)
    model = replace(model, vaults=(replace(model.vaults[0], vault=vault, pose=pose, surface=field),))
    cloud = Cloud((local @ placement[:3, :3].T + placement[:3, 3]).astype(np.float32))
    labels = Labels(
        sample.component.astype(np.uint16),
        np.ones(points, np.uint16),
        vault.distance(local).astype(np.float32),
        np.zeros(points, np.uint16),
    )
    return labelled_scan(model, cloud, labels)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda cls: cls.id)
def test_section_lines_lie_on_the_stone_of_every_family(make_model, family):
    scan = scanned(make_model, family())
    found = sections(scan, grid=0.04)
    assert len({section.id for section in found}) == len(found)
    apart = []
    for section in found:
        assert section.ideal
        for run, line in ((run, line) for run in section.profile for line in section.as_built):
            off = np.linalg.norm(run.line[:, None] - line.line[None], axis=2).min(axis=1)
            if off.max() < 0.2:  # else the other side of a ring
                apart.append(off)
    assert np.median(np.concatenate(apart)) < 0.006  # of the displaced line's samples, a centimetre apart


def test_a_section_says_how_wide_high_and_round_its_arch_is(make_model):
    (section,) = sections(scanned(make_model, Barrel(4.0, 6.0), settled=0.01), planes=[(4.0, 3.0, 0.4)])
    (arch,) = section.arches
    assert arch.odds["semicircular"] > 0.3
    for name, true in (("span", 4.0), ("rise", 2.0), ("middle", 0.0)):
        assert arch.sizes[name].value == pytest.approx(true, abs=3 * (arch.sizes[name].std or 0) + 0.02)
    (arc,) = arch.arcs
    assert arc.radius.value == pytest.approx(2.0, abs=0.03)
    # In the scan's coordinates the line lies on the placed barrel.
    there = section.in_scan(arc.points())
    np.testing.assert_allclose(there[:, :2].mean(axis=0), (4.0, 3.0), atol=0.1)


def test_files_say_what_the_sections_are(make_model, tmp_path):
    scan = scanned(make_model, Groin(4.0, 4.0))
    found = sections(scan)
    for name, write in WRITERS.items():
        write(scan.model, found, tmp_path / name)
    write_drawings(found, tmp_path, pictures=False)
    told = json.loads((tmp_path / "sections.json").read_text())
    assert [one["id"] for one in told["sections"]] == [section.id for section in found]
    diagonal = next(one for one in told["sections"] if one["plane"]["kind"] == "diagonal")
    assert diagonal["arches"][0]["kind"] == "elliptical"
    assert len(diagonal["profile"][0]["line"]) == len(diagonal["profile"][0]["scan_line"])
    document = ezdxf.readfile(tmp_path / "sections.dxf")
    assert not document.audit().errors
    layers = {entity.dxf.layer for entity in document.modelspace()}
    assert {"DIAGONAL-SCAN", "WALL-ARCH-ARCS", "ACROSS-IDEAL", "ACROSS-AS-BUILT", "SPRINGING-TEXT"} <= layers
    assert all((tmp_path / name).stat().st_size > 1000 for name in drawn_names(found, ".svg"))
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    for name, write in WRITERS.items():
        write(scan.model, sections(scan), tmp_path / name)
    assert before == {path.name: path.read_bytes() for path in tmp_path.iterdir()}


def test_what_cannot_be_cut_is_refused(make_model, tmp_path, capsys):
    scan = scanned(make_model, Barrel(), points=5_000)
    with pytest.raises(VaultcadError, match="meet no vault"):
        sections(scan, planes=[(500.0, 500.0, 0.0)])
    with pytest.raises(VaultcadError, match="vault 2: there is none"):
        sections(scan, vault=2)
    with pytest.raises(ValueError, match="slab"):
        sections(scan, slab=0.0)
    empty = LabelledScan(
        scan.model, scan.xyz[:0], scan.vault[:0], scan.component[:0], scan.arch[:0], scan.deviation[:0]
    )
    assert all(section.points == 0 and not section.profile for section in sections(empty))
    for arguments in (["--plane", "1,2"], ["--plane", "1,2,nan"], []):
        assert main(["sections", str(tmp_path), "-o", str(tmp_path / "out"), *arguments]) == 2
        assert not (tmp_path / "out").exists()
    assert "model.json" in capsys.readouterr().err


def test_without_a_model_the_line_is_found_among_clutter():
    rng = np.random.default_rng(4)
    angle, off = rng.uniform(0, np.pi, 8000), rng.uniform(-0.03, 0.03, 8000)
    reach = 2.5 + 0.5 * off + rng.normal(0, NOISE, 8000)  # the plane cuts the surface at an angle
    points = np.column_stack([reach * np.cos(angle), reach * np.sin(angle)])
    points = np.concatenate([points, rng.uniform((-2, 0.2), (2, 1.5), (400, 2))])
    line = free_profile(points, np.concatenate([off, np.zeros(400)]), np.zeros(2), 0.02)
    assert np.median(np.abs(np.hypot(*line.T) - 2.5)) < 0.001
    assert (np.diff(line[:, 0]) > -0.01).all()
    with pytest.raises(ValueError, match="show no line"):
        free_profile(points[:3], off[:3], np.zeros(2), 0.02)

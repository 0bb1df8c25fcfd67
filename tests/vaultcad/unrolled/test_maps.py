"""Maps show what a scan has where it has it; what was drawn on a sheet comes back to where it was measured."""

import json
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from PIL import Image

from families import Barrel, Dome, Groin
from families.drawing.deviation_colours import shades
from families.unrolled.sheet import unrolled
from vaultcad.errors import ExportError, NoSuchVaultError
from vaultcad.labelled_scan import LabelledScan
from vaultcad.pose import Pose
from vaultcad.unrolled.back import lift_lines
from vaultcad.unrolled.contours import contours
from vaultcad.unrolled.drawn_lines import READERS, WRITERS, DrawnLine, read_lines, write_lifted
from vaultcad.unrolled.maps import UNROLLED, plain_sheet, write_maps
from vaultcad.unrolled.raster import WHAT, lay_scan, pixel_for, raster

POSE = Pose(14.0, -3.0, 2.5, 0.7)


def scanned(model, vault, count=60_000, hole=None):
    """A scan of a vault that bulges into the stone by 20 mm in its east, without the points that `hole` takes out."""
    sample = vault.sample(count, np.random.default_rng(5))
    keep = np.ones(len(sample), bool) if hole is None else ~hole(sample.xyz)
    xyz, component, normals = sample.xyz[keep], sample.component[keep], sample.normals[keep]
    deviation = np.where(xyz[:, 0] > 0.5, 0.02, -0.005)
    placed = POSE.placement()
    there = (xyz - deviation[:, None] * normals) @ placed[:3, :3].T + placed[:3, 3]
    fitted = replace(model.vaults[0], vault=vault, pose=POSE)
    model = replace(model, vaults=(fitted,), origin=np.array([431_000.0, 5_000_000.0, 100.0]))
    color = np.repeat(np.where(xyz[:, :1] > 0.5, 60_000, 20_000), 3, axis=1).astype(np.uint16)
    n = len(xyz)
    return LabelledScan(
        model,
        there.astype(np.float32),
        np.ones(n, np.uint16),
        component.astype(np.uint16),
        np.zeros(n, np.uint16),
        deviation.astype(np.float32),
        color,
        np.full(n, 1000, np.uint16),
    )


@pytest.fixture
def barrel(make_model):
    return scanned(make_model("barrel"), Barrel(4.0, 6.0), hole=lambda xyz: np.hypot(xyz[:, 0], xyz[:, 1]) < 0.3)


def test_each_pixel_has_what_its_points_have_and_holes_stay_open(barrel):
    laid = lay_scan(barrel, 1)
    found = raster(laid, 0.02, WHAT)
    s = found.left + 0.02 * (np.arange(found.counts.shape[1]) + 0.5)
    t = found.top - 0.02 * (np.arange(found.counts.shape[0]) + 0.5)
    hole = np.hypot(*np.meshgrid(s, t)) < 0.25
    deviation = found.channels["deviation"]
    assert np.isnan(deviation[hole]).all()
    around = np.hypot(*np.meshgrid(s, t)) > 0.4
    assert np.isfinite(deviation[around]).mean() > 0.99  # the gaps between points are closed
    assert (found.counts[around] == 0).mean() > 0.05
    east = np.broadcast_to(s > 0.6, deviation.shape) & np.isfinite(deviation)
    west = np.broadcast_to(s < 0.4, deviation.shape) & np.isfinite(deviation)
    assert deviation[east].min() == pytest.approx(0.02, abs=1e-6)
    assert deviation[west].max() == pytest.approx(-0.005, abs=1e-6)
    assert found.channels["colour"].shape == (3, *deviation.shape)
    crown = found.channels["height"][:, np.abs(s).argmin()]
    assert np.nanmedian(crown) == pytest.approx(2.5 + 2.0, abs=0.01)


def test_the_pixel_follows_from_how_dense_points_lie(barrel):
    laid = lay_scan(barrel, 1)
    assert pixel_for(laid) == 0.005
    dense = replace(laid, which=np.zeros(4_000_000, np.int64))
    assert pixel_for(dense) == 0.004
    with pytest.raises(ExportError, match=r"--pixel 0\.0001: .* give 0\.\d+ or more"):
        raster(laid, 0.0001, WHAT)


def test_pictures_lie_where_the_world_file_says_and_have_the_colours_of_deviations(barrel, tmp_path):
    written = write_maps(barrel, tmp_path, pixel=0.02)
    assert not written.notes
    told = json.loads((tmp_path / UNROLLED).read_text())["sheets"][0]
    assert {*told["files"], UNROLLED} == {path.name for path in tmp_path.iterdir()}
    picture = Image.open(tmp_path / "vault-1-deviation.png")
    step, _, _, down, left, top = map(float, (tmp_path / "vault-1-deviation.pgw").read_text().split())
    rgba = np.array(picture.convert("RGBA"))
    at = int((0.0 - top) / down), int((2.0 - left) / step)
    limit = 0.02
    assert np.abs(rgba[at][:3].astype(int) - shades(np.array(0.02), limit)).max() <= 3
    middle = int((0.0 - top) / down), int((0.0 - left) / step)
    assert rgba[middle][3] == 0
    values = Image.open(tmp_path / "vault-1-deviation.tif")
    assert np.array(values)[at] == pytest.approx(0.02, abs=1e-6)
    assert values.tag_v2[33550][:2] == (0.02, 0.02)
    assert values.tag_v2[33922][3:5] == pytest.approx((left - 0.01, top + 0.01))
    height = np.array(Image.open(tmp_path / "vault-1-height.tif"))
    assert np.nanmax(height) == pytest.approx(104.5, abs=0.03)
    drawn = ezdxf.readfile(tmp_path / "vault-1.dxf")
    assert not drawn.audit().errors
    assert {entity.dxf.layer for entity in drawn.modelspace()} == {"OUTLINES", "NAMES", "DEVIATION", "HEIGHT"}


def test_the_same_scan_gives_the_same_files(barrel, tmp_path):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        write_maps(barrel, tmp_path / name, what=("deviation",))
    one, two = ({p.name: p.read_bytes() for p in (tmp_path / name).iterdir()} for name in ("one", "two"))
    assert one == two


def test_height_lines_run_along_a_barrel_at_round_heights(barrel):
    found = raster(lay_scan(barrel, 1), 0.01, ("height",))
    lines = [line for line in contours(found, "height", 100.0) if np.ptp(line.line[:, 1]) > 3]
    assert len(lines) >= 8
    for line in lines:
        assert line.level == pytest.approx(round(line.level, 3))
        if line.line[:, 0].max() < 0:  # the stone is 5 mm nearer there
            turned = np.arccos((line.level - 102.5) / 1.995)  # down the arch from its crown
            assert np.median(line.line[:, 0]) == pytest.approx(-2.0 * turned, abs=0.02)


def test_a_line_comes_back_onto_the_stone_as_it_stands(make_model):
    for vault in (Barrel(4.0, 6.0), Groin(5.0, 5.0), Dome(3.0)):
        scan = scanned(make_model(vault.id), vault)
        leaf = next(leaf for leaf in unrolled(vault).leaves if leaf.name == vault.components[0])
        middle = np.array(leaf.outline.representative_point().coords[0])
        drawn = DrawnLine("crack", middle + np.array([[0.0, 0.0], [0.06, 0.03], [0.02, -0.05]]))
        (line,), notes = lift_lines(scan, 1, [drawn])
        assert line.component == leaf.name
        assert not notes
        assert np.hypot(*np.diff(line.sheet, axis=0).T).max() <= 0.0201
        local = line.points - scan.model.origin
        frame = POSE.frame()
        off = vault.distance(local @ frame[:, :3].T + frame[:, 3])
        assert off == pytest.approx(line.deviation, abs=1e-5)
        assert ((line.deviation >= -0.0051) & (line.deviation <= 0.0201)).all()


def test_what_is_drawn_beside_the_sheet_is_refused_and_what_crosses_is_cut(make_model):
    scan = scanned(make_model("groin"), Groin(5.0, 5.0))
    with pytest.raises(ExportError, match=r"stain, point 2 at \(0\.000, 0\.000\) lies off all parts"):
        lift_lines(scan, 1, [DrawnLine("stain", np.array([[3.5, 0.0], [0.0, 0.0]]))])
    with pytest.raises(NoSuchVaultError, match="vault 2: there is none; give 1 to 1"):
        lift_lines(scan, 2, [])
    lifted, notes = lift_lines(scan, 1, [DrawnLine("crack", np.array([[3.5, 0.0], [-3.5, 0.0]]))])
    assert [line.component for line in lifted] == ["web_east", "web_west"]
    assert "1 times" in notes[0]


def test_where_nothing_was_seen_a_line_lies_on_the_ideal_surface(barrel):
    (line,), notes = lift_lines(barrel, 1, [DrawnLine("crack", np.array([[0.0, 0.0], [0.05, 0.0]]))])
    assert "on the ideal surface" in notes[0]
    assert (line.deviation == 0).all()
    assert line.points[0] - barrel.model.origin == pytest.approx([14.0, -3.0, 4.5], abs=1e-6)


@pytest.mark.parametrize("suffix", [".dxf", ".geojson", ".csv"])
def test_lines_are_read_from_and_written_to_each_kind_of_file(barrel, tmp_path, suffix):
    points = [[1.0, -2.0], [1.5, -1.0], [1.4, 0.5]]
    path = tmp_path / f"drawn{suffix}"
    if suffix == ".dxf":
        document = ezdxf.new()
        document.modelspace().add_lwpolyline(points, dxfattribs={"layer": "crack"})
        document.modelspace().add_lwpolyline([(0, 0), (9, 9)], dxfattribs={"layer": "OUTLINES"})
        document.saveas(path)
    elif suffix == ".csv":
        path.write_text("line,s,t\n" + "".join(f"crack,{s},{t}\n" for s, t in points))
    else:
        line = {
            "type": "Feature",
            "properties": {"name": "crack"},
            "geometry": {"type": "LineString", "coordinates": points},
        }
        path.write_text(json.dumps({"type": "FeatureCollection", "features": [line]}))
    (drawn,) = read_lines(path)
    assert drawn.name == "crack"
    np.testing.assert_allclose(drawn.points, points)
    lifted, _ = lift_lines(barrel, 1, [drawn])
    out = tmp_path / f"lifted{suffix}"
    write_lifted(lifted, out, "metres")
    there = lifted[0].points
    if suffix == ".dxf":
        (entity,) = ezdxf.readfile(out).modelspace()
        assert entity.dxf.layer == "crack"
        back = np.array([tuple(vertex.dxf.location) for vertex in entity.vertices])
    elif suffix == ".csv":
        back = np.loadtxt(out, delimiter=",", skiprows=1, usecols=(2, 3, 4))
    else:
        back = np.array(json.loads(out.read_text())["features"][0]["geometry"]["coordinates"])
    np.testing.assert_allclose(back, there, atol=1e-6)


def test_layers_of_lines_whose_names_differ_by_their_case_are_one(barrel, tmp_path):
    drawn = [DrawnLine(name, np.array([[1.0, -2.0], [1.5, -1.0]])) for name in ("Crack", "crack")]
    lifted, _ = lift_lines(barrel, 1, drawn)
    write_lifted(lifted, tmp_path / "lifted.dxf", "metres")
    document = ezdxf.readfile(tmp_path / "lifted.dxf")
    assert len(document.modelspace()) == 2
    assert document.layers.get("crack") is document.layers.get("Crack")


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.svg", "<svg/>", r"unknown suffix '\.svg'"),
        ("a.csv", "x,y\n1,2\n", "cannot be read as csv"),
        ("a.csv", "line,s,t\n" + "x" * 200_000 + ",0,0\n", "cannot be read as csv"),
        ("a.csv", "line,s,t\n", "has no lines"),
        ("a.csv", "line,s,t\ncrack,nan,0\n", "crack has a point that is no number"),
        ("a.geojson", '{"type": "Point", "coordinates": [0, 0]}', "is a Point, no line"),
        ("a.dxf", "nonsense", "cannot be read as dxf"),
    ],
)
def test_files_that_have_no_lines_are_refused(tmp_path: Path, name, text, said):
    (tmp_path / name).write_text(text)
    with pytest.raises(ExportError, match=said):
        read_lines(tmp_path / name)


def test_what_is_read_can_be_written():
    assert set(WRITERS) <= set(READERS)


def test_the_sheet_tells_of_each_part_where_it_lies():
    told = plain_sheet(unrolled(Groin(5.0, 5.0)))
    assert [part["component"] for part in told["parts"]] == ["web_south", "web_north", "web_east", "web_west"]
    assert {part["laid"] for part in told["parts"]} == {"cylinder"}
    assert told["distortion"] < 1e-4

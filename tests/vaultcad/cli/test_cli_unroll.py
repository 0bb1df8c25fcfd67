"""`vaultcad unroll` on what a fit left: maps in a folder, and a crack back in space."""

import numpy as np
import pytest

from families import Barrel
from segmentation import read, write_cloud
from vaultcad.cli import main


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """What a fit left of the points of a barrel in colour, far from zero."""
    folder = tmp_path_factory.mktemp("unroll")
    sample = Barrel(4.0, 5.0).sample(60_000, np.random.default_rng(3))
    color = np.full((len(sample), 3), 30_000, np.uint16)
    write_cloud(folder / "scan.laz", sample.xyz + [431_000.0, 5_000_000.0, 100.0], color=color)
    assert main(["fit", str(folder / "scan.laz"), "-o", str(folder / "out"), "--family", "barrel"]) == 0
    return folder / "out"


def test_maps_appear_whole_and_are_replaced_as_one(result, tmp_path, capsys):
    out = tmp_path / "maps"
    for what in ("deviation,colour", "deviation"):
        assert main(["unroll", str(result), "-o", str(out), "--what", what, "--pixel", "0.02"]) == 0
        said = capsys.readouterr().out
        assert "1 part" in said
        assert "lengths within 0.00 %" in said
        names = {path.name for path in out.iterdir()}
        assert ("vault-1-colour.png" in names) == ("colour" in what)
        assert {"vault-1.dxf", "unrolled.json", "vault-1-deviation.tif", "vault-1-deviation.pgw"} <= names


def test_a_crack_comes_back_in_the_coordinates_of_the_scan(result, tmp_path, capsys):
    drawn, out = tmp_path / "crack.csv", tmp_path / "crack.dxf"
    drawn.write_text("line,s,t\ncrack,0.0,-1.0\ncrack,1.0,1.0\n")
    assert main(["unroll", str(result), "--back", str(drawn), "-o", str(out)]) == 0
    assert "1 lines of 1 drawn" in capsys.readouterr().out
    import ezdxf

    (line,) = ezdxf.readfile(out).modelspace()
    points = np.array([tuple(vertex.dxf.location) for vertex in line.vertices])
    cloud = read(result.parent / "scan.laz")
    local = points - cloud.origin
    nearest = np.array([np.linalg.norm(cloud.xyz - p, axis=1).min() for p in local])
    assert nearest.max() < 0.05  # points of the scan are 2 cm apart


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--what", "heat"], "--what heat: is none of deviation, height, intensity, colour"),
        (["--pixel", "0"], "lies outside what can be"),
        (["--vault", "none"], "--vault none: is no number; give 1 or more"),
        (["--back", "lines.svg"], "unknown suffix"),
    ],
)
def test_what_cannot_be_served_is_refused_in_one_line(result, tmp_path, capsys, arguments, said):
    out = tmp_path / ("lines.dxf" if "--back" in arguments else "maps")
    assert main(["unroll", str(result), "-o", str(out), *arguments]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert not out.exists()


def test_a_folder_that_is_no_result_is_refused(tmp_path, capsys):
    assert main(["unroll", str(tmp_path), "-o", str(tmp_path / "maps")]) == 2
    assert "has no model.json" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["unroll", "sections", "drawings", "nurbs"])
@pytest.mark.parametrize("more", [[], ["--force"]])
def test_nothing_that_is_made_of_a_fit_takes_its_place(result, capsys, command, more):
    there = sorted(result.iterdir())
    assert main([command, str(result), "-o", str(result), *more]) == 2
    assert "name another folder" in capsys.readouterr().err
    assert sorted(result.iterdir()) == there


@pytest.mark.parametrize("command", ["unroll", "sections", "drawings", "nurbs"])
def test_a_vault_that_is_not_there_is_told_in_the_same_way_by_all(result, tmp_path, capsys, command):
    assert main([command, str(result), "-o", str(tmp_path / "out"), "--vault", "7"]) == 2
    assert "vault 7: there is none; give 1 to 1" in capsys.readouterr().err


def test_drawings_do_not_take_the_place_of_the_model_that_they_show(result, capsys):
    assert main(["drawings", str(result / "model.json"), "-o", str(result)]) == 2
    assert "name another folder" in capsys.readouterr().err
    assert (result / "model.json").is_file()

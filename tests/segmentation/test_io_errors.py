"""Bad input: one line that names the file, what is wrong and the way out."""

import shutil
import struct
from pathlib import Path

import laspy
import numpy as np
import pye57
import pytest

import segmentation
from segmentation import ReadError, read, write_cloud
from segmentation.io import READERS

SUFFIXES = sorted(READERS)
BINARY = (".e57", ".las", ".laz", ".ply", ".pcd")


BROKEN = "is no |has no |no fields|no line|truncated|damaged|makes no sense|has a list|its PCD data"


def refused(path: Path, match: str = BROKEN) -> None:
    with pytest.raises(ReadError, match=match) as error:
        read(path)
    message = str(error.value)
    assert "\n" not in message
    assert message.startswith(str(path))
    assert ";" in message


def test_a_read_error_is_a_value_error():
    assert issubclass(ReadError, ValueError)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_missing_file(tmp_path, suffix):
    refused(tmp_path / f"none{suffix}", "no such file")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_an_empty_file(tmp_path, suffix):
    path = tmp_path / f"empty{suffix}"
    path.touch()
    refused(path, "is empty")


def test_a_folder(tmp_path):
    refused(tmp_path, "is a folder")


@pytest.mark.parametrize("name", ["scan.docx", "scan", "scan.laz.zip"])
def test_an_unknown_suffix(tmp_path, name):
    (tmp_path / name).write_text("1 2 3\n" * 9)
    refused(tmp_path / name, "unknown suffix")


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("content", [b"It was the best of times.\n" * 400, bytes(range(256)) * 40, b"\0" * 9999])
def test_what_is_no_cloud(tmp_path, suffix, content):
    path = tmp_path / f"novel{suffix}"
    path.write_bytes(content)
    refused(path)


@pytest.mark.parametrize(
    ("suffix", "other"), [(s, o) for s in SUFFIXES for o in BINARY if READERS[s] is not READERS[o]]
)
def test_the_content_of_another_format(tmp_path, suffix, other, clouds):
    path = tmp_path / f"wrong{suffix}"
    shutil.copy(clouds.sample(tmp_path, other), path)
    refused(path, f"rename it to {'.las' if other == '.laz' else other}")


@pytest.mark.parametrize("suffix", BINARY)
@pytest.mark.parametrize("share", [0.01, 0.1, 0.5, 0.9, 0.999, 1])
def test_a_truncated_file(tmp_path, suffix, share, clouds):
    path = clouds.sample(tmp_path, suffix)
    whole = path.read_bytes()
    path.write_bytes(whole[: min(int(len(whole) * share), len(whole) - 1)])
    refused(path)


def test_damage_in_the_middle_of_an_e57(tmp_path, clouds):
    path = clouds.sample(tmp_path, ".e57")
    whole = bytearray(path.read_bytes())
    whole[len(whole) // 2 : len(whole) // 2 + 3000] = b"\xff" * 3000
    path.write_bytes(whole)
    refused(path)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_a_las_header_that_promises_more_points(tmp_path, suffix, clouds):
    path = clouds.sample(tmp_path, suffix)
    whole = bytearray(path.read_bytes())
    whole[247:255] = struct.pack("<Q", 2 * len(clouds.points()))
    path.write_bytes(whole)
    refused(path, "promises 10000 points")


@pytest.mark.parametrize("suffix", [".xyz", ".pts", ".csv"])
def test_a_text_cut_within_a_row(tmp_path, suffix, clouds):
    path = clouds.sample(tmp_path, suffix)
    text = path.read_text()
    path.write_text(text[: len(text) // 2].rsplit(" " if suffix != ".csv" else ",", 1)[0])
    refused(path, "truncated")


def test_a_pts_cut_between_rows(tmp_path, clouds):
    path = clouds.sample(tmp_path, ".pts")
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:3001]))
    refused(path, "3000 of 5000 points")


def test_a_ply_cut_in_ascii(tmp_path):
    path = tmp_path / "a.ply"
    header = (
        "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    )
    path.write_text(header + "1 2 3\n" * 8)
    refused(path, "8 of 9 points")


def test_a_line_that_is_no_row_is_named(tmp_path):
    path = tmp_path / "a.xyz"
    path.write_text("1 2 3\n" * 6 + "1 two 3\n" + "1 2 3\n" * 6)
    refused(path, "line 7 is no row of numbers .'1 two 3'")


def test_a_row_of_another_width_is_named(tmp_path):
    path = tmp_path / "a.xyz"
    path.write_text("1 2 3\n" * 6 + "1 2 3 4\n" + "1 2\n" * 6)
    refused(path, "line 7 has 4 numbers where others have 3")


@pytest.mark.parametrize("suffix", [".ply", ".pcd", ".xyz", ".csv"])
def test_nothing_but_nan(tmp_path, suffix, clouds):
    path = tmp_path / f"nan{suffix}"
    xyz = np.full((50, 3), np.nan)
    if suffix == ".pcd":
        shutil.move(clouds.sample(tmp_path, ".pcd", 50), path)
        whole = path.read_bytes()
        path.write_bytes(whole[:-600] + xyz.astype("<f4").tobytes())
    elif suffix == ".csv":
        path.write_text("x,y,z\n" + "nan,nan,nan\n" * 50)
    else:
        write_cloud(path, xyz)
    refused(path, "all 50 points are NaN, infinite or marked invalid")


def test_an_e57_whose_points_are_marked_invalid(tmp_path):
    path = tmp_path / "a.e57"
    with pye57.E57(str(path), mode="w") as file:
        names = ("cartesianX", "cartesianY", "cartesianZ")
        state = (np.arange(50) > 0).astype(np.int8)
        file.write_scan_raw(dict.fromkeys(names, np.arange(50.0)) | {"cartesianInvalidState": state})
    refused(path, "all but 1 of its 50 points are marked .* say --keep-marked")


@pytest.mark.parametrize("suffix", [".las", ".laz", ".ply", ".pcd"])
def test_no_points(tmp_path, suffix, clouds):
    if suffix == ".pcd":
        path = clouds.sample(tmp_path, suffix, 0)
    else:
        path = tmp_path / f"none{suffix}"
        write_cloud(path, np.zeros((0, 3)))
    refused(path, "holds no points")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_three_points(tmp_path, suffix, clouds):
    refused(clouds.sample(tmp_path, ".xyz" if suffix in (".txt", ".asc") else suffix, 3), "holds 3 valid")


def test_a_ply_without_coordinates(tmp_path):
    path = tmp_path / "a.ply"
    path.write_text("ply\nformat ascii 1.0\nelement vertex 1\nproperty float u\nend_header\n1\n")
    refused(path, "no vertices with x, y and z")


@pytest.mark.parametrize(
    "header",
    [
        "ply\nformat ascii 1.0\nelement vertex many\nproperty float x\nend_header\n",
        "ply\nformat rot13 1.0\nelement vertex 4\nproperty float x\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty quaternion x\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex -4\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        "ply\nformat ascii 1.0\n",
    ],
)
def test_a_ply_header_that_makes_no_sense(tmp_path, header):
    path = tmp_path / "a.ply"
    path.write_text(header + "1 2 3\n" * 9)
    refused(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [("TYPE F F F", "TYPE F F Q"), ("SIZE 4 4 4", "SIZE 4 4"), ("DATA binary", "DATA base64"), ("x y z", "u v w")],
)
def test_a_pcd_header_that_makes_no_sense(tmp_path, old, new, clouds):
    path = clouds.sample(tmp_path, ".pcd")
    path.write_bytes(path.read_bytes().replace(old.encode(), new.encode()))
    refused(path)


def test_an_e57_without_coordinates_or_scans(tmp_path):
    path = tmp_path / "a.e57"
    with pye57.E57(str(path), mode="w"):
        pass
    refused(path, "holds no points")


def test_nothing_reaches_standard_error(tmp_path, capfd, clouds):
    path = clouds.sample(tmp_path, ".laz")
    path.write_bytes(path.read_bytes()[:-100])
    refused(path)
    assert capfd.readouterr().err == ""


def test_an_unknown_axis(tmp_path, clouds):
    with pytest.raises(ValueError, match="up = 'w'"):
        read(clouds.sample(tmp_path, ".laz"), up="w")


def test_every_public_name_is_there():
    assert set(segmentation.__all__) <= set(dir(segmentation))
    for name in ("Cloud", "ReadError", "read", "write_cloud", "write_labelled"):
        assert callable(getattr(segmentation, name))
    with pytest.raises(AttributeError, match="nonsense"):
        segmentation.nonsense  # noqa: B018


def test_a_laz_of_two_points_is_whole_but_too_small(tmp_path, clouds):
    path = tmp_path / "a.laz"
    write_cloud(path, clouds.points(2))
    assert len(laspy.read(path)) == 2
    refused(path, "holds 2 valid")

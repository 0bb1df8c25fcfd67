"""Columns of numbers in all the ways people write them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from segmentation import read

XYZ = np.array([[1.5, 2.25, 3.0], [-4, 5, 6.125], [7, -8, 9], [0, 0.5, -1], [3, 3, 3]])
I = np.array([7, 100, 2000, 0, 65535])  # noqa: E741
RGB = np.array([[0, 0, 255], [255, 0, 0], [1, 2, 3], [10, 20, 30], [9, 9, 9]])
N = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0], [0.6, 0.8, 0], [0, -0.6, 0.8]])


def text(*columns, sep=" ", decimal=".", head="", end="\n"):
    rows = np.column_stack(columns)
    return head + end.join(sep.join(f"{v:g}".replace(".", decimal) for v in row) for row in rows) + end


def written(tmp_path, content, name="a.xyz"):
    (tmp_path / name).write_bytes(content.encode() if isinstance(content, str) else content)
    return read(tmp_path / name)


@pytest.mark.parametrize(
    "content",
    [
        text(XYZ),
        text(XYZ, sep="\t"),
        text(XYZ, sep="   "),
        text(XYZ, sep=","),
        text(XYZ, sep=", "),
        text(XYZ, sep=";"),
        text(XYZ, sep=";", decimal=","),
        text(XYZ, sep=" ", decimal=","),
        text(XYZ, sep=" ; "),
        text(XYZ, end="\r\n"),
        text(XYZ, end="\n\n"),
        text(XYZ, end=" \n"),
        text(XYZ).rstrip("\n"),
        text(XYZ, head="5\n"),
        text(XYZ, head="x y z\n"),
        text(XYZ, sep=",", head="X,Y,Z\n"),
        text(XYZ, sep=",", head='"X","Y","Z"\n'),
        text(XYZ, head="//X Y Z\n"),
        text(XYZ, head="# a scan of a room\n# made on a Monday\n"),
        text(XYZ, head="\ufeff"),
        text(XYZ) + "# the end\n",
        text(XYZ[:2]) + "# half of it\n" + text(XYZ[2:]),
        text(XYZ[:2], head="2\n") + text(XYZ[2:], head="3\n"),
        text(XYZ[:, [2, 0, 1]], head="Z X Y\n"),
        text(XYZ[:, [1, 0, 2]], sep=",", head="northing,easting,elevation\n"),
    ],
)
def test_coordinates(tmp_path, content):
    cloud = written(tmp_path, content)
    np.testing.assert_allclose(cloud.xyz, XYZ)
    assert (cloud.color, cloud.intensity, cloud.normals) == (None, None, None)


@pytest.mark.parametrize(
    ("columns", "head", "has"),
    [
        ((XYZ, I), "", "i"),
        ((XYZ, RGB), "", "c"),
        ((XYZ, N), "", "n"),
        ((XYZ, I, RGB), "", "ic"),
        ((XYZ, I, RGB), "5\n", "ic"),
        ((XYZ, RGB, I / 65535), "", "ci"),
        ((XYZ, I, N), "", "in"),
        ((XYZ, RGB, N), "", "cn"),
        ((XYZ, I, RGB, N), "", "icn"),
        ((XYZ, RGB, I), "X Y Z R G B Intensity\n", "ci"),
        ((N, I, RGB, XYZ), "//nx ny nz intensity red green blue x y z\n", "icn"),
        ((XYZ, I, RGB / 255), "x,y,z,scalar_Intensity,r,g,b\n", "ic"),
    ],
)
def test_what_else_is_in_the_columns(tmp_path, columns, head, has):
    cloud = written(tmp_path, text(*columns, sep=",", head=head), "a.csv")
    np.testing.assert_allclose(cloud.xyz, XYZ)
    for name, key, expected in (("intensity", "i", I), ("color", "c", RGB * 257), ("normals", "n", N)):
        found = getattr(cloud, name)
        assert (found is not None) == (key in has), name
        if found is not None:
            np.testing.assert_allclose(found, expected, atol=1.5 if key != "n" else 1e-6)


def test_intensities_of_pts_are_stretched(tmp_path):
    cloud = written(tmp_path, text(XYZ, [-2048, -1024, 0, 1000, 2047], RGB, head="5\n"), "a.pts")
    assert cloud.intensity.tolist() == [0, 16388, 32776, 48779, 65535]


@pytest.mark.parametrize("word", ["nan", "NaN", "-nan(ind)", "null", "NA", "1.#QNAN"])
def test_words_for_what_is_missing(tmp_path, word):
    cloud = written(tmp_path, text(XYZ) + f"{word} 1 2\n")
    assert cloud.dropped == 1
    np.testing.assert_allclose(cloud.xyz, XYZ)


def test_empty_fields_of_csv(tmp_path):
    cloud = written(tmp_path, text(XYZ, I, sep=",") + ",,,5\n" + "1,2,3,\n", "a.csv")
    assert cloud.kept.tolist() == [True] * 5 + [False, True]
    assert cloud.intensity[-1] == 0


@pytest.mark.parametrize("block", [1, 7, 64, 1 << 20])
def test_blocks_make_no_difference(tmp_path, monkeypatch, block):
    monkeypatch.setattr("segmentation.io.table.BLOCK", block)
    rng = np.random.default_rng(8)
    xyz = np.round(rng.uniform(-9, 9, (500, 3)), 4)
    cloud = written(tmp_path, text(xyz, head="x y z\n"))
    np.testing.assert_allclose(cloud.xyz, xyz, atol=1e-4)


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.tuples(*[st.floats(-9000, 9000, allow_subnormal=False)] * 3), min_size=4, max_size=20),
    st.sampled_from([" ", ",", ";", "\t"]),
)
def test_numbers_come_back(tmp_path_factory, rows, sep):
    path = tmp_path_factory.mktemp("text") / "a.csv"
    path.write_text("".join(sep.join(map(repr, row)) + "\n" for row in rows))
    np.testing.assert_allclose(read(path).xyz, rows, rtol=1e-6, atol=1e-30)

"""What points tell of a damaged file: zeros, normals of any length, a box that is not theirs, what was dropped."""

from __future__ import annotations

import struct

import laspy
import numpy as np
import pytest

from segmentation import ReadError, read, write_cloud
from segmentation.io.facts import ALIKE, Facts

N = 3000
XYZ = np.round(np.random.default_rng(3).uniform(-3, 3, (N, 3)), 4)
NORMALS = np.tile(np.float32([0, 0.6, 0.8]), (N, 1))


def las(path, offset=0.0):
    """LAS 1.2 by laspy, without counts by return, its offset amid the points."""
    file = laspy.create(point_format=3, file_version="1.2")
    file.header.scales, file.header.offsets = [1e-4] * 3, [offset] * 3
    file.x, file.y, file.z = XYZ.T
    file.write(path)
    return path


def changed(path, at, layout, *values):
    data = bytearray(path.read_bytes())
    struct.pack_into(layout, data, at, *values)
    path.write_bytes(data)
    return path


def told(path):
    return dict(read(path).notes)


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_a_good_las_is_not_suspected(tmp_path, suffix):
    assert set(told(las(tmp_path / f"a{suffix}"))) == {"unit-assumed"}


@pytest.mark.parametrize(
    ("at", "layout", "values", "code", "match"),
    [
        (107, "<I", (N - 100,), "damaged", "room for 100 others"),
        (131, "<d", (1e-9,), "box", "larger than its points by up to 3 of its units"),
        (155, "<d", (9.0,), "damaged", "outside their box by up to"),
        (179, "<6d", (0, 0, 0, 0, 0, 0), "unchecked", "no box"),
        (179, "<d", (float("nan"),), "unchecked", "no box"),
        (227, "<34s", (bytes(340),), "zeros", "10 points in 0, 0, 0: bytes lost from the file, or beams"),
    ],
)
def test_what_contradicts_a_las_header_is_told(tmp_path, at, layout, values, code, match):
    path = las(tmp_path / "a.las")
    if at == 227:
        at, layout = struct.unpack_from("<I", path.read_bytes(), 96)[0], "<340s"
    assert match in told(changed(path, at, layout, *values))[code]


def test_points_of_zero_bytes_are_told_once_where_a_las_has_an_offset(tmp_path):
    path = las(tmp_path / "a.las", offset=0.5)
    start = struct.unpack_from("<I", path.read_bytes(), 96)[0]
    found = told(changed(path, start, "<340s", bytes(340)))
    assert "10 points in 0.5 0.5 0.5, the offset of the file: bytes lost" in found["zeros"]


@pytest.mark.parametrize(("counts", "damaged"), [((N, 0), False), ((0, N), True), ((N - 1, 1), True)])
def test_counts_by_return_begin_with_the_first_or_with_none(tmp_path, counts, damaged):
    path = changed(las(tmp_path / "a.las"), 111, "<2I", *counts)  # all are of return 0, as laspy leaves them
    assert ("damaged" in told(path)) == damaged


@pytest.mark.parametrize("points", [0, N])
@pytest.mark.parametrize("kept", [0, 7])
def test_a_laz_cut_where_its_points_begin_is_refused(tmp_path, points, kept):
    path = tmp_path / "a.laz"
    las(path) if points else laspy.create(point_format=3, file_version="1.2").write(path)
    data = path.read_bytes()
    path.write_bytes(data[: struct.unpack_from("<I", data, 96)[0] + kept])
    with pytest.raises(ReadError):
        read(path)


def test_chunks_of_a_laz_are_counted(tmp_path):
    path = tmp_path / "a.laz"
    rng = np.random.default_rng(0)
    write_cloud(path, np.round(rng.uniform(-3, 3, (120_000, 3)), 4))
    assert "damaged" not in told(path)
    assert "need 2 chunks of 50,000, and 3 are there" in told(changed(path, 247, "<Q", 99_000))["damaged"]


@pytest.mark.parametrize("place", [-1, 0, 2**62, 2**63 - 1])
def test_an_empty_laz_is_refused_wherever_its_chunks_are_to_be(tmp_path, place):
    laspy.create(point_format=3, file_version="1.2").write(path := tmp_path / "a.laz")
    (start,) = struct.unpack_from("<I", path.read_bytes(), 96)
    with pytest.raises(ReadError, match="holds no points"):
        read(changed(path, start, "<q", place))


def test_a_lost_sector_among_the_layers_of_a_laz_is_told(tmp_path):
    path = tmp_path / "a.laz"
    write_cloud(path, XYZ, color=np.random.default_rng(1).integers(0, 256, (N, 3)).astype(np.uint8))
    data = path.read_bytes()
    at = (len(data) // 512 - 2) * 512  # colours come last
    assert "512 bytes are zero" in told(changed(path, at, "<512s", bytes(512)))["damaged"]


@pytest.mark.parametrize("at", [1, 25_000, 49_999])
def test_layers_of_a_laz_that_hardly_change_are_good(tmp_path, at):
    rng = np.random.default_rng(1)
    values = np.zeros((120_000, 3), np.float32)
    values[at::50_000] = 1
    path = tmp_path / "a.laz"
    write_cloud(
        path, np.round(rng.uniform(-3, 3, values.shape), 4), normals=values, color=values, intensity=values[:, 0]
    )
    assert "damaged" not in told(path)


def test_two_counts_of_a_las_are_compared(tmp_path):
    path = tmp_path / "a.las"
    write_cloud(path, XYZ)
    assert "two counts of points, 5 and 3,000" in told(changed(path, 107, "<I", 5))["damaged"]


@pytest.mark.parametrize(("at", "layout", "value"), [(104, "<B", 11), (104, "<B", 5), (131, "<d", -1e-4)])
def test_las_headers_that_cannot_be(tmp_path, at, layout, value):
    with pytest.raises(ReadError, match="its header tells of"):
        read(changed(las(tmp_path / "a.las"), at, layout, value))


@pytest.mark.parametrize("suffix", [".ply", ".xyz", ".e57"])
@pytest.mark.parametrize(("zeros", "code"), [(3, None), (12, "zeros")])
def test_points_of_zeros_are_counted(tmp_path, suffix, zeros, code):
    xyz = XYZ.copy()
    xyz[100 : 100 + zeros] = 0
    write_cloud(tmp_path / f"a{suffix}", xyz)
    found = told(tmp_path / f"a{suffix}")
    assert ("zeros" in found) == (code is not None)
    assert code is None or found["zeros"].startswith("12 points in 0, 0, 0")


def test_a_lost_coordinate_of_an_e57_is_told(tmp_path):
    xyz = XYZ.copy()
    xyz[500:530, 1] = 0
    write_cloud(tmp_path / "a.e57", xyz)
    assert "30 points in succession of scan 1 have cartesianY = 0" in told(tmp_path / "a.e57")["zeros"]


def test_what_is_lost_of_an_e57_is_told_once_a_scan(tmp_path, monkeypatch):
    xyz = XYZ.copy()
    xyz[100:130, 1] = xyz[1500:1560, 1] = 0
    write_cloud(tmp_path / "a.e57", xyz)
    monkeypatch.setattr("segmentation.io.e57.SIZE", 1000)
    (note,) = (note for note in read(tmp_path / "a.e57").notes if note.code == "zeros")
    assert note.text.startswith("60 points in succession of scan 1 have cartesianY = 0")


NORMALS_OF = {
    "long": (1000.0, "3,000 normals of the file not of unit length", [0, 0.6, 0.8]),
    "huge": (1e30, "3,000 normals of the file not of unit length", [0, 0.6, 0.8]),
    "nan": (np.nan, "3,000 normals of the file that are NaN", [0, 0, 0]),
}


@pytest.mark.parametrize("kind", NORMALS_OF)
def test_normals_are_made_unit_vectors(tmp_path, kind):
    factor, match, expected = NORMALS_OF[kind]
    write_cloud(tmp_path / "a.ply", XYZ, normals=NORMALS * np.float32(factor))
    cloud = read(tmp_path / "a.ply")
    assert match in dict(cloud.notes)["normals"]
    np.testing.assert_allclose(cloud.normals, np.tile(expected, (N, 1)), atol=1e-6)


@pytest.mark.parametrize("kind", ["i1", "i2", "u1"])
def test_normals_of_whole_numbers_are_made_unit_vectors(tmp_path, kind):
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {N}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += "".join(f"property {'u' * (kind[0] == 'u')}int{8 * int(kind[1])} n{axis}\n" for axis in "xyz")
    records = np.zeros(N, [("xyz", "<f4", 3), ("n", f"<{kind}", 3)])
    records["xyz"], records["n"] = XYZ, (16, 0, 48)  # 16² and 48² are 0 in bytes, but for a sign
    (tmp_path / "a.ply").write_bytes(f"{head}end_header\n".encode() + records.tobytes())
    cloud = read(tmp_path / "a.ply")
    assert "3,000 normals of the file not of unit length" in dict(cloud.notes)["normals"]
    np.testing.assert_allclose(cloud.normals, np.tile([0.1**0.5, 0, 0.9**0.5], (N, 1)), atol=1e-6)


@pytest.mark.parametrize("factor", [0.0, 1.0, 0.99])
def test_unit_normals_and_none_stay_as_they_are(tmp_path, factor):
    write_cloud(tmp_path / "a.ply", XYZ, normals=NORMALS * np.float32(factor))
    cloud = read(tmp_path / "a.ply")
    assert "normals" not in dict(cloud.notes)
    np.testing.assert_array_equal(cloud.normals, NORMALS * np.float32(factor))


@pytest.mark.parametrize("suffix", [".ply", ".xyz"])
@pytest.mark.parametrize(
    ("dropped", "said"),
    [
        (2700, "2,700 points of the file that are NaN, infinite or empty beams, 90% of all"),
        (2990, ", more than 99% of all"),
        (1, ", less than 0.1% of all"),
    ],
)
def test_how_much_was_dropped_is_said(tmp_path, suffix, dropped, said):
    xyz = XYZ.copy()
    xyz[:dropped] = np.nan
    write_cloud(tmp_path / f"a{suffix}", xyz)
    assert said in told(tmp_path / f"a{suffix}")["dropped"]


def test_notes_of_a_kind_are_told_some_times():
    facts = Facts()
    for number in range(2000):
        facts.tell("pose", f"scan {number} stands nowhere")
    facts.tell("unit", "metres")
    assert len(facts.told()) == ALIKE + 2
    assert facts.told()[-1].text == f"and {2000 - ALIKE:,} others like these"

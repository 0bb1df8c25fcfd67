"""PLY and PCD as other programs write them: lists, other elements first, capital names, no comment line."""

import numpy as np
import pytest

from segmentation import ReadError, read
from segmentation.io.labels import read_labels

RNG = np.random.default_rng(3)
N = 200
XYZ = np.round(RNG.uniform(0, 5, (N, 3)), 3).astype(np.float32)
RGB = RNG.integers(0, 256, (N, 3)).astype(np.uint8)
LENGTHS = RNG.integers(0, 5, N)
ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


def vertices(encoding, lengths, count="uchar"):
    """Vertices with a list between the coordinates and the colours."""
    kind = {"uchar": "u1", "int": "i4", "ushort": "u2"}[count]
    if encoding == "ascii":
        rows = (
            " ".join([*(f"{v:.3f}" for v in p), str(n), *["0.5"] * n, *map(str, c)])
            for p, n, c in zip(XYZ, lengths, RGB, strict=True)
        )
        return ("\n".join(rows) + "\n").encode()
    order = ORDERS[encoding]
    return b"".join(
        p.astype(order + "f4").tobytes() + np.array(n, order + kind).tobytes() + np.full(n, 0.5, order + "f8").tobytes()
        + c.tobytes()
        for p, n, c in zip(XYZ, lengths, RGB, strict=True)
    )  # fmt: skip


def ply(
    path, encoding, body, *, before="", inner="property list uchar double descriptor\n", names="x y z red green blue"
):
    x, y, z, r, g, b = names.split()
    path.write_bytes(
        (
            f"ply\nformat {encoding} 1.0\n{before}element vertex {N}\nproperty float {x}\nproperty float {y}\n"
            f"property float {z}\n{inner}property uchar {r}\nproperty uchar {g}\nproperty uchar {b}\nend_header\n"
        ).encode()
        + body
    )
    return path


@pytest.mark.parametrize("encoding", ["ascii", *ORDERS])
@pytest.mark.parametrize("lengths", [np.full(N, 2), np.zeros(N, int), LENGTHS], ids=["equal", "none", "various"])
def test_lists_in_the_vertices_are_passed_over(tmp_path, encoding, lengths):
    cloud = read(ply(tmp_path / "a.ply", encoding, vertices(encoding, lengths)))
    np.testing.assert_allclose(cloud.xyz, XYZ)
    np.testing.assert_array_equal(cloud.color, RGB.astype(int) * 257)


@pytest.mark.parametrize("count", ["int", "ushort"])
def test_lengths_of_lists_of_any_kind(tmp_path, count):
    inner = f"property list {count} double descriptor\n"
    body = vertices("binary_big_endian", LENGTHS, count)
    np.testing.assert_allclose(read(ply(tmp_path / "a.ply", "binary_big_endian", body, inner=inner)).xyz, XYZ)


@pytest.mark.parametrize("encoding", ["ascii", *ORDERS])
@pytest.mark.parametrize("faces", [0, 3])
def test_faces_may_come_first(tmp_path, encoding, faces):
    before = f"element face {faces}\nproperty list uchar int vertex_indices\n"
    if encoding == "ascii":
        body = b"3 0 1 2\n" * faces
    else:
        one = np.array([3], "u1").tobytes() + np.array([0, 1, 2], ORDERS[encoding] + "i4").tobytes()
        body = one * faces
    path = ply(tmp_path / "a.ply", encoding, body + vertices(encoding, LENGTHS), before=before)
    np.testing.assert_allclose(read(path).xyz, XYZ)


@pytest.mark.parametrize("encoding", ["ascii", *ORDERS])
@pytest.mark.parametrize("names", ["X Y Z Red Green Blue", "X Y Z RED GREEN BLUE", "x y z R G B"])
def test_capital_names(tmp_path, encoding, names):
    if encoding == "ascii":
        rows = (" ".join([*(f"{v:.3f}" for v in p), *map(str, c)]) for p, c in zip(XYZ, RGB, strict=True))
        body = "\n".join(rows).encode()
    else:
        body = b"".join(
            p.astype(ORDERS[encoding] + "f4").tobytes() + c.tobytes() for p, c in zip(XYZ, RGB, strict=True)
        )
    cloud = read(ply(tmp_path / "a.ply", encoding, body, inner="", names=names))
    np.testing.assert_allclose(cloud.xyz, XYZ)
    np.testing.assert_array_equal(cloud.color, RGB.astype(int) * 257)


@pytest.mark.parametrize("encoding", ["ascii", *ORDERS])
@pytest.mark.parametrize("share", [0.3, 0.9])
def test_vertices_that_are_missing(tmp_path, encoding, share):
    body = vertices(encoding, LENGTHS)
    with pytest.raises(ReadError, match="truncated"):
        read(ply(tmp_path / "a.ply", encoding, body[: int(share * len(body))]))


def test_a_length_that_runs_over_the_end(tmp_path):
    body = bytearray(vertices("binary_little_endian", LENGTHS, "int"))
    body[12:16] = b"\xff\xff\xff\x7f"
    with pytest.raises(ReadError, match="truncated"):
        read(ply(tmp_path / "a.ply", "binary_little_endian", body, inner="property list int double descriptor\n"))


def test_labels_beside_lists(tmp_path):
    path = ply(tmp_path / "a.ply", "ascii", vertices("ascii", LENGTHS))
    np.testing.assert_array_equal(read_labels(path, "Red"), RGB[:, 0])


@pytest.mark.parametrize(
    "head",
    ["VERSION 0.7\n", "", "# a cloud\n# of a room\nVERSION .7\n", "\n# .PCD v.7\nVERSION .7\n", "#comment\n"],
)
@pytest.mark.parametrize("names", ["x y z", "X Y Z"])
def test_pcd_without_its_comment(tmp_path, head, names):
    path = tmp_path / "a.pcd"
    text = f"{head}FIELDS {names}\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {N}\nHEIGHT 1\nPOINTS {N}\nDATA binary\n"
    path.write_bytes(text.encode() + XYZ.astype("<f4").tobytes())
    np.testing.assert_allclose(read(path).xyz, XYZ)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("COUNT 1 1 1", "COUNT 2 1 1"),
        ("WIDTH", "VIEWPOINT 1 2\nWIDTH"),
        ("WIDTH", "VIEWPOINT nan 0 0 1 0 0 0\nWIDTH"),
    ],
)
def test_a_pcd_header_that_cannot_be(tmp_path, old, new):
    text = f"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {N}\nHEIGHT 1\nPOINTS {N}\nDATA binary\n"
    (tmp_path / "a.pcd").write_bytes(text.replace(old, new).encode() + XYZ.astype("<f4").tobytes() * 2)
    with pytest.raises(ReadError, match=r"several values|is no place"):
        read(tmp_path / "a.pcd")


@pytest.mark.parametrize("count", [10**12, 10**20])
@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian"])
def test_more_of_another_element_than_a_file_can_hold(tmp_path, encoding, count):
    before = f"element foo {count}\nproperty list uchar int a\n"
    with pytest.raises(ReadError, match=r"truncated|makes no sense"):
        read(ply(tmp_path / "a.ply", encoding, b"1 2 3\n" * 50, before=before, inner=""))

"""What a header promises is compared with the file: PLY, PCD, PTS, PTX and texts that hold less, more, or nonsense."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from segmentation import ReadError, read

N = 60
XYZ = np.round(np.random.default_rng(5).uniform(-3, 3, (N, 3)), 3)
AXES = "".join(f"property float {axis}\n" for axis in "xyz")
ROWS = "".join(f"{x:.3f} {y:.3f} {z:.3f}\n" for x, y, z in XYZ)
BODY = XYZ.astype("<f4").tobytes()
TRIANGLE, SQUARE = b"\x03" + bytes(12), b"\x04" + bytes(16)


def ply(encoding="binary_little_endian", count=N, middle="", after=""):
    head = f"ply\nformat {encoding} 1.0\n{middle}element vertex {count}\n{AXES}{after}end_header\n"
    return head.encode()


def faces(count, middle=""):
    return f"element face {count}\n{middle}property list uchar int vertex_indices\n"


def pcd(data="binary", **lines):
    told = {
        "SIZE": "4 4 4",
        "TYPE": "F F F",
        "COUNT": "1 1 1",
        "WIDTH": N,
        "HEIGHT": 1,
        "POINTS": N,
        "DATA": data,
    } | lines
    return ("VERSION 0.7\nFIELDS x y z\n" + "".join(f"{name} {value}\n" for name, value in told.items())).encode()


def lzf(packed=None, plain=None, body=b""):
    return (
        pcd("binary_compressed") + struct.pack("<II", len(body) if packed is None else packed, plain or 12 * N) + body
    )


def ptx(counts=f"{N}\n1\n", place="0 0 0", matrix="1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"):
    rows = ROWS.replace("\n", " 0.5\n")
    return f"{counts}{place}\n1 0 0\n0 1 0\n0 0 1\n{matrix}{rows}".encode()


MOVED = "1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 0 1\n"
BYTES = ply("ascii", after="property uchar intensity\n")
PLANES = np.ascontiguousarray(XYZ.astype("<f4").T).tobytes()
LITERAL = b"".join(bytes([len(PLANES[k : k + 32]) - 1]) + PLANES[k : k + 32] for k in range(0, len(PLANES), 32))


def outcome(tmp_path, suffix, content):
    path = tmp_path / f"a{suffix}"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read(path)


REFUSED = {
    "ply without a format": (".ply", ply().replace(b"format binary_little_endian 1.0\n", b"") + BODY, "no line"),
    "ply of two formats": (".ply", ply(middle="format ascii 1.0\n") + BODY, "makes no sense"),
    "ply with a line that is none": (".ply", ply(after="propery float w\n") + BODY, "'propery float w'"),
    "ply with vertices twice": (".ply", ply(after=f"element vertex 9\n{AXES}") + BODY, "two elements 'vertex'"),
    "ply with x twice": (".ply", ply(after="property float X\n") + BODY, "two properties 'x'"),
    "ply without z": (".ply", ply().replace(b"property float z\n", b"") + BODY, "no vertices with x, y and z"),
    "ply of 1_0 vertices": (".ply", ply(count="1_0") + BODY, "makes no sense"),
    "ply of 5,000 digits": (".ply", ply(count="9" * 5000) + BODY, "makes no sense"),
    "ply in ascii of too many": (".ply", ply("ascii", 10**9) + ROWS.encode(), "is truncated"),
    "ply in ascii behind too many": (".ply", ply("ascii", middle=faces(10**9)) + ROWS.encode(), "is truncated"),
    "ply behind too many": (".ply", ply(middle=faces(10**9)) + BODY, "is truncated"),
    "ply in ascii with a wide row": (".ply", ply("ascii") + ROWS.replace("\n", " 1\n", 1).encode(), "has 4 numbers"),
    "ply in ascii with 1_0": (".ply", ply("ascii") + b"1_0 2 3\n" * N, "is no row"),
    "ply list with 1_0": (".ply", ply("ascii", after="property list uchar int a\n") + b"1_0 2 3 0\n" * N, "is no row"),
    "pcd of another width": (".pcd", pcd(WIDTH=100) + BODY, "WIDTH x HEIGHT = 100, POINTS 60"),
    "pcd of height 0": (".pcd", pcd(HEIGHT=0) + BODY, "makes no sense"),
    "pcd of count 0": (".pcd", pcd(COUNT="1 0 1") + BODY, "COUNT 1 0 1"),
    "pcd of a large count": (".pcd", pcd(COUNT="1 1 4294967295") + BODY, "makes no sense"),
    "pcd of a large size": (".pcd", pcd(SIZE="4 4 4294967295") + BODY, "makes no sense"),
    "pcd of half a size": (".pcd", pcd(SIZE="2 2 2") + BODY, "makes no sense"),
    "pcd of 5,000 digits": (".pcd", pcd(POINTS="9" * 5000) + BODY, "makes no sense"),
    "pcd of two widths": (".pcd", pcd(POINTS=f"{N}\nWIDTH {N}") + BODY, "two lines 'WIDTH'"),
    "pcd packed beyond its end": (".pcd", lzf(packed=2**32 - 1, body=BODY), "is truncated"),
    "pcd packed too densely": (".pcd", lzf(body=b"\0\0"), "is truncated"),
    "pcd packed to 4 GB": (".pcd", lzf(plain=2**32 - 1, body=BODY), "is truncated"),
    "pts with fewer": (".pts", f"{N + 1}\n{ROWS}", "60 of 61 points"),
    "pts of 5,000 digits": (".pts", f"{'9' * 5000}\n{ROWS}", "is no count of points"),
    "text with 5,000 digits alone": (".xyz", ROWS + "9" * 5000 + "\n", "is no row of numbers"),
    "text with 1_000": (".xyz", ROWS + "1_000 2 3\n", "is no row of numbers"),
    "text with 0x10": (".xyz", ROWS + "0x10 2 3\n", "is no row of numbers"),
    "text with foreign digits": (".xyz", ROWS + "\u0663 2 3\n", "is no row of numbers"),
    "text with a count in the middle": (".xyz", ROWS + "99\n" + ROWS[:60].rsplit("\n", 1)[0] + "\n", "is truncated"),
    "ply of another property": (".ply", ply().replace(b"float z", b"short z") + BODY, "are no lengths on earth"),
    "ptx of 10^26 beams": (".ptx", ptx("1" + "0" * 26 + "\n1\n"), "no whole PTX header"),
    "ptx of 10^12 beams": (".ptx", ptx("1" + "0" * 12 + "\n1\n"), "is truncated"),
    "ptx of 1e2 beams": (".ptx", ptx("1e2\n1\n"), "no whole PTX header"),
    "ptx with 1_0": (".ptx", ptx(place="1_0 0 0"), "no whole PTX header"),
    "ptx with rows behind": (".ptx", ptx() + b"1 2 3 0.5\n", "no whole PTX header of scan 2"),
}  # fmt: skip
TOLD = {
    "ply with bytes behind": (".ply", ply() + BODY + bytes(12), "damaged", "12 bytes follow"),
    "ply with fewer promised": (".ply", ply(count=N - 1) + BODY, "damaged", "12 bytes follow"),
    "ply without its faces": (".ply", ply(after=faces(2)) + BODY + TRIANGLE, "damaged", "the 2 records of 'face'"),
    "ply with a face more": (".ply", ply(after=faces(2)) + BODY + 3 * TRIANGLE, "damaged", "13 bytes follow"),
    "ply with various faces": (".ply", ply(after=faces(2)) + BODY + SQUARE + TRIANGLE + b"\1", "damaged", "1 byte"),
    "ply of faces without end": (".ply", ply(after=faces(2**39)) + BODY + TRIANGLE, "damaged", "records of 'face'"),
    "ply in ascii with rows behind": (".ply", ply("ascii", N - 2) + ROWS.encode(), "damaged", "come 2 lines"),
    "ply in ascii without its faces": (".ply", ply("ascii", after=faces(2)) + ROWS.encode(), "damaged", "come 0 lines"),
    "ply in ascii of another type": (".ply", ply("ascii").replace(b"float x", b"uchar x") + ROWS.encode(), "damaged",
                                     "'x' is to hold whole numbers up to 255"),
    "ply without its last end": (".ply", ply("ascii") + ROWS[:-1].encode(), "unended", "has no end"),
    "ply in another order": (".ply", ply().replace(b"float x", b"float Y", 1).replace(b"float y", b"float x") + BODY,
                             "columns", "order y x z"),
    "pcd with bytes behind": (".pcd", pcd() + BODY + b"\1", "damaged", "1 byte follow"),
    "pcd in ascii with rows behind": (".pcd", pcd("ascii", WIDTH=59, POINTS=59) + ROWS.encode(), "damaged", "1 line"),
    "pcd without its last end": (".pcd", pcd("ascii") + ROWS[:-1].encode(), "unended", "has no end"),
    "pts with more": (".pts", f"{N - 1}\n{ROWS}", "damaged", "promise 59 points, 60 are there"),
    "text without its last end": (".xyz", ROWS[:-1], "unended", "has no end"),
    "ptx without its last end": (".ptx", ptx()[:-1], "unended", "has no end"),
    "ptx of another place": (".ptx", ptx(place="5 6 1", matrix=MOVED), "damaged", "stands elsewhere"),
    "ptx of points that are placed": (".ptx", ptx(place="5 6 1"), "pose", "stands elsewhere"),
    "pcd with a page of more than zeros": (".pcd", pcd() + BODY + bytes(4095) + b"\1", "damaged", "4,096 bytes follow"),
    "pcd with more than a page": (".pcd", pcd() + BODY + bytes(65537), "damaged", "65,537 bytes follow"),
    "ply in ascii with a colour of 256": (".ply", BYTES + " 256\n".join(ROWS.splitlines()).encode() + b" 256\n",
                                          "damaged", "'intensity' is to hold whole numbers up to 255"),
}  # fmt: skip
GOOD = {
    "ply": (".ply", ply() + BODY),
    "ply with a line feed behind": (".ply", ply() + BODY + b"\n"),
    "ply with triangles": (".ply", ply(after=faces(3)) + BODY + 3 * TRIANGLE),
    "ply with various faces": (".ply", ply(after=faces(3, "property short a\n")) + BODY + b"".join(
        b"\0\0" + face for face in (SQUARE, TRIANGLE, SQUARE))),
    "ply with no faces": (".ply", ply(after=faces(0)) + BODY),
    "ply with an element of nothing": (".ply", ply(after="element nothing 9\n") + BODY),
    "ply in ascii": (".ply", ply("ascii", after=faces(1)) + f"{ROWS}\n3 0 1 2\n\n".encode()),
    "pcd": (".pcd", pcd() + BODY),
    "pcd in ascii": (".pcd", pcd("ascii") + f"{ROWS}\n".encode()),
    "pcd without a height": (".pcd", pcd().replace(b"HEIGHT 1\n", b"") + BODY),
    **{f"pcd with a page of {size:,}": (".pcd", pcd() + BODY + bytes(size)) for size in (4096, 16384, 65536)},
    "pcd packed with a page behind": (".pcd", lzf(body=LITERAL) + bytes(4096)),
    **{f"ply in ascii with an intensity of {word}": (".ply", BYTES + f" {word}\n".join(ROWS.splitlines()).encode()
       + f" {word}\n".encode()) for word in ("-1", "255", "nan")},
    "ply in ascii with halves of no use": (".ply", BYTES.replace(b"intensity", b"curvature")
                                           + " 0.5\n".join(ROWS.splitlines()).encode() + b" 0.5\n"),
    "pts": (".pts", f"{N}\n{ROWS}  "),
    "ptx": (".ptx", ptx()),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused(tmp_path, name):
    suffix, content, match = REFUSED[name]
    with pytest.raises(ReadError, match=match) as error:
        outcome(tmp_path, suffix, content)
    assert len(str(error.value)) < 500


@pytest.mark.parametrize("name", TOLD)
def test_told(tmp_path, name):
    suffix, content, code, match = TOLD[name]
    notes = dict(outcome(tmp_path, suffix, content).notes)
    assert match in notes[code]


@pytest.mark.parametrize("name", GOOD)
def test_nothing_is_said_of_good_files(tmp_path, name):
    cloud = outcome(tmp_path, *GOOD[name])
    assert len(cloud) == N
    assert {note.code for note in cloud.notes} <= {"unit-assumed", "columns"}

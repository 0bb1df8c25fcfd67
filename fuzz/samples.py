"""Good files of every format, of a few thousand points, and where the numbers of their headers stand."""

from __future__ import annotations

import io
import re
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import laspy
import lazrs
import numpy as np
import pye57

from fuzz.pages import logical
from segmentation import write_cloud

COUNT = 2400
CHUNK = 300  # points in a chunk of LAZ, where there are to be several
LONGEST_BACK = 1 << 13  # bytes that a copy in LZF may lie back
GUID = re.compile(rb"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}")


@dataclass(frozen=True)
class Sample:
    """A good file. data: its bytes, of an E57 without checksums. fields: places and struct layouts of numbers.

    head: bytes that are header, a text's or not. text: whether all of it is text, as its header alone is where
    `words`. paged: whether checksums are to be put in. is_empty: whether it has no points, and is refused for it.
    """

    name: str
    suffix: str
    data: bytes
    head: int
    fields: tuple[tuple[int, str], ...] = ()
    words: bool = False
    text: bool = False
    paged: bool = False
    is_empty: bool = False


def room(count: int = COUNT) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Points (n, 3) of a room on a grid of 0.1 mm, with normals, colours and intensities."""
    rng = np.random.default_rng(12)
    xyz = rng.uniform(-3, 3, (count, 3))
    wall = rng.integers(0, 3, count)
    xyz[np.arange(count), wall] = rng.choice([-3.0, 3.0], count) + rng.normal(0, 0.002, count)
    normals = np.zeros((count, 3), np.float32)
    normals[np.arange(count), wall] = 1
    color = rng.integers(1, 256, (count, 3)).astype(np.uint8)
    return np.round(xyz, 4), normals, color, rng.integers(1, 65536, count).astype(np.uint16)


LAS = (
    (24, "<B"), (25, "<B"), (94, "<H"), (96, "<I"), (100, "<I"), (104, "<B"), (105, "<H"), (107, "<I"),
    *((at, "<I") for at in range(111, 131, 4)), *((at, "<d") for at in range(131, 227, 8)),
)  # fmt: skip
LAS_14 = ((227, "<Q"), (235, "<Q"), (243, "<I"), (247, "<Q"), (255, "<Q"), (263, "<Q"))


def las(folder: Path, suffix: str, new: bool, count: int = COUNT, chunk: int = 0) -> Sample:
    """LAS 1.4 by our writer or, not new, 1.2 by laspy, which leaves the counts by return empty.

    chunk: points in each chunk of LAZ, 50,000 by default.
    """
    path, (xyz, normals, color, intensity) = folder / f"a{suffix}", room(count)
    if new:
        write_cloud(path, xyz, normals=normals, color=color, intensity=intensity)
    else:
        file = laspy.create(point_format=3, file_version="1.2")
        file.header.scales, file.header.offsets = [1e-4] * 3, [0.0, 0.0, 0.0]
        file.x, file.y, file.z = xyz.T
        file.intensity = intensity
        file.red, file.green, file.blue = color.T.astype(np.uint16) * 257
        file.write(path)
    data = path.read_bytes() if not chunk else _in_chunks(path, chunk)
    size, start, records = struct.unpack_from("<HII", data, 94)
    fields, at = [*LAS, *(LAS_14 if new else ())], size
    for _ in range(records):
        fields += [(at + 18, "<H"), (at + 20, "<H")]
        length = struct.unpack_from("<H", data, at + 20)[0]
        if data[at + 2 : at + 16] == b"laszip encoded":
            layout = "<HHBBHIIqqH" + "HHH" * ((length - 34) // 6)
            place = at + 54
            for kind in layout[1:]:
                fields.append((place, "<" + kind))
                place += struct.calcsize("<" + kind)
        at += 54 + length
    if suffix == ".laz" and count:
        fields.append((start, "<q"))
        table = struct.unpack_from("<q", data, start)[0]
        fields += [(table, "<I"), (table + 4, "<I")]
    name = f"{suffix[1:]} {'1.4' if new else '1.2'}{' chunks' if chunk else ''}{'' if count else ' empty'}"
    return Sample(name, suffix, data, start, tuple(fields), is_empty=not count)


def _in_chunks(path: Path, chunk: int) -> bytes:
    """A LAZ file with so many points in each chunk."""
    with laspy.open(path) as reader:
        start, points = reader.header.offset_to_point_data, reader.read().points
    head = path.read_bytes()[:start]
    at = head.index(b"laszip encoded") - 2 + 54
    (length,) = struct.unpack_from("<H", head, at - 34)
    record = bytearray(head[at : at + length])
    struct.pack_into("<I", record, 12, chunk)
    out = io.BytesIO()
    out.write(head[:at] + record + head[at + length :])
    packer = lazrs.LasZipCompressor(out, lazrs.LazVlr(bytes(record)))
    packer.compress_many(np.frombuffer(points.array.tobytes(), np.uint8))
    packer.done()
    return out.getvalue()


def e57(folder: Path, ours: bool) -> Sample:
    """E57 by our writer, in double precision, or by pye57, in single precision, with a pose."""
    path, (xyz, normals, color, intensity) = folder / "a.e57", room()
    if ours:
        write_cloud(path, xyz, normals=normals, color=color, intensity=intensity)
    else:
        path.unlink(missing_ok=True)
        columns = dict(zip(("cartesianX", "cartesianY", "cartesianZ"), xyz.T.copy(), strict=True))
        turn, place = np.array([0.8, 0, 0, 0.6]), np.array([5.0, 6.0, 1.0])
        with pye57.E57(str(path), mode="w") as file:
            file.write_scan_raw(columns | {"intensity": intensity / 65535}, rotation=turn, translation=place)
    data = GUID.sub(lambda found: b"0" * len(found[0]), logical(path.read_bytes()))  # else no two are the same
    streams = struct.unpack_from("<H", data, 84)[0]
    fields = (
        *((at, "<Q") for at in (16, 24, 32, 40)), (8, "<I"), (12, "<I"), (48, "<B"), (56, "<Q"), (64, "<Q"), (72, "<Q"),
        (80, "<B"), (81, "<B"), (82, "<H"), (84, "<H"), *((86 + 2 * k, "<H") for k in range(streams)),
    )  # fmt: skip
    return Sample("e57 double" if ours else "e57 pose", ".e57", data, 86 + 2 * streams, fields, words=True, paged=True)


def ply(encoding: str, order: str, faces: bool, count: int = COUNT) -> Sample:
    """PLY by hand: x, y and z in double precision, colours; with faces, half of them triangles."""
    xyz, _, color, _ = room(count)
    rng = np.random.default_rng(1)
    polygons = [rng.integers(0, COUNT, 3 + k % 2) for k in range(200 if faces else 0)]
    header = (
        f"ply\nformat {encoding} 1.0\ncomment by hand\nelement vertex {count}\nproperty double x\nproperty double y\n"
        "property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        + (f"element face {len(polygons)}\nproperty list uchar int vertex_indices\n" if faces else "")
        + "end_header\n"
    ).encode()
    if encoding == "ascii":
        rows = [" ".join([*(f"{v:.4f}" for v in p), *map(str, c)]) for p, c in zip(xyz, color, strict=True)]
        rows += [" ".join(map(str, [len(polygon), *polygon])) for polygon in polygons]
        body = ("\n".join(rows) + "\n").encode()
    else:
        body = b"".join(p.astype(order + "f8").tobytes() + c.tobytes() for p, c in zip(xyz, color, strict=True))
        body += b"".join(bytes([len(polygon)]) + polygon.astype(order + "i4").tobytes() for polygon in polygons)
    name = f"ply {encoding}{' faces' if faces else ''}{'' if count else ' empty'}"
    is_text = encoding == "ascii"
    return Sample(name, ".ply", header + body, len(header), words=True, text=is_text, is_empty=not count)


def pcd(encoding: str, count: int = COUNT, copies: bool = False) -> Sample:
    """PCD by hand, single precision, with packed colours; compressed without any copy, which LZF allows, or with.

    Copies need repetitions: coordinates are then multiples of 1/64 m.
    """
    xyz, _, color, _ = room(count)
    xyz = np.round(xyz * 64) / 64 if copies else xyz
    rgb = color.astype(np.uint32) @ np.array([65536, 256, 1], np.uint32)
    header = (
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
        f"WIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {encoding}\n"
    ).encode()
    columns = [c.astype("<f4").tobytes() for c in xyz.T] + [rgb.astype("<u4").tobytes()]
    if encoding == "ascii":
        body = "".join(f"{x:.4f} {y:.4f} {z:.4f} {c}\n" for (x, y, z), c in zip(xyz, rgb, strict=True)).encode()
    elif encoding == "binary":
        body = np.stack([np.frombuffer(c, "<u4") for c in columns], axis=1).tobytes()
    else:
        plain = b"".join(columns)
        packed = lzf(plain, copies)
        body = struct.pack("<II", len(packed), len(plain)) + packed
    fields = ((len(header), "<I"), (len(header) + 4, "<I")) if encoding == "binary_compressed" else ()
    name = f"pcd {encoding}{' copies' if copies else ''}{'' if count else ' empty'}"
    is_text = encoding == "ascii"
    return Sample(name, ".pcd", header + body, len(header), fields, words=True, text=is_text, is_empty=not count)


def lzf(plain: bytes, copies: bool) -> bytes:
    """Bytes compressed as `segmentation.io.lzf` has them, with copies of what came before, or without any."""
    out, literal, at = bytearray(), bytearray(), 0
    places: dict[bytes, int] = {}
    while at < len(plain):
        before = places.get(plain[at : at + 3], -LONGEST_BACK) if copies else -LONGEST_BACK
        places[plain[at : at + 3]] = at
        length, back = 0, at - before - 1
        while back < LONGEST_BACK and length < 264 and plain[before + length] == plain[at + length]:
            length += 1
            if at + length == len(plain):
                break
        if length >= 3:
            out += _literals(literal)
            short = min(length - 2, 7)
            out += bytes([short << 5 | back >> 8, *([length - 9] if short == 7 else []), back & 255])
            literal = bytearray()
            at += length
        else:
            literal.append(plain[at])
            at += 1
    return bytes(out + _literals(literal))


def _literals(literal: bytes) -> bytes:
    parts = (literal[k : k + 32] for k in range(0, len(literal), 32))
    return b"".join(bytes([len(part) - 1]) + part for part in parts)


def rows(name: str, suffix: str, header: str, row: str) -> Sample:
    """A text with a header, and rows of x, y, z, intensity, red, green, blue in that format."""
    xyz, _, color, intensity = room()
    table = [(*p, i, *c) for p, c, i in zip(xyz, color, intensity / 65535, strict=True)]
    width = row.count("%")
    body = "".join(row % tuple(values[:width]) for values in table)
    return Sample(name, suffix, (header + body).encode(), len(header) or 120, words=True, text=True)


def ptx() -> Sample:
    """PTX of two stations."""
    half = COUNT // 2
    matrix = "0.8 0.6 0 0\n-0.6 0.8 0 0\n0 0 1 0\n5 6 1 1\n"
    head = f"{half // 10}\n10\n5 6 1\n0.8 0.6 0\n-0.6 0.8 0\n0 0 1\n{matrix}"
    whole = rows("ptx", ".ptx", "", "%.4f %.4f %.4f %.4f %d %d %d\n").data.splitlines(keepends=True)
    data = head.encode() + b"".join(whole[:half]) + head.encode() + b"".join(whole[half:])
    return Sample("ptx", ".ptx", data, len(head), words=True, text=True)


MAKERS: dict[str, Callable[[Path], Sample]] = {
    "las 1.4": lambda folder: las(folder, ".las", True),
    "las 1.2": lambda folder: las(folder, ".las", False),
    "laz 1.4": lambda folder: las(folder, ".laz", True),
    "laz 1.2": lambda folder: las(folder, ".laz", False),
    "laz 1.2 chunks": lambda folder: las(folder, ".laz", False, chunk=CHUNK),
    "laz 1.4 chunks": lambda folder: las(folder, ".laz", True, chunk=CHUNK),
    "e57 double": lambda folder: e57(folder, True),
    "e57 pose": lambda folder: e57(folder, False),
    **{
        f"ply {encoding}{' faces' if faces else ''}": lambda _, e=encoding, o=order, f=faces: ply(e, o, f)  # type: ignore[misc]
        for encoding, order in (("binary_little_endian", "<"), ("binary_big_endian", ">"), ("ascii", ""))
        for faces in (False, True)
    },
    **{f"pcd {e}": lambda _, e=e: pcd(e) for e in ("ascii", "binary", "binary_compressed")},  # type: ignore[misc]
    "pcd binary_compressed copies": lambda _: pcd("binary_compressed", copies=True),
    "pts": lambda _: rows("pts", ".pts", f"{COUNT}\n", "%.4f %.4f %.4f %.4f %d %d %d\n"),
    "ptx": lambda _: ptx(),
    "xyz": lambda _: rows("xyz", ".xyz", "", "%.4f %.4f %.4f %.4f %d %d %d\n"),
    "csv": lambda _: rows("csv", ".csv", "X,Y,Z,Intensity,R,G,B\n", "%.4f,%.4f,%.4f,%.4f,%d,%d,%d\n"),
    "las 1.2 empty": lambda folder: las(folder, ".las", False, 0),
    "laz 1.2 empty": lambda folder: las(folder, ".laz", False, 0),
    "ply binary_little_endian empty": lambda _: ply("binary_little_endian", "<", False, 0),
    "ply ascii empty": lambda _: ply("ascii", "", False, 0),
    "pcd binary empty": lambda _: pcd("binary", 0),
    "pcd binary_compressed empty": lambda _: pcd("binary_compressed", 0),
}

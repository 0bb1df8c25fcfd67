"""LAZ and LAS files of strangers: whatever they hold, they take nothing down, and what contradicts itself is said."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from segmentation import read
from segmentation.errors import ReadError
from segmentation.io import laz_apart
from segmentation.io.las import open_las
from segmentation.io.write import write_cloud

COUNT = 120_000


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, bytes]:
    """A good LAS and a good LAZ file of the same points."""
    folder, rng = tmp_path_factory.mktemp("las"), np.random.default_rng(0)
    xyz = np.round(rng.uniform(-3, 3, (COUNT, 3)), 3)
    intensity = rng.integers(0, 65535, COUNT).astype(np.uint16)
    for suffix in (".las", ".laz"):
        write_cloud(folder / f"good{suffix}", xyz, intensity=intensity)
    return {suffix: (folder / f"good{suffix}").read_bytes() for suffix in (".las", ".laz")}


def changed(data: bytes, at: int, layout: str, *values: float) -> bytes:
    out = bytearray(data)
    struct.pack_into(layout, out, at, *values)
    return bytes(out)


def put(folder: Path, data: bytes, suffix: str) -> Path:
    path = folder / f"scan{suffix}"
    path.write_bytes(data)
    return path


def test_laz_holds_what_las_holds(files, tmp_path) -> None:
    las, laz = (read(put(tmp_path, files[suffix], suffix)) for suffix in (".las", ".laz"))
    assert np.array_equal(las.xyz, laz.xyz)
    assert np.array_equal(las.intensity, laz.intensity)


def test_points_come_in_any_portions(files, tmp_path) -> None:
    with open_las(put(tmp_path, files[".laz"], ".laz")) as reader:
        parts = [np.array(points["X"]) for points in reader.chunk_iterator(7001)]
    with open_las(put(tmp_path, files[".las"], ".las")) as reader:
        assert np.array_equal(np.concatenate(parts), reader.read_points(-1)["X"])


@pytest.mark.parametrize("suffix", [".las", ".laz"])
@pytest.mark.parametrize(
    ("at", "layout", "value"),
    [
        (94, "<H", 3),
        (94, "<H", 65535),
        (96, "<I", 5),
        (96, "<I", 2**32 - 1),
        (100, "<I", 2**32 - 1),
        (105, "<H", 0),
        (131, "<d", float("nan")),
        (131, "<d", 0.0),
    ],
)
def test_headers_that_cannot_be_are_refused_at_once(files, tmp_path, suffix, at, layout, value) -> None:
    with pytest.raises(ReadError, match=r"whole LAS or LAZ file|truncated or damaged"):
        read(put(tmp_path, changed(files[suffix], at, layout, value), suffix))


@pytest.mark.parametrize("suffix", [".las", ".laz"])
def test_more_points_than_a_file_can_hold_are_refused(files, tmp_path, suffix) -> None:
    data = changed(files[suffix], 107, "<I", 2**32 - 1)
    if data[25] >= 4:
        data = changed(data, 247, "<Q", 2**40)
    with pytest.raises(ReadError, match="promises"):
        read(put(tmp_path, data, suffix))


@pytest.mark.parametrize("seed", range(24))
def test_a_broken_block_ends_in_an_error_or_a_word(files, tmp_path, seed) -> None:
    rng, data = np.random.default_rng(seed), bytearray(files[".laz"])
    start = struct.unpack_from("<I", data, 96)[0]
    at = int(rng.integers(start, len(data) - 512))
    data[at : at + 512] = bytes(512) if seed % 2 else rng.bytes(512)
    try:
        cloud = read(put(tmp_path, bytes(data), ".laz"))
    except ReadError:
        return
    good = read(put(tmp_path, files[".laz"], ".laz"))
    same = len(cloud) == len(good) and np.array_equal(cloud.xyz, good.xyz)
    assert same or any(note.code in ("damaged", "dropped", "specks") for note in cloud.notes)


def test_a_decoder_that_dies_is_one_error_with_its_code(files, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(laz_apart, "MEMORY", 1 << 20)
    with pytest.raises(ReadError, match=r"cannot be unpacked \(.+\)"):
        read(put(tmp_path, files[".laz"], ".laz"))


def test_points_outside_their_box_are_told(files, tmp_path) -> None:
    x1, x0 = struct.unpack_from("<2d", files[".las"], 179)
    path = put(tmp_path, changed(files[".las"], 179, "<2d", x1 - 1, x0), ".las")
    told = [note.text for note in read(path).notes if note.code == "damaged"]
    assert len(told) == 1
    assert "outside their box by up to 1" in told[0]
    assert not [note for note in read(put(tmp_path, files[".las"], ".las")).notes if note.code == "damaged"]


def test_other_returns_than_promised_are_told(files, tmp_path) -> None:
    at = 255 if files[".las"][25] >= 4 else 111
    layout = "<2Q" if files[".las"][25] >= 4 else "<2I"
    data = changed(files[".las"], at, layout, COUNT - 5, 5)
    if files[".las"][25] >= 4:
        data = changed(data, 111, "<2I", COUNT - 5, 5)
    told = [note.text for note in read(put(tmp_path, data, ".las")).notes if note.code == "damaged"]
    assert len(told) == 1
    assert "of return 1 there are" in told[0]

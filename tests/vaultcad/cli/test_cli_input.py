"""Bad input to the commands that read: exit 2, one line that names the thing and the way out, nothing left behind."""

import subprocess
import sys

import numpy as np
import pytest

from segmentation.io import write_cloud

READING = ("fit", "segment")


@pytest.fixture
def bad(tmp_path, room):
    """Makes a file that is no scan, by its kind."""
    whole = room.read_bytes()
    rng = np.random.default_rng(0)
    contents = {
        "empty.laz": b"",
        "text.laz": b"a letter, not a cloud\n" * 50,
        "jpeg.laz": b"\xff\xd8\xff\xe0\x00\x10JFIF\x00" + bytes(2000),
        "jpeg.jpg": b"\xff\xd8\xff\xe0\x00\x10JFIF\x00" + bytes(2000),
        "truncated.laz": whole[: len(whole) // 2],
        "header.laz": whole[:200],
        "text.e57": b"not an E57 file" * 100,
        "words.xyz": b"one two three\n" * 50,
    }
    clouds = {
        "nan.ply": np.full((1000, 3), np.nan),
        "three.ply": rng.random((3, 3)),
        "none.ply": np.zeros((0, 3)),
    }

    def make(name):
        path = tmp_path / name
        if name in contents:
            path.write_bytes(contents[name])
        elif name in clouds:
            write_cloud(path, clouds[name])
        elif name == "folder.laz":
            path.mkdir()
        return path

    return make


KINDS = (
    "missing.laz", "folder.laz", "empty.laz", "text.laz", "jpeg.laz", "jpeg.jpg", "truncated.laz", "header.laz",
    "text.e57", "words.xyz", "nan.ply", "three.ply", "none.ply",
)  # fmt: skip


@pytest.mark.parametrize("command", READING)
@pytest.mark.parametrize("kind", KINDS)
def test_a_file_that_is_no_scan_is_refused(run, bad, tmp_path, untouched, command, kind):
    path = bad(kind)
    assert untouched()
    told = run(command, path, "-o", tmp_path / ("out" if command == "fit" else "out.laz")).complaint
    assert str(path) in told
    assert "; " in told  # what is wrong; what to do
    assert untouched()


@pytest.mark.parametrize("kind", ["truncated.laz", "nan.ply"])
def test_a_process_of_its_own_says_the_same(bad, tmp_path, kind):
    command = [sys.executable, "-c", "import sys; from vaultcad.cli import main; sys.exit(main())"]
    arguments = ["fit", bad(kind), "-o", tmp_path / "out"]
    done = subprocess.run([*command, *map(str, arguments)], capture_output=True, text=True, timeout=100, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_room_without_a_vault_is_refused(run, cube, tmp_path, untouched):
    assert untouched()
    assert "no vault found" in run("fit", cube, "-o", tmp_path / "out", "--family", "barrel").complaint
    assert untouched()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--family", "igloo"], "no vault family is called 'igloo'; there are sail"),
        (["--up", "w"], "'w' is not one of 'z', 'y', 'x'"),
        (["--seed", "one"], "--seed one: is no number"),
        (["--thickness", "0"], "--thickness 0: lies outside what can be; give 0.01 to 5 m"),
        (["--voxel", "1"], "--voxel"),
    ],
)
def test_wrong_options_of_fit_are_refused(run, room, tmp_path, untouched, arguments, said):
    assert untouched()
    assert said in run("fit", room, "-o", tmp_path / "out", *arguments).complaint
    assert untouched()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--preset", "igloo"], "--preset igloo: unknown; there are sail-ideal"),
        (["--alpha", "91"], "--alpha 91: lies outside what can be; give 0.572958 to 90°"),
        (["--epsilon", "-1"], "--epsilon -1: lies outside"),
        (["--sphere-r-min", "3", "--sphere-r-max", "2"], "sphere_r_min = 3 m exceeds sphere_r_max = 2 m"),
        (["--primitives", "plane,cube"], "name at least one of plane, sphere"),
    ],
)
def test_wrong_options_of_segment_are_refused(run, room, tmp_path, untouched, arguments, said):
    assert untouched()
    assert said in run("segment", room, "-o", tmp_path / "out.laz", *arguments).complaint
    assert untouched()


def test_a_result_does_not_take_the_place_of_something_else(run, room, tmp_path, untouched):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "letter.txt").write_text("mine")
    assert untouched()
    for out in ("file", "folder", "file/below"):
        assert str(tmp_path / out) in run("fit", room, "-o", tmp_path / out).complaint
    assert "is the file that is read" in run("segment", room, "-o", room).complaint
    assert untouched()


def test_a_result_does_not_replace_the_scan_that_it_is_of(run, room, tmp_path, untouched):
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.json").write_text('{"schema": 1}')
    scan = out / "segments.laz"
    scan.write_bytes(room.read_bytes())
    assert untouched()
    assert str(scan) in run("fit", scan, "-o", out).complaint
    assert untouched()


def test_labels_that_cannot_be_compared_are_refused(run, room, tmp_path):
    truth = room.with_suffix(".truth.npz")
    other, broken = tmp_path / "other.ply", tmp_path / "broken.npz"
    write_cloud(other, np.zeros((10, 3)), extra={"component": np.ones(10, np.uint16)})
    broken.write_bytes(truth.read_bytes()[:500])
    assert "has no 'component', only X, Y, Z" in run("compare", room, truth).complaint
    assert "labels has 10 points" in run("compare", other, truth).complaint
    assert str(broken) in run("compare", other, broken).complaint
    assert "no such file" in run("compare", other, tmp_path / "none.npz").complaint
    assert "cannot be read from '.jpg'" in run("compare", other, tmp_path / "a.jpg").complaint
    assert "'xml' is not one of" in run("compare", other, other, "--format", "xml").complaint

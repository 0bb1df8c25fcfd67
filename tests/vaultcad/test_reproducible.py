"""The same scan with the same settings gives the same bytes: elsewhere, on another day, on other cores."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import laspy
import numpy as np
import pytest

from segmentation import read, write_labelled
from segmentation.io.stamp import stamp
from vaultcad.cli import main

FIT = """
import os, sys
cores, points = int(sys.argv.pop(1)), int(sys.argv.pop(1))
os.cpu_count = lambda: cores
import segmentation.io.chunk, vaultcad.fit.label
segmentation.io.chunk.SIZE = vaultcad.fit.label.CHUNK = points
from vaultcad.cli import main
scan, *outs = sys.argv[1:]
sys.exit(max(main(["fit", scan, "-o", out, "--review", "--correlations"]) for out in outs))
"""


def fit(scan: Path, *outs: Path, cores: int, points: int) -> None:
    """In one process as often as there are folders; `points` are read and labelled at once."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), str(cores))
    environment = {**os.environ, **threads, "PYTHONHASHSEED": str(cores)}
    environment.pop("SOURCE_DATE_EPOCH", None)
    command = [sys.executable, "-c", FIT, str(cores), str(points), str(scan), *map(str, outs)]
    subprocess.run(command, env=environment, check=True, capture_output=True)


def test_every_file_of_a_fit_is_the_same_in_another_folder_on_other_cores_in_other_chunks(tmp_path, room):
    other = tmp_path / "deeper" / "still" / room.name
    other.parent.mkdir(parents=True)
    shutil.copy(room, other)
    os.utime(other, (0, 0))
    fit(room, tmp_path / "one", cores=1, points=1_000_000)
    fit(other, tmp_path / "two", tmp_path / "three", cores=2, points=12_001)
    one, *others = ({p.name: p.read_bytes() for p in (tmp_path / name).iterdir()} for name in ("one", "two", "three"))
    assert len(one) == 11
    for found in others:
        assert [name for name in one if one[name] != found.get(name)] == []


@pytest.mark.parametrize(("epoch", "year"), [(None, 1970), ("1700000000", 2023), ("soon", 1970), ("9" * 30, 9999)])
def test_time_stamps_are_those_of_the_environment_or_none(epoch, year, monkeypatch):
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    if epoch is not None:
        monkeypatch.setenv("SOURCE_DATE_EPOCH", epoch)
    assert stamp().year == year


def test_a_laz_made_from_another_format_does_not_tell_the_day(tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    np.savetxt(tmp_path / "scan.xyz", np.random.default_rng(3).random((100, 3)) * 4, fmt="%.4f")
    cloud = read(tmp_path / "scan.xyz")
    write_labelled(tmp_path / "scan.xyz", tmp_path / "out.laz", cloud, {"component": np.ones(100, np.uint16)})
    with laspy.open(tmp_path / "out.laz") as file:
        assert file.header.creation_date.isoformat() == "2023-11-14"


def test_a_scan_whose_name_is_no_text_is_fitted(tmp_path, room):
    scan = tmp_path / os.fsdecode(b"Gew\xf6lbe ';ENDSEC;.laz")
    shutil.copy(room, scan)
    out = tmp_path / os.fsdecode(b"Gew\xf6lbe\n'")
    assert main(["fit", str(scan), "-o", str(out), "--review", "--family", "sail"]) == 0
    assert len(list(out.iterdir())) == 11
    assert "Gew\ufffdlbe" in (out / "report.json").read_text(encoding="utf-8")

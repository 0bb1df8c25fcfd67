"""The comparison with other engines: a job goes and comes back; an engine that is missing is said so in one line."""

import sys
from argparse import Namespace

import numpy as np
import pytest

from bench import clouds, tables
from bench.peers import table
from bench.peers.job import CLOUD, Job, write_points


def chosen(**given) -> Namespace:
    return Namespace(
        **({"points": 10_000, "rounds": 1, "vaults": "groin", "peers": "paper", "peer_python": sys.executable} | given)
    )


def test_points_and_job_come_back_as_they_were(tmp_path):
    case = clouds.ideal(clouds.IDEALS[0], 1000)
    write_points(tmp_path / CLOUD, case.xyz, case.normals)
    xyz, normals = Job(str(tmp_path), 0.01, 0.1, 20, 25.0, 0.01, ["sphere"]).points()
    assert np.array_equal(xyz, case.xyz.astype(np.float32))
    assert np.array_equal(normals, case.normals.astype(np.float32))


def test_ours_is_measured_on_ideal_and_settled_clouds():
    shown = tables.show(*table.run(chosen()))
    assert [row[0] for row in shown.rows] == ["groin", "groin", "groin settled", "groin settled"]
    names = [column.name for column in shown.columns]
    assert all(row[names.index("found")] == row[names.index("of")] == 4 for row in shown.rows)


def test_an_engine_that_is_missing_is_said_so_once_and_left_out(monkeypatch):
    monkeypatch.setenv("PATH", "")
    shown = tables.show(*table.run(chosen(peers="cloudcompare")))
    assert shown.notes == ["CloudCompare left out: no program CloudCompare: on Debian, apt-get install cloudcompare"]
    assert "CloudCompare" not in {row[1] for row in shown.rows}


def test_an_engine_that_is_unknown_is_refused():
    with pytest.raises(SystemExit, match="no engine meshlab; there are ours, paper, cloudcompare"):
        list(table.run(chosen(peers="paper,meshlab")))

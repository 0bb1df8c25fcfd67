"""Ribs in virtual scans: points on them show no component but the rib, and without them all is as it was."""

import json

import numpy as np
import pytest

from families import Groin, Mirror
from vaultcad.errors import VaultcadError
from vaultcad.scanner import ScannerSettings, scan, write_scan


def shot(**settings):
    return scan(Groin(4, 4), ScannerSettings(points=40_000, settlement=0.0, **settings), rng=np.random.default_rng(2))


def test_points_on_ribs_have_the_ribs_number_and_stand_below_the_webs(tmp_path):
    virtual = shot(rib_width=0.3, rib_depth=0.2, rib_kinds=("diagonal",), relief=0.0)
    own = virtual.arch > 0
    assert not virtual.component[own].any()
    below = -Groin(4, 4).distance(virtual.xyz[own] - [0, 0, 3.0])
    assert np.quantile(below, 0.02) > -0.01
    assert np.median(below) > 0.1
    path = write_scan(virtual, tmp_path / "a.laz")
    with np.load(path) as truth:
        assert (truth["arch"] == virtual.arch).all()
        names = json.loads(str(truth["case"]))["ribs"]
    assert len(names) == virtual.arch.max() == 5
    assert names[-1] == "boss"


def test_without_ribs_nothing_is_told_of_them(tmp_path):
    virtual = shot()
    assert not virtual.arch.any()
    with np.load(write_scan(virtual, tmp_path / "a.laz")) as truth:
        assert "arch" not in truth.files
        assert "ribs" not in json.loads(str(truth["case"]))


def test_ribs_that_cannot_be_are_refused():
    with pytest.raises(ValueError, match="choose of"):
        ScannerSettings(rib_width=0.2, rib_kinds=("lierne",))
    with pytest.raises(VaultcadError, match=r"rib_width = 0\.2: a mirror vault like this has no lines"):
        scan(Mirror(), ScannerSettings(points=5000, rib_width=0.2), rng=np.random.default_rng(1))

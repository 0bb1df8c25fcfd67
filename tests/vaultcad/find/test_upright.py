"""Any axis of a file may be up; where the file does not say which, the vault does."""

from __future__ import annotations

import numpy as np
import pytest

from families import Barrel, Groin
from segmentation.cloud import AXES, Cloud, Up, stood_up, turn, turn_back
from vaultcad.errors import NoVaultError
from vaultcad.find.upright import PHONES, stand_up
from vaultcad.scanner import ScannerSettings, VirtualScan, scan

FAMILIES = (Barrel, Groin)


@pytest.fixture(scope="module")
def virtual() -> VirtualScan:
    settings = ScannerSettings(points=20_000, openings=1, tie_rods=0, furniture=0)
    return scan(Groin(4, 5), settings, rng=np.random.default_rng(1))


@pytest.mark.parametrize("up", AXES)
def test_turning_back_undoes_a_turn_and_mirrors_nothing(up: Up) -> None:
    xyz = np.random.default_rng(0).normal(size=(10, 3))
    assert np.array_equal(turn_back(turn(xyz, up), up), xyz)
    assert np.linalg.det(turn(np.eye(3), up)) == pytest.approx(1)
    axis = np.zeros((1, 3))
    axis[0, "xyz".index(up[-1])] = -1 if up.startswith("-") else 1
    assert turn(axis, up).tolist() == [[0, 0, 1]]


@pytest.mark.parametrize(("up", "axes"), [("-x", tuple(AXES)), ("y", PHONES), ("z", ("z", "-z"))], ids=["-x", "y", "z"])
def test_the_vault_tells_which_way_is_up(up: Up, axes: tuple[Up, ...], virtual: VirtualScan) -> None:
    in_file = Cloud(turn_back(virtual.xyz, up).astype(np.float32), origin=np.array([1.0, 2.0, 3.0]))
    stood = stand_up(in_file, np.random.default_rng(0), families=FAMILIES, axes=axes)
    assert stood.up == up
    assert stood.xyz == pytest.approx(virtual.xyz, abs=1e-5)
    assert stood.in_file(stood.xyz) == pytest.approx(in_file.xyz + in_file.origin, abs=1e-5)


def test_without_a_vault_no_axis_is_up() -> None:
    flat = np.random.default_rng(2).uniform(-3, 3, (20_000, 3)) * [1, 1, 0]
    with pytest.raises(NoVaultError, match="whichever axis"):
        stand_up(Cloud(flat.astype(np.float32)), np.random.default_rng(0), families=FAMILIES)


def test_what_was_turned_when_it_was_read_is_not_turned_again() -> None:
    with pytest.raises(ValueError, match="read it with up = 'z'"):
        stood_up(Cloud(np.zeros((3, 3), np.float32), up="y"), "x")

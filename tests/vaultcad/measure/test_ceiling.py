"""The account of a ceiling: every square metre is told, and what is bent and unexplained is said."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from families import Barrel
from vaultcad.fit.solve import Placed
from vaultcad.measure.ceiling import KINDS, account, missed
from vaultcad.pose import Pose
from vaultcad.survey.patches import Patches

Array = NDArray[np.float64]

STEP = 0.05  # m


def _level(x: float, width: float, depth: float) -> tuple[Array, Array]:
    """Points and normals of a level ceiling 3 m up."""
    grid = np.stack(np.meshgrid(*(np.arange(STEP / 2, size, STEP) for size in (width, depth))), axis=-1).reshape(-1, 2)
    points = np.column_stack([grid[:, 0] + x, grid[:, 1], np.full(len(grid), 3.0)])
    return points, np.tile([0.0, 0.0, 1.0], (len(points), 1))


def _bent(x: float, length: float) -> tuple[Array, Array]:
    """Those of a half barrel, 2 m in radius, that springs at 1 m, with its axis along y."""
    angle, along = np.arange(0.4, np.pi - 0.4, STEP / 2), np.arange(-length / 2, length / 2, STEP)
    turn, far = (grid.ravel() for grid in np.meshgrid(angle, along))
    out = np.column_stack([np.cos(turn), np.zeros(len(turn)), np.sin(turn)])
    return out * 2 + np.column_stack([np.full(len(far), x), far, np.ones(len(far))]), out


def _patches(*stone: tuple[Array, Array]) -> Patches:
    points, normals = (np.concatenate(arrays) for arrays in zip(*stone, strict=True))
    return Patches(points, normals, np.repeat(np.arange(len(stone)), [len(part[0]) for part in stone]), STEP)


BARREL = Placed(Barrel(span=4.0, length=6.0), Pose(0.0, 0.0, 1.0, 0.0))


def test_every_square_metre_is_told() -> None:
    hung = _patches(_bent(0.0, 5.0), _level(10.0, 3.0, 2.0), _bent(20.0, 1.0), _level(30.0, 0.5, 0.5))
    told, places = account(hung, [(BARREL, 0.03)], [])
    vault, _, _, _ = hung.areas
    assert told["area"] == pytest.approx(hung.areas.sum())
    assert sum(told[name] for name in KINDS) == pytest.approx(told["area"])
    assert told["vault"] == pytest.approx(vault)
    assert told["flat"] == pytest.approx(6.0, abs=0.3)
    assert told["clutter"] == pytest.approx(0.25)
    assert told["unexplained"] == pytest.approx(hung.areas[2])
    assert len(places) * STEP**2 == pytest.approx(told["unexplained"])


def test_a_lost_vault_is_said_with_its_place() -> None:
    told, places = account(_patches(_bent(0.0, 5.0), _bent(20.0, 4.0)), [(BARREL, 0.03)], [])
    (note,) = missed(told, places)
    assert note.code == "ceiling"
    x, y = map(float, note.text.split("(")[1].split(")")[0].split(","))
    assert abs(x - 20.0) <= 2.0
    assert abs(y) <= 2.0


def test_a_little_that_is_unexplained_is_not() -> None:
    assert not list(missed(*account(_patches(_bent(0.0, 5.0), _bent(20.0, 0.5)), [(BARREL, 0.03)], [])))

"""A barrel goes as far as its stone does, whatever was cut by guess, and no farther than where another vault begins."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from families import Barrel, Sail
from vaultcad.find.reach import reach_of
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.survey.bays import CeilingGrid

CELL, RADIUS, LENGTH, TOLERANCE = 0.125, 2.0, 4.0, 0.03
X, Y = (np.arange(-17, 17)[:, None] + 0.5) * CELL, (np.arange(-17, 48)[None] + 0.5) * CELL
SAIL = Placed(Sail(2 * RADIUS, 2 * RADIUS, 1.0), Pose(0.0, 0.0, 0.0, 0.0))
ARM = (RADIUS, 5.9)  # m, from where to where along y it goes


def crossing() -> CeilingGrid:
    """A sail over a crossing, and one arm of it, a barrel along y."""
    square = np.where(Y < RADIUS, 2 * RADIUS**2 - X**2 - Y**2, RADIUS**2 - X**2)
    inside = (np.abs(X) < RADIUS) & (Y > -RADIUS) & (ARM[1] > Y)
    height: NDArray[np.float64] = np.where(inside, np.sqrt(np.maximum(square, 0.0)), np.nan)
    places = np.stack(np.broadcast_arrays(X, Y, height), axis=-1)
    return CeilingGrid(height, places, np.array([X.min(), Y.min()]) - CELL / 2, CELL, 0.0)


def arm(start: float, end: float) -> Placed:
    """The barrel over it, were that from one place to another along y."""
    return Placed(Barrel(2 * RADIUS, end - start), Pose(0.0, (start + end) / 2, 0.0, 0.0))


@pytest.mark.parametrize("ends", [(3.0, 4.5), (2.0, 4.0), (3.5, 5.9), (1.0, 5.9)], ids=str)
def test_a_barrel_goes_to_where_its_stone_ends_or_another_vault_begins(ends: tuple[float, float]) -> None:
    part = reach_of(arm(*ends), TOLERANCE, [(SAIL, TOLERANCE)], crossing())
    assert part is not None
    assert part.low[1] == pytest.approx(ARM[0], abs=2 * CELL)
    assert part.high[1] == pytest.approx(ARM[1] + 2 * CELL, abs=CELL)  # with the wall that stands there
    assert part.valleys == ((1, 0),)


def test_what_ends_where_its_stone_does_is_left_alone() -> None:
    assert reach_of(arm(*ARM), TOLERANCE, [(SAIL, TOLERANCE)], crossing()) is None


def test_only_barrels_go_on() -> None:
    assert reach_of(SAIL, TOLERANCE, [], crossing()) is None

"""Where a ceiling of one section goes on in another."""

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.bays import CeilingGrid
from vaultcad.survey.stretches import along_and_beyond

CELL, RADIUS, LENGTH = 0.125, 2.5, 4.0
X, Y = (np.arange(-20, 20)[:, None] + 0.5) * CELL, (np.arange(52)[None] + 0.5) * CELL - LENGTH


def ceiling(height: NDArray[np.float64]) -> CeilingGrid:
    height = height + np.random.default_rng(1).normal(0, 0.01, height.shape)
    places = np.stack(np.broadcast_arrays(X, Y, height), axis=-1)
    return CeilingGrid(height, places, np.array([-RADIUS, -LENGTH]), CELL, 0.0)


def nave(y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Height of a barrel along y, a half dome before its end at 0."""
    square = RADIUS**2 - X**2 - np.maximum(y, 0) ** 2
    return np.where(square > 0, np.sqrt(np.maximum(square, 0)), np.nan)


def test_a_nave_ends_where_its_apse_begins() -> None:
    grid = ceiling(nave(Y))
    core, apse = along_and_beyond(grid, grid.whole)
    assert abs(core.high[1]) < 0.15
    assert apse.low[1] == core.high[1]
    assert (core.valleys, apse.valleys) == (((1, 1),), ((1, 0),))


def test_what_has_one_section_or_none_is_left_whole() -> None:
    for height in (nave(Y - LENGTH), np.full(nave(Y).shape, 3.0), RADIUS - 0.2 * X**2 - 0.2 * Y**2):
        grid = ceiling(height)
        assert len(along_and_beyond(grid, grid.whole)) == 1

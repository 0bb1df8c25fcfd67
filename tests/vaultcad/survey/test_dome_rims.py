"""Domes on drums are told from apses, naves and heads of windows, by their plan and the height of their rim."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from vaultcad.survey.dome_rims import is_dome

CELL = 0.1  # m
Array = NDArray[np.float64]

COLUMN, ROW = (axis.ravel() for axis in np.meshgrid(np.arange(60), np.arange(60), indexing="ij"))
X, Y = (COLUMN - 30) * CELL, (ROW - 30) * CELL


def dome(x: Array, y: Array) -> Array:
    """Heights of a high dome of 2.77 m radius, but for what is steepest; NaN beside it."""
    square = 2.77**2 - x**2 - y**2
    return np.where(np.hypot(x, y) < 2.5, 1.8 * np.sqrt(np.maximum(square, 0)), np.nan)


def barrel(x: Array, y: Array) -> Array:
    """Heights of a barrel of 2 m span along y."""
    return np.where(np.abs(x) < 1.0, np.sqrt(np.maximum(1.0 - x**2, 0)), np.nan)


def all_of_it(x: Array, y: Array) -> Array:
    return np.isfinite(x + y)


@pytest.mark.parametrize(
    ("surface", "seen", "expected"),
    [
        (dome, all_of_it, True),
        (dome, lambda x, y: np.hypot(x, y) > 0.3, True),
        (dome, lambda x, y: np.hypot(x - 0.3, y + 1.2) > 1.8, True),
        (dome, lambda x, y: y > 0, False),
        (barrel, all_of_it, False),
    ],
    ids=["whole", "with an oculus", "half of it hidden", "an apse", "a nave"],
)
def test_a_dome_is_told_by_its_plan_and_its_rim(
    surface: Callable[[Array, Array], Array], seen: Callable[[Array, Array], Array], expected: bool
) -> None:
    height = surface(X, Y)
    held = np.isfinite(height) & seen(X, Y)
    assert is_dome(np.column_stack([COLUMN, ROW])[held], height[held], CELL) == expected

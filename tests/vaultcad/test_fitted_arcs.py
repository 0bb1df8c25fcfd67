"""Rows of points become few arcs and lines, never farther off than they may be."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from families import FAMILIES
from families.drawing.section import PLANES, outlines
from vaultcad.drawings.marks import ARC_STEP, Path, circle_of
from vaultcad.fitted_arcs import OFF, fitted_arcs

SECTIONS = [
    pytest.param(line, id=f"{cls.id}-{plane.letter}")
    for cls in FAMILIES
    for plane in PLANES
    for line, _ in outlines(cls(), plane.across, 0.0)
]


@pytest.mark.parametrize("line", SECTIONS)
def test_the_sections_of_every_family_are_a_few_arcs(line):
    corners, bulges = fitted_arcs(line)
    assert len(corners) == len(bulges) < 15
    drawn = shapely.LineString(Path("INTRADOS", corners, bulges).row())
    chord = 40.0 * (1 - np.cos(ARC_STEP / 2))  # by which the steps of an arc of 40 m are off it
    assert shapely.distance(drawn, shapely.points(line)).max() < OFF + chord
    np.testing.assert_array_equal(corners[[0, -1]], line[[0, -1]])


@given(
    radius=st.floats(0.5, 20),
    start=st.floats(-3.0, 3.0),
    sweep=st.floats(0.3, 2.8),
    clockwise=st.booleans(),
    count=st.integers(20, 200),
)
@settings(deadline=None, max_examples=60)
def test_a_circle_is_found_whole(radius, start, sweep, clockwise, count):
    turn = start + np.linspace(0, -sweep if clockwise else sweep, count)
    row = np.array([3.0, -2.0]) + radius * np.column_stack([np.cos(turn), np.sin(turn)])
    corners, bulges = fitted_arcs(row)
    assert len(corners) == 2
    assert bulges[0] == pytest.approx((-1 if clockwise else 1) * np.tan(sweep / 4), rel=1e-6)
    centre, found = circle_of(*corners, bulges[0])
    assert centre == pytest.approx([3.0, -2.0], abs=1e-6)
    assert found == pytest.approx(radius, abs=1e-6)


def test_corners_stay_corners():
    square = np.array([[0, 0], [1, 0], [2, 0], [2, 2], [0, 2], [0, 0]], dtype=float)
    corners, bulges = fitted_arcs(square)
    assert corners.tolist() == [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0]]
    assert bulges == (0.0,) * 5

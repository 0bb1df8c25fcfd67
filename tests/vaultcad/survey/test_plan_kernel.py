"""Passes over all points agree with what numpy makes of whole columns, to the last bit."""

import numpy as np
import pytest

from vaultcad.survey.plan_grid import Laid, PlanGrid
from vaultcad.survey.plan_kernel import beside, highest, outermost, places_within, within
from vaultcad.survey.thinned_scan import direction, turned

LOW, HIGH, YAW = np.array([-2.0, -1.0]), np.array([1.5, 2.5]), 0.3


@pytest.fixture(params=[np.float32, np.float64])
def points(request):
    return np.random.default_rng(1).uniform(-4, 4, (20_000, 3)).astype(request.param)


def test_what_lies_between_corners_of_a_turned_plan(points):
    x, y = (frame := turned(points[:, :2], YAW)).T
    mine = (x > LOW[0]) & (x < HIGH[0]) & (y > LOW[1]) & (y < HIGH[1])
    turn = direction(YAW, points)
    assert (within(points, *turn, LOW, HIGH) == mine).all()
    assert (places_within(points, *turn, LOW, HIGH, 1.0) == frame[mine & (points[:, 2] > 1.0)]).all()


def test_cells_and_what_lies_over_some_of_them(points):
    grid = PlanGrid.over(LOW, HIGH, 0.4)
    i, j = np.floor((points[:, :2] - LOW) / 0.4).astype(int).T
    inside = (i >= 0) & (j >= 0) & (i < grid.shape[0]) & (j < grid.shape[1])
    number = np.where(inside, i * grid.shape[1] + j, -1)
    assert (grid.numbers(points) == number).all()
    some = np.isin(i, range(2, 5)) & np.isin(j, range(1, 4)) & inside
    found = Laid.over(grid, points).numbers_about(LOW + [0.9, 0.5], LOW + [1.9, 1.5])
    assert (found == np.flatnonzero(some)).all()


def test_what_lies_beside_a_line_along_a_side():
    places = np.random.default_rng(2).uniform(-4, 4, (5_000, 2))
    depth, along = -(1.0 - places[:, 1]), places[:, 0] - 0.5
    inside = depth - 0.2 - 0.1 * along
    near = (inside < 0.3) & (inside > -0.1)
    found = beside(places, 1, -1.0, 1.0, 0.5, 0.2, 0.1, np.array([-0.1, 0.3]))
    assert near.any()
    assert (found == np.column_stack([depth, along])[near]).all()


def test_the_outermost_of_strips_are_in_order_the_first_of_equals_before_the_next():
    rng = np.random.default_rng(3)
    strip, reach = rng.integers(0, 9, 500), rng.integers(0, 20, 500) / 10
    strip[strip == 4] = 5
    count, outer = outermost(strip, reach, 4)
    order = np.lexsort((-reach, strip))
    assert (count == np.bincount(strip)).all()
    assert (outer[4] == -1).all()
    for k in set(range(9)) - {4}:
        assert (outer[k] == order[strip[order] == k][:4]).all()


def test_the_highest_point_of_each_strip_and_bin_inside_an_edge(points):
    x, y = turned(points[:, :2].astype(np.float64), YAW).T
    depth, along = 1.5 - x, y - 0.5
    near = (depth >= 0) & (depth < 1.2) & (np.abs(along) < 1.0)
    expected = np.full((11, 40), -np.inf)
    bins = np.minimum(depth[near] / 0.03, 39).astype(int)
    np.maximum.at(expected, (((along[near] + 1.0) / 0.2).astype(int), bins), points[near, 2])
    turn = float(np.cos(YAW)), float(np.sin(YAW))
    found = highest(points, *turn, 0, -1.0, 1.5, 0.5, 1.0, np.array([0.2, 0.03]), (11, 40))
    assert (found == expected).all()

"""A displacement of space: what it is between, at and far beyond its coefficients."""

import json

import numpy as np
import pytest

from vaultcad.displacement import Displacement

LOW, STEP = np.array([-1.0, 2.0, 0.5]), np.array([0.5, 0.4, 0.8])


def grid(value, shape=(7, 6, 5)):
    """With the value (n, 3) of a place at each coefficient."""
    axes = [low + step * np.arange(n) for low, step, n in zip(LOW, STEP, shape, strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return Displacement(LOW, STEP, value(places).reshape(*shape, 3))


@pytest.fixture
def inside():
    return LOW + STEP + np.random.default_rng(0).random((500, 3)) * STEP * [4, 3, 2]


def test_a_linear_field_is_the_same_within_the_grid(inside):
    matrix = np.array([[0.01, 0.02, -0.03], [0.0, 0.04, 0.01], [-0.02, 0.03, 0.05]])
    field = grid(lambda places: places @ matrix.T)
    assert field(inside) == pytest.approx(inside @ matrix.T)
    assert field.jacobian(inside) == pytest.approx(np.broadcast_to(matrix, (500, 3, 3)))
    assert field.moved(inside) == pytest.approx(inside + inside @ matrix.T)


def test_the_jacobian_is_that_of_the_field_and_both_are_smooth_across_the_border():
    rng = np.random.default_rng(1)
    field = grid(lambda places: rng.normal(0, 0.02, places.shape))
    points = LOW + rng.uniform(-4, 11, (2000, 3)) * STEP
    h = 1e-6
    for axis, moved in enumerate(h * np.eye(3)):
        slope = (field(points + moved) - field(points - moved)) / (2 * h)
        assert np.abs(field.jacobian(points)[:, :, axis] - slope).max() < 1e-9


def test_far_from_the_grid_it_is_that_of_its_border():
    field = grid(np.sin)
    assert field(np.array([[-500.0, -500.0, -500.0]])) == pytest.approx(field.coefficients[:1, 0, 0])
    assert field(np.array([[500.0, 500.0, 500.0]])) == pytest.approx(field.coefficients[-1:, -1, -1])
    assert field(np.empty((0, 3))).shape == (0, 3)


def test_it_is_read_back_within_half_a_micrometre_and_then_the_same(inside):
    field = grid(lambda places: 0.03 * np.sin(places))
    again = Displacement.from_plain(json.loads(json.dumps(field.plain())))
    assert np.abs(again(inside) - field(inside)).max() < 0.6e-6
    assert Displacement.from_plain(again.plain()) == again != field
    assert len({again, Displacement.from_plain(again.plain()), field}) == 2


def test_a_field_that_may_fold_is_neither_read_nor_undone(inside):
    steep = grid(lambda places: np.where(np.arange(len(places))[:, None] % 2 == 0, 0.3, -0.3) * [0.0, 0.0, 1.0])
    assert steep.may_fold
    for refused in (lambda: steep.undone(inside), lambda: Displacement.from_plain(steep.plain())):
        with pytest.raises(ValueError, match=r"the as-built surface stretches by up to 1\.7, where it may fold"):
            refused()
    gentle = grid(lambda places: 0.05 * np.sin(places))
    assert gentle.moved(gentle.undone(inside)) == pytest.approx(inside, abs=1e-6)

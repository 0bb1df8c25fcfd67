"""Primitives: distances and normals agree, minimal sets and least squares give the truth back."""

import numpy as np
import pytest
from numpy.typing import NDArray

from segmentation.primitives.minimal_sets import MINIMAL_SETS
from segmentation.primitives.shapes import PRIMITIVES, Cone, Cylinder, Plane, Primitive, Sphere, Torus

AXIS = tuple(np.array([0.36, -0.48, 0.8]))
TRUTHS = (
    Plane((1.0, 2.0, 3.0), AXIS),
    Sphere((1.0, 2.0, 3.0), 2.0),
    Cylinder((1.0, 2.0, 3.0), AXIS, 2.0),
    Cone((1.0, 2.0, 3.0), AXIS, 0.6),
    Torus((1.0, 2.0, 3.0), AXIS, 3.0, 1.0),
)
every = pytest.mark.parametrize("truth", TRUTHS, ids=lambda p: p.name)


def on_surface(truth: Primitive, n: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Points on the primitive, off its axis and apex: random points brought there along the normal."""
    points = rng.uniform(-2.0, 6.0, (4 * n, 3))
    for _ in range(3):
        points = points - truth.distance(points)[:, None] * truth.normal(points)
    far = np.linalg.norm(points - truth.row[:3], axis=1) > 0.5
    return points[far & (np.abs(truth.distance(points)) < 1e-9)][:n]


def test_the_index_is_the_kind():
    assert [p.kind for p in PRIMITIVES] == list(range(len(MINIMAL_SETS)))


@every
def test_rows_go_and_come_back(truth):
    assert type(truth).from_row(truth.row) == truth


@every
def test_the_normal_is_the_gradient_of_the_distance(truth):
    points = on_surface(truth, 50, np.random.default_rng(1)) + 0.3
    step = 1e-6
    numeric = [(truth.distance(points + step * e) - truth.distance(points - step * e)) / (2 * step) for e in np.eye(3)]
    assert truth.normal(points) == pytest.approx(np.stack(numeric, axis=1), abs=1e-6)


@every
def test_a_minimal_set_gives_the_primitive_whatever_the_signs_of_its_normals(truth):
    rng = np.random.default_rng(2)
    points = on_surface(truth, 400, rng)
    size = MINIMAL_SETS[truth.kind].size
    hits = 0
    for _ in range(60):
        chosen = points[rng.choice(len(points), size, replace=False)]
        found = type(truth).from_sample(chosen, truth.normal(chosen) * rng.choice([-1.0, 1.0], (size, 1)))
        hits += found is not None and np.abs(found.distance(points)).max() < 1e-6
    assert hits > 40  # a torus has two solutions, and near-parallel normals are refused


@every
def test_a_degenerate_set_gives_none(truth):
    size = MINIMAL_SETS[truth.kind].size
    assert type(truth).from_sample(np.zeros((size, 3)), np.tile([0.0, 0.0, 1.0], (size, 1))) is None


def test_a_set_of_another_size_is_refused():
    with pytest.raises(ValueError, match="a sphere takes 2 points"):
        Sphere.from_sample(np.zeros((3, 3)), np.ones((3, 3)))


def test_points_of_another_shape_are_refused():
    with pytest.raises(ValueError, match=r"\(n, 3\)"):
        TRUTHS[0].distance(np.zeros((4, 2)))


def test_distances_are_positive_outside():
    outside = np.array([[50.0, 2.0, 3.0]])
    assert all(truth.distance(outside)[0] > 0.0 for truth in TRUTHS[1:])
    assert TRUTHS[1].distance([[1.0, 2.0, 3.0]])[0] == -2.0


@every
def test_a_fit_recovers_the_primitive_from_noisy_points(truth):
    rng = np.random.default_rng(3)
    clean = on_surface(truth, 4000, rng)
    start = type(truth).from_row(truth.row + np.where(truth.row == 0.0, 0.0, 0.05))
    fitted = start.fit(clean + 0.003 * rng.normal(size=clean.shape))
    assert np.sqrt((fitted.distance(clean) ** 2).mean()) < 3e-4


@pytest.mark.parametrize("noise", [0.01, 0.1])
def test_a_radius_is_not_biased_by_more_than_theory_allows(noise):
    rng = np.random.default_rng(4)
    directions = rng.normal(size=(200_000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    points = 2.0 * directions + noise * rng.normal(size=directions.shape)
    radius = Sphere((0.1, 0.0, 0.0), 1.5).fit(points).radius
    assert radius == pytest.approx(2.0 + noise**2 / 2.0, abs=5e-4 + 3 * noise / np.sqrt(len(points)))


def test_weights_decide_what_is_fitted():
    rng = np.random.default_rng(5)
    low, high = (np.column_stack((rng.uniform(-1, 1, (500, 2)), np.full(500, z))) for z in (0.0, 1.0))
    points = np.concatenate((low, high))
    weights = np.repeat([1.0, 0.0], 500)
    fitted = Plane((0.0, 0.0, 0.4), (0.0, 0.6, 0.8)).fit(points, weights)
    assert np.abs(fitted.distance(low)).max() < 1e-9
    assert np.abs(fitted.distance(high)) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("size", "radius"), [((2.5, 9.0), 2.5), ((0.0, 1.5), 1.5), ((2.0, 2.0), 2.0), ((0.0, np.inf), 2.0)]
)
def test_size_limits_are_inclusive_and_hold_for_the_result(size, radius):
    points = on_surface(TRUTHS[2], 1000, np.random.default_rng(6))
    fitted = Cylinder((1.2, 2.0, 3.1), TRUTHS[2].axis, 5.0).fit(points, size=size)
    assert fitted.radius == pytest.approx(radius, abs=1e-6)
    assert size[0] <= fitted.radius <= size[1]


def test_bad_weights_and_limits_are_refused():
    with pytest.raises(ValueError, match="weights have shape"):
        TRUTHS[0].fit(np.zeros((5, 3)), np.ones(4))
    with pytest.raises(ValueError, match="is empty"):
        TRUTHS[1].fit(np.zeros((5, 3)), size=(2.0, 1.0))


def test_without_weight_the_start_stays():
    start = Sphere((0.0, 0.0, 0.0), 1.0)
    assert start.fit(np.ones((5, 3)), np.zeros(5)) == start

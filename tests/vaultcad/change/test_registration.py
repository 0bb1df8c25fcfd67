import numpy as np
import pytest

from vaultcad.change.registration import Registration, registered_on
from vaultcad.errors import VaultcadError


def room(rng, count=30_000, noise=0.002):
    """Floor and lower walls of a room of 5 × 4 m, with a door in one wall."""
    faces = []
    for share, corner, a, b in (
        (0.4, (0, 0, 0), (5, 0, 0), (0, 4, 0)),
        (0.15, (0, 0, 0), (5, 0, 0), (0, 0, 1.5)),
        (0.15, (0, 4, 0), (5, 0, 0), (0, 0, 1.5)),
        (0.15, (0, 0, 0), (0, 4, 0), (0, 0, 1.5)),
        (0.15, (5, 0, 0), (0, 4, 0), (0, 0, 1.5)),
    ):
        s, t = rng.uniform(0, 1, (2, int(share * count), 1))
        faces.append(np.array(corner) + s * np.array(a) + t * np.array(b))
    points = np.vstack(faces)
    points = points[~((points[:, 0] > 4.99) & (abs(points[:, 1] - 1) < 0.5))]
    return points + rng.normal(0, noise, points.shape)


def motion(turn, shift):
    c, s = np.cos(turn), np.sin(turn)
    out = np.eye(4)
    out[:2, :2], out[:3, 3] = [[c, -s], [s, c]], shift
    return out


@pytest.mark.parametrize("seed", range(5))
def test_a_motion_is_undone_within_its_stated_deviation(seed):
    rng = np.random.default_rng(seed)
    moved = motion(rng.uniform(-0.02, 0.02), rng.uniform(-0.05, 0.05, 3))
    there = room(rng) @ moved[:3, :3].T + moved[:3, 3]
    found = registered_on(room(rng), there, [np.eye(4)])
    spots = np.array([[0, 0, 0], [5, 4, 3], [2.5, 2, 4.0]])
    back = found(spots @ moved[:3, :3].T + moved[:3, 3]) - spots
    for way in np.eye(3):
        rows = found.rows(spots, np.tile(way, (3, 1)))
        std = np.sqrt(np.einsum("ni,ij,nj->n", rows, found.covariance, rows))
        assert (np.abs(back @ way) < 4 * std + 1e-4).all()
    assert np.abs(back).max() < 0.001


def test_furniture_that_was_moved_does_not_pull():
    rng = np.random.default_rng(7)
    box = rng.uniform(0, 1, (3000, 3)) * [1, 1, 0.02] + [1, 1, 0.8]
    found = registered_on(np.vstack([room(rng), box]), np.vstack([room(rng), box + [0.05, 0.03, 0.04]]), [np.eye(4)])
    assert np.abs(found.shift).max() < 0.001


def test_of_several_starts_that_is_taken_under_which_scans_meet():
    rng = np.random.default_rng(8)
    far = motion(2.0, (30.0, -20.0, 1.0))
    there = room(rng) @ far[:3, :3].T + far[:3, 3]
    found = registered_on(room(rng), there, [np.eye(4), np.linalg.inv(far)])
    assert np.abs(found.turn - far[:3, :3].T).max() < 1e-3


def test_scans_that_do_not_meet_are_refused():
    rng = np.random.default_rng(9)
    with pytest.raises(VaultcadError, match="two scans of the same room"):
        registered_on(room(rng), room(rng) + [40, 0, 0], [np.eye(4)])


def test_a_floor_alone_is_refused_as_it_can_slide():
    rng = np.random.default_rng(10)
    floor = np.column_stack([rng.uniform(0, 5, (20_000, 2)), rng.normal(0, 0.001, 20_000)])
    with pytest.raises(VaultcadError, match="slide"):
        registered_on(floor, floor + [0, 0, 0.01], [np.eye(4)])


def test_too_few_points_are_refused():
    with pytest.raises(VaultcadError, match="--registered"):
        registered_on(np.zeros((10, 3)), np.zeros((10, 3)), [np.eye(4)])


def test_what_is_registered_already_stays_where_it_is():
    points = np.array([[1.0, 2.0, 3.0]])
    given = Registration.exact(0.002)
    assert (given(points) == points).all()
    rows = given.rows(points, np.array([[0.0, 0.0, 1.0]]))
    assert np.sqrt(rows @ given.covariance @ rows.T).item() == pytest.approx(0.002)

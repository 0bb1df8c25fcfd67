"""Normals that come with a cloud are used if they are of use, whatever their sign and length, else estimated anew."""

import re
from functools import cache

import numpy as np
import pytest

from families import Barrel, Groin
from families.void.sampling import sample
from segmentation import compare, detect
from segmentation.given_normals import usable


def cloud(vault=None, n=60_000):
    made = sample(vault or Groin(6.0, 6.0), n, np.random.default_rng(0))
    return made.xyz, made.normals.astype(float), made.component.astype(int)


@cache
def estimated():
    """What is found without normals."""
    return detect(cloud()[0]).labels.tobytes()


def turned(normals, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return normals @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T


USELESS = {
    "zero": (lambda n, rng: 0 * n, "zero"),
    "nearly all zero": (lambda n, rng: n * (rng.random((len(n), 1)) < 0.2), "zero on 8[01]% of the points"),
    "not a number": (lambda n, rng: np.full_like(n, np.nan), "zero"),
    "all up": (lambda n, rng: np.tile([0, 0, 1.0], (len(n), 1)), "all the same"),
    "all along x, of any length": (lambda n, rng: rng.uniform(-2, 2, (len(n), 1)) * [1.0, 0, 0], "all the same"),
    "random": (lambda n, rng: rng.normal(size=n.shape), "off those of the surface on"),
    "of another axis up": (lambda n, rng: turned(n, 90), "off those of the surface on"),
    "in another order": (lambda n, rng: rng.permutation(n), "off those of the surface on"),
}


@pytest.mark.parametrize("kind", USELESS)
def test_useless_normals_are_estimated_anew_and_it_is_said(kind):
    xyz, normals, truth = cloud()
    change, reason = USELESS[kind]
    found = detect(xyz, change(normals, np.random.default_rng(1)))
    assert found.labels.tobytes() == estimated()
    (note,) = found.notes
    assert note.code == "normals"
    assert re.search(rf"are {reason}.*estimated anew", note.text)
    assert compare(found.labels, truth).least_iou > 0.95


FINE = {
    "as they are": lambda n, rng: n,
    "turned inside": lambda n, rng: -n,
    "of random sign": lambda n, rng: n * rng.choice([-1.0, 1.0], (len(n), 1)),
    "noisy": lambda n, rng: n + 0.1 * rng.normal(size=n.shape),
    "some zero": lambda n, rng: n * (rng.random((len(n), 1)) < 0.9),
}


@pytest.mark.parametrize("kind", FINE)
def test_good_normals_are_used(kind):
    xyz, normals, truth = cloud()
    found = detect(xyz, FINE[kind](normals, np.random.default_rng(1)))
    assert found.notes == ()
    assert compare(found.labels, truth).least_iou > 0.95


@pytest.mark.parametrize("length", [1000.0, 0.01])
def test_lengths_say_nothing(length):
    xyz, normals, _ = cloud()
    found = detect(xyz, length * normals)
    assert found.labels.tobytes() == detect(xyz, normals).labels.tobytes()
    assert "not of unit length" in found.notes[0].text


def test_on_a_plane_all_normals_are_the_same():
    rng = np.random.default_rng(2)
    xyz = np.column_stack([rng.uniform(0, 5, (20_000, 2)), 0.002 * rng.normal(size=20_000)])
    given, note = usable(xyz[:5000], np.tile([0, 0, 1.0], (5000, 1)))
    assert note is None
    np.testing.assert_allclose(given, np.tile([0, 0, 1.0], (5000, 1)))


def test_a_shallow_vault_is_no_plane():
    xyz, _, _ = cloud(Barrel(6.0, 9.0))
    _, note = usable(xyz[:8000], np.tile([0, 0, 1.0], (8000, 1)))
    assert note is not None


def test_a_stray_point_at_the_end_of_the_world_does_no_harm():
    xyz, normals, _ = cloud()
    found = detect(np.concatenate([xyz, [[3e9, 0, 0]]]), np.concatenate([normals, [[0, 0, 1.0]]]))
    assert found.labels[-1] == 0

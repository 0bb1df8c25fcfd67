"""Walls that belly are one plane each, whatever the limits of radii; the flattest vaults are none."""

from itertools import product

import numpy as np
import pytest

from families import Barrel, Sail
from families.declaration.profiles import Segmental
from families.void.sampling import sample
from segmentation import PRESETS, Settings, compare, detect

LIMITS = {
    "automatic": Settings(),
    "limits": Settings(sphere_r_max=20.0, cylinder_r_max=20.0),
    "planes": Settings(primitives=("plane",)),
    "all": Settings(primitives=("plane", "sphere", "cylinder", "cone", "torus")),
}
ROOMS = {"small": (3.0, 2.5, 2.5), "usual": (5.0, 4.0, 3.0), "long": (12.0, 4.0, 3.0)}
BULGES = {
    "along": lambda u, v: np.sin(np.pi * u),
    "upward": lambda u, v: 4.0 * v * (1.0 - v),
    "both ways": lambda u, v: np.sin(np.pi * u) * np.sin(np.pi * v),
    "inward": lambda u, v: -np.sin(np.pi * u) * np.sin(np.pi * v),
}


def room(size, bulge, belly, noise, seed=0, points=40_000):
    """Points of a room turned about the vertical, whose four walls belly [m], with noise [m]; normals of the walls;
    labels.
    """
    rng, (x, y, z) = np.random.default_rng(seed), size
    area = np.repeat([x * y, x * z, y * z], 2)
    face = np.sort(rng.choice(6, points, p=area / area.sum()))
    u, v = rng.random((2, points))
    across, side = face // 2, np.where(face % 2, 1.0, -1.0)
    out = np.where(side > 0.0, np.array([z, y, x])[across], 0.0)
    out += side * belly * BULGES[bulge](u, v) * (across > 0)
    axes = np.array([[0, 1, 2], [0, 2, 1], [1, 2, 0]])[across]
    xyz, normals, each = np.empty((points, 3)), np.zeros((points, 3)), np.arange(points)
    xyz[each, axes[:, 0]], xyz[each, axes[:, 1]] = u * np.where(across < 2, x, y), v * np.where(across == 0, y, z)
    xyz[each, axes[:, 2]], normals[each, axes[:, 2]] = out, 1.0
    turn = np.array([[np.cos(0.3), -np.sin(0.3), 0.0], [np.sin(0.3), np.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    return (xyz + noise * rng.normal(size=xyz.shape)) @ turn.T, normals @ turn.T, face + 1


@pytest.mark.parametrize(
    ("size", "bulge", "limits"),
    [
        *product(ROOMS, BULGES, ["automatic"]),
        *product(["long"], BULGES, [name for name in LIMITS if name != "automatic"]),
    ],
)
def test_a_wall_that_bellies_is_one_plane(size, bulge, limits):
    for seed, (belly, noise, given) in enumerate([(0.02, 0.005, True), (0.03, 0.001, False)]):
        xyz, normals, truth = room(ROOMS[size], bulge, belly, noise, seed)
        found = detect(xyz, normals if given else None, LIMITS[limits], np.random.default_rng(seed))
        assert [s.primitive.name for s in found.shapes] == ["plane"] * 6
        assert compare(found.labels, truth).least_iou > 0.95


@pytest.mark.parametrize("bulge", BULGES)
def test_a_wall_that_bellies_by_more_than_epsilon_is_one_plane_too(bulge):
    xyz, _, _ = room(ROOMS["usual"], bulge, 0.03, 0.003)
    found = detect(xyz, settings=PRESETS["mirror-real"])  # epsilon 0.010 m
    assert [s.primitive.name for s in found.shapes] == ["plane"] * 6


def test_the_plane_of_a_wall_is_that_of_least_squares_and_the_rms_is_from_it():
    xyz, _, _ = room(ROOMS["usual"], "along", 0.03, 0.002)
    for segment in (found := detect(xyz)).shapes:
        mine = xyz[found.labels == segment.id]
        assert segment.rms == pytest.approx(np.sqrt((segment.primitive.distance(mine) ** 2).mean()), rel=1e-6)
        assert segment.rms == pytest.approx(np.sqrt(np.linalg.eigvalsh(np.cov(mine.T))[0]), rel=0.02)
    walls = [s.rms for s in found.shapes if abs(s.primitive.direction[2]) < 0.1]
    assert walls == pytest.approx([np.hypot(0.03 * 0.308, 0.002)] * 4, rel=0.05)  # a half wave's deviation is 0.308


@pytest.mark.parametrize("kinds", [("sphere",), ("cylinder",), ("sphere", "cylinder")], ids="+".join)
@pytest.mark.parametrize("largest", [3.0, np.inf])
def test_walls_that_belly_are_nothing_where_planes_are_off(kinds, largest):
    for bulge in BULGES:
        xyz, _, _ = room(ROOMS["usual"], bulge, 0.03, 0.002)
        found = detect(xyz, settings=Settings(primitives=kinds, sphere_r_max=largest, cylinder_r_max=largest))
        assert found.shapes == ()
        assert not found.labels.any()


@pytest.mark.parametrize("sunk", [0.0, 0.025])
@pytest.mark.parametrize(
    ("vault", "name"),
    [
        (Barrel(4.0, 3.0, Segmental(0.06)), "cylinder"),
        (Barrel(4.0, 12.0, Segmental(0.06)), "cylinder"),
        (Barrel(3.0, 3.0, Segmental(0.05)), "cylinder"),
        (Sail(6.0, 6.0, 0.1), "sphere"),
    ],
    ids=["barrel", "long barrel", "flattest barrel", "flattest sail"],
)
def test_a_shallow_vault_is_no_wall(vault, name, sunk):
    made = sample(vault, 60_000, np.random.default_rng(0))
    xyz = made.xyz + 0.003 * np.random.default_rng(1).normal(size=made.xyz.shape)
    xyz[:, 2] -= sunk * np.cos(3.0 * made.xyz[:, :2] / np.ptp(made.xyz[:, :2], axis=0)).prod(axis=1)
    assert [s.primitive.name for s in detect(xyz).shapes] == [name]

"""A vault over the crowns of others, without a wall between, is a part of something else."""

from __future__ import annotations

import numpy as np

from families import Barrel, Groin, Segmental
from vaultcad.find.footing import on_ceilings
from vaultcad.find.misfit import FITS, UNBORNE
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.survey.thinned_scan import Thin

POSE = Pose(1.0, 2.0, 3.0, 0.4)
MIDDLE = Barrel(3.6, 6.0)


def in_place(local: np.ndarray, normals: np.ndarray) -> Thin:
    frame = POSE.frame()
    xyz = (local - frame[:, 3]) @ frame[:, :3]
    return Thin(xyz, normals @ frame[:, :3], np.ones(len(xyz)), 0.05)


def with_lobes(step: float, apart: float, wall: float) -> Thin:
    """The barrel, and beside it the inner halves of two lesser ones, their crowns under its springings [m].

    wall: how high the wall is that it stands on [m].
    """
    rng = np.random.default_rng(1)
    across = int(np.argmin(np.abs(MIDDLE.plan.half - 1.8)))
    middle, lobe = MIDDLE.sample(8_000, rng), Barrel(2.4, 6.0).sample(16_000, rng)
    parts = [(middle.xyz, middle.normals)]
    for side in (-1.0, 1.0):
        half = side * lobe.xyz[:, across] > 0
        shift = np.array([0.0, 0.0, -1.2 - step])
        shift[across] = side * (1.8 + apart)
        parts.append((lobe.xyz[half] + shift, lobe.normals[half]))
        u, z = np.meshgrid(np.arange(-3, 3, 0.05), np.arange(-wall, 0, 0.05))
        face = np.zeros((u.size, 3))
        face[:, across], face[:, 1 - across], face[:, 2] = side * 1.8, u.ravel(), z.ravel()
        normal = np.zeros((u.size, 3))
        normal[:, across] = side
        parts.append((face, normal))
    local, normals = (np.concatenate(column) for column in zip(*parts, strict=True))
    return in_place(local, normals)


def test_the_middle_lobe_of_a_trefoil_is_doubted() -> None:
    placed = Placed(MIDDLE, POSE)
    for step in (0.0, 0.1, 0.25):
        share = on_ceilings(placed, with_lobes(step, 0.0, wall=step))
        assert share > 0.9
        doubted = FITS.with_sign(UNBORNE, share)
        assert doubted.chance > 0.8
        assert "springings are over another ceiling" in doubted.reason


def test_a_nave_on_its_walls_is_not_nor_one_beside_which_aisles_stand_apart() -> None:
    placed = Placed(MIDDLE, POSE)
    for thin in (with_lobes(0.6, 0.0, wall=0.6), with_lobes(0.1, 0.5, wall=0.0)):
        assert on_ceilings(placed, thin) < 0.1
    assert FITS.with_sign(UNBORNE, 0.3).chance == 0.0


def test_vaults_that_spring_where_their_neighbours_do_stand_on_what_these_stand_on() -> None:
    rng = np.random.default_rng(1)
    flat = Barrel(3.6, 6.0, Segmental(0.15))
    across = int(np.argmin(np.abs(flat.plan.half - 1.8)))
    sample = flat.sample(8_000, rng)
    beside = np.zeros(3)
    beside[across] = 3.6
    rows = np.concatenate([sample.xyz, sample.xyz + beside, sample.xyz - beside])
    assert on_ceilings(Placed(flat, POSE), in_place(rows, np.tile(sample.normals, (3, 1)))) < 0.1
    groin = Groin(5.0, 4.5)
    sample = groin.sample(8_000, rng)
    assert on_ceilings(Placed(groin, POSE), in_place(sample.xyz, sample.normals)) == 0.0

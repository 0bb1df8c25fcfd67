"""Piers as a model has them: how high, how sure, once each."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from families import Barrel
from vaultcad.measure.piers import piers_under
from vaultcad.model import FittedVault
from vaultcad.pose import Pose
from vaultcad.survey.thinned_scan import Thin
from vaultcad.uncertain import Covariance

STEP = 0.05  # m
DIAMETER = 0.4  # m


@pytest.fixture
def column() -> Thin:
    """A round one of 6 m in the middle of a floor at 0.1 m."""
    angle, z = (grid.ravel() for grid in np.meshgrid(np.arange(0, 2 * np.pi, 0.2), np.arange(0.1, 6.0, STEP)))
    out = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(len(angle))])
    shaft = out * DIAMETER / 2 + z[:, None] * [0.0, 0.0, 1.0]
    floor = np.stack(np.meshgrid(*[np.arange(-4, 4, STEP)] * 2, [0.1]), axis=-1).reshape(-1, 3)
    points, normals = np.concatenate([shaft, floor]), np.concatenate([out, np.tile([0.0, 0.0, 1.0], (len(floor), 1))])
    points = points + np.random.default_rng(1).normal(0, 0.002, points.shape)
    return Thin(points, normals, np.full(len(points), 3.0), STEP)


@pytest.fixture
def vault(make_model):
    """Makes a barrel whose north-east corner is over the middle, by its springing and how unsure that is [m]."""

    def made(springing: float, std: float) -> FittedVault:
        (fitted,) = make_model("barrel").vaults
        matrix = np.diag([1e-6, 1e-6, std**2, 1e-6])
        return dataclasses.replace(
            fitted,
            vault=Barrel(span=4.0, length=6.0),
            pose=Pose(-2.1, -3.1, springing, 0.0),
            covariance=Covariance(("x", "y", "z", "yaw"), matrix),
        )

    return made


def test_a_column_reaches_to_the_springing_that_is_known(column, vault):
    (pier,) = piers_under([vault(3.0, 0.005), vault(2.8, 0.3)], [], column)
    assert pier.plan == "round"
    assert pier.size == pytest.approx((DIAMETER, DIAMETER, 2.9), abs=0.005)
    assert (pier.pose.x, pier.pose.y, pier.pose.z) == pytest.approx((0.0, 0.0, 0.1), abs=0.003)
    assert 0.005 <= pier.parameters["height"].std < 0.007
    assert pier.deviation.rms < 0.003
    assert pier.points > 500


def test_a_column_under_vaults_of_unequal_springings_is_one_and_ends_at_the_lowest(column, vault):
    (pier,) = piers_under([vault(5.0, 0.005), vault(3.0, 0.005)], [], column)
    assert pier.size[2] == pytest.approx(2.9, abs=0.005)


def test_without_vaults_there_is_none(column):
    assert piers_under([], [], column) == ()

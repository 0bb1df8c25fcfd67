"""Ideal vault → cloud → fit → the same parameters, over all families."""

from __future__ import annotations

from math import pi, remainder

import numpy as np
import pytest

from families import (
    Annular,
    Barrel,
    Cloister,
    Conch,
    Dome,
    Groin,
    Lunette,
    Mirror,
    Pointed,
    Rib,
    Rotunda,
    Sail,
    Segmental,
    Semicircular,
    Trough,
    Umbrella,
    Vault,
)
from segmentation import compare
from segmentation.cloud import Cloud
from vaultcad.pipeline import fit_scan
from vaultcad.pose import Pose

POSE = Pose(1.2, -0.7, 3.1, 0.4)
DENSE = (Barrel, Lunette, Annular)  # whose ends or rims no wall and no corner tells: their outermost points do
IDEALS = (
    Sail(5.2, 4.4, 0.8),
    Barrel(4.8, 7.3, Pointed(0.7)),
    Lunette(5.4, 9.6, Segmental(0.35), 3, 0.94, 0.0, 0.85, 0.3),
    Trough(4.8, 8.0, Segmental(0.42), 0.6, 0.55),
    Mirror(4.6, 7.0, 0.5, 0.4, 0.8, 1.0),
    Groin(4.2, 4.6, Segmental(0.4), Segmental(0.37)),
    Dome(2.6, Semicircular(), 0.42, 0.0),
    Rotunda(2.8, Segmental(0.4)),
    Conch(2.4, Pointed(0.7)),
    Annular(5.5, 0.5, 2.3, Semicircular()),
    Annular(5.5, 0.5, 2 * pi, Segmental(0.3)),
    Cloister(8, 2.7, Segmental(0.4)),
    Cloister(5, 2.7, Semicircular()),
    Cloister(8, 2.7, Segmental(0.4), 0.3, crossing=1),
    Cloister(8, 2.7, Semicircular(), 0.4, crossing=2),
    Barrel(4.8, 7.3, Pointed(0.7), slope=0.3),
    Rib(4.6, 5.4, Pointed(0.75), Pointed(0.62), Semicircular()),
    Umbrella(8, 2.7, Segmental(0.3), Semicircular()),
)


def same_again(truth: Vault) -> float:
    """The least angle by which it may be turned and be the same, its components in another order [rad]; 0 for any."""
    if truth.plan.turns:
        return 0.0
    if isinstance(truth, Cloister):
        return pi / 2 if truth.crossing else 2 * pi / truth.sides
    if isinstance(truth, Umbrella):
        return 2 * pi / truth.sides
    return 2 * pi


@pytest.mark.parametrize("truth", IDEALS, ids=lambda v: v.id)
def test_the_fit_of_an_ideal_cloud_returns_every_parameter_within_a_millimetre(truth: Vault) -> None:
    sample = truth.sample(1_000_000 if isinstance(truth, DENSE) else 300_000, np.random.default_rng(3))
    turn = POSE.placement()
    xyz = (sample.xyz @ turn[:3, :3].T + turn[:3, 3]).astype(np.float32)

    result = fit_scan(Cloud(xyz))

    fitted = result.model.vaults[0]
    assert type(fitted.vault) is type(truth)
    assert {**fitted.vault.values(), **fitted.vault.derived_values()} == pytest.approx(
        {**truth.values(), **truth.derived_values()}, abs=1e-3
    )
    assert (fitted.pose.x, fitted.pose.y, fitted.pose.z) == pytest.approx((POSE.x, POSE.y, POSE.z), abs=1e-3)
    if (turn := same_again(truth)) > 0:
        assert remainder(fitted.pose.yaw - POSE.yaw, turn) == pytest.approx(0, abs=1e-3)
    # Half of a drum over a crossing stands in one plane with the walls under it, which take it.
    flush = isinstance(truth, Cloister) and truth.crossing > 0
    assert compare(result.labels.component, sample.component).mean_iou > (0.9 if flush else 0.998)
    assert fitted.deviation.p95 < 1e-3
    assert fitted.coverage > (0.92 if flush else 0.99)

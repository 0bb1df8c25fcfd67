"""Ideal vault → cloud → fit → the same parameters, over all families."""

from __future__ import annotations

import numpy as np
import pytest

from families import Barrel, Dome, Groin, Lunette, Mirror, Pointed, Sail, Segmental, Semicircular, Trough, Vault
from segmentation.cloud import Cloud
from vaultcad.model import Pose
from vaultcad.pipeline import fit_scan

POSE = Pose(1.2, -0.7, 3.1, 0.4)
IDEALS = (
    Sail(5.2, 4.4, 0.8),
    Barrel(4.8, 7.3, Pointed(0.7)),
    Lunette(5.4, 9.6, Segmental(0.35), 3, 0.94, 0.0, 0.85, 0.3),
    Trough(4.8, 8.0, Segmental(0.42), 0.6, 0.55),
    Mirror(4.6, 7.0, 0.5, 0.4, 0.8, 1.0),
    Groin(4.2, 4.6, Segmental(0.4), Segmental(0.37)),
    Dome(2.6, Semicircular(), 0.42, 0.0),
)


@pytest.mark.parametrize("truth", IDEALS, ids=lambda v: v.id)
def test_the_fit_of_an_ideal_cloud_returns_every_parameter_within_a_millimetre(truth: Vault) -> None:
    sample = truth.sample(1_000_000, np.random.default_rng(3))
    turn = POSE.placement()
    xyz = (sample.xyz @ turn[:3, :3].T + turn[:3, 3]).astype(np.float32)

    result = fit_scan(Cloud(xyz))

    fitted = result.model.vaults[0]
    assert type(fitted.vault) is type(truth)
    assert {**fitted.vault.values(), **fitted.vault.derived_values()} == pytest.approx(
        {**truth.values(), **truth.derived_values()}, abs=1e-3
    )
    assert (fitted.pose.x, fitted.pose.y, fitted.pose.z) == pytest.approx((POSE.x, POSE.y, POSE.z), abs=1e-3)
    assert fitted.pose.yaw == pytest.approx(POSE.yaw, abs=1e-3)
    assert (result.labels.component == sample.component).mean() > 0.999
    assert fitted.deviation.p95 < 1e-3
    assert fitted.coverage > 0.99

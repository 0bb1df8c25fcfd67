"""Two vaults cannot hang in one place: the one that reaches into the other is too large."""

from __future__ import annotations

import numpy as np
import pytest

from families import Barrel, Groin, Segmental, Vault
from vaultcad.find.misfit import FITS, OVERLAID
from vaultcad.find.overlaid import overlaid
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose

SPAN, LENGTH = 3.0, 5.0
ONE = Barrel(SPAN, LENGTH, Segmental(0.2))
ACROSS = np.eye(3)[int(np.argmin(np.abs(ONE.plan.half - SPAN / 2)))]


def beside(vault: Vault, step: float, rise: float = 0.0) -> tuple[Placed, np.ndarray]:
    """A vault so far across and upwards [m], and its stone."""
    away = step * ACROSS + [0.0, 0.0, rise]
    stone = vault.sample(8_000, np.random.default_rng(1)).xyz + away
    return Placed(vault, Pose(*away.tolist(), 0.0)), stone


@pytest.mark.parametrize("step", [SPAN, SPAN + 0.4])
def test_neighbours_are_not_in_each_others_place(step: float) -> None:
    found = [beside(ONE, k * step) for k in range(3)]
    shares = overlaid([(placed, 0.03) for placed, _ in found], np.concatenate([stone for _, stone in found]))
    assert max(shares) < 0.02


def test_a_vault_that_reaches_into_the_next_is_doubted_and_that_is_not() -> None:
    _, own = beside(ONE, 0.0)
    second, other = beside(ONE, SPAN)
    wide = Placed(Barrel(1.5 * SPAN, LENGTH, Segmental(0.1)), Pose(*(SPAN / 4 * ACROSS).tolist(), 0.0))
    shares = overlaid([(wide, 0.03), (second, 0.03)], np.concatenate([own, other]))
    assert shares[0] > 0.25
    assert shares[1] < 0.02
    doubted = FITS.with_sign(OVERLAID, shares[0])
    assert doubted.chance > 0.6
    assert doubted.reason == f"another vault hangs over {shares[0]:.0%} of its plan"


def test_storeys_are_not_in_each_others_place() -> None:
    low, below = beside(ONE, 0.0)
    high, above = beside(Groin(SPAN, LENGTH), 0.0, rise=2.5)
    shares = overlaid([(low, 0.03), (high, 0.03)], np.concatenate([below, above]))
    assert max(shares) == 0.0

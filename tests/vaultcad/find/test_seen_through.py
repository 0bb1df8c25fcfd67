"""A vault through which other stone is seen is not there."""

import numpy as np
import pytest

from families import Barrel, Dome, Groin, Vault
from vaultcad.find.misfit import FITS, SEEN_THROUGH
from vaultcad.find.seen_through import seen_through
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose

POSE = Pose(1.0, 2.0, 3.0, 0.4)


def in_place(local: np.ndarray) -> np.ndarray:
    frame = POSE.frame()
    return (local - frame[:, 3]) @ frame[:, :3]


@pytest.mark.parametrize("vault", [Barrel(4.0, 6.0), Groin(5.0, 4.5), Dome()], ids=lambda v: v.id)
def test_a_storey_above_and_a_shadow_are_not_seen_through_a_vault(vault: Vault) -> None:
    seen = vault.sample(8_000, np.random.default_rng(1)).xyz
    storey = seen + [0.0, 0.0, 3.0]
    shaded = seen[seen[:, 0] < 0.3]
    for local in (seen, np.concatenate([seen, storey]), shaded):
        assert seen_through(Placed(vault, POSE), in_place(local)) < 0.02
    assert seen_through(Placed(vault, POSE), in_place(storey)) > 0.9


def test_half_a_barrel_with_another_vault_over_its_other_half_is_doubted() -> None:
    lobe = Barrel(2.4, 9.0)
    seen = lobe.sample(8_000, np.random.default_rng(1)).xyz
    middle = seen * [1.0, 1.0, 0.2] + [0.0, 0.0, 1.6]
    across = 0 if lobe.plan.half[0] == pytest.approx(1.2) else 1
    lobed = np.concatenate([seen[seen[:, across] > 0], middle[middle[:, across] < 0]])
    through = seen_through(Placed(lobe, POSE), in_place(lobed))
    assert through == pytest.approx(0.5, abs=0.05)
    doubted = FITS.with_sign(SEEN_THROUGH, through)
    assert doubted.chance > 0.8
    assert doubted.reason.startswith("other stone is seen through")
    assert (FITS.with_sign(SEEN_THROUGH, 0.15).chance, FITS.with_sign(SEEN_THROUGH, 0.15).reason) == (0.0, "")

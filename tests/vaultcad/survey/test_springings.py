"""The level at which an arch springs, seen where the stone below its soffit ends."""

from __future__ import annotations

import numpy as np
import pytest

from families import Profile, Segmental, Semicircular
from vaultcad.scanner.building.elements import outline
from vaultcad.survey.plan_grid import Laid, PlanGrid
from vaultcad.survey.soffits import Soffit
from vaultcad.survey.springings import Springing, springings

SPRINGS, WIDTH, NOISE = 2.4, 0.42, 0.003  # m
SEEN = 0.25  # m above its springing from where on a soffit is taken for one

FEET = {"jamb": (np.inf, 0.0), "pier": (np.inf, 0.03), "capital": (0.15, 0.03)}  # m: how deep, how far out it stands


def arch(profile: Profile, span: float, foot: str, rng: np.random.Generator) -> np.ndarray:
    """Points (n, 3) [m] of the soffit of an arch along x, and of what is under its ends."""
    right = outline(profile, span / 2, profile.rise(span / 2))
    steps = np.hypot(*np.diff(right, axis=0).T)
    at = rng.uniform(0, steps.sum(), int(2000 * steps.sum()))
    length = np.concatenate([[0.0], np.cumsum(steps)])
    soffit = np.column_stack([np.interp(at, length, right[:, 0]), np.interp(at, length, right[:, 1])])
    deep, proud = FEET[foot]
    below = -rng.uniform(0, 1.2, 2400)
    face = np.where(below > -deep, span / 2 - proud, span / 2 + 0.1) * rng.choice([-1, 1], len(below))
    curve = np.concatenate([soffit, np.column_stack([face, below])])
    points = np.column_stack([curve[:, 0], rng.uniform(-WIDTH / 2, WIDTH / 2, len(curve)), curve[:, 1] + SPRINGS])
    return np.asarray(points + NOISE * rng.standard_normal(points.shape))


def seen(points: np.ndarray) -> tuple[Springing, ...]:
    """Where the arch over such points springs, its soffit found from a little above on."""
    x, z = points[points[:, 2] > SPRINGS + SEEN][:, [0, 2]].T
    bins = np.floor(x / 0.1)
    curve = np.array([[x[bins == k].mean(), np.median(z[bins == k])] for k in np.unique(bins)])
    soffit = Soffit(np.zeros(2), 0.0, float(np.ptp(x)), WIDTH, curve)
    grid = PlanGrid.over(points[:, :2].min(axis=0), points[:, :2].max(axis=0), 0.5)
    (found,) = springings((soffit,), Laid.over(grid, points))
    return found


@pytest.mark.parametrize("foot", FEET)
@pytest.mark.parametrize("profile", [Segmental(0.3), Segmental(0.4), Segmental(0.45)], ids=str)
def test_a_springing_is_seen_where_the_face_below_it_ends(profile: Profile, foot: str) -> None:
    for seed in range(2):
        feet = seen(arch(profile, 3.2, foot, np.random.default_rng(seed)))
        assert len(feet) == 2
        for one in feet:
            assert one.place[2] == pytest.approx(SPRINGS, abs=3 * one.std)
            assert abs(abs(one.place[0]) - 1.6) < 0.04
            assert one.std < 0.03


def test_a_semicircle_springs_at_no_level_that_is_far_off() -> None:
    """No crease is there: the stone only begins to bend."""
    for seed in range(2):
        for one in seen(arch(Semicircular(), 3.2, "jamb", np.random.default_rng(seed))):
            assert one.place[2] == pytest.approx(SPRINGS, abs=3 * one.std)


def test_nothing_is_said_where_nothing_is_seen_below_a_soffit() -> None:
    points = arch(Segmental(0.4), 3.2, "jamb", np.random.default_rng(0))
    assert not seen(points[points[:, 2] > SPRINGS + 0.1])

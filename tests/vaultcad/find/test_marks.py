"""What the springings of arches beside a vault tell of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import Barrel, Dome, Groin, Sail, Segmental, Semicircular, Vault
from families.declaration.lengths import with_lengths
from tests.vaultcad.find.test_choices import fitted, given_way, stone
from vaultcad.find.choices import Choice, weigh
from vaultcad.find.likelihood import Field
from vaultcad.fit.freedom import NONE
from vaultcad.survey.springings import Springing

SURE = 0.008  # m, standard deviation of a level
NEARLY_ROUND = Groin(3.7, 3.55, Segmental(0.432), Segmental(0.4507))


def told(vault: Vault, seed: int, off: float = 0.0) -> tuple[tuple[float, float], tuple[float, float]]:
    """Rise and its deviation [m] without and with levels at the corners of a vault, so much too high, that settled."""
    rng = np.random.default_rng(seed)
    corners = np.column_stack([vault.corners, np.zeros(len(vault.corners))])
    points = given_way(vault, np.concatenate([stone(vault, 2000, rng), corners]), 0.005, rng)
    levels = points[-len(corners) :] + SURE * rng.standard_normal(corners.shape) * (0, 0, 1) + (0, 0, off)
    refined = fitted(vault, points[: -len(corners)])
    known = (Choice(refined.placed, refined.kept, 1.0, {}),)
    feet = [Springing(place, SURE) for place in levels]
    alone, beside = (weigh(refined, NONE, np.random.default_rng(0), known, marks) for marks in ((), feet))
    return alone[0].sizes["rise"], beside[0].sizes["rise"]


@pytest.mark.parametrize(
    "vault",
    [NEARLY_ROUND, with_lengths(Sail(3.7, 3.55), {"rise": 2.0})],
    ids=lambda one: one.id,
)
def test_where_arches_spring_tells_the_rise_of_what_is_nearly_round(vault: Vault) -> None:
    true = vault.derived_values()["rise"]
    alone, beside = told(vault, 1)
    assert abs(beside[0] - true) < 0.02
    assert beside[1] < 0.9 * alone[1]


def test_levels_that_a_vault_does_not_spring_from_do_not_draw_it_there() -> None:
    """As where it is stilted, or the ledge seen is another's."""
    alone, beside = told(Groin(3.7, 3.55, Segmental(0.3), Segmental(0.3127)), 1, off=0.25)
    assert beside[0] == pytest.approx(alone[0], abs=0.005)


def test_without_levels_all_is_as_it_was() -> None:
    rng = np.random.default_rng(4)
    points = given_way(NEARLY_ROUND, stone(NEARLY_ROUND, 1500, rng), 0.01, rng)
    refined = fitted(NEARLY_ROUND, points)
    far = [Springing(np.array([9.0, 9.0, 0.0]), SURE), Springing(np.array([1.85, 1.775, 1.5]), SURE)]
    known = (Choice(refined.placed, refined.kept, 1.0, {}),)
    alone, beside = (weigh(refined, NONE, np.random.default_rng(0), known, feet) for feet in ((), far))
    assert [(one.kinds, one.chance, one.sizes) for one in alone] == [
        (one.kinds, one.chance, one.sizes) for one in beside
    ]


@pytest.mark.parametrize("vault", [Dome(2.0, Semicircular(), 0.4), Barrel(3.0, 4.0, slope=0.5)], ids=lambda one: one.id)
def test_what_does_not_spring_at_one_level_is_not_told_by_one(vault: Vault) -> None:
    rng = np.random.default_rng(5)
    refined = fitted(vault, stone(vault, 1500, rng))
    x, y = vault.corners[0] if len(vault.corners) else (0.0, 0.0)
    field = Field.of(refined, rng, [Springing(np.array([x, y, 0.0]), SURE)])
    assert field is not None
    assert len(field.marks.level) == 0


def test_one_level_that_is_off_all_others_does_not_count() -> None:
    rng = np.random.default_rng(6)
    refined = fitted(NEARLY_ROUND, stone(NEARLY_ROUND, 1500, rng))
    feet = [Springing(np.array([*corner, 0.0]), SURE) for corner in NEARLY_ROUND.corners]
    feet[2] = replace(feet[2], place=feet[2].place + (0.0, 0.0, 0.3))
    field = Field.of(refined, rng, feet)
    assert field is not None
    assert field.marks.level.tolist() == [0.0] * 3

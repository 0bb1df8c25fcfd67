"""Which arches and constraints a vault was built with: odds, what is said of them, and the deviation that they mean."""

from __future__ import annotations

from dataclasses import replace
from math import inf, sqrt

import numpy as np
import pytest

from families import (
    Barrel,
    BasketHandle,
    Dome,
    Elliptical,
    Groin,
    Mirror,
    Pointed,
    Sail,
    Segmental,
    Semicircular,
    Stilted,
    Trough,
    Vault,
)
from families.declaration.constraints import Constraint
from vaultcad.find.choices import Choice, deviation, kinds_of, likeliest, odds, rivals, weigh, widened
from vaultcad.find.likelihood import near_edges
from vaultcad.find.refine import Refined, settled
from vaultcad.fit.evidence import Evidence
from vaultcad.fit.freedom import NONE, Demands
from vaultcad.fit.solve import POSE, Placed
from vaultcad.model import said
from vaultcad.pose import Pose
from vaultcad.uncertain import Covariance

STANDS = Pose(0.0, 0.0, 0.0, 0.0)


def stone(vault: Vault, count: int, rng: np.random.Generator) -> np.ndarray:
    """Points (n, 3) on a vault and its walls, with 2 mm of noise."""
    on, half = vault.sample(count, rng).xyz, (vault.plan.half_x, vault.plan.half_y)
    side = rng.choice([-1.0, 1.0], count // 2)
    walls = np.column_stack([side, rng.uniform(-1, 1, (count // 2, 1)), rng.uniform(-1.5, 0, (count // 2, 1))])
    walls[::2, :2] = walls[::2, 1::-1]
    walls[:, :2] *= half
    return np.asarray(np.concatenate([on, walls]) + 0.002 * rng.standard_normal((len(on) + len(walls), 3)))


def given_way(vault: Vault, points: np.ndarray, size: float, rng: np.random.Generator) -> np.ndarray:
    """Points moved by about `size` [m]: the springings outwards, the crown down, and all by a few long waves."""
    height = np.clip(points[:, 2:] / vault.derived_values()["rise"], 0, 1)
    xy = np.clip(points[:, :2] / (vault.plan.half_x, vault.plan.half_y), -1, 1)
    moved = np.column_stack([xy * (1 - height), -height]) * rng.uniform(1, 2, 3)
    for _ in range(4):
        way = rng.standard_normal(3)
        way *= 2 * np.pi / rng.uniform(4, 12) / np.linalg.norm(way)
        moved += np.cos(points @ way + rng.uniform(0, 7))[:, None] * rng.standard_normal(3) / 3
    return np.asarray(points + size * moved)


def fitted(vault: Vault, points: np.ndarray, kept: tuple[Constraint, ...] | None = None) -> Refined:
    """The fit of a vault to points, with the constraints that it fulfils."""
    if kept is None:
        values = vault.values()
        kept = tuple(c for c in vault.constraints if all(values[k] == v for k, v in c.holds(vault).items()))
    evidence = Evidence(points, np.ones(len(points)), -inf)
    return settled(Placed(vault, STANDS), kept, evidence, 0.01)


def choices_of(
    vault: Vault, size: float, seed: int, *, count: int = 4000, demands: Demands = NONE
) -> tuple[Choice, ...]:
    """The choices for a vault that has settled by about `size` [m]."""
    rng = np.random.default_rng(seed)
    points = given_way(vault, stone(vault, count, rng), size, rng)
    return weigh(fitted(vault, points), demands, rng)


SETTLED: tuple[Vault, ...] = (
    Barrel(5.0, 8.0, Semicircular()),
    Barrel(5.0, 8.0, Segmental(0.35)),
    Barrel(5.0, 8.0, Pointed(0.75)),
    Barrel(5.0, 8.0, BasketHandle(0.35, 0.6)),
    Barrel(5.0, 8.0, Elliptical(0.35)),
    Barrel(5.0, 8.0, Stilted(0.58)),
    Trough(4.5, 7.0, Semicircular()),
    Groin(5.0, 5.0, Semicircular(), Semicircular()),
    Groin(4.6, 5.4, Segmental(0.4), Segmental(0.34)),
    Dome(2.5, Semicircular(), 0.4),
)


def name_of(vault: Vault) -> str:
    return "-".join([vault.id, *(arch.id for arch in vault.profiles.values())])


@pytest.mark.parametrize("vault", SETTLED, ids=name_of)
def test_the_true_arch_is_among_those_said_once_the_vault_has_settled(vault: Vault) -> None:
    told = odds(choices_of(vault, 0.015, 1))
    for name, arch in vault.profiles.items():
        assert arch.id in said(told[name])
        assert sum(told[name].values()) == pytest.approx(1)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_semicircle_that_has_settled_is_not_called_a_segment(seed: int) -> None:
    barrel = Barrel(5.0, 8.0, Semicircular())
    choices = choices_of(barrel, 0.02, seed)
    assert choices[0].kinds == (Semicircular,)
    told = odds(choices)["profile"]
    assert len(said(told)) > 1, "a settled semicircle is never certain"
    rise = choices[0].placed.vault.derived_values()["rise"]
    spread = deviation("rise", rise, 0.02, choices)
    assert abs(rise - 2.5) < 2 * spread
    assert spread > 0.03, "what the other kinds would make of it"


def test_a_pointed_arch_is_named_alone() -> None:
    assert said(odds(choices_of(Barrel(5.0, 8.0, Pointed(0.8)), 0.01, 2))["profile"]) == ("pointed",)


@pytest.mark.parametrize("vault", [Sail(4.2, 4.6, 0.7), Mirror(4.2, 4.6, 0.5, 0.5, 0.8, 0.8)], ids=name_of)
def test_vaults_without_arches_have_choices_of_constraints_alone(vault: Vault) -> None:
    choices = choices_of(vault, 0.01, 1)
    assert odds(choices) == {}
    assert sum(choice.chance for choice in choices) == pytest.approx(1)
    assert {choice.kinds for choice in choices} == {()}
    assert len(choices) == 1 or vault.constraints


def test_stone_tells_arches_but_for_the_last_hand_before_an_edge() -> None:
    """A little above the springing, segments that are almost semicircles differ most from these."""
    placed = Placed(Barrel(5.0, 8.0, Segmental(0.45)), STANDS)
    on = placed.vault.sample(20_000, np.random.default_rng(0)).xyz
    foot = near_edges(placed, on[(on[:, 2] < 0.05) & (np.abs(on[:, 1]) < 3.0)])
    hand = near_edges(placed, on[(on[:, 2] > 0.2) & (on[:, 2] < 0.3) & (np.abs(on[:, 1]) < 3.0)])
    assert len(foot) > 50
    assert foot.all()
    assert len(hand) > 50
    assert not hand.any()


def test_the_same_fit_has_the_same_choices() -> None:
    one, two = (choices_of(SETTLED[0], 0.01, 5) for _ in range(2))
    assert [(c.chance, c.sizes) for c in one] == [(c.chance, c.sizes) for c in two]


def test_too_little_stone_tells_nothing_and_leaves_the_fit_as_it_is() -> None:
    barrel = Barrel(5.0, 8.0, Semicircular())
    refined = fitted(barrel, stone(barrel, 12, np.random.default_rng(0)))
    assert weigh(refined, NONE, np.random.default_rng(0)) == ()
    assert likeliest(refined, (), NONE) is refined


@pytest.mark.parametrize("demands", [Demands(sizes={"rise": 2.4}), Demands(pose={"z": 0.0})], ids=["rise", "z"])
def test_what_a_user_fixes_holds_in_every_choice(demands: Demands) -> None:
    barrel = Barrel(5.0, 8.0, Segmental(0.48))
    rng = np.random.default_rng(3)
    points = given_way(barrel, stone(barrel, 4000, rng), 0.02, rng)
    evidence = Evidence(points, np.ones(len(points)), -inf)
    choices = weigh(settled(Placed(barrel, STANDS), (), evidence, 0.01, demands), demands, rng)
    assert len(choices) > 1
    for choice in choices:
        sizes = choice.placed.vault.derived_values()
        assert sizes["rise"] == pytest.approx(demands.sizes.get("rise", sizes["rise"]), abs=1e-6)
        assert choice.placed.pose.z == pytest.approx(demands.pose.get("z", choice.placed.pose.z), abs=1e-9)
        assert "rise" not in demands.sizes or Semicircular not in choice.kinds
    fixed = "rise" if demands.sizes else "z"
    assert deviation(fixed, demands.sizes.get("rise", 0.0), 0.0, choices) < 1e-4


def test_the_vault_is_fitted_anew_where_another_choice_is_likelier() -> None:
    barrel = Barrel(5.0, 8.0, Segmental(0.47))
    rng = np.random.default_rng(4)
    true = Barrel(5.0, 8.0, Semicircular())
    refined = fitted(barrel, given_way(true, stone(true, 4000, rng), 0.01, rng))
    choices = weigh(refined, NONE, rng)
    better = likeliest(refined, choices, NONE)
    assert kinds_of(better.placed.vault) == choices[0].kinds == (Semicircular,)
    assert better.points is refined.points
    assert likeliest(better, choices, NONE) is better


def made(chance: float, kind: Vault, rise: tuple[float, float], z: tuple[float, float]) -> Choice:
    return Choice(Placed(kind, STANDS), (), chance, {"rise": rise, "span": (5.0, 0.01), "z": z})


def test_deviations_hold_what_the_other_choices_mean() -> None:
    barrel = Barrel(5.0, 8.0, Semicircular())
    one = made(0.8, barrel, (2.5, 0.03), (0.0, 0.03))
    other = made(0.2, replace(barrel, profile=Stilted(0.6)), (3.0, 0.1), (-0.5, 0.1))
    wide = sqrt(0.03**2 + 0.2 * (0.5**2 + 0.1**2 - 0.03**2))
    assert deviation("rise", 2.5, 0.03, (one, other)) == pytest.approx(wide)
    assert deviation("unknown", 1.0, 0.03, (one, other)) == pytest.approx(0.03)
    names = (*POSE, "span")
    spread = widened(Covariance(names, np.diag([0.01**2] * 2 + [0.03**2, 0.001**2, 0.01**2])), one.placed, (one, other))
    assert spread.stds()["z"] == pytest.approx(wide)
    assert spread.stds()["x"] == pytest.approx(0.01)
    told = rivals((one, other), one.placed)
    assert [(r.profiles["profile"], r.springing) for r in told] == [("semicircular", 0.0), ("stilted", -0.5)]
    assert set(told[0].sizes) == {"rise", "span"}


@pytest.mark.parametrize(
    ("chances", "kinds"),
    [
        ({"pointed": 0.97, "segmental": 0.03}, ("pointed",)),
        ({"segmental": 0.3, "semicircular": 0.66, "stilted": 0.04}, ("semicircular", "segmental")),
        ({"a": 0.5, "b": 0.3, "c": 0.2}, ("a", "b", "c")),
        ({"pointed": 1.0}, ("pointed",)),
    ],
)
def test_as_few_kinds_are_said_as_hold_with_95_percent(chances: dict[str, float], kinds: tuple[str, ...]) -> None:
    assert said(chances) == kinds

"""The optimiser: bounds, outliers, derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import FAMILIES, Barrel, Groin, Mirror, Pointed, Rib, Rotunda, Segmental, Vault
from vaultcad.fit.freedom import Demands
from vaultcad.fit.solve import Placed, Solution, _Bodies, _jacobian, robust_cost, solve
from vaultcad.fit.uncertainty import slopes_of_distances
from vaultcad.pose import Pose

TRUTH = Placed(Groin(4.2, 4.6, Segmental(0.4), Segmental(0.36)), Pose(1.0, -2.0, 3.0, 0.3))
FREE = ("span_x", "span_y", "rise_ratio_x", "rise_ratio_y")


def cloud(count: int, noise: float, rng: np.random.Generator) -> np.ndarray:
    """Points on the true vault and its walls (n, 3)."""
    on = TRUTH.vault.sample(count, rng).xyz
    side = rng.choice([-1.0, 1.0], count // 2)
    across, height = rng.uniform(-1, 1, count // 2), rng.uniform(-1, 0, count // 2)
    walls = np.column_stack([side * 2.1, across * 2.3, height])
    walls[::2, 0], walls[::2, 1] = across[::2] * 2.1, side[::2] * 2.3
    turn = TRUTH.pose.placement()
    local = np.concatenate([on, walls]) + noise * rng.standard_normal((count + count // 2, 3))
    return local @ turn[:3, :3].T + turn[:3, 3]


def off() -> Placed:
    """A start that is wrong in everything."""
    vault = replace(TRUTH.vault, span_x=4.3, span_y=4.45, profile_x=Segmental(0.35), profile_y=Segmental(0.4))
    return Placed(vault, Pose(1.06, -2.05, 3.1, 0.33))


def test_the_true_vault_is_found_from_a_wrong_start() -> None:
    points = cloud(3000, 0.0, np.random.default_rng(1))
    found = solve(off(), points, np.ones(len(points)), FREE, (0.1, 0.01), most=40)
    assert found.converged
    assert np.abs(found.residuals).max() < 1e-6
    assert found.placed.vault.values() == pytest.approx(TRUTH.vault.values(), abs=1e-5)


def test_a_third_of_outliers_moves_nothing() -> None:
    rng = np.random.default_rng(2)
    good = cloud(3000, 0.001, rng)
    bad = rng.uniform(good.min(axis=0), good.max(axis=0), (1500, 3))
    points = np.concatenate([good, bad])
    found = solve(off(), points, np.ones(len(points)), FREE, (0.2, 0.05, 0.01), most=30)
    assert found.placed.vault.span_x == pytest.approx(4.2, abs=2e-3)
    assert found.placed.pose.yaw == pytest.approx(0.3, abs=1e-3)


def test_parameters_and_springing_stay_within_their_bounds() -> None:
    points = cloud(2000, 0.0, np.random.default_rng(3))
    barrel = Placed(Barrel(4.0, 4.0, Segmental(0.06)), Pose(1.0, -2.0, 4.6, 0.3))
    found = solve(barrel, points, np.ones(len(points)), ("span", "length", "rise_ratio"), (0.3, 0.1), lowest=4.5)
    assert 0.05 <= found.placed.vault.profile.rise_ratio <= 0.5  # type: ignore[attr-defined]
    assert found.placed.pose.z >= 4.5


def test_the_jacobian_is_the_derivative_of_the_distances() -> None:
    points = cloud(500, 0.01, np.random.default_rng(4))
    found = solve(off(), points, np.ones(len(points)), FREE, (0.1,), most=1)
    step, pose = 1e-6, found.placed.pose
    for k, name in enumerate(("x", "y", "z", "yaw")):
        moved = replace(found.placed, pose=replace(pose, **{name: getattr(pose, name) + step}))
        numeric = (moved.distance(points) - found.placed.distance(points)) / step
        agree = np.abs(numeric - found.jacobian[:, k]) < 1e-3
        assert agree.mean() > 0.99  # a point on an edge has two derivatives


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.id)
def test_bodies_near_by_change_about_as_they_did(family: type[Vault]) -> None:
    here = family()
    free = Demands().freedom(here)
    step = {name: here.values()[name] * 0.98 - (0.01 if here.values()[name] == 0 else 0) for name in free.names}
    ranges = {p.name: p.range for p in here.parameters()}
    moved = {name: min(max(value, ranges[name].low), ranges[name].high) for name, value in step.items()}
    there = Placed(here.replaced(moved), Pose(0, 0, 0, 0))
    points = there.vault.sample(2000, np.random.default_rng(1)).xyz
    anew = _Bodies.of(there, free)
    carried = _Bodies.of(Placed(here, there.pose), free).at(there, free)
    one, other = (_jacobian(there, bodies, free, points) for bodies in (anew, carried))
    assert (carried.table == anew.table).all()
    assert np.linalg.norm(one - other, axis=0).max() < 0.1 * np.linalg.norm(one, axis=0).max()


def test_bodies_of_another_kind_are_packed_anew() -> None:
    level, ramped = (Placed(Barrel(4.0, 6.0, slope=slope), Pose(0, 0, 0, 0)) for slope in (0.0, 0.01))
    free = Demands().freedom(level.vault)
    carried, anew = _Bodies.of(level, free).at(ramped, free), _Bodies.of(ramped, free)
    assert (carried.moved == anew.moved).all()


def test_the_cost_runs_from_none_to_one_by_way_of_a_half() -> None:
    assert robust_cost(np.array([0.0, 0.05, 1e6]), 0.05) == pytest.approx([0.0, 0.5, 1.0])


def test_a_solution_keeps_the_order_of_its_unknowns() -> None:
    points = cloud(300, 0.0, np.random.default_rng(5))
    found: Solution = solve(TRUTH, points, np.ones(len(points)), ("span_y",), (0.05,))
    assert found.names == ("x", "y", "z", "yaw", "span_y")
    assert found.jacobian.shape == (len(points), 5)


REACH = [
    (Mirror(4.0, 4.5, 0.5, 0.5, rise_ratio=1.0, plane_ratio=0.7), {"cove_rise": 1.02}),
    (Rib(4.4, 3.8, Pointed(0.5), Pointed(0.6)), {"rise_x": 0.98}),
    (Rotunda(2.0, Pointed(0.5)), {"rise": 0.98}),
    (Barrel(4.0, 5.0, Segmental(0.49)), {"rise": 1.03}),
]
"""Vaults that have the most or the least of a length that they can, and by how much more or less is asked."""


@pytest.mark.parametrize(("vault", "asked"), REACH, ids=lambda one: getattr(one, "id", ""))
def test_a_length_that_is_given_is_met_where_the_stone_draws_other_sizes_beyond_what_allows_it(
    vault: Vault, asked: dict[str, float]
) -> None:
    made = vault.derived_values()
    demands = Demands({name: made[name] * by for name, by in asked.items()}, {"z": 0.0})
    begun = demands.within_reach(vault)
    assert begun is not None
    assert demands.met(begun)
    points = vault.sample(1500, rng=np.random.default_rng(3)).xyz
    start, weights = Placed(begun, Pose(0.02, -0.01, 0.0, 0.01)), np.ones(1500)
    found = solve(start, points, weights, demands.freedom(begun, demands.begun_with(begun)), (0.3,))
    assert demands.met(found.placed.vault)
    assert robust_cost(found.residuals, 0.3).mean() < 0.95 * robust_cost(start.distance(points), 0.3).mean()


@pytest.mark.parametrize("run_y", [0.3, 0.4, 0.44, 0.6])
def test_what_is_given_holds_beside_what_follows(run_y: float) -> None:
    """Coves rise by a share of the narrower, and by a constraint all are as wide as those along x."""
    vault = Mirror(4.0, 4.5, 0.5, run_y, rise_ratio=0.8, plane_ratio=0.7)
    demands = Demands({"cove_rise": 0.7, "rise": 0.45})
    equal = [one for one in vault.constraints if one.name == "equal-coves"]
    free = demands.freedom(vault, equal)
    for share in (0.45, 0.5, 0.55):
        made = free.settled(vault, {"run_x_ratio": share})
        assert demands.met(made)
        assert free.reaches(made)
        assert made.derived_values()["run_x"] == pytest.approx(made.derived_values()["run_y"])


def test_slopes_are_told_one_way_where_the_other_would_change_a_length_that_is_given() -> None:
    vault = Rotunda(2.0, Pointed(0.5))  # no wider one has its rise
    free = Demands({"rise": 2.0}).freedom(vault)
    points = vault.sample(300, rng=np.random.default_rng(3)).xyz
    placed = Placed(vault, Pose(0.0, 0.0, 0.0, 0.0))
    found = solve(placed, points, np.ones(300), free, (0.1,), most=1)
    slopes = slopes_of_distances(replace(found, placed=placed), points)[:, found.names.index("radius")]
    less = free.settled(vault, {"radius": 2.0 - 1e-5})
    assert less.derived_values()["rise"] == pytest.approx(2.0)
    told = (placed.distance(points) - Placed(less, placed.pose).distance(points)) / 1e-5
    assert slopes == pytest.approx(told, abs=1e-3)


def test_a_size_that_no_near_guess_can_have_has_none() -> None:
    assert Demands({"rise": 5.0}).within_reach(Barrel(4.0, 5.0, Segmental(0.3))) is None

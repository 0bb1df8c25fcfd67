"""How sure a fit is: settled vaults, unseen stone, unknowns that the points say nothing of."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import Barrel, Groin, Mirror, Sail, Segmental, Vault
from vaultcad.find.choices import Choice
from vaultcad.fit.freedom import Demands, Freedom
from vaultcad.fit.solve import POSE, Placed, Solution, solve
from vaultcad.fit.uncertainty import covariance, loosened, slopes_of_distances, slopes_of_sizes
from vaultcad.measure.coverage import information, look
from vaultcad.measure.estimates import estimates
from vaultcad.pose import Pose
from vaultcad.uncertain import Covariance, Estimate

STANDS = Pose(1.0, -2.0, 3.0, 0.3)
VAULTS: tuple[Vault, ...] = (
    Groin(4.2, 4.6, Segmental(0.4), Segmental(0.36)),
    Sail(4.2, 4.6, 0.7),
    Mirror(4.2, 4.6, 0.5, 0.5, 0.8, 0.8),
)
BY_NAME = pytest.mark.parametrize("vault", VAULTS, ids=lambda v: v.id)


def room(vault: Vault, count: int, rng: np.random.Generator, noise: float = 0.002) -> np.ndarray:
    """Points (n, 3) on a vault and its walls, in the vault's frame."""
    on, half = vault.sample(count, rng).xyz, (vault.plan.half_x, vault.plan.half_y)
    side = rng.choice([-1.0, 1.0], count // 2)
    walls = np.column_stack([side, rng.uniform(-1, 1, (count // 2, 1)), rng.uniform(-1.5, 0, (count // 2, 1))])
    walls[::2, :2] = walls[::2, 1::-1]
    walls[:, :2] *= half
    return np.asarray(np.concatenate([on, walls]) + noise * rng.standard_normal((len(on) + len(walls), 3)))


def settled(vault: Vault, points: np.ndarray, size: float, rng: np.random.Generator) -> np.ndarray:
    """Points moved smoothly, by about `size` [m]: the springings in x and y, the crown, and all by a few long waves."""
    height = np.clip(points[:, 2:] / vault.derived_values()["rise"], 0, 1)
    xy = np.clip(points[:, :2] / (vault.plan.half_x, vault.plan.half_y), -1, 1)
    moved = np.column_stack([xy * (1 - height), height]) * rng.standard_normal(3)
    for _ in range(6):
        way = rng.standard_normal(3)
        way *= 2 * np.pi / rng.uniform(4, 12) / np.linalg.norm(way)
        moved += np.cos(points @ way + rng.uniform(0, 7))[:, None] * rng.standard_normal(3) / np.sqrt(3)
    return np.asarray(points + size * moved)


def fit(vault: Vault, points: np.ndarray, free: Freedom | None = None) -> tuple[Solution, np.ndarray]:
    """The solution from points in the vault's frame, with what is rare held, and the points where the vault stands."""
    turn = STANDS.placement()
    placed = points @ turn[:3, :3].T + turn[:3, 3]
    free = free or Demands().freedom(vault, [c for c in vault.constraints if c.rare])
    return solve(Placed(vault, STANDS), placed, np.ones(len(placed)), free, (0.05,), most=30), placed


def told(solution: Solution, points: np.ndarray, seen: np.ndarray, rng: np.random.Generator) -> dict[str, Estimate]:
    """Estimates, `seen` (n, 3) being the points on the vault in its frame."""
    return estimates(solution, points, look(solution.placed.vault, seen, 0.2, rng), covariance(solution, points))


def test_the_truth_of_settled_vaults_lies_within_two_deviations_nine_times_in_ten() -> None:
    inside, wide = [], []
    for seed in range(6):
        for vault in VAULTS:
            rng = np.random.default_rng(seed)
            solution, points = fit(vault, settled(vault, room(vault, 1500, rng), 0.01, rng))
            spread, found = covariance(solution, points), solution.placed.vault
            true, sizes = vault.values() | vault.derived_values(), found.values() | found.derived_values()
            for name, slopes in slopes_of_sizes(solution).items():
                if (std := spread.std(slopes)) > 0:
                    inside.append(abs(sizes[name] - true[name]) < 1.96 * std)
                    wide.append(abs(sizes[name] - true[name]) / std)
    assert np.mean(inside) >= 0.9
    assert np.median(wide) > 0.15  # nor is all the world within them


@BY_NAME
def test_a_vault_that_has_not_settled_is_known_to_millimetres(vault: Vault) -> None:
    solution, points = fit(vault, room(vault, 3000, np.random.default_rng(1)))
    stds = covariance(solution, points).stds()
    assert all(stds[name] < 0.01 for name in ("x", "y", "yaw", "span_x", "span_y"))


@BY_NAME
def test_settlement_widens_every_deviation(vault: Vault) -> None:
    rng = np.random.default_rng(2)
    still = room(vault, 2000, rng)
    firm, moved = (covariance(*fit(vault, points)).stds() for points in (still, settled(vault, still, 0.02, rng)))
    assert all(moved[name] > firm[name] for name in moved)


@BY_NAME
def test_three_times_the_points_do_not_leave_a_third_of_the_variance(vault: Vault) -> None:
    rng = np.random.default_rng(3)
    points = settled(vault, room(vault, 6000, rng), 0.01, rng)
    many, few = (covariance(*fit(vault, part)).stds() for part in (points, points[::3]))
    assert np.mean([many[name] / few[name] for name in many]) > 0.75


def test_the_same_solution_has_the_same_covariance() -> None:
    solution, points = fit(VAULTS[0], room(VAULTS[0], 1000, np.random.default_rng(4)))
    assert np.array_equal(covariance(solution, points).matrix, covariance(solution, points).matrix)


def test_what_the_points_say_nothing_of_is_as_unsure_as_its_range_is_wide() -> None:
    barrel = Barrel(4.0, 6.0, Segmental(0.4))
    rng = np.random.default_rng(5)
    points = barrel.sample(2000, rng).xyz + 0.002 * rng.standard_normal((2000, 3))
    points = points[np.abs(points[:, 1]) < 2.0]
    stds = covariance(*fit(barrel, points)).stds()
    assert stds["length"] == pytest.approx((100 - 0.5) / np.sqrt(12), rel=0.01)
    assert stds["x"] < 0.02


def test_a_part_of_the_pose_that_was_held_has_no_deviation() -> None:
    solution, points = fit(VAULTS[0], room(VAULTS[0], 1000, np.random.default_rng(6)))
    held = replace(solution, free=replace(solution.free, pose={"z": solution.placed.pose.z}))
    spread = covariance(held, points)
    assert spread.stds()["z"] == 0.0
    assert 0 < spread.stds()["span_x"] < 0.1
    assert spread.correlations()[2].tolist() == [0, 0, 1, *[0] * (len(spread.names) - 3)]


def test_correlations_are_those_of_the_covariance() -> None:
    spread = Covariance(("a", "b"), np.array([[4.0, -1.0], [-1.0, 1.0]]))
    assert spread.correlations() == pytest.approx(np.array([[1.0, -0.5], [-0.5, 1.0]]))
    assert spread.stds() == {"a": 2.0, "b": 1.0}
    assert spread.std(np.array([1.0, 1.0])) == pytest.approx(np.sqrt(3))


@BY_NAME
def test_slopes_are_those_that_the_optimiser_uses(vault: Vault) -> None:
    solution, points = fit(vault, room(vault, 1000, np.random.default_rng(7)))
    agree = np.abs(slopes_of_distances(solution, points) - solution.jacobian) < 1e-4
    assert agree.mean() > 0.999  # a point on an edge has two


def test_a_derived_size_moves_with_its_parameters() -> None:
    solution, _ = fit(VAULTS[0], room(VAULTS[0], 1000, np.random.default_rng(8)))
    slopes, values = slopes_of_sizes(solution)["rise_x"], solution.placed.vault.values()
    names = solution.names
    assert slopes[names.index("span_x")] == pytest.approx(values["rise_ratio_x"], abs=1e-6)
    assert slopes[names.index("rise_ratio_x")] == pytest.approx(values["span_x"], abs=1e-6)
    assert (slopes[: len(POSE)] == 0).all()


def test_what_follows_an_unknown_is_as_unsure_as_that() -> None:
    vault = Groin(4.0, 5.0, Segmental(0.4), Segmental(0.32))
    points = room(vault, 1000, np.random.default_rng(13))
    (level,) = [c for c in vault.constraints if c.name == "equal-rises"]
    solution, placed = fit(vault, points, Demands().freedom(vault, (*(c for c in vault.constraints if c.rare), level)))
    spread, slopes = covariance(solution, placed), slopes_of_sizes(solution)
    assert "rise_ratio_y" not in solution.names
    assert spread.std(slopes["rise_y"]) == pytest.approx(spread.std(slopes["rise_x"]), rel=1e-3)
    assert spread.std(slopes["rise_ratio_y"]) > 0
    assert spread.std(slopes["crown_rise"]) == 0


def test_what_a_kept_constraint_holds_is_as_unsure_as_without_it() -> None:
    vault = Mirror(4.2, 4.6, 0.5, 0.5, 0.8, 1.0)
    points, demands = room(vault, 2000, np.random.default_rng(14)), Demands()
    (tangent,) = [c for c in vault.constraints if c.name == "tangent-plane"]
    held, placed = fit(vault, points, demands.freedom(vault, [tangent]))
    loose = loosened(held, demands.freedom(vault), placed)
    assert "plane_ratio" not in held.names
    assert 0 < covariance(loose, placed).stds()["plane_ratio"] < 0.2
    assert loose.residuals is held.residuals


def test_the_higher_of_two_equal_arches_is_as_unsure_as_one() -> None:
    vault = Groin(4.0, 5.0, Segmental(0.4), Segmental(0.32))
    solution, placed = fit(vault, room(vault, 1000, np.random.default_rng(15)))
    level = replace(solution, placed=replace(solution.placed, vault=vault))
    spread, slopes = covariance(level, placed), slopes_of_sizes(level)
    higher = max(spread.std(slopes[name]) for name in ("rise_x", "rise_y"))
    assert spread.std(slopes["rise"]) <= higher


@BY_NAME
def test_nothing_is_flagged_where_all_was_seen(vault: Vault) -> None:
    rng = np.random.default_rng(9)
    points = room(vault, 3000, rng)
    numbers = told(*fit(vault, points), points[:3000], rng)
    assert {name: e.flags for name, e in numbers.items() if e.flags} == {}
    assert all(e.seen is not None and e.seen > 0.8 for e in numbers.values() if e.std is not None)


def test_what_hangs_on_webs_that_nobody_saw_is_flagged() -> None:
    vault, rng = VAULTS[0], np.random.default_rng(10)
    sample = vault.sample(4000, rng)
    seen = sample.xyz[sample.component <= 2] + 0.002 * rng.standard_normal(((sample.component <= 2).sum(), 3))
    walls = room(vault, 3000, rng)[3000:]
    numbers = told(*fit(vault, np.concatenate([seen, walls])), seen, rng)
    assert "unseen" in numbers["rise_ratio_y"].flags
    assert "unseen" in numbers["rise_y"].flags
    for name in ("span_x", "span_y", "rise_ratio_x", "rise_x"):
        assert numbers[name].flags == (), name


def test_half_a_vault_tells_its_width_and_not_its_length() -> None:
    vault, rng = Mirror(4.0, 6.0, 0.5, 0.4, 0.8, 0.8), np.random.default_rng(11)
    points = room(vault, 4000, rng)
    points = points[points[:, 1] < -0.5]
    numbers = told(*fit(vault, points), points[points[:, 2] > 0], rng)
    assert "unseen" in numbers["span_y"].flags
    assert numbers["span_x"].flags == ()


def test_information_is_what_noise_would_leave() -> None:
    vault, rng = VAULTS[1], np.random.default_rng(12)
    points = room(vault, 4000, rng)
    on = points[:4000]
    half = points[(points[:, 1] > 0) | (points[:, 2] < 0)]
    solution, placed = fit(vault, half)
    share = information(solution, placed, look(vault, on[on[:, 1] > 0], 0.2, rng))
    assert 0 < share.share(np.eye(len(solution.names))[6]) < 0.9
    assert share.share(np.zeros(len(solution.names))) == 0.0


def test_what_a_row_shares_is_no_surer_than_the_arches_it_was_told_by() -> None:
    rng, vault = np.random.default_rng(5), VAULTS[0]
    solution, points = fit(vault, room(vault, 1500, rng))
    sight, spread = look(vault, points[:0], 0.2, rng), covariance(solution, points)
    held = replace(spread, matrix=np.zeros_like(spread.matrix))
    rise = solution.placed.vault.derived_values()["rise_y"]
    choices = [Choice(solution.placed, (), 0.7, {"rise_y": (rise, 0.004)})]
    choices += [Choice(solution.placed, (), 0.3, {"rise_y": (rise - 0.2, 0.1)})]
    one = estimates(solution, points, sight, held, choices, {"rise_y": (rise, 0.004)})["rise_y"]
    assert one.std == pytest.approx(np.sqrt(0.7 * 0.004**2 + 0.3 * (0.2**2 + 0.1**2)))
    assert "row" in one.flags
    assert "unseen" not in one.flags

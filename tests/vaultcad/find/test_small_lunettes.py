"""Lunettes so small that all of their stone is near edges: their place and arch are told by that stone all the same."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np
import pytest

from families import Barrel, Elliptical, Lunette, Pointed, Segmental, Semicircular
from vaultcad.find.choices import weigh
from vaultcad.find.lunettes import lunettes_at
from vaultcad.find.pockets import pockets_behind
from vaultcad.find.recognise import Hypothesis
from vaultcad.find.refine import refine, settled
from vaultcad.fit.evidence import Evidence
from vaultcad.fit.freedom import NONE, RECTANGLE
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.survey.thinned_scan import Site

STANDS = Placed(Lunette(), Pose(0.0, 0.0, 0.0, 0.0))


def stone(vault: Lunette, count: int, rng: np.random.Generator) -> np.ndarray:
    """Points (n, 3) on a vault that has settled by up to 10 mm, and on its walls, with 2 mm of noise."""
    share = rng.uniform(-1, 1, (count // 2, 3))
    walls = share * [vault.span / 2, vault.length / 2, 0.5] - [0, 0, 0.5]
    walls[::2, 0], walls[1::2, 1] = np.sign(walls[::2, 0]) * vault.span / 2, np.sign(walls[1::2, 1]) * vault.length / 2
    xyz = np.concatenate([vault.sample(count, rng).xyz, walls])
    sunk = np.cos(xyz[:, 0] / vault.span * 3) * np.cos(xyz[:, 1] / vault.length * 3)
    return np.asarray(xyz - 0.01 * sunk[:, None] * [0, 0, 1] + 0.002 * rng.standard_normal(xyz.shape))


def test_no_choice_moves_a_row_of_lunettes_away_from_its_stone() -> None:
    vault = Lunette(5.0, 10.6, Elliptical(0.32), 3, 0.9, -0.26, 0.67, 0.0, Pointed(0.88))
    rng = np.random.default_rng(1)
    points = stone(vault, 6000, rng)
    kept = tuple(c for c in vault.constraints if c.name == "common-springing")
    evidence = Evidence(points, np.ones(len(points)), -inf)
    choices = weigh(settled(replace(STANDS, vault=vault), kept, evidence, 0.01), NONE, rng)
    assert choices
    for choice in choices:
        assert "centred-row" not in {c.name for c in choice.kept}
        assert choice.placed.vault.derived_values()["shift"] == pytest.approx(vault.shift, abs=0.05)


def test_a_lunette_is_found_again_from_one_of_another_arch_elsewhere() -> None:
    truth = Lunette(5.4, 3.66, Elliptical(0.32), 1, 0.8, -0.7, 0.85, 0.0, Segmental(0.4))
    begun = replace(truth, pitch_ratio=1.0, shift_ratio=0.0, width_ratio=0.607, lunette_profile=Semicircular())
    rng = np.random.default_rng(2)
    points = stone(truth, 8000, rng)
    ones = np.ones(len(points))
    half = truth.plan.half
    normals = truth.evaluate(points).normal
    site = Site(points, normals, ones, 0.0, -half, half, np.zeros((2, 2), bool), 0.0, truth.top, 0.05, points[:0], ones)
    kept = (RECTANGLE, *truth.constraints)
    evidence = Evidence(points, ones, -inf)
    placed, free = replace(STANDS, vault=begun), NONE.freedom(begun, kept)
    near = evidence.solve(placed, free, (0.05,))
    assert near.placed.vault.derived_values()["lunette_span"] < truth.lunette_span - 0.2, "from near by it is not"
    found = refine(Hypothesis(near, free, kept, 0.0, 0.0, own=True), site, rng).placed.vault
    assert found.derived_values()["lunette_span"] == pytest.approx(truth.lunette_span, abs=0.25)
    assert found.derived_values()["shift"] == pytest.approx(truth.shift, abs=0.05)


@pytest.mark.parametrize(
    "truth",
    [
        Lunette(4.3, 5.4, Semicircular(), 2, 0.91, 0.0, 0.9, 0.25, Segmental(0.33)),
        Lunette(5.75, 6.0, Segmental(0.33), 3, 1.0, 0.0, 0.91, 0.4, Segmental(0.26)),
        Lunette(4.0, 5.8, Elliptical(0.28), 2, 0.85, -0.5, 0.87, 0.0, Pointed(0.59)),
    ],
    ids=["two", "three", "shifted"],
)
def test_the_arch_of_small_lunettes_is_told_by_their_own_stone(truth: Lunette) -> None:
    rng = np.random.default_rng(3)
    points = stone(truth, 6000, rng)
    kept = tuple(c for c in truth.constraints if all(getattr(truth, k) == v for k, v in c.holds(truth).items()))
    begun = settled(replace(STANDS, vault=truth), kept, Evidence(points, np.ones(len(points)), -inf), 0.01)
    first = weigh(begun, NONE, rng)[0].placed.vault
    assert first.derived_values()["lunette_span"] == pytest.approx(truth.lunette_span, rel=0.12)
    assert first.derived_values()["lunette_rise"] == pytest.approx(truth.lunette_rise, rel=0.25)


def site_of(vault: Lunette) -> Site:
    """What the scan shows of a vault between walls on all sides."""
    sample = vault.sample(40_000, np.random.default_rng(4))
    one, half = np.ones(len(sample.xyz)), np.array(vault.plan.half)
    walled, none = np.ones((2, 2), np.bool_), np.zeros((0, 3))
    return Site(sample.xyz, sample.normals, one, 0.0, -half, half, walled, -2.0, 2.0, 0.04, none, one)


@pytest.mark.parametrize("lunettes", [(3, 0.9, -0.26), (2, 0.8, 0.6), (1, 0.5, 0.9), (4, 1.0, 0.0)])
def test_a_row_begins_where_stone_goes_back_behind_a_barrel(lunettes: tuple[int, float, float]) -> None:
    truth = Lunette(5.0, 10.6, Elliptical(0.32), *lunettes, 0.7, 0.0, Pointed(0.88))
    barrel = replace(STANDS, vault=Barrel(5.0, 10.6, Elliptical(0.32)))
    site = site_of(truth)
    start = lunettes_at(barrel, pockets_behind(barrel, site))
    assert start is not None
    nearest = min((way.vault for way in start.ways), key=lambda vault: np.abs(vault.distance(site.points)).mean())
    assert isinstance(nearest, Lunette)
    assert nearest.count == truth.count
    assert nearest.positions == pytest.approx(truth.positions, abs=0.1)
    assert np.abs(nearest.distance(site.points)).mean() < np.abs(barrel.distance(site.points)).mean()


def test_one_pocket_is_a_door_and_pockets_behind_no_barrel_begin_nothing() -> None:
    pocket = np.array([[2.0, -0.5, 1.0], [2.0, 0.5, 1.0]])
    assert lunettes_at(replace(STANDS, vault=Barrel(5.0, 10.6)), [pocket]) is None
    assert lunettes_at(STANDS, [pocket, -pocket]) is None


def test_a_row_that_ends_where_the_barrel_does_is_begun_there() -> None:
    barrel = replace(STANDS, vault=Barrel(4.0, 7.1))
    for last in np.linspace(3.4, 3.6, 101):
        middles = [(2.2 * side, last - 1.1 * k) for k in range(3) for side in (-1.9, 1.9)]
        pockets = [np.array([[x, y - 0.4, 0.7], [x, y + 0.4, 1.1]]) for x, y in middles]
        start = lunettes_at(barrel, pockets)
        assert start is not None
        for way in start.ways:
            assert isinstance(way.vault, Lunette)
            assert 0 < way.vault.shift_ratio <= 1

"""Plans of four free corners: bodies keep their kind, stand on the walls as they are, and are cut by them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from families import FAMILIES, Barrel, Dome, Groin, Lunette, Mirror, Sail, Trough, Vault
from families.declaration.corners import Skew
from families.declaration.pieces import Ball, BarrelPart
from families.declaration.plan import Plan

SKEW = Skew(0.06, 0.08, -0.05)
SEVEN = (Sail, Barrel, Lunette, Trough, Mirror, Groin, Dome)
EACH = pytest.mark.parametrize("family", SEVEN, ids=lambda f: f.id)


def skewed(family: type[Vault]) -> Vault:
    return replace(family(), skew=SKEW)


def test_the_corners_are_where_they_are_said_to_be() -> None:
    south_west, south_east, north_east, north_west = np.array(SKEW.corners(2.0, 3.0))
    assert north_east[0] - north_west[0] == pytest.approx(2 * 2.0 * (1 + SKEW.taper_x))
    assert south_east[0] - south_west[0] == pytest.approx(2 * 2.0 * (1 - SKEW.taper_x))
    assert north_east[1] - south_east[1] == pytest.approx(2 * 3.0 * (1 + SKEW.taper_y))
    assert (north_east + north_west)[0] / 2 - (south_east + south_west)[0] / 2 == pytest.approx(2 * 3.0 * SKEW.shear)
    assert Barrel(4.0, 6.0, skew=SKEW).corners.tolist() == [list(c) for c in SKEW.corners(2.0, 3.0)]


def test_what_a_rectangle_knows_beforehand_follows_from_its_sides() -> None:
    plan = Plan.rectangle(2.0, 3.0, on_wall_x=True)
    general = Plan(plan.sides)
    assert plan == general
    assert (plan.table == general.table).all()
    assert plan.axes == general.axes
    assert plan.half.tolist() == [2.0, 3.0]


@EACH
def test_no_skew_changes_nothing(family: type[Vault]) -> None:
    plain, other = family(), replace(family(), skew=Skew())
    assert other.pieces() == plain.pieces()
    assert other.plan == plain.plan
    assert (other.plan.table == plain.plan.table).all()
    assert set(other.values()) - set(plain.values()) == {"shear", "taper_x", "taper_y"}
    assert other.derived_values() == plain.derived_values()


@EACH
def test_samples_lie_on_the_surface_and_a_step_along_the_normal_is_as_long_as_it_says(family: type[Vault]) -> None:
    vault = skewed(family)
    sample = vault.sample(2000, np.random.default_rng(2))
    here = vault.evaluate(sample.xyz)
    assert np.abs(here.distance).max() < 1e-9
    assert np.linalg.norm(here.normal, axis=1) == pytest.approx(1)
    assert vault.plan.distance(sample.xyz[:, :2]).max() < 1e-9
    beside = vault.distance(sample.xyz + 1e-4 * here.normal)
    assert np.quantile(np.abs(beside - 1e-4), 0.95) < 1e-6  # at groins the next component is nearer
    assert set(here.component) == set(range(1, len(vault.components) + 1))


def test_a_barrel_springs_from_its_walls_and_its_crown_is_level() -> None:
    vault = Barrel(4.0, 6.0, skew=SKEW)
    south, east, north, west = vault.plan.sides
    for wall in (east, west):
        springing = np.column_stack([wall.points(20), np.full(21, 0.0)])
        assert vault.distance(springing) == pytest.approx(0, abs=1e-12)
    (part,) = vault.pieces()[0].parts
    assert isinstance(part, BarrelPart)
    for along in (-2.0, 0.0, 2.5):
        place = np.add(part.origin, np.multiply(along, part.along))
        assert vault.distance(np.array([[*place, vault.rise]])) == pytest.approx(0, abs=1e-12)
    for wall in (south, north):  # the axis runs from one to the other
        ends = [np.add(part.origin, np.multiply(way * vault.axis.half_length, part.along)) for way in (-1, 1)]
        assert min(abs(np.dot(wall.normal, end) - wall.offset) for end in ends) < 1e-12


def test_wall_arches_of_a_groin_vault_meet_their_barrels() -> None:
    vault = Groin(5.0, 4.0, skew=SKEW)
    for part, walls in zip((p.parts[0] for p in vault.pieces()), ((1, 3), (0, 2)), strict=True):
        assert isinstance(part, BarrelPart)
        for k in walls:
            springing = np.column_stack([vault.plan.sides[k].points(20), np.zeros(21)])
            across = np.array([part.local(x, y) for x, y, _ in springing.tolist()])
            half = part.curve.half_span * (1 + part.splay * across[:, 1])
            assert np.abs(across[:, 0]) == pytest.approx(half, abs=1e-12)
    assert vault.rise_x == pytest.approx(vault.axes[0].half_span)


def test_coves_and_heads_are_parallel_to_their_walls() -> None:
    for vault in (Mirror(skew=SKEW), Trough(south_ratio=1.0, north_ratio=1.0, skew=SKEW)):
        coves = [part for part in vault.pieces()[0].parts if isinstance(part, BarrelPart) and part.side]
        assert len(coves) == 4
        for side in vault.plan.sides:
            springing = np.column_stack([side.points(10), np.zeros(11)])
            assert np.abs(vault.distance(springing)).max() < 1e-12
        assert all(part.splay == 0 for part in coves)


def test_a_cloister_over_free_corners_has_one_summit() -> None:
    vault = Trough(5.0, 6.0, south_ratio=1.0, north_ratio=1.0, skew=SKEW)
    x, y = np.random.default_rng(3).uniform(-2.5, 2.5, (2, 5000))
    level = vault.distance(np.column_stack([x, y, np.full(5000, vault.rise - 0.01)]))
    assert vault.distance(np.array([[0.0, 0.0, vault.rise]])) == pytest.approx(0, abs=1e-12)
    assert np.hypot(x, y)[level < 0].max() < 1.0


def test_a_sail_stays_a_sphere_and_goes_through_corners_that_lie_on_a_circle() -> None:
    trapezium = Sail(5.0, 4.0, skew=Skew(taper_x=0.1))
    assert trapezium.distance(np.column_stack([trapezium.corners, np.zeros(4)])) == pytest.approx(0, abs=1e-12)
    other = Sail(5.0, 4.0, skew=SKEW)
    (ball,) = other.pieces()[0].parts
    assert isinstance(ball, Ball)
    off = other.distance(np.column_stack([other.corners, np.zeros(4)]))
    assert abs(off.mean()) < 0.01
    assert np.abs(off).max() < 0.25


def test_lunettes_cross_the_barrel_at_right_angles_to_its_axis() -> None:
    vault = Lunette(skew=SKEW)
    barrel, *lunettes = (piece.parts[0] for piece in vault.pieces())
    assert isinstance(barrel, BarrelPart)
    for part, place in zip(lunettes, vault.positions, strict=True):
        assert isinstance(part, BarrelPart)
        assert part.across == barrel.along
        assert barrel.local(*part.origin) == pytest.approx((0.0, place))


@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.id)
def test_the_plan_is_told_once(family: type[Vault]) -> None:
    vault = family()
    assert isinstance(vault.plan, Plan)
    assert (vault.corners == vault.plan.corners).all()

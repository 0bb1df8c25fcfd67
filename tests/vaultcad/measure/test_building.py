"""What vaults are to one another, and how arches were set out."""

import dataclasses
from math import isnan, sqrt

import numpy as np
import pytest

from families import Barrel, Groin, Pointed, Segmental
from families.declaration.profiles import PROFILES
from vaultcad.measure.arcs import arcs_of, springing_of
from vaultcad.measure.building import building_of
from vaultcad.measure.setting_out import FREE, RULES, setting_out
from vaultcad.pose import Pose


def test_equal_neighbours_joined_by_an_arch_are_a_row_from_west_to_east(building):
    found = building_of(building)
    assert found.rows == ((2, 1), (3,))
    assert [found.name(k) for k in (1, 2, 3)] == ["row A bay 2", "row A bay 1", "row B bay 1"]
    assert found.rooms == ((1, 2), (3,))


def test_what_lies_over_others_is_a_storey_above_their_crowns(building):
    found = building_of(building)
    assert found.storeys == ((1, 2), (3,))
    assert isnan(found.floors[0])
    assert found.floors[1] == pytest.approx(3.0 + 2.5 + 0.15)
    (arch,) = building.arches
    assert found.storey_of_arch(arch) == 1


def test_one_without_neighbours_is_on_the_storey_where_it_springs(building):
    low, high = (dataclasses.replace(building.vaults[0], pose=Pose(30.0 + z, 0.0, z, 0.0)) for z in (2.0, 8.5))
    found = building_of(dataclasses.replace(building, vaults=(*building.vaults, low, high)))
    assert found.storeys == ((1, 2, 4), (3, 5))


def test_a_grid_is_rows_along_its_longer_side(building):
    """Three by two bays, each joined to its neighbours."""
    vault = building.vaults[0]
    places = [(x, y) for y in (0, 1) for x in (0, 1, 2)]
    vaults = tuple(dataclasses.replace(vault, pose=Pose(5.1 * x, 5.5 * y, 3.0, 0.0)) for x, y in places)
    pairs = [(1, 2), (2, 3), (4, 5), (5, 6), (1, 4), (2, 5), (3, 6)]
    arches = tuple(dataclasses.replace(building.arches[0], beside=pair) for pair in pairs)
    assert building_of(dataclasses.replace(building, vaults=vaults, arches=arches)).rows == ((1, 2, 3), (4, 5, 6))


def test_a_bay_that_is_shorter_along_its_row_belongs_to_it(building):
    """A crypt of three by three bays, whose first row of each direction is a fifth narrower than the others."""
    vault = building.vaults[0]
    wide = (2.2, 2.8, 2.8)
    places = [(i, j) for j in range(3) for i in range(3)]
    bays = [Groin(wide[i], wide[j], *(Segmental(0.9 / wide[k]) for k in (i, j))) for i, j in places]
    vaults = tuple(
        dataclasses.replace(vault, vault=bay, pose=Pose(3.0 * i, 3.0 * j, 3.0, 0.0))
        for bay, (i, j) in zip(bays, places, strict=True)
    )
    pairs = [(k, k + 1) for k in (1, 2, 4, 5, 7, 8)] + [(k, k + 3) for k in range(1, 7)]
    arches = tuple(dataclasses.replace(building.arches[0], beside=pair) for pair in pairs)
    found = building_of(dataclasses.replace(building, vaults=vaults, arches=arches))
    assert found.rows == ((1, 2, 3), (4, 5, 6), (7, 8, 9))


def test_rows_as_long_are_named_from_south_to_north_whatever_their_numbers(building):
    vault = building.vaults[0]
    places = [(0, 2), (1, 2), (0, 0), (1, 0), (0, 1), (1, 1)]
    vaults = tuple(dataclasses.replace(vault, pose=Pose(5.1 * x, 5.5 * y, 3.0, 0.0)) for x, y in places)
    pairs = [(1, 2), (3, 4), (5, 6)]
    arches = tuple(dataclasses.replace(building.arches[0], beside=pair) for pair in pairs)
    assert building_of(dataclasses.replace(building, vaults=vaults, arches=arches)).rows == ((3, 4), (5, 6), (1, 2))


def test_a_row_does_not_go_round_a_corner_and_ends_at_another_size(building):
    vault = building.vaults[0]
    wide = dataclasses.replace(vault, vault=Groin(6.0, 5.0), pose=Pose(-6.0, 0.0, 3.0, 0.0))
    north = dataclasses.replace(vault, pose=Pose(5.1, 5.5, 3.0, 0.0))
    arches = tuple(dataclasses.replace(building.arches[0], beside=pair) for pair in ((2, 1), (3, 2), (1, 4)))
    found = building_of(dataclasses.replace(building, vaults=(*building.vaults[:2], wide, north), arches=arches))
    assert found.rows == ((2, 1), (3,), (4,))
    assert found.rooms == ((1, 2, 3, 4),)


def test_vaults_that_nothing_joins_are_rooms_of_their_own(every_family):
    found = building_of(every_family)
    assert len(found.rooms) == len(found.rows) == len(every_family.vaults)
    assert len(found.storeys) == 1


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.name)
def test_an_arch_set_out_by_a_rule_is_said_to_follow_it(building, rule):
    profile = rule.kind.over(rule.ratio)
    assert profile is not None
    arch = dataclasses.replace(building.arches[0], vault=Barrel(4.0, 0.5, profile), rivals=())
    odds = setting_out(arch)
    assert sum(odds.values()) == pytest.approx(1)
    assert next(iter(odds)) == rule.name
    assert odds[rule.name] > 0.5


def test_an_arch_between_the_rules_follows_none(building):
    arch = dataclasses.replace(building.arches[0], vault=Barrel(4.0, 0.5, Pointed(0.58)), rivals=())
    assert setting_out(arch)[FREE] > 0.99


def test_odds_of_rules_follow_those_of_the_kinds(building):
    (arch,) = building.arches
    ways = ((0.6, "semicircular", 0.5), (0.4, "stilted", 0.56))
    rivals = tuple(
        dataclasses.replace(
            arch.rivals[0], chance=chance, profiles={"profile": kind}, sizes={"span": 4.0, "rise": 4 * k}
        )
        for chance, kind, k in ways
    )
    odds = setting_out(dataclasses.replace(arch, rivals=rivals))
    assert odds["semicircle"] == pytest.approx(0.6)
    assert odds[FREE] > 0.39


def test_arcs_have_the_deviations_that_follow_from_span_and_rise(building):
    (arch,) = building.arches
    (arc,) = arcs_of(arch)
    span, ratio = 4.6, sqrt(0.55)
    assert arc.radius.value == pytest.approx(0.8 * span)  # the fifth point
    assert arc.across.value == pytest.approx(-0.3 * span)
    assert arc.height.value == pytest.approx(arch.pose.z)
    assert arc.radius.std == pytest.approx(np.hypot(0.8 * 0.005, 2 * ratio * span * 0.001), rel=1e-3)
    assert arc.height.std == springing_of(arch).std == pytest.approx(0.002)


@pytest.mark.parametrize("kind", PROFILES, ids=lambda kind: kind.id)
def test_every_kind_of_arch_has_its_circles(building, kind):
    arch = dataclasses.replace(building.arches[0], vault=Barrel(4.0, 0.5, kind()), covariance=None)
    count = {"elliptical": 0, "basket-handle": 2}.get(kind.id, 1)
    assert len(arcs_of(arch)) == count


def test_arches_know_their_ring_and_kind(building):
    (arch,) = building.arches
    assert arch.ring == building.thickness_of(arch) == 0.25
    assert arch.kind == "transverse"
    alone = dataclasses.replace(arch, beside=(2, 0), depth=(float("nan"), float("nan")))
    assert alone.kind == "wall"
    assert building.thickness_of(alone) == building.thickness

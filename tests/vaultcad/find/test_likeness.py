"""What looks alike is searched once, and begun from there."""

from __future__ import annotations

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from families import Barrel, Groin, Pointed, Sail, Segmental, Semicircular, Vault
from vaultcad.find import rows
from vaultcad.find.choices import Choice
from vaultcad.find.found import Found
from vaultcad.find.likeness import choices_like, firsts, in_turn, look_of_ceiling, starts_like
from vaultcad.find.recognise import Hypothesis, confidence
from vaultcad.find.refine import Refined
from vaultcad.find.second_look import second_looks
from vaultcad.fit.evidence import Evidence
from vaultcad.fit.freedom import NONE, Freedom
from vaultcad.fit.solve import Placed, Solution
from vaultcad.pose import Pose
from vaultcad.survey.parting import Ceiling, Part
from vaultcad.survey.plan_grid import PlanGrid
from vaultcad.survey.thinned_scan import Site

NOTHING = np.empty(0)
NOWHERE = np.empty((0, 3))
LARGE, SMALL = Groin(4.6, 5.4, Segmental(0.4), Segmental(0.34)), Groin(2.8, 3.0)


def stone(vault: Vault, pose: Pose, seed: int) -> np.ndarray:
    """Points (n, 3) on a vault where it stands."""
    turn = pose.placement()
    xyz = vault.sample(3000, np.random.default_rng(seed)).xyz
    return np.asarray(xyz @ turn[:3, :3].T + turn[:3, 3])


def site(pose: Pose, quarter: int) -> Site:
    """A site about a vault's middle; its x axis may be along either side."""
    spans = np.array([4.6, 5.4])[:: 1 - 2 * quarter]
    yaw = pose.yaw + quarter * np.pi / 2
    c, s = np.cos(yaw), np.sin(yaw)
    middle = np.array([c * pose.x + s * pose.y, c * pose.y - s * pose.x])
    return Site(
        points=NOWHERE,
        normals=NOWHERE,
        weights=NOTHING,
        yaw=yaw,
        low=middle - spans / 2,
        high=middle + spans / 2,
        walled=np.zeros((2, 2), np.bool_),
        bottom=0.0,
        crown=pose.z + LARGE.top,
        spacing=0.02,
        ends=NOWHERE,
        counts=NOTHING,
    )


def hypothesis(vault: Vault, pose: Pose, score: float) -> Hypothesis:
    solution = Solution(Placed(vault, pose), (), NOWHERE, NOTHING, NOTHING, True, Freedom(()))
    return Hypothesis(solution, Freedom(()), (), 0.0, score, own=True)


def found(vault: Vault, pose: Pose, over: Site, *others: tuple[Vault, float]) -> Found:
    """A vault as if it had been found; others that were tried, with their scores beyond its own."""
    tried = tuple(hypothesis(one, pose, score) for one, score in ((vault, 0.0), *others))
    refined = Refined(tried[0].solution, Evidence(NOWHERE, NOTHING, 0.0), 0.002, (), Freedom(()))
    return Found(over, tried, refined, 0.03)


def ceiling(points: np.ndarray) -> Ceiling:
    grid = PlanGrid(np.zeros(2), 1.0, (1, 1))
    part = Part(grid, np.ones((1, 1), np.bool_), np.zeros((1, 1)), 0.0, ())
    return Ceiling(points, np.zeros(len(points), np.bool_), 20.0, part)


def test_ceilings_look_alike_wherever_they_stand_and_others_do_not() -> None:
    pointed = replace(LARGE, profile_x=Pointed(0.8), profile_y=Pointed(0.7))
    larger = replace(LARGE, span_x=5.6, span_y=6.6)
    vaults = (LARGE, SMALL, LARGE, pointed, SMALL, LARGE, larger, larger)
    poses = [Pose(7.0 * k, -2.0 * k, 0.3 * k, radians(40 * k)) for k in range(len(vaults))]
    looks = [look_of_ceiling(stone(vault, pose, k)) for k, (vault, pose) in enumerate(zip(vaults, poses, strict=True))]
    assert firsts(looks) == [0, 1, 0, 3, 1, 0, 0, 6]  # what is larger begins from the first, the next from that


def test_the_first_of_each_kind_comes_first_and_is_told_to_the_others() -> None:
    told = list(in_turn([0, 1, 0, 2, 1, 5], lambda k, first: (k, first and first[0])))
    assert told == [(0, (0, None)), (1, (1, None)), (5, (5, None)), (2, (2, 0)), (4, (4, 1)), (3, (3, 2))]


def test_of_arches_only_those_of_a_vault_as_large_are_taken_over() -> None:
    pose = Pose(0.0, 0.0, 3.0, 0.0)
    kinds = (LARGE, replace(LARGE, profile_x=Semicircular()))
    told = tuple(
        Choice(Placed(vault, pose), (), chance, {}) for vault, chance in zip(kinds, (0.995, 0.005), strict=True)
    )
    first = replace(found(LARGE, pose, site(pose, 0)), choices=told)
    turned, larger = Groin(5.4, 4.6, LARGE.profile_y, LARGE.profile_x), replace(LARGE, span_y=6.8)
    assert choices_like(first, found(turned, pose, site(pose, 1))) == told[:1]
    assert choices_like(first, found(larger, pose, site(pose, 0))) == ()


@pytest.mark.parametrize("quarter", [0, 1])
def test_families_begin_where_the_stone_is_that_looks_alike(quarter: int) -> None:
    here, there = Pose(1.0, 2.0, 3.0, 0.2), Pose(-20.0, 9.0, 4.5, 1.4)
    first = found(LARGE, here, site(here, 0))
    (start,) = starts_like(first, site(there, quarter), (Groin, Sail))
    assert starts_like(first, site(there, quarter), (Sail,)) == ()
    points = stone(LARGE, there, 1)
    assert min(np.abs(way.distance(points)).max() for way in start.ways) < 1e-9
    assert len({round(way.pose.yaw, 6) for way in start.ways}) == 4


@pytest.mark.parametrize("quarter", [0, 1])
def test_what_is_larger_begins_stretched_to_its_own_plan(quarter: int) -> None:
    small, there = replace(LARGE, span_x=3.9, span_y=4.5), Pose(-20.0, 9.0, 4.5, 1.4)
    first = found(small, Pose(1.0, 2.0, 3.0, 0.2), site(Pose(1.0, 2.0, 3.0, 0.2), 0))
    (start,) = starts_like(first, site(there, quarter), (Groin,))
    points = stone(LARGE, there, 1)
    assert min(np.abs(way.distance(points)).max() for way in start.ways) < 0.01


def test_what_a_row_lacks_is_looked_at_again() -> None:
    places = [Pose(5.1 * k, 0.0, 3.0, 0.0) for k in range(4)] + [Pose(15.3, 12.0, 3.0, 0.0)]
    stones = [ceiling(stone(LARGE, pose, k)) for k, pose in enumerate(places)]
    rows = [(found(LARGE, pose, site(pose, 0)),) for pose in places[:2]]
    for third in ((), (found(Sail(4.6, 5.4, 0.9), places[2], site(places[2], 0), (LARGE, 5.0)),)):
        (look,) = second_looks(stones, [*rows, third, (), ()])
        assert (look.number, look.beside) == (2, rows[1][0])  # the next is beside that one alone
        taken = look.taken(found(LARGE, places[2], site(places[2], 0)), third, NONE, np.random.default_rng(0))
        assert [h.vault.id for h in taken.hypotheses] == ["groin", *(["sail"] if third else [])]
        assert confidence(taken.hypotheses)[0] > 0.7


def test_what_is_clearly_odd_in_a_row_stays_so() -> None:
    places = [Pose(5.1 * k, 0.0, 3.0, 0.0) for k in range(3)]
    stones = [ceiling(stone(LARGE, pose, k)) for k, pose in enumerate(places)]
    odd = found(Sail(4.6, 5.4, 0.9), places[2], site(places[2], 0), (LARGE, 20.0))
    rows = [(found(LARGE, pose, site(pose, 0)),) for pose in places[:2]]
    assert second_looks(stones, [*rows, (odd,)]) == []


def test_a_bay_found_in_its_row_is_no_surer_than_the_one_beside_it() -> None:
    places = [Pose(5.1 * k, 0.0, 3.0, 0.0) for k in range(3)]
    stones = [ceiling(stone(LARGE, pose, k)) for k, pose in enumerate(places)]
    rows = [(found(LARGE, pose, site(pose, 0), (Barrel(), 3.0)),) for pose in places[:2]]
    (look,) = second_looks(stones, [*rows, ()])
    taken = look.taken(found(LARGE, places[2], site(places[2], 0)), (), NONE, np.random.default_rng(0))
    assert confidence(taken.hypotheses) == confidence(rows[1][0].hypotheses)


def test_what_is_larger_higher_or_out_of_line_is_no_bay_of_the_row() -> None:
    bays = [Pose(5.1 * k, 0.0, 3.0, 0.0) for k in range(2)]
    rows = [(found(LARGE, pose, site(pose, 0)),) for pose in bays]
    before = [ceiling(stone(LARGE, pose, k)) for k, pose in enumerate(bays)]
    for vault, pose in (
        (Barrel(6.5, 5.4, Segmental(0.3)), Pose(11.1, 0.0, 3.0, 0.0)),
        (LARGE, Pose(10.2, 0.0, 4.2, 0.0)),
        (LARGE, Pose(10.2, 1.5, 3.0, 0.0)),
    ):
        assert second_looks([*before, ceiling(stone(vault, pose, 9))], [*rows, ()]) == []


def test_bays_that_say_the_same_are_no_surer_of_their_arches_together(monkeypatch: pytest.MonkeyPatch) -> None:
    likelier = Groin(4.6, 5.4, Semicircular(), Segmental(0.426))
    odds = {likelier: 0.6, Groin(4.6, 5.4, Segmental(0.45), Segmental(0.38)): 0.4}
    bays = []
    for k in range(5):
        pose = Pose(0.0, 5.8 * k, 3.0, 0.0)
        told = [Choice(Placed(vault, pose), (), share, {"span_x": (4.6, 0.005)}) for vault, share in odds.items()]
        bays.append(replace(found(likelier, pose, site(pose, 0)), choices=tuple(told)))
    monkeypatch.setattr(rows, "settled", lambda *_: bays[0].refined)
    for one in rows.learned(bays, NONE):
        assert one.shared["span_x"][0] == pytest.approx(4.6)
        assert [choice.chance for choice in one.choices] == pytest.approx([0.6, 0.4])

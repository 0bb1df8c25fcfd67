"""Bays of a row."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from families import FAMILIES, Barrel, Profile, Segmental, Semicircular, Vault
from segmentation.cloud import Cloud
from vaultcad.find import rows
from vaultcad.find.found import Found
from vaultcad.find.neighbours import Row, rows_of
from vaultcad.find.refine import settled
from vaultcad.find.rows import _Agreed, learned, shared_by
from vaultcad.find.search import under_one_ceiling
from vaultcad.find.second_look import SecondLook
from vaultcad.fit.demands import constraints_of
from vaultcad.fit.freedom import NONE, Demands, decides
from vaultcad.fit.uncertainty import covariance
from vaultcad.measure.coverage import look
from vaultcad.measure.estimates import estimates
from vaultcad.scanner import ScannerSettings, scan
from vaultcad.survey.thinned_scan import thin_scan

SETTINGS = ScannerSettings(points=150_000, noise=0.002, settlement=0.01, mixed=0)


@cache
def fitted(profile: Profile) -> Found:
    """The barrel over a room that has settled."""
    room = scan(Barrel(5.3, 4.0, profile), SETTINGS, rng=np.random.default_rng(5))
    cloud = Cloud(room.xyz.astype(np.float32))
    (found,) = under_one_ceiling(thin_scan(cloud), cloud.xyz, (Barrel,), np.random.default_rng(0), NONE)
    return found


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.id)
def test_what_a_fit_may_move_goes_from_process_to_process(family: type[Vault]) -> None:
    vault = family()
    own, values = {p.name for p in vault.parameters()}, vault.derived_values()
    lengths = {name: values[name] for name, parameter in decides(family).items() if parameter in own}
    free = Demands(sizes=lengths).freedom(vault, constraints_of(family))
    again = pickle.loads(pickle.dumps(free))
    assert again.settled(vault, {}) == free.settled(vault, {})


def test_a_bay_is_not_fitted_with_what_takes_it_off_its_stone(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is left near a vault that lies beside its stone may scatter as little: a choir narrower than its nave."""
    found = fitted(Semicircular())
    joint = {choice.kinds: 1.0 for choice in found.choices}
    row = _Agreed(
        joint, found.choices[0].kinds, {"span": (found.placed.vault.values()["span"], 0.01)}, frozenset({"span"})
    )

    def moved(by: float) -> Found:
        solution, pose = found.refined.solution, found.placed.pose
        there = replace(solution, placed=replace(found.placed, pose=replace(pose, x=pose.x + by)))
        monkeypatch.setattr(rows, "settled", lambda *_: replace(found.refined, solution=there))
        return row.fitted(found, NONE)

    assert moved(0.5) is found
    assert moved(0.005).placed.pose.x == pytest.approx(found.placed.pose.x + 0.005)


def test_what_follows_from_the_sizes_of_a_row_is_as_unsure_as_the_row_is_of_it() -> None:
    """Else a radius would be exact that hangs on a span and a rise which are not."""
    found = fitted(Segmental(0.3))
    bays = [replace(found, choices=found.choices[:1])] * 3
    (one, *_) = learned([bays[0], *(_beside(bay, k) for k, bay in enumerate(bays[1:], 1))], NONE)
    assert {"span", "rise", "radius"} <= one.shared.keys()
    sight = look(one.placed.vault, one.refined.points, 0.1, np.random.default_rng(0))
    spread = covariance(one.refined.loose, one.refined.points)
    told = estimates(one.refined.loose, one.refined.points, sight, spread, shared=one.shared)
    for name in ("span", "rise", "radius"):
        assert told[name].std == pytest.approx(one.shared[name][1])
        assert "row" in told[name].flags


def test_a_corner_bay_with_other_arches_leaves_a_row_what_it_shares() -> None:
    """What can be asked of a fit depends on the arches of the row, not on those of the first bay in it."""
    found = fitted(Segmental(0.3))
    bay = replace(found, choices=found.choices[:1])
    round_one = found.placed.vault.with_arches({"profile": Semicircular()})
    solution = replace(found.refined.solution, placed=replace(found.placed, vault=round_one))
    other = replace(bay, refined=replace(found.refined, solution=solution))
    bays = [other, *(_beside(bay, k) for k in (1, 2, 3))]
    shared = shared_by(bays, Row((0, 1, 2, 3)))
    assert {"span", "rise"} <= shared.keys()


def test_a_segment_that_came_out_round_tells_a_row_no_rise() -> None:
    """It rests at the end of its range and seems exact: a walk of six bays shared nothing, or would its rise."""
    found = fitted(Segmental(0.3))
    first = found.choices[0]
    first = replace(first, sizes=first.sizes | {"rise": (first.sizes["rise"][0], 0.6)})
    vault = first.placed.vault.with_arches({"profile": Segmental(0.5)})
    rise = vault.derived_values()["rise"]
    round_one = replace(first, placed=replace(first.placed, vault=vault), sizes=first.sizes | {"rise": (rise, 1e-4)})
    last = replace(_beside(found, 3), choices=(round_one,))
    bays = [*(replace(_beside(found, k), choices=(first,)) for k in range(3)), last]
    mean, _ = shared_by(bays, Row((0, 1, 2, 3)))["rise"]
    assert mean == pytest.approx(first.sizes["rise"][0])


def test_a_bay_that_differs_keeps_its_own_sizes_and_the_others_share_theirs() -> None:
    """It spoilt the row before: all kept their own, or were drawn to it."""
    found = fitted(Semicircular())
    first = found.choices[0]
    spans = [5.29, 5.295, 5.3, 5.305, 5.39]

    def bay(k: int) -> Found:
        one = _beside(found, k) if k else found
        vault = replace(first.placed.vault, span=spans[k])
        placed = replace(one.placed, vault=vault)
        sizes = first.sizes | {"span": (spans[k], 0.008), "rise": (spans[k] / 2, 0.004)}
        solution = replace(one.refined.solution, placed=placed)
        choice = replace(first, placed=placed, sizes=sizes, chance=1.0)
        return replace(one, choices=(choice,), refined=replace(one.refined, solution=solution))

    bays = [bay(k) for k in range(5)]
    (row,) = rows_of(bays)
    assert shared_by(bays, row)["span"][0] == pytest.approx(5.2975)
    *alike, odd = learned(bays, NONE)
    assert all(one.shared["span"][0] == pytest.approx(5.2975) for one in alike)
    assert "span" not in odd.shared


@pytest.mark.parametrize("off", [0.0, 0.1])
def test_a_bay_whose_stone_speaks_against_the_sizes_of_its_row_keeps_its_own(off: float) -> None:
    """Corner bays that were looked at again had spans 11 cm off, with 5 mm of deviation."""
    found = fitted(Semicircular())
    span = found.placed.vault.values()["span"] - off
    held = Demands(sizes={"span": span})
    start = replace(found.placed, vault=held.begun(found.placed.vault))
    refined = settled(start, found.refined.kept, found.refined.evidence, found.refined.scatter, held)
    second = SecondLook(1, found, {"span": (span, 0.004)})
    taken = second.taken(replace(found, refined=refined), (), NONE, np.random.default_rng(0))
    assert taken.placed.vault.values()["span"] == pytest.approx(span + off, abs=0.005)
    assert taken.shared == ({} if off else second.shared)
    assert taken.choices


def _beside(bay: Found, number: int) -> Found:
    """The same bay so many lengths farther along its axis."""
    pose = bay.placed.pose
    away = number * (bay.placed.vault.plan.half[1] * 2 + 0.5)
    there = replace(pose, x=pose.x - away * np.sin(pose.yaw), y=pose.y + away * np.cos(pose.yaw))
    solution = bay.refined.solution
    placed = replace(solution.placed, pose=there)
    moved = bay.refined.evidence.points + (there.x - pose.x, there.y - pose.y, 0.0)
    evidence = replace(bay.refined.evidence, points=moved)
    choices = tuple(replace(choice, placed=replace(choice.placed, pose=there)) for choice in bay.choices)
    refined = replace(bay.refined, solution=replace(solution, placed=placed, points=moved), evidence=evidence)
    return replace(bay, refined=refined, choices=choices)

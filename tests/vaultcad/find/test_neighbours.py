"""Rows of bays, grids of them, and the corners at which they end."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from families import Barrel, Groin, Sail, Segmental, Vault
from tests.vaultcad.find.test_likeness import found, site
from vaultcad.find import rows
from vaultcad.find.choices import Choice
from vaultcad.find.found import Found
from vaultcad.find.neighbours import along, faced, rows_of
from vaultcad.find.refine import Refined, settled
from vaultcad.find.rows import learned, shared_by
from vaultcad.fit.evidence import Evidence
from vaultcad.fit.freedom import NONE
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose

GAP = 0.4  # m


def bay(vault: Vault, x: float, y: float, yaw: float = 0.0) -> Found:
    """A bay whose only choice tells its sizes to 8 mm."""
    pose = Pose(x, y, 3.0, yaw)
    sizes = {name: (value, 0.008) for name, value in {**vault.values(), **vault.derived_values()}.items()}
    sizes |= {name: (getattr(pose, name), 0.008) for name in ("x", "y", "z", "yaw")}
    choice = Choice(Placed(vault, pose), (), 1.0, sizes)
    return replace(found(vault, pose, site(pose, 0)), choices=(choice,))


def test_a_row_runs_on_where_a_walk_turns_but_its_corner_is_not_as_long_as_its_bays() -> None:
    walk, corner = Groin(2.91, 2.94), Groin(2.91, 2.91)
    along_y = [bay(walk, 0.0, (2.94 + GAP) * k) for k in (1, 2)]
    along_x = [bay(Groin(2.94, 2.91), (2.94 + GAP) * k, 0.0) for k in (1, 2, 3)]
    bays = [*along_y, bay(corner, 0.0, 0.0), *along_x]
    one, other = rows_of(bays)
    assert [one.bays, other.bays] == [(0, 1), (2, 3, 4, 5)]
    assert (one.corners, other.corners) == ({}, {2: 0})
    assert shared_by(bays, other)["span_x"][0] == pytest.approx(2.94)
    assert shared_by(bays, other)["span_y"][0] == pytest.approx(2.91)
    assert shared_by(bays, one)["span_y"][0] == pytest.approx(2.94)


def test_a_grid_of_bays_is_one_and_has_no_corners() -> None:
    (row,) = rows_of([bay(Groin(2.9, 2.7), (2.9 + GAP) * i, (2.7 + GAP) * j) for i in range(3) for j in range(2)])
    assert row.bays == (0, 1, 2, 3, 4, 5)
    assert not row.corners


@pytest.mark.parametrize(
    ("vault", "turned"),
    [
        (Sail(3.1, 3.9, 0.6), Sail(3.9, 3.1, 0.6)),
        (Groin(3.1, 3.9, Segmental(0.45), Segmental(0.36)), Groin(3.9, 3.1, Segmental(0.36), Segmental(0.45))),
    ],
    ids=["sail", "groin"],
)
def test_what_is_called_long_and_wide_the_other_way_is_a_bay_of_its_row_all_the_same(
    vault: Vault, turned: Vault
) -> None:
    step = vault.plan.half[1] * 2 + GAP
    bays = [bay(vault, 0.0, 0.0), bay(turned, 0.0, step, pi / 2), bay(vault, 0.0, 2 * step, pi)]
    rng = np.random.default_rng(0)
    placed = bays[1].placed
    frame, local = placed.pose.frame(), turned.sample(800, rng).xyz
    points = (local - frame[:, 3]) @ frame[:, :3]
    refined = settled(placed, (), Evidence(points, np.ones(len(points)), -np.inf), 0.003)
    bays[1] = replace(bays[1], refined=refined)
    (row,) = rows_of(bays)
    assert row.bays == (0, 1, 2)
    told = faced(bays, NONE)
    assert told[0] is bays[0]
    assert told[2] is bays[2]
    values = told[1].placed.vault.values()
    assert all(values[name] == pytest.approx(value, abs=1e-4) for name, value in vault.values().items())
    assert np.abs(told[1].placed.distance(points)).max() < 1e-4
    assert told[1].choices[0].placed.vault.kinds == vault.kinds
    assert shared_by(told, row)["span_x"][0] == pytest.approx(3.1, abs=1e-3)


def test_a_barrel_at_right_angles_is_no_bay_of_a_row() -> None:
    assert rows_of([bay(Barrel(3.0, 3.0), 0.0, 0.0), bay(Barrel(3.0, 3.0), 0.0, 3.4, pi / 2)]) == []


def test_what_makes_a_plan_longer_is_told_by_the_plan_itself() -> None:
    assert along(Groin(3.0, 4.0), 0) == {"span_x"}
    assert along(Barrel(3.0, 4.0), 1) == {"length"}


def test_what_was_built_as_high_tells_rises_together_and_plans_each_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """As the wings of a walk, or an aisle and its mirror; another storey is another matter."""
    rises = [1.36, 1.38, 1.37, 1.35, 1.50, 1.50]
    spans = [3.20, 3.20, 3.22, 3.22, 3.20, 3.20]
    bays = []
    for k, (rise, span) in enumerate(zip(rises, spans, strict=True)):
        one = bay(Barrel(span, 4.0, Segmental(rise / span)), 9.0 * (k // 2), 4.4 * (k % 2))
        there = replace(one.placed.pose, z=3.0 if k < 4 else 7.0)
        solution = replace(one.refined.solution, placed=replace(one.placed, pose=there))
        bays.append(replace(one, refined=replace(one.refined, solution=solution)))
    fit = bays[0].refined

    def at_rest(start: Placed, *_: object) -> Refined:
        return replace(fit, solution=replace(fit.solution, placed=start))

    monkeypatch.setattr(rows, "settled", at_rest)
    shared = [one.shared for one in learned(bays, NONE)]
    assert [one["rise"][0] for one in shared] == pytest.approx([1.365] * 4 + [1.5] * 2)
    assert [one["span"][0] for one in shared] == pytest.approx(spans)

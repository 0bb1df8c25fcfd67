"""Which bays stand next to each other and may have been built alike: rows, and grids of them.

Rows end at corners. A bay about which a walk turns is as wide as either of its wings, and as long as neither's bays.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import pi

import numpy as np

from families import Vault
from families.declaration.constraints import Constraint
from families.declaration.symmetry import Symmetry
from vaultcad.find.choices import Choice
from vaultcad.find.found import Found
from vaultcad.find.refine import settled
from vaultcad.fit.freedom import Demands
from vaultcad.fit.solve import Placed

SIZE, SPRINGING = 0.2, 0.2  # share of a plan's size, and m of the springing, by which bays of a row may differ
APART, OUT_OF_LINE, TURN = 2.0, 0.5, 0.05  # m between two bays of a row; m across it; sine of their angle
LONGER = 1.01  # times that a size is as large, to see what the plan makes of it


@dataclass(frozen=True)
class Row:
    """Numbers, from 0, of bays that may have been built alike, in order.

    corners: those of them about which a walk turns, and the axis of theirs along which the row runs.
    """

    bays: tuple[int, ...]
    corners: Mapping[int, int] = field(default_factory=dict)


def rows_of(found: Sequence[Found]) -> list[Row]:
    """The neighbours that may have been built alike, by rows and grids of two or more."""
    beside: dict[int, dict[int, int]] = defaultdict(dict)  # bay -> bay next to it -> axis of the first
    for i, j in combinations(range(len(found)), 2):
        axis = _alike(found[i], found[j])
        if axis is not None:
            beside[i][j], beside[j][i] = axis, (axis + _quarters(found[i], found[j])) % 2
    corners = {k: _way_on(found, k, near) for k, near in beside.items() if _is_corner(beside, k)}
    row = list(range(len(found)))
    for i, near in beside.items():
        for j, axis in near.items():
            if corners.get(i, axis) == axis and corners.get(j, beside[j][i]) == beside[j][i]:
                row = [row[i] if k == row[j] else k for k in row]
    groups = [[k for k, r in enumerate(row) if r == first] for first in dict.fromkeys(row)]
    return [Row(tuple(own), {k: corners[k] for k in own if k in corners}) for own in groups if len(own) > 1]


def faced(found: Sequence[Found], demands: Demands) -> list[Found]:
    """The same vaults; those of a row in the frame of its first, where that is turned by a right angle against theirs.

    What is as long and wide there may have been called wide and long.
    """
    out = list(found)
    for row in rows_of(found):
        for k in row.bays:
            turn = out[k].placed.vault.quarter_turn
            if turn is not None and _quarters(out[row.bays[0]], out[k]) % 2:
                out[k] = _turned(out[k], turn, demands)
    return out


def along(vault: Vault, axis: int) -> frozenset[str]:
    """The lengths among its parameters by which a plan is longer along an axis of its own."""
    half, values = vault.plan.half[axis], vault.values()
    lengths = {p.name: p.range for p in vault.parameters() if p.range.unit == "m"}
    changed = {
        name: values[name] * LONGER if values[name] * LONGER < of.high else values[name] / LONGER
        for name, of in lengths.items()
    }
    return frozenset(name for name, value in changed.items() if vault.replaced({name: value}).plan.half[axis] != half)


def _quarters(one: Found, other: Found) -> int:
    """By how many right angles, 0 to 3, a vault is about turned against another."""
    return round((other.placed.pose.yaw - one.placed.pose.yaw) / (pi / 2)) % 4


def _alike(one: Found, other: Found) -> int | None:
    """The axis of a vault along which one of its family is next to it in line, about as large and high, if it is."""
    a, b, quarters = one.placed, other.placed, _quarters(one, other)
    if type(a.vault) is not type(b.vault) or abs(a.pose.z - b.pose.z) > SPRINGING:
        return None
    if abs(np.sin(b.pose.yaw - a.pose.yaw - quarters * pi / 2)) > TURN:
        return None
    if quarters % 2 and not (_can_turn(a.vault) and _can_turn(b.vault)):
        return None
    half, others = a.vault.plan.half, np.roll(b.vault.plan.half, quarters % 2)
    if (np.abs(half - others) > SIZE * np.maximum(half, others)).any():
        return None
    c, s = np.cos(a.pose.yaw), np.sin(a.pose.yaw)
    away = np.abs(np.array([[c, s], [-s, c]]) @ (b.pose.x - a.pose.x, b.pose.y - a.pose.y))
    gaps = away - half - others
    return next((k for k in range(2) if gaps[k] < APART and away[1 - k] < OUT_OF_LINE), None)


def _can_turn(vault: Vault) -> bool:
    return vault.quarter_turn is not None and vault.skew is None


def _is_corner(beside: Mapping[int, Mapping[int, int]], k: int) -> bool:
    """Whether a bay has others beside it along both axes, but nothing between these: a walk turns there, or meets one.

    In a grid of bays every corner has one across from it.
    """
    pairs = [(i, j) for i, axis in beside[k].items() if axis == 0 for j, other in beside[k].items() if other == 1]
    return bool(pairs) and not any((beside[i].keys() & beside[j].keys()) - {k} for i, j in pairs)


def _way_on(found: Sequence[Found], k: int, near: Mapping[int, int]) -> int:
    """The axis of a corner along which the row runs that it is counted to: where there are more, or more alike."""
    half = found[k].placed.vault.plan.half

    def off(j: int) -> float:
        return float(np.abs(half - np.roll(found[j].placed.vault.plan.half, _quarters(found[k], found[j]) % 2)).max())

    ways = [[j for j, axis in near.items() if axis == way] for way in range(2)]
    return max(range(2), key=lambda way: (len(ways[way]), -min(off(j) for j in ways[way])))


def _turned(one: Found, turn: Symmetry, demands: Demands) -> Found:
    """The same vault in a frame that is turned by a right angle."""

    def placed(old: Placed) -> Placed:
        arches = turn.names(old.vault.profiles)
        vault = old.vault.with_arches(arches).replaced(turn.sizes(old.vault.values()))
        return Placed(vault, replace(old.pose, yaw=old.pose.yaw + pi / 2))

    def kept(old: Sequence[Constraint], vault: Vault) -> tuple[Constraint, ...]:
        named = {c.name: c for c in demands.keepable(vault)}
        names = turn.names({c.name.replace("-", "_"): c for c in old})
        return tuple(named.get(name.replace("_", "-"), c) for name, c in names.items())

    def choice(old: Choice) -> Choice:
        means = {name: (-mean if name in turn.negated else mean, std) for name, (mean, std) in old.sizes.items()}
        yaw, std = old.sizes["yaw"]
        pose = {name: old.sizes[name] for name in ("x", "y")} | {"yaw": (yaw + pi / 2, std)}  # of the scan, not its own
        sizes = turn.names(means) | pose
        there = placed(old.placed)
        return replace(old, placed=there, kept=kept(old.kept, there.vault), sizes=sizes)

    there, refined = placed(one.placed), one.refined
    again = settled(there, kept(refined.kept, there.vault), refined.evidence, refined.scatter, demands)
    shared = turn.names(dict(one.shared))
    return replace(
        one, refined=again, tolerance=again.tolerance, choices=tuple(map(choice, one.choices)), shared=shared
    )

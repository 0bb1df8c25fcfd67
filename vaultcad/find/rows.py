"""Bays learn from each other: neighbours of one family that were built alike are fitted with what they share.

Each bay tells each size with a deviation of its own (`vaultcad.find.choices`). Where those of a row agree by the
chi-square test, their weighted mean stands for all; kinds of arches are chosen by the mean odds of all bays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import exp, log, sqrt
from statistics import fmean

import numpy as np

from families import Vault
from families.declaration.constraints import Constraint
from families.declaration.parameters import derived_declarations
from families.declaration.profiles import as_kind
from vaultcad.find.choices import Choice
from vaultcad.find.found import Found
from vaultcad.find.recognise import Kinds
from vaultcad.find.refine import settled
from vaultcad.fit.freedom import BAYS, Demands, decides
from vaultcad.fit.solve import Placed
from vaultcad.processes import spread

SIZE, SPRINGING = 0.2, 0.2  # share of a plan's size, and m of the springing, by which bays of a row may differ
APART, OUT_OF_LINE, TURN = 2.0, 0.5, 0.05  # m between two bays of a row; m across it; sine of their angle
FORGOTTEN = 1e-3  # chance of a kind that a bay does not list
AGREE = 0.99  # level of the test
EXACT = 0.003  # m; no size is known better by one bay
LOST = 0.03  # share of the stone of a bay that may be farther from it with what it shares
WORSE = 1.3, 1e-3  # times, and m, by which the scatter of a bay may grow with what it shares


def learned(found: Sequence[Found], demands: Demands) -> tuple[Found, ...]:
    """The vaults of a scan, those of rows fitted again with what they share; all as they are where bays are free."""
    rows = [] if BAYS.name in demands.freed else rows_of(found)
    told = {k: _told([found[j] for j in row]) for row in rows for k in row}
    numbers = [k for k, row in told.items() if row is not None]

    def work(n: int) -> Found:
        row = told[numbers[n]]
        assert row is not None
        return row.fitted(found[numbers[n]], demands)

    out = list(found)
    for k, one in zip(numbers, spread(work, len(numbers)), strict=True):
        out[k] = one
    return tuple(out)


@dataclass(frozen=True)
class _Row:
    """What equal bays tell together: how likely each choice of kinds is for all, and the sizes in which they agree.

    demanded: the names of those sizes that can be asked of a fit; the others follow from these, or from none.
    """

    joint: Mapping[Kinds, float]
    kinds: Kinds
    shared: Mapping[str, tuple[float, float]]
    demanded: frozenset[str]

    def fitted(self, one: Found, demands: Demands) -> Found:
        """A bay fitted again with what it shares; as it is where the stone says otherwise."""
        start, kept = self._start(one)
        known = {name: std for name, (_, std) in one.shared.items()}  # of a bay that had a second look
        told = {
            name: (mean, max(std, known.get(name, 0.0)))
            for name, (mean, std) in self.shared.items()
            if name not in demands.sizes
        }
        sizes = {name: mean for name, (mean, _) in told.items() if name in self.demanded}
        asked = replace(demands, sizes=sizes | dict(demands.sizes))
        if not sizes or not asked.suits(start.vault):
            return one
        begun = replace(start, vault=asked.begun(start.vault))
        if not asked.met(begun.vault):
            return one
        refined = settled(begun, kept, one.refined.evidence, one.refined.scatter, asked)
        if refined.scatter > WORSE[0] * one.refined.scatter + WORSE[1]:
            return one
        if _share_near(refined.placed, one) < _share_near(one.placed, one) - LOST:
            return one
        return replace(one, refined=refined, tolerance=refined.tolerance, choices=self._weighed(one), shared=told)

    def _start(self, one: Found) -> tuple[Placed, tuple[Constraint, ...]]:
        """Where to begin with the arches of the row, and the constraints then kept."""
        for choice in one.choices:
            if choice.kinds == self.kinds:
                return choice.placed, choice.kept
        old = one.placed.vault.profiles
        arches = {name: as_kind(kind, arch) for (name, arch), kind in zip(old.items(), self.kinds, strict=True)}
        known = {name: arch for name, arch in arches.items() if arch is not None}
        return replace(one.placed, vault=one.placed.vault.with_arches(known)), one.refined.kept

    def _weighed(self, one: Found) -> tuple[Choice, ...]:
        """The choices of a bay, those with the arches of the row first, as likely as all bays together make them."""
        mine = _kinds(one.choices)
        choices = sorted(one.choices, key=lambda choice: choice.kinds != self.kinds)
        weighed = [c.chance * self.joint[c.kinds] / mine[c.kinds] for c in choices]
        return tuple(replace(c, chance=w / sum(weighed)) for c, w in zip(choices, weighed, strict=True))


def _share_near(placed: Placed, one: Found) -> float:
    """Share of the stone that a bay rests on which is as near to a vault as what is called the bay's."""
    evidence = one.refined.evidence
    near = np.abs(placed.distance(evidence.points)) < one.tolerance
    return float(evidence.weights @ near / max(evidence.weights.sum(), 1e-12))


def _told(row: Sequence[Found]) -> _Row | None:
    """What these bays tell together; None if nobody knows their arches."""
    joint = _joint(row)
    if not joint:
        return None
    kinds = max(joint, key=lambda kinds: joint[kinds])
    own = [one for one in row if not one.shared]  # others have their sizes from these
    picked = [next((c for c in one.choices if c.kinds == kinds), None) for one in own]
    choices = [choice for choice in picked if choice is not None]
    shared = _shared(choices)
    return _Row(joint, kinds, shared, _demandable(choices[0].placed.vault) & shared.keys() if shared else frozenset())


def shared_by(row: Sequence[Found]) -> Mapping[str, tuple[float, float]]:
    """Mean and standard deviation of the lengths in which bays of a row agree and which can be asked, by name [m]."""
    told = _told(row)
    return {name: told.shared[name] for name in told.demanded} if told else {}


def _demandable(vault: Vault) -> frozenset[str]:
    """The lengths of a vault that can be asked of a fit: its parameters, and what one of these decides alone."""
    own = {p.name for p in vault.parameters()}
    lengths = {p.name for p in vault.parameters() if p.range.unit == "m"}
    return frozenset(lengths | {name for name, parameter in decides(type(vault)).items() if parameter in own})


def lengths_of(vault: Vault) -> list[str]:
    """All lengths of a vault that bays may have in common, by name."""
    every = _demandable(vault) | {name for name, one in derived_declarations(type(vault)).items() if one.unit == "m"}
    return sorted(name for name in every if not name.startswith("skew"))


def rows_of(found: Sequence[Found]) -> list[list[int]]:
    """The numbers, from 0, of neighbours that may have been built alike, by rows and grids of two or more."""
    row = list(range(len(found)))
    for i, j in combinations(range(len(found)), 2):
        if _alike(found[i], found[j]):
            row = [row[i] if k == row[j] else k for k in row]
    groups = [[k for k, r in enumerate(row) if r == first] for first in dict.fromkeys(row)]
    return [group for group in groups if len(group) > 1]


def _alike(one: Found, other: Found) -> bool:
    """Whether two vaults are of one family, next to each other in line, and about as large and high."""
    a, b = one.placed, other.placed
    if type(a.vault) is not type(b.vault) or abs(np.sin(a.pose.yaw - b.pose.yaw)) > TURN:
        return False
    if abs(a.pose.z - b.pose.z) > SPRINGING:
        return False
    half, others = a.vault.plan.half, b.vault.plan.half
    if (np.abs(half - others) > SIZE * np.maximum(half, others)).any():
        return False
    c, s = np.cos(a.pose.yaw), np.sin(a.pose.yaw)
    away = np.abs(np.array([[c, s], [-s, c]]) @ (b.pose.x - a.pose.x, b.pose.y - a.pose.y))
    gaps = away - half - others
    return any(gaps[axis] < APART and away[1 - axis] < OUT_OF_LINE for axis in range(2))


def _joint(row: Sequence[Found]) -> dict[Kinds, float]:
    """How likely each choice of kinds is, if all bays have the same: as the middling bay tells.

    Bays that were built alike and settled together err alike, and each has counted what is known beforehand: taken as
    evidence one of the other, eight that say 45 % would be sure.
    """
    told = [_kinds(one.choices) for one in row if one.choices]
    every = dict.fromkeys(kinds for chances in told for kinds in chances)
    raw = {kinds: exp(fmean(log(max(chances.get(kinds, 0.0), FORGOTTEN)) for chances in told)) for kinds in every}
    whole = sum(raw.values())
    return {kinds: chance / whole for kinds, chance in raw.items()}


def _kinds(choices: Sequence[Choice]) -> dict[Kinds, float]:
    found: dict[Kinds, float] = {}
    for choice in choices:
        found[choice.kinds] = found.get(choice.kinds, 0.0) + choice.chance
    return found


def _shared(choices: Sequence[Choice]) -> dict[str, tuple[float, float]]:
    """Mean and standard deviation of the lengths in which bays agree; springings have settled each its own way."""
    from scipy.stats import chi2

    if len(choices) < 2:
        return {}
    found = {}
    for name in lengths_of(choices[0].placed.vault):
        told = [choice.sizes[name] for choice in choices if name in choice.sizes]
        if len(told) < len(choices):
            continue
        mean, std = np.array(told).T
        weight = 1 / (std**2 + EXACT**2)
        middle = float(weight @ mean / weight.sum())
        if float(weight @ (mean - middle) ** 2) < chi2.ppf(AGREE, len(mean) - 1):
            # All of a row has settled together: many bays tell no more than one of them, but the same.
            found[name] = middle, sqrt(len(mean) / float(weight.sum()))
    return found

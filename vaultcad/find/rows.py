"""Bays learn from each other: neighbours of one family that were built alike are fitted with what they share.

Each bay tells each size with a deviation of its own (`vaultcad.find.choices`). Those of a row that agree by the
chi-square test share their weighted mean, if they are most; others keep their own. Kinds of arches are chosen by the
mean odds of all bays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, log, sqrt
from statistics import fmean

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.constraints import Constraint
from families.declaration.parameters import derived_declarations
from families.declaration.profiles import as_kind
from vaultcad.find.choices import Choice
from vaultcad.find.found import Found
from vaultcad.find.neighbours import SPRINGING, Row, along, faced, rows_of
from vaultcad.find.recognise import Kinds, kinds_of
from vaultcad.find.refine import settled
from vaultcad.fit.freedom import BAYS, Demands, decides
from vaultcad.fit.solve import Placed
from vaultcad.processes import spread

FORGOTTEN = 1e-3  # chance of a kind that a bay does not list
AGREE = 0.99  # level of the test
EXACT = 0.003  # m; no size is known better by one bay
LOST = 0.03  # share of the stone of a bay that may be farther from it with what it shares
WORSE = 1.3, 1e-3  # times, and m, by which the scatter of a bay may grow with what it shares


def learned(found: Sequence[Found], demands: Demands) -> tuple[Found, ...]:
    """The vaults of a scan, those of rows fitted again with what they share; all as they are where bays are free."""
    if BAYS.name in demands.freed:
        return tuple(found)
    bays = faced(found, demands)
    rows = rows_of(bays)

    def fitted(told: Mapping[int, _Agreed]) -> list[Found]:
        out, numbers = list(bays), list(told)
        work = [(told[k], bays[k]) for k in numbers]
        for k, one in zip(numbers, spread(lambda n: work[n][0].fitted(work[n][1], demands), len(work)), strict=True):
            out[k] = one
        return out

    def agreed(plans: Sequence[Found]) -> dict[int, _Agreed]:
        every = ((row.bays, _told(bays, row, plans, rows)) for row in rows)
        return {k: one for numbers, told in every for k, one in zip(numbers, told, strict=True) if one is not None}

    as_high = fitted({k: one.heights(bays[k].placed.vault) for k, one in agreed(bays).items()})
    return tuple(fitted(agreed(as_high)))


@dataclass(frozen=True)
class _Agreed:
    """What a bay has in common with its row: how likely each choice of kinds is for all, and the sizes that it shares.

    demanded: the names of those sizes that can be asked of a fit; the others follow from these, or from none.
    """

    joint: Mapping[Kinds, float]
    kinds: Kinds
    shared: Mapping[str, tuple[float, float]]
    demanded: frozenset[str]

    def heights(self, vault: Vault) -> _Agreed:
        """The same without what makes the plan of a bay longer or wider, which hangs on how high that is."""
        return replace(self, demanded=self.demanded - along(vault, 0) - along(vault, 1))

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


def _told(found: Sequence[Found], row: Row, plans: Sequence[Found], rows: Sequence[Row] = ()) -> list[_Agreed | None]:
    """What each bay of a row has in common with it; None if nobody knows their arches.

    plans: the same bays as they were fitted to tell their plans. rows: all of the scan. What was built as high, as the
    other aisle or the next wing, tells heights as well.
    """
    bays = [found[k] for k in row.bays]
    joint = _joint(bays)
    if not joint:
        return [None] * len(bays)
    kinds = max(joint, key=lambda kinds: joint[kinds])
    told = {k: sizes for k, one in enumerate(bays) if (sizes := _sizes(one, kinds, plans[row.bays[k]].placed.vault))}
    vault = next(choice for one in bays for choice in one.choices if choice.kinds == kinds).placed.vault
    own = {k: along(bays[k].placed.vault, row.corners[n]) for k, n in enumerate(row.bays) if n in row.corners}
    shared: list[dict[str, tuple[float, float]]] = [{} for _ in bays]
    can, plan = _demandable(vault), along(vault, 0) | along(vault, 1)
    level = [
        _sizes(found[k], kinds, found[k].placed.vault)
        for other in rows
        if _is_as_high(found, row, other)
        for k in other.bays
    ]
    for name in lengths_of(vault):
        asked = [k for k in range(len(bays)) if name not in own.get(k, ())]
        telling = [k for k in asked if name in told.get(k, {})]
        mine = [told[k][name] for k in telling]
        agreed = _agreed(mine, tested=name in can)
        if agreed is not None:
            middle, std, agreeing = agreed
            more = [sizes[name] for sizes in level if name in sizes] if name not in plan else []
            every = _agreed([*mine, *more], tested=name in can)
            if more and every is not None and every[2].all():
                middle, std, _ = every
            apart = {telling[n] for n in np.flatnonzero(~agreeing)}
            for k in set(asked) - apart:
                shared[k][name] = middle, std
    return [_Agreed(joint, kinds, sizes, can & sizes.keys()) for sizes in shared]


def _is_as_high(found: Sequence[Found], row: Row, other: Row) -> bool:
    """Whether another row is of the same family, and springs from the same level."""
    one, two = (found[of.bays[0]].placed for of in (row, other))
    levels = [float(np.median([found[k].placed.pose.z for k in of.bays])) for of in (row, other)]
    return other != row and type(one.vault) is type(two.vault) and abs(levels[0] - levels[1]) < SPRINGING


def shared_by(found: Sequence[Found], row: Row) -> Mapping[str, tuple[float, float]]:
    """Mean and standard deviation of the lengths in which bays of a row agree and which can be asked, by name [m]."""
    return {name: told.shared[name] for told in _told(found, row, found) if told for name in told.demanded}


def _demandable(vault: Vault) -> frozenset[str]:
    """The lengths of a vault that can be asked of a fit: its parameters, and what one of these decides alone."""
    own = {p.name for p in vault.parameters()}
    lengths = {p.name for p in vault.parameters() if p.range.unit == "m"}
    return frozenset(lengths | {name for name, parameter in decides(type(vault)).items() if parameter in own})


def lengths_of(vault: Vault) -> list[str]:
    """All lengths of a vault that bays may have in common, by name."""
    every = _demandable(vault) | {name for name, one in derived_declarations(type(vault)).items() if one.unit == "m"}
    return sorted(name for name in every if not name.startswith("skew"))


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


def _sizes(one: Found, kinds: Kinds, fitted: Vault) -> Mapping[str, tuple[float, float]]:
    """Mean and standard deviation of the lengths of a bay with these arches, by name [m]; nothing if it tells none.

    A bay that has them from its row tells none, nor does one at the end of its range, as a segment that came out round.
    Those of the plan are as all its stone has them, in `fitted`: what the field of a settlement is told of leaves out
    what is near walls and edges, which show them best.
    """
    choice = next((choice for choice in one.choices if choice.kinds == kinds), None)
    if choice is None or one.shared:
        return {}
    values = (fitted if kinds_of(fitted) == kinds else choice.placed.vault).values()
    plan = along(fitted, 0) | along(fitted, 1)
    sizes = {**choice.sizes, **{name: (values[name], choice.sizes[name][1]) for name in plan & choice.sizes.keys()}}
    return {name: sizes[name] for name in sizes.keys() - _at_the_end(choice.placed.vault)}


def _at_the_end(vault: Vault) -> set[str]:
    """The sizes of a vault that are as large as they may be, and those that follow from one of these alone."""
    values = vault.values()
    ends = {p.name for p in vault.parameters() if values[p.name] >= p.range.high}
    return ends | {name for name, parameter in decides(type(vault)).items() if parameter in ends}


def _agreed(told: Sequence[tuple[float, float]], *, tested: bool) -> tuple[float, float, NDArray[np.bool_]] | None:
    """The mean of the most (mean, standard deviation) that agree, its own deviation, and which (n,) do; None if few.

    tested: whether they must agree by the chi-square test, as what only follows from other sizes need not.
    """
    from scipy.stats import chi2

    mean, std = np.array(told).reshape(-1, 2).T
    weight, order = 1 / (std**2 + EXACT**2), np.argsort(mean, kind="stable")
    for count in range(len(told), max(1, len(told) // 2), -1):  # most of them, and two at least
        best, middle, off = order, 0.0, np.inf
        for k in range(len(told) - count + 1):
            own = order[k : k + count]
            there = float(weight[own] @ mean[own] / weight[own].sum())
            if (apart := float(weight[own] @ (mean[own] - there) ** 2)) < off:
                best, middle, off = own, there, apart
        if not tested or off < chi2.ppf(AGREE, count - 1):
            # All of a row has settled together: many bays tell no more than one of them, but the same.
            return middle, sqrt(count / float(weight[best].sum())), np.isin(np.arange(len(told)), best)
    return None

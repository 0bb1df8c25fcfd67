"""Ceilings that a row lacks: refused alone, or of another family than the bays beside them, they may be bays of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np
from numpy.typing import NDArray

from vaultcad.find.found import Found, likeliest_of
from vaultcad.find.neighbours import APART, OUT_OF_LINE, faced, rows_of
from vaultcad.find.recognise import Hypothesis
from vaultcad.find.refine import gain, settled
from vaultcad.find.rows import shared_by
from vaultcad.fit.evidence import INDEPENDENT
from vaultcad.fit.freedom import NONE, Demands
from vaultcad.survey.parting import Ceiling
from vaultcad.survey.springings import Springing

Array = NDArray[np.float64]

LEVEL = 0.5  # m by which the crown of a bay may differ from its neighbours'
ODDS = 50.0  # how many times as often a bay is of the family of its row as of another
PART = 0.2  # share of a bay's plan over which its ceiling must have been seen


@dataclass(frozen=True)
class SecondLook:
    """What the ceiling with a number, from 0, may be: a bay like `beside`, with sizes that its row shares.

    shared: mean and standard deviation by name [m].
    """

    number: int
    beside: Found
    shared: Mapping[str, tuple[float, float]]

    def taken(
        self,
        found: Found,
        odd: Sequence[Found],
        demands: Demands,
        rng: np.random.Generator,
        springings: Sequence[Springing] = (),
    ) -> Found:
        """What was found as a bay of the row: no surer than its own stone, or else the bay beside it, tells.

        odd: what was found before, if anything was. demands: of the user. springings: of the arches in the scan.
        """
        if odd:
            own = _of_row(odd[0], self.beside)
            others = [h for h in odd[0].hypotheses if h is not own]
            chosen = [] if own is None else [replace(own, score=own.score - 2 * log(ODDS))]
        else:
            chosen, known = [found.hypotheses[0]], self.beside.hypotheses
            others = [replace(h, score=chosen[0].score + h.score - known[0].score) for h in known[1:]]
        bay = replace(found, hypotheses=(*chosen, *others), shared=self.shared)
        return self._as_its_stone(bay, demands, rng, springings) if self.shared else bay

    def _as_its_stone(
        self, held: Found, demands: Demands, rng: np.random.Generator, springings: Sequence[Springing]
    ) -> Found:
        """A bay with the sizes of the row, or with its own where its stone is clearly for others.

        As that of a corner is, which may be as wide as another wing.
        """
        with_row = held.refined
        free = settled(with_row.placed, with_row.kept, with_row.evidence, with_row.scatter, demands)
        if gain(free.evidence, with_row, free) < len(self.shared) * log(INDEPENDENT):
            return held
        own = replace(held, refined=free, tolerance=free.tolerance, shared={})
        return likeliest_of(own, demands, rng, springings=springings)


def second_looks(
    ceilings: Sequence[Ceiling], found: Sequence[Sequence[Found]], demands: Demands = NONE
) -> list[SecondLook]:
    """Which ceilings are worth one, from what was found under each: nothing, or one vault of another family."""
    under = [k for k, vaults in enumerate(found) for _ in vaults]
    every = faced([one for vaults in found for one in vaults], demands)
    rows = rows_of(every)
    settled = {under[n] for row in rows for n in row.bays}
    looks = []
    for k, ceiling in enumerate(ceilings):
        if k in settled or len(found[k]) > 1:
            continue
        for row in rows:
            beside = next((every[n] for n in row.bays if _is_beside(ceiling, every[n])), None)
            if beside is not None and all(_of_row(odd, beside) for odd in found[k]):
                looks.append(SecondLook(k, beside, shared_by(every, row)))
                break
    return looks


def _of_row(odd: Found, beside: Found) -> Hypothesis | None:
    """The hypothesis that a vault is of the family beside it, if that is likelier for its place; None if it is not."""
    own = next((h for h in odd.hypotheses if type(h.vault) is type(beside.placed.vault)), None)
    return own if own and own.score < odd.hypotheses[0].score + 2 * log(ODDS) else None


def _is_beside(ceiling: Ceiling, bay: Found) -> bool:
    """Whether a ceiling lies next to a bay, in line with it, as high, and no larger."""
    placed, plan = bay.placed, bay.placed.vault.plan
    frame = placed.pose.frame()
    local = ceiling.points @ frame[:, :3].T + frame[:, 3]
    low, high = np.quantile(local, (0.01, 0.99), axis=0)
    if abs(high[2] - placed.vault.top) > LEVEL or np.prod(high[:2] - low[:2]) < PART * plan.area:
        return False
    gap = np.maximum(low[:2] - plan.half, -plan.half - high[:2])  # beyond the bay's sides, along x and y
    within = (low[:2] > -plan.half - OUT_OF_LINE) & (high[:2] < plan.half + OUT_OF_LINE)
    fits = high[:2] - low[:2] < 2 * plan.half + OUT_OF_LINE
    return any(-OUT_OF_LINE < gap[axis] < APART and within[1 - axis] and fits[axis] for axis in range(2))

"""Ceilings that a row lacks: refused alone, or of another family than the bays beside them, they may be bays of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot, log

import numpy as np
from numpy.typing import NDArray

from vaultcad.find.found import Found
from vaultcad.find.recognise import Hypothesis
from vaultcad.find.refine import Refined, gain, settled
from vaultcad.find.rows import APART, OUT_OF_LINE, lengths_of, rows_of, shared_by
from vaultcad.fit.evidence import INDEPENDENT
from vaultcad.fit.freedom import Demands
from vaultcad.survey.parting import Ceiling

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

    def taken(self, found: Found, odd: Sequence[Found], demands: Demands) -> Found:
        """What was found as a bay of the row: no surer than its own stone, or else the bay beside it, tells.

        odd: what was found before, if anything was. demands: of the user.
        """
        if odd:
            own = _of_row(odd[0], self.beside)
            others = [h for h in odd[0].hypotheses if h is not own]
            chosen = [] if own is None else [replace(own, score=own.score - 2 * log(ODDS))]
        else:
            chosen, known = [found.hypotheses[0]], self.beside.hypotheses
            others = [replace(h, score=chosen[0].score + h.score - known[0].score) for h in known[1:]]
        return replace(found, hypotheses=(*chosen, *others), shared=self._borne_out(found.refined, demands))

    def _borne_out(self, held: Refined, demands: Demands) -> Mapping[str, tuple[float, float]]:
        """The sizes of the row: less sure by what they are off where the stone of the bay is clearly for others."""
        if not self.shared:
            return self.shared
        free = settled(held.placed, held.kept, held.evidence, held.scatter, demands)
        if gain(held.evidence, held, free) < len(self.shared) * log(INDEPENDENT):
            return self.shared
        own, mine = _lengths(held), _lengths(free)
        off = {name: abs(mine[name] - own[name]) for name in lengths_of(held.placed.vault) if name in mine}
        known = {name: (own[name], 0.0) for name in off} | dict(self.shared)
        return {name: (mean, hypot(std, off.get(name, 0.0))) for name, (mean, std) in known.items()}


def _lengths(refined: Refined) -> dict[str, float]:
    vault = refined.placed.vault
    return {**vault.values(), **vault.derived_values()}


def second_looks(ceilings: Sequence[Ceiling], found: Sequence[Sequence[Found]]) -> list[SecondLook]:
    """Which ceilings are worth one, from what was found under each: nothing, or one vault of another family."""
    every = [(k, one) for k, vaults in enumerate(found) for one in vaults]
    rows = [[every[j] for j in row] for row in rows_of([one for _, one in every])]
    settled = {k for row in rows for k, _ in row}
    looks = []
    for k, ceiling in enumerate(ceilings):
        if k in settled or len(found[k]) > 1:
            continue
        for row in rows:
            bays = [one for _, one in row]
            beside = next((one for one in bays if _is_beside(ceiling, one)), None)
            if beside is not None and all(_of_row(odd, beside) for odd in found[k]):
                looks.append(SecondLook(k, beside, shared_by(bays)))
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

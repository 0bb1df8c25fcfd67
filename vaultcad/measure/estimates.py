"""All numbers of a fitted vault with how sure they are, and marks on those that hang on stone nobody saw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from families.declaration.parameters import Derived, Range, derived_declarations
from vaultcad.find.choices import Choice, deviation
from vaultcad.fit.solve import Solution
from vaultcad.fit.uncertainty import slopes_of_sizes
from vaultcad.measure.coverage import Sight, information
from vaultcad.uncertain import Covariance, Estimate

UNSEEN = 0.5  # share of what could be told of a number below which it hangs on unseen stone
NOTHING = 1e-9  # standard deviation of what was fixed, by way of what follows it
WEAK_LENGTH = 0.03  # standard deviation of a length / shorter span, from which it is weak
WEAK_SHARE = 0.1  # the same of a ratio / its range


def estimates(
    solution: Solution,
    points: NDArray[np.float64],
    sight: Sight,
    covariance: Covariance,
    choices: Sequence[Choice] = (),
    shared: Mapping[str, tuple[float, float]] = MappingProxyType({}),
) -> dict[str, Estimate]:
    """Parameters, then derived sizes, of a solution that rests on points (n, 3) [m]; what was held has no deviation.

    choices: of how the vault may have been built, the solution's first; deviations allow for them. shared: mean and
    standard deviation of the sizes that all bays of its row have, if they were built as the first choice is [m]; what
    follows from those that were given it is no surer than the row is of it.
    """
    vault, slopes = solution.placed.vault, slopes_of_sizes(solution)
    told = information(solution, points, sight)
    short = vault.plan.width

    def estimate(name: str, value: float, of: Range | Derived, weak: float, *, derived: bool) -> Estimate:
        alone = covariance.std(slopes[name])
        of_row = name in shared and alone < NOTHING
        own = max(alone, shared[name][1]) if name in shared else alone
        std = deviation(name, value, own, choices)
        if std < NOTHING:
            return Estimate(value, of.unit, None, of.meaning, derived)
        # Where a constraint decides, other choices vary.
        seen = None if own < NOTHING or of_row else told.share(slopes[name])
        flags = {"unseen": seen is not None and seen < UNSEEN, "weak": std > weak, "row": of_row}
        return Estimate(value, of.unit, std, of.meaning, derived, seen, tuple(flag for flag, up in flags.items() if up))

    found, values = {}, vault.values()
    for p in vault.parameters():
        weak = WEAK_LENGTH * short if p.range.unit == "m" else WEAK_SHARE * (p.range.high - p.range.low)
        found[p.name] = estimate(p.name, values[p.name], p.range, weak, derived=False)
    declared = derived_declarations(type(vault))
    for name, value in vault.derived_values().items():
        found[name] = estimate(name, value, declared[name], WEAK_LENGTH * short, derived=True)
    return found

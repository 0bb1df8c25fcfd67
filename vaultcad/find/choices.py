"""With which arches and under which constraints a vault was built, and how sure that is.

A semicircle and a segment, an ellipse and a basket-handle differ by less than a vault settles, so the kind that is
nearest to the stone is often not the one that was built. Here every choice is fitted, and weighed by how likely the
motion is that would have brought it to where the stone stands (`vaultcad.find.likelihood`), and by what builders mostly
did (`vaultcad.find.practice`). Constraints take part: wall arches outside the springings, for example, pass for another
arch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from math import exp, log

import numpy as np
from numpy.typing import NDArray

from families import PROFILES
from families.declaration.constraints import Constraint
from families.declaration.profiles import as_kind
from vaultcad.find.identity import is_its_family
from vaultcad.find.likelihood import FIT_STEPS, GAIN, Field, Marginal
from vaultcad.find.practice import log_prior
from vaultcad.find.recognise import Kinds, kinds_of, turned_over
from vaultcad.find.refine import Refined, settled
from vaultcad.fit.freedom import RECTANGLE, Demands
from vaultcad.fit.solve import POSE, Placed, Solution
from vaultcad.model import Rival
from vaultcad.survey.springings import Springing
from vaultcad.uncertain import Covariance

Array = NDArray[np.float64]

CLEARLY = 3.0  # times as likely: then constraints are others than the fit's
SLIGHT = 1e-3  # chance below which a choice is forgotten
UNLIKELY = 4.0  # by which a score is below the best where what is next to it is not tried
HOLDS = 0.05  # chance, where it looks alike, of the likeliest arches, from which on no others need be tried
MOST_CHOICES = 8  # choices next to which others are tried


@dataclass(frozen=True)
class Choice:
    """One choice of arches and constraints, as it fits best.

    chance: how likely it is. sizes: mean and standard deviation, by name, of what it makes of sizes and pose before the
    settlement [m, rad, 1].
    """

    placed: Placed
    kept: tuple[Constraint, ...]
    chance: float
    sizes: Mapping[str, tuple[float, float]]

    @property
    def kinds(self) -> Kinds:
        """Of its arches, in the order of its fields."""
        return kinds_of(self.placed.vault)


def weigh(
    refined: Refined,
    demands: Demands,
    rng: np.random.Generator,
    known: Sequence[Choice] = (),
    springings: Sequence[Springing] = (),
) -> tuple[Choice, ...]:
    """All choices of arches and constraints that are not out of the question; none if there is too little stone.

    known: those of a vault that looks like this one; no others are looked for while these hold. springings: of the
    arches in the scan.
    The first has the likeliest arches, and the constraints of the fit unless others are clearly likelier with these;
    the likeliest of the rest follow.
    """
    moved = Field.of(refined, rng, springings)
    if moved is None:
        return ()
    search = _ChoiceSearch(moved, demands)
    if not search.among(refined.placed, refined.kept, known):
        search.around(refined.placed, refined.kept)
    fitted = sorted(search.fitted.values(), key=lambda one: -one.score)
    if not fitted:
        return ()
    first = _first(fitted, {c.name for c in refined.kept})
    fitted = [first, *(one for one in fitted if one is not first)]
    top = max(one.score for one in fitted)
    raw = [exp(one.score - top) for one in fitted]
    likely = [(one, chance) for one, chance in zip(fitted, raw, strict=True) if chance > SLIGHT * sum(raw)]
    whole = sum(chance for _, chance in likely)
    return tuple(
        Choice(one.placed, one.kept, chance / whole, moved.sizes(one.solution, one.told)) for one, chance in likely
    )


@dataclass(frozen=True)
class _Fitted:
    """One choice fitted, and what it says of the field. score: log of its odds, up to a constant."""

    solution: Solution
    kept: tuple[Constraint, ...]
    told: Marginal
    score: float

    @property
    def placed(self) -> Placed:
        return self.solution.placed

    @property
    def kinds(self) -> Kinds:
        return kinds_of(self.placed.vault)


def _first(fitted: Sequence[_Fitted], kept: set[str]) -> _Fitted:
    """The one to draw, of choices sorted by how likely they are."""
    whole: dict[Kinds, float] = {}
    for one in fitted:
        whole[one.kinds] = whole.get(one.kinds, 0.0) + exp(one.score - fitted[0].score)
    likeliest = max(whole, key=lambda kinds: whole[kinds])
    mine = [one for one in fitted if one.kinds == likeliest]
    same = [one for one in mine if {c.name for c in one.kept} == kept]
    return same[0] if same and same[0].score > mine[0].score - log(CLEARLY) else mine[0]


@dataclass(frozen=True)
class _ChoiceSearch:
    """The choices that were fitted so far, by kinds and the names of the constraints that are kept."""

    moved: Field
    demands: Demands
    fitted: dict[tuple[Kinds, frozenset[str]], _Fitted] = field(default_factory=dict)

    def among(self, placed: Placed, kept: tuple[Constraint, ...], known: Sequence[Choice]) -> bool:
        """Fit known choices, and tell whether that will do: the likeliest arches are not unlikely among those known."""
        if not known:
            return False
        self._try(placed, kinds_of(placed.vault), kept)
        for choice in known:
            start = placed
            if (choice.placed.vault.skew is None) != (placed.vault.skew is None):
                start, _ = turned_over(placed, kept, RECTANGLE)
            self._try(start, choice.kinds, choice.kept)
        if not self.fitted:
            return False
        best = max(self.fitted.values(), key=lambda one: one.score)
        return sum(choice.chance for choice in known if choice.kinds == best.kinds) > HOLDS

    def around(self, placed: Placed, kept: tuple[Constraint, ...]) -> None:
        """Fit all choices that are likely, and those next to them: one arch or one constraint is another."""
        count = len(placed.vault.profiles)
        for kind in PROFILES if count else ():
            self._try(placed, (kind,) * count, kept)
        self._try(placed, kinds_of(placed.vault), kept)
        seen: set[tuple[Kinds, frozenset[str]]] = set()
        while True:
            top = max((one.score for one in self.fitted.values()), default=0.0)
            fresh = [k for k, one in self.fitted.items() if k not in seen and one.score > top - UNLIKELY]
            if not fresh or len(seen) == MOST_CHOICES:
                return
            best = max(fresh, key=lambda k: self.fitted[k].score)
            seen.add(best)
            self._neighbours(self.fitted[best])

    def _neighbours(self, one: _Fitted) -> None:
        """Fit those next to one."""
        for k, kind in product(range(len(one.kinds)), PROFILES):
            self._try(one.placed, (*one.kinds[:k], kind, *one.kinds[k + 1 :]), one.kept)
        top = max(other.score for other in self.fitted.values())
        for constraint in self.demands.keepable(one.placed.vault):
            if constraint is RECTANGLE and one.score < top:  # hardly hangs on the arches, and costs time
                continue
            other, kept = turned_over(one.placed, one.kept, constraint)
            self._try(other, one.kinds, kept)

    def _try(self, start: Placed, kinds: Kinds, kept: tuple[Constraint, ...]) -> None:
        """Fit a choice, if there is a vault of the family with these arches that comes near, and nobody forbids it."""
        key = (kinds, frozenset(c.name for c in kept))
        old = start.vault.profiles
        wanted = [one for one in zip(old.items(), kinds, strict=True) if one[1] in start.vault.kinds_for(one[0][0])]
        new = {name: as_kind(kind, arch) for (name, arch), kind in wanted}
        arches = {name: arch for name, arch in new.items() if arch is not None}
        if key in self.fitted or len(arches) < len(old):
            return
        vault = start.vault.with_arches(arches)
        if not self.demands.suits(vault):
            return
        begun, moved = replace(start, vault=self.demands.begun(vault)), self.moved
        free = self.demands.freedom(begun.vault, kept)
        solution = moved.evidence.solve(begun, free, (moved.scale,), most=FIT_STEPS, gain=GAIN)
        fitted = solution.placed.vault
        if is_its_family(fitted) and self.demands.met(fitted) and moved.near(solution):
            told = moved.marginal(solution)
            score = moved.log_likelihood(solution, told) + log_prior(fitted, kept)
            self.fitted[key] = _Fitted(solution, kept, told, score)


def likeliest(refined: Refined, choices: Sequence[Choice], demands: Demands) -> Refined:
    """The fit with the arches and under the constraints of the first choice."""
    if not choices:
        return refined
    first, names = choices[0], {c.name for c in refined.kept}
    if first.kinds == kinds_of(refined.placed.vault) and {c.name for c in first.kept} == names:
        return refined
    return settled(first.placed, first.kept, refined.evidence, refined.scatter, demands)


def odds(choices: Sequence[Choice]) -> dict[str, dict[str, float]]:
    """How likely each kind of arch is in each place: field -> id -> chance, the likeliest first."""
    found: dict[str, dict[str, float]] = {}
    for choice in choices:
        for place, kind in choice.placed.vault.kinds.items():
            chances = found.setdefault(place, {})
            chances[kind] = chances.get(kind, 0.0) + choice.chance
    return {place: dict(sorted(chances.items(), key=lambda item: -item[1])) for place, chances in found.items()}


def rivals(choices: Sequence[Choice], placed: Placed) -> tuple[Rival, ...]:
    """The choices as they are reported, for a vault that was fitted with the first."""
    z = placed.pose.z
    return tuple(
        Rival(
            choice.chance,
            choice.placed.vault.kinds,
            tuple(c.name for c in choice.kept),
            {name: mean for name, (mean, _) in choice.sizes.items() if name not in POSE},
            choice.sizes["z"][0] - z,
        )
        for choice in choices
    )


def widened(spread: Covariance, placed: Placed, choices: Sequence[Choice]) -> Covariance:
    """A covariance of the unknowns of the first choice, with what the others make of these."""
    vault, pose = placed.vault, placed.pose
    here = {**vault.values(), **{name: getattr(pose, name) for name in POSE}}
    values, own = np.array([here[name] for name in spread.names]), np.sqrt(np.diag(spread.matrix))
    matrix = spread.matrix.copy()
    for choice in choices[1:]:
        means = [choice.sizes.get(name, (here[name], 0.0))[0] for name in spread.names]
        matrix += choice.chance * np.outer(means - values, means - values)
    wanted = [deviation(name, here[name], float(own[k]), choices) for k, name in enumerate(spread.names)]
    made = np.sqrt(np.diag(matrix))
    scale = np.array(wanted) / np.where(made > 0, made, 1.0)
    return Covariance(spread.names, matrix * np.outer(scale, scale))


def deviation(name: str, value: float, std: float, choices: Sequence[Choice]) -> float:
    """The standard deviation of a size over all choices, the first of which has this value and this deviation."""
    variance = std**2
    for choice in choices[1:]:
        mean, own = choice.sizes.get(name, (value, std))
        variance += choice.chance * ((mean - value) ** 2 + own**2 - std**2)
    return float(np.sqrt(max(variance, 0.0)))

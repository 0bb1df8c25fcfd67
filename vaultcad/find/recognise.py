"""Which family, with which profile: all are fitted to the site, and the one that explains it best for its size wins."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from math import exp, inf, log

import numpy as np
from numpy.typing import NDArray

from families import FAMILIES, Profile, Vault
from families.declaration.constraints import Constraint
from families.declaration.corners import Skew
from families.declaration.profiles import as_kind
from vaultcad.errors import NoVaultError
from vaultcad.find.first_guesses import starts
from vaultcad.find.identity import is_its_family, shows_its_family
from vaultcad.fit.evidence import INDEPENDENT, Evidence
from vaultcad.fit.freedom import NONE, RECTANGLE, Demands, Freedom
from vaultcad.fit.solve import Placed, Solution
from vaultcad.survey.thinned_scan import Site

Array = NDArray[np.float64]
Kinds = tuple[type[Profile], ...]

PAYS = 10.0  # by so much the score must fall for that
TRIED = 3  # starts of a variant of a family along an axis, unless it is a supple one
COARSE, MIDDLE, FINE = 0.15, 0.1, 0.05  # m, scales of the loss
FLOOR = 2e-3  # m; below this no scanner tells two models apart
CLOSE = 1e-3  # share of the cost that a step must still gain
FOREIGN = 1000.0  # on the score of what is rather another family's: it wins only where there is nothing else
MISSED = 0.01
"""Chance that the true family is there but its best fit was not found. With it, and the scores as they are, the truth
of 164 virtual rooms (seeds 5000 to 5069 and 5100 to 5197, 23 November 2026) was about the likeliest; on others it is
checked by `python -m bench rooms`."""
HOPELESS = 2.5  # a family whose cost is this much above the best one's is not refined
ARCHED = 6.0  # nor tried with other kinds of arches: a wide loss tells them badly, and the wrong kind costs so much
RIVAL = 15.0  # on the score: families as close as that are begun again from arches of each kind, if they have several
WIDER = 0.03  # m, least scale of the loss that then tells them apart


@dataclass(frozen=True)
class Hypothesis:
    """One family fitted to the site. kept: the constraints that it was fitted under.

    score: the lower the better; differences are twice those of a log likelihood; infinite without a size that is fixed.
    own: whether the scan shows what makes its family.
    """

    solution: Solution
    free: Freedom
    kept: tuple[Constraint, ...]
    cost: float
    score: float
    own: bool

    @property
    def vault(self) -> Vault:
        """The fitted vault."""
        return self.solution.placed.vault


@dataclass(frozen=True)
class Start:
    """Where a family may begin, in several ways of which one will do, and the constraints that it then keeps."""

    ways: tuple[Placed, ...]
    kept: tuple[Constraint, ...]

    def asked(self, demands: Demands) -> Start | None:
        """The same with arches that can have the sizes that are fixed; None where the family has none."""
        suited = [(way, demands.suited(way.vault)) for way in self.ways]
        ways = tuple(replace(way, vault=vault) for way, vault in suited if vault is not None)
        return Start(ways, self.kept) if ways else None


def recognise(
    site: Site,
    rng: np.random.Generator,
    *,
    families: Iterable[type[Vault]] = FAMILIES,
    demands: Demands = NONE,
    known: Sequence[Start] = (),
) -> tuple[Hypothesis, ...]:
    """Every family's best fit, the most likely first.

    known: where families begin, if a site that looks like this one tells it, and they need not be looked for.

    Raises:
        NoVaultError: none of the families comes near the points.
    """
    few, some = (Evidence.draw(site, count, rng, demands) for count in (1500, 3000))
    supple: list[Placed] = []
    if known := [start for one in known if (start := one.asked(demands)) is not None]:
        simple = [_nearest_way(start, few, some, demands) for start in known]
    else:
        simple, supple = _begun(families, lambda family, tried: _rough(family, site, few, some, demands, tried), some)
    rough = simple + supple
    if not rough:
        raise NoVaultError(
            "no vault found: nothing above the floor has the plan of a vault; scan a whole bay, or crop to it"
            + (", or fix other sizes" if demands.of_vault or demands.pose else "")
        )
    costs = [some.cost(placed, MIDDLE) for placed in rough]
    enough = HOPELESS * _least(rough, costs)
    hopeful = [placed for placed, cost in zip(rough, costs, strict=True) if cost <= enough]
    telling = Evidence.draw(site, 3000, rng, demands, about=hopeful)
    scale = _scale(rough[int(np.argmin(costs))], telling)
    judge = _Judge(telling, scale, demands)
    if known:
        fitted = [judge.of(placed, start.kept) for placed, start in zip(simple, known, strict=True)]
        close = _rivals(fitted)  # one that is far ahead wins with any arches, and these are weighed later
        fitted = [judge.best_variant(h) if any(h is one for one in close) else h for h in fitted]
    else:
        costs = [telling.cost(placed, scale) for placed in simple]
        least = _least(simple, costs)
        fitted = [judge.as_far(placed, cost, least) for placed, cost in zip(simple, costs, strict=True)]
        nearest = min((h.cost for h in fitted), default=inf)
        fitted += [judge.within(placed, nearest) for placed in supple]
    rivals = [] if known else _rivals(fitted)  # where a site looks like this one, the arches are those that it has
    if others := [placed for h in rivals for placed in _other_arches(h, site, some, demands)]:
        # Stone that no hypothesis was near to, as the feet of another arch, said nothing so far.
        wider = Evidence.draw(site, 3000, rng, demands, about=[*hopeful, *others])
        judge = _Judge(wider, max(scale, WIDER), demands)
        fitted = [judge.of(h.solution.placed, h.kept) for h in fitted] + [judge.within(p, inf) for p in others]
    met = [h for h in fitted if h.score < inf]
    if not met:
        asked = ", ".join(
            [f"{name} = {value:g}" for name, value in demands.sizes.items()]
            + [f"{name} = {kind.id}" for name, kind in demands.arches.items()]
        )
        raise NoVaultError(f"no vault found: none that fits the scan can have {asked}")
    proper = [h for h in met if h.own] or met
    best = {h.vault.id: h for h in sorted(proper, key=lambda h: -h.score)}
    return tuple(sorted(best.values(), key=lambda h: h.score))


def confidence(hypotheses: Sequence[Hypothesis], strange: float = 0.0) -> list[float]:
    """How likely each hypothesis is, in their order: its share in the likelihood, or that the right one was missed.

    strange: chance that none of them is right, as the vault is of none of the families.
    """
    best = min(h.score for h in hypotheses)
    raw = [exp(-0.5 * min(h.score - best, 700.0)) for h in hypotheses]
    return [(1 - strange) * ((1 - MISSED) * value / sum(raw) + MISSED / len(raw)) for value in raw]


def _least(rough: Sequence[Placed], costs: Sequence[float]) -> float:
    """The least of these costs among what is of its family, or else of all.

    A lunette as wide as its barrel is long makes a groin vault before that has its own arches.
    """
    own = [cost for placed, cost in zip(rough, costs, strict=True) if is_its_family(placed.vault)]
    return min(own or costs, default=inf)


def _rivals(fitted: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Those that are so close that a better fit of one may decide; none if one is far ahead."""
    best = min(h.score for h in fitted)
    close = [h for h in fitted if h.score < best + RIVAL]
    return close if len(close) > 1 else []


def _begun(
    families: Iterable[type[Vault]], rough: Callable[[type[Vault], int], list[Placed]], evidence: Evidence
) -> tuple[list[Placed], list[Placed]]:
    """Where families begin; then supple ones, if they are nearer than all others: elsewhere they only cost time."""
    families = tuple(families)
    simple = [placed for family in families if not family.supple for placed in rough(family, TRIED)]
    least = min((evidence.cost(placed, MIDDLE) for placed in simple), default=inf)
    supple = [placed for family in families if family.supple for placed in rough(family, 1)]
    return simple, [placed for placed in supple if evidence.cost(placed, MIDDLE) < least]


def _rough(
    family: type[Vault], site: Site, few: Evidence, some: Evidence, demands: Demands, tried: int
) -> list[Placed]:
    """The best of a few starts, `tried` of each variant along each axis to choose, refined with a wide loss."""

    def kind(placed: Placed) -> tuple[float, ...]:
        return placed.pose.yaw, *(getattr(placed.vault, name) for name in family.variants)

    solved = []
    for _, alike in groupby(starts(family, site, demands), key=kind):
        grid = list(alike)
        for k in np.argsort([few.cost(placed, COARSE) for placed in grid], kind="stable")[:tried]:
            free = demands.freedom(grid[k].vault, demands.begun_with(grid[k].vault))
            solved.append(some.solve(grid[k], free, (0.3, MIDDLE), most=8).placed)
    return [min(solved, key=lambda placed: some.cost(placed, MIDDLE))] if solved else []


def _nearest_way(start: Start, few: Evidence, some: Evidence, demands: Demands) -> Placed:
    """The nearest of its ways, refined with a wide loss."""
    placed = min(start.ways, key=lambda way: few.cost(way, COARSE))
    return some.solve(placed, demands.freedom(placed.vault, start.kept), (MIDDLE,), most=8, gain=CLOSE).placed


def _other_arches(best: Hypothesis, site: Site, some: Evidence, demands: Demands) -> Iterator[Placed]:
    """The same family begun with arches of each kind, the same in all places; nothing if it has not several arches.

    Arches that stand on one springing do not change their kind one by one.
    """
    vault, begun = best.vault, dict[Kinds, list[Placed]]()
    if len(vault.profiles) < 2:
        return
    for start in starts(type(vault), site, demands):
        alike = len({type(start.vault.profiles[name]) for name in vault.alike}) < 2
        if alike and all(getattr(start.vault, name) == getattr(vault, name) for name in vault.variants):
            begun.setdefault(kinds_of(start.vault), []).append(start)
    for grid in begun.values():
        start = min(grid, key=lambda placed: some.cost(placed, COARSE))
        free = demands.freedom(start.vault, demands.begun_with(start.vault))
        yield some.solve(start, free, (0.3, MIDDLE), most=8).placed


def _scale(placed: Placed, evidence: Evidence) -> float:
    """Scale of the loss [m] that tells models apart: a few times what the best of them leaves, within reason."""
    residuals = np.abs(placed.distance(evidence.points))
    inliers = residuals[residuals < MIDDLE]
    return float(np.clip(3 * 1.4826 * np.median(inliers), 0.01, FINE)) if len(inliers) else FINE


@dataclass(frozen=True)
class _Judge:
    """Fits with a narrow loss of `scale` [m] to the evidence, and scores."""

    evidence: Evidence
    scale: float
    demands: Demands

    def of(self, placed: Placed, kept: Sequence[Constraint] | None = None) -> Hypothesis:
        """Fitted, and scored by Schwarz's criterion on the residuals that say something new."""
        kept = self.demands.begun_with(placed.vault) if kept is None else tuple(kept)
        free = self.demands.freedom(placed.vault, kept)
        solution = self.evidence.solve(placed, free, (2 * self.scale, self.scale), most=8, gain=CLOSE)
        cost = self.evidence.cost(solution.placed, self.scale)
        integers = sum(p.integer for p in placed.vault.parameters())
        likelihood = INDEPENDENT * log(cost + (FLOOR / self.scale) ** 2)
        score = likelihood + (len(free.names) + integers) * log(INDEPENDENT)
        own = shows_its_family(solution.placed, self.evidence.points, self.scale)
        if not self.demands.met(solution.placed.vault):
            score = inf
        elif not own:
            score += FOREIGN
        return Hypothesis(solution, free, tuple(kept), cost, score, own)

    def within(self, placed: Placed, most: float) -> Hypothesis:
        """The best variant of what costs less than that, else what it is."""
        one = self.of(placed)
        return self.best_variant(one) if one.cost < most else one

    def as_far(self, placed: Placed, cost: float, least: float) -> Hypothesis:
        """The best variant, unless the family is hopeless with the best kinds of arches, too.

        cost: its own as it stands. least: that of the best family.
        """
        one, enough = self.of(placed), HOPELESS * least
        if enough < cost < ARCHED * least:
            one = self.best_profiles(one)
        return self.best_variant(one) if cost <= enough or one.cost < enough else one

    def best_variant(self, begun: Hypothesis) -> Hypothesis:
        """The fit with the most likely kind of profile in each place, and with the constraints that cost little."""
        best = self.best_profiles(begun)
        before = best.kept
        for constraint in self.demands.keepable(best.vault):
            if constraint is RECTANGLE:  # free corners are no family's own, and would cost each some time
                continue
            trial = self.of(*turned_over(best.solution.placed, best.kept, constraint))
            price = PAYS if constraint.rare else 0.0
            if trial.score < best.score - price:
                best = trial
        return self.best_profiles(best) if best.kept != before else best

    def best_profiles(self, best: Hypothesis) -> Hypothesis:
        """With each kind of profile in place of its own, place by place."""
        for name in best.vault.profiles:
            placed = best.solution.placed
            old = placed.vault.profiles[name]
            for kind in placed.vault.kinds_for(name):
                new = None if type(old) is kind else as_kind(kind, old)
                if new is None:
                    continue
                vault = placed.vault.with_arches({name: new})
                if self.demands.suits(vault):
                    trial = self.of(replace(placed, vault=self.demands.begun(vault)), best.kept)
                    best = min(best, trial, key=lambda h: h.score)
        return best


def kinds_of(vault: Vault) -> Kinds:
    """Of its arches, in the order of its fields."""
    return tuple(type(arch) for arch in vault.profiles.values())


def turned_over(
    placed: Placed, kept: Sequence[Constraint], constraint: Constraint
) -> tuple[Placed, tuple[Constraint, ...]]:
    """Where to start from without a constraint that is kept, or with one that is not; and what is then kept."""
    vault, fewer = placed.vault, tuple(c for c in kept if c != constraint)
    if constraint is RECTANGLE:
        skew, others = (Skew(), fewer) if constraint in kept else (None, (*kept, constraint))
        return replace(placed, vault=replace(vault, skew=skew)), others
    if constraint in kept:
        return replace(placed, vault=vault.replaced(constraint.let_go(vault))), fewer
    return replace(placed, vault=vault.replaced(constraint.holds(vault))), (*kept, constraint)

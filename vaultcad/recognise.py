"""Which family, with which profile: all are fitted to the site, and the one that explains it best for its size wins."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import exp, log

import numpy as np
from numpy.typing import NDArray

from families import FAMILIES, PROFILES, Profile, Vault
from vaultcad.errors import NoVaultError
from vaultcad.site import Site
from vaultcad.solve import Placed, Solution, robust_cost, solve
from vaultcad.starts import starts

Array = NDArray[np.float64]

EXTRAS = ("crown_rise_ratio", "offset_x_ratio", "offset_y_ratio", "shift_ratio")  # held at zero unless they pay
FIRST = 0.02  # such a parameter starts from here
PAYS = 10.0  # and must lower the score by this much
COARSE, MIDDLE, FINE = 0.15, 0.1, 0.05  # m, scales of the loss
ENDS = 0.06  # share of the evidence that the ends of the stone have where there are no walls
BELOW = 0.1  # m; a springing lower than this and two points under the lowest point is a guess
BLOCK = 0.5  # m; settlement makes residuals alike within about this distance, so a block counts once
FLOOR = 2e-3  # m; below this no scanner tells two models apart
CLOSE = 1e-3  # share of the cost that a step must still gain
HOPELESS = 2.5  # a family whose cost is this much above the best one's is not refined


@dataclass(frozen=True)
class Hypothesis:
    """One family fitted to the site. score: the lower the better; differences are twice those of a log likelihood."""

    solution: Solution
    free: tuple[str, ...]
    cost: float
    score: float

    @property
    def vault(self) -> Vault:
        """The fitted vault."""
        return self.solution.placed.vault


@dataclass(frozen=True)
class Evidence:
    """Points of a site as many as a stage works with (n, 3) [m], weights (n,), and the lowest springing [m]."""

    points: Array
    weights: Array
    lowest: float

    @classmethod
    def draw(cls, site: Site, count: int, rng: np.random.Generator) -> Evidence:
        """`count` of the site's points, or all if they are fewer, and the ends of the stone where no walls are."""
        k = np.sort(rng.permutation(len(site.points))[:count])
        points, weights = site.points[k], site.weights[k]
        if len(site.ends):  # they tie the plan to where the stone ends, as walls would
            tie = np.full(len(site.ends), ENDS * weights.sum() / len(site.ends))
            points, weights = np.concatenate([points, site.ends]), np.concatenate([weights, tie])
        return cls(points, weights, site.bottom - BELOW - 2 * site.spacing)

    def cost(self, placed: Placed, scale: float) -> float:
        """Weighted mean of the robust cost, 0 to 1."""
        return float(self.weights @ robust_cost(placed.distance(self.points), scale) / self.weights.sum())

    def solve(
        self, start: Placed, free: tuple[str, ...], scales: tuple[float, ...], *, most: int = 15, gain: float = 1e-7
    ) -> Solution:
        """Fit pose and the free parameters, see `vaultcad.solve.solve`."""
        return solve(start, self.points, self.weights, free, scales, lowest=self.lowest, most=most, gain=gain)


def free_parameters(vault: Vault, *, extras: Sequence[str] = ()) -> tuple[str, ...]:
    """What the optimiser may move: all real parameters, of those that are mostly zero only the `extras` named."""
    return tuple(p.name for p in vault.parameters() if not p.integer and (p.name not in EXTRAS or p.name in extras))


def recognise(
    site: Site, rng: np.random.Generator, *, families: Iterable[type[Vault]] = FAMILIES
) -> tuple[Hypothesis, ...]:
    """Every family's best fit, the most likely first.

    Raises:
        NoVaultError: none of the families comes near the points.
    """
    few, some = Evidence.draw(site, 1500, rng), Evidence.draw(site, 3000, rng)
    blocks = count_blocks(site)
    rough = [h for family in families for h in _rough(family, site, few, some)]
    if not rough:
        raise NoVaultError(
            "no vault found: nothing above the floor has the plan of a vault; scan a whole bay, or crop to it"
        )
    scale = _scale(min(rough, key=lambda s: some.cost(s.placed, MIDDLE)))
    least = min(some.cost(s.placed, scale) for s in rough)
    fitted = [
        (_best_variant if some.cost(s.placed, scale) <= HOPELESS * least else _judge)(s.placed, some, scale, blocks)
        for s in rough
    ]
    return tuple(sorted(fitted, key=lambda h: h.score))


def confidence(hypotheses: Sequence[Hypothesis]) -> list[float]:
    """Share of each hypothesis in the likelihood of all, in their order."""
    best = min(h.score for h in hypotheses)
    raw = [exp(-0.5 * min(h.score - best, 700.0)) for h in hypotheses]
    return [value / sum(raw) for value in raw]


def _rough(family: type[Vault], site: Site, few: Evidence, some: Evidence) -> list[Solution]:
    """The best of the three best starts, refined with a wide loss."""
    grid = list(starts(family, site))
    order = np.argsort([few.cost(placed, COARSE) for placed in grid], kind="stable")[:3]
    solved = [some.solve(grid[k], free_parameters(grid[k].vault), (0.3, MIDDLE), most=8) for k in order]
    return [min(solved, key=lambda s: some.cost(s.placed, MIDDLE))] if solved else []


def _scale(solution: Solution) -> float:
    """Scale of the loss [m] that tells models apart: a few times what the best of them leaves, within reason."""
    inliers = np.abs(solution.residuals)[np.abs(solution.residuals) < MIDDLE]
    return float(np.clip(3 * 1.4826 * np.median(inliers), 0.01, FINE)) if len(inliers) else FINE


def _best_variant(placed: Placed, evidence: Evidence, scale: float, blocks: int) -> Hypothesis:
    """The fit with the most likely kind of profile in each place, and those extras that pay."""
    best = _best_profiles(_judge(placed, evidence, scale, blocks), (), evidence, scale, blocks)
    freed: tuple[str, ...] = ()
    for name in [p.name for p in best.vault.parameters() if p.name in EXTRAS]:
        start = replace(best.solution.placed, vault=best.vault.replaced({name: FIRST}))
        trial = _judge(start, evidence, scale, blocks, (*freed, name))
        if trial.score < best.score - PAYS:
            best, freed = trial, (*freed, name)
    return _best_profiles(best, freed, evidence, scale, blocks) if freed else best


def _best_profiles(
    best: Hypothesis, extras: tuple[str, ...], evidence: Evidence, scale: float, blocks: int
) -> Hypothesis:
    """With each kind of profile in place of its own, place by place."""
    for name in [name for name in vars(best.vault) if isinstance(getattr(best.vault, name), Profile)]:
        placed = best.solution.placed
        old = getattr(placed.vault, name)
        for kind in PROFILES:
            new = None if type(old) is kind else _as(kind, old)
            if new is not None:
                trial = replace(placed, vault=replace(placed.vault, **{name: new}))
                best = min(best, _judge(trial, evidence, scale, blocks, extras), key=lambda h: h.score)
    return best


def _as(kind: type[Profile], profile: Profile) -> Profile | None:
    """A profile of another kind, as near as it can be, or None if it would be far."""
    ratio = profile.rise(0.5)
    for near in (ratio, ratio - 0.02, ratio + 0.02, ratio - 0.06, ratio + 0.06):
        if (made := kind.over(near)) is not None:
            return made
    return kind.over(0.5) if abs(ratio - 0.5) < 0.1 else None


def _judge(placed: Placed, evidence: Evidence, scale: float, blocks: int, extras: tuple[str, ...] = ()) -> Hypothesis:
    """Fit with a narrow loss, and score by Schwarz's criterion on as many independent residuals as there are blocks."""
    free = free_parameters(placed.vault, extras=extras)
    solution = evidence.solve(placed, free, (2 * scale, scale), most=8, gain=CLOSE)
    cost = evidence.cost(solution.placed, scale)
    floor = (FLOOR / scale) ** 2
    integers = sum(p.integer for p in placed.vault.parameters())
    score = blocks * log(cost + floor) + (len(free) + integers) * log(blocks)
    return Hypothesis(solution, free, cost, score)


def count_blocks(site: Site) -> int:
    """Number of blocks of space that hold points."""
    return max(20, len(np.unique(np.floor(site.points / BLOCK).astype(np.int64), axis=0)))

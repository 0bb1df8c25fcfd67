"""Whether a vault is of none of the families: by how far, and how, the stone is off the best of them.

The likelihood of a family among those that were tried says nothing of a shape that is none of them. Here two hypotheses
about the residuals are weighed, each a random field of `vaultcad.fit.settlement` of unknown strength, length and
roughness: what settlement and plaster leave of the right family, and what a wrong one leaves, which is larger and
breaks where edges of the model are not the stone's. The odds are the ratio of marginal likelihoods (Jeffreys 1961).

Old rubble and thick plaster leave as much as a wrong family does, but here and there, while a family that is wrong is
wrong on both sides alike, or all round: in the mirrors of the plan its residuals repeat themselves, or their negative,
as those of a ramp do. What does not is a rough vault of the right family, and that is the third hypothesis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import exp, log, sqrt

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.plan import Plan
from vaultcad.errors import NoVaultError
from vaultcad.find.refine import Refined
from vaultcad.find.ridges import Ridges
from vaultcad.fit.settlement import (
    LENGTHS,
    OUTLIER,
    ROUGHNESSES,
    STRENGTHS,
    Blocks,
    Partition,
    field_likelihood,
    scatter_of,
)
from vaultcad.fit.solve import Placed
from vaultcad.survey.parting import LEVEL_NORMAL
from vaultcad.survey.thinned_scan import STEEP, Site, support

Array = NDArray[np.float64]

POINTS = 4_000  # of the fit, that are looked at
REACH = 0.15  # m off the model, to where stone may be the vault's
LIGHT = 0.3  # of the median weight of blocks, below which one is a remnant at an edge
ENOUGH = 25  # blocks without which nothing is said
FEW_FAR = 0.2  # share of the blocks that may be another thing's near the vault
STRANGE = 0.02  # chance beforehand that a vault is of none of the families
REFUSED = 0.995  # chance of that from which on there is no model
DOUBTFUL = 0.2  # chance of that from which on it is said why
SMALL, SMALL_REFUSED = 4.0, 0.8  # m² of a plan up to which coffers and niches are as frequent; refused from there on
RIDGED = 0.999  # chance of that where it runs in ridges all over
BESIDE, SURELY = (0.06, 0.12), 4.5  # shares of what is bent over a plan, off the model, that say nothing; and so much
IN_POCKETS = 0.0, 0.1, 0.5  # chance of that where stone goes back behind a vault in no place, one, and more
COLUMN = 0.25  # m, edge of the plan's cells in which a vault is seen or not
QUARTER, HALF = 0.25, 0.5  # shares of what is bent in a scan; where that is explained, this may be parts of the rest
SURELY_OTHER = 0.9  # chance of that where a sign could not be clearer
MOST_LEFT = 0.8  # chance of that where no more than a quarter is explained; nought from a half on
ROUGH = 0.3  # chance beforehand that a vault is of rough stone / that it is not
ROUGHEST = 0.025, 0.01  # m off the model up to which stone may be rough; by how much more it seldom is
MIRRORS = np.array([[-1, 1, 1], [1, -1, 1], [-1, -1, 1]])  # of the plan
# Mean and spread of how far residuals are alike there; set by hand on 13 virtual rooms that had settled: 0.10 to 0.68;
# on nine vaults of other hands and eight rooms with waves of 6 to 25 mm: 0.07 to 0.55; on four rooms seen as another
# family: 0.67 to 0.89 (30 November 2026).
OF_SETTLED, OF_ROUGH, OF_WRONG = (0.45, 0.2), (0.3, 0.13), (0.75, 0.2)
MOST_ODDS = log(10.0)  # that such a likeness can tell
WAVES, OF_VARIANCE = range(3, 13), 0.4  # round an axis, and the share of the residuals from which on they are named


def _prior(strength: float, spread: float, roughness: float, rough_spread: float) -> Array:
    """Logarithm (lengths, strengths, roughnesses) of log-normal chances, of medians [m] and spreads; they sum to 1."""
    length = -0.5 * (np.log(np.array(LENGTHS) / 0.5) / 0.5) ** 2
    smooth = -0.5 * (np.log(STRENGTHS / strength) / spread) ** 2
    rough = -0.5 * (np.log(ROUGHNESSES / roughness) / rough_spread) ** 2
    whole: Array = length[:, None, None] + smooth[:, None] + rough
    whole -= np.logaddexp.reduce(whole, axis=None)
    return whole


LEFT_BY_THE_RIGHT = _prior(0.004, 0.7, 0.0018, 0.5)
LEFT_BY_A_WRONG_ONE = _prior(0.015, 0.8, 0.005, 0.7)
"""From 26 and 21 virtual rooms (29 November 2026), settled by up to 5 cm, fitted with their family and without it;
`python -m bench strangers` tries others."""
LEFT_BY_ROUGH_STONE = _prior(0.012, 0.5, 0.005, 0.5)  # as on the rough vaults above


@dataclass(frozen=True)
class Sign:
    """What speaks against a vault the more, the larger the share of it is that shows it.

    ends: shares up to which that is nothing, and from which on the chance is `SURELY_OTHER` that it is none. text: what
    is said then, of the share.
    """

    ends: tuple[float, float]
    text: str

    def chance(self, share: float) -> float:
        """That it is no vault of the families, by that share alone."""
        low, high = self.ends
        return SURELY_OTHER * min(max((share - low) / (high - low), 0.0), 1.0)


SEEN_THROUGH = Sign((0.2, 0.4), "other stone is seen through {:.0%} of it")
UNBORNE = Sign((0.4, 0.7), "{:.0%} of its springings are over another ceiling, and no wall is there")
OVERLAID = Sign((0.12, 0.3), "another vault hangs over {:.0%} of its plan")


@dataclass(frozen=True)
class Misfit:
    """What the stone says against the best model.

    chance: that it is of none of the families. off: root mean square of the stone's distance, over blocks [m]. waves:
    round the axis, in which most of it runs; 0 if in none. certain: chance likewise, by the vault's own stone alone.
    ridges: in which it runs, as corrugated sheet. beside: share of what is bent over the plan that is no part of it.
    pockets: places in which stone goes back behind it. share: of what is bent over all rooms of the scan, that all its
    vaults explain. signs: what else speaks against it, each with the share of it that does.
    """

    chance: float
    off: float
    waves: int = 0
    certain: float = 0.0
    ridges: Ridges | None = None
    beside: float = 0.0
    pockets: int = 0
    share: float = 1.0
    signs: tuple[tuple[Sign, float], ...] = ()

    @classmethod
    def of(cls, refined: Refined) -> Misfit:
        """Of a fit, by the blocks of its stone; nothing is said against it where they are few."""
        placed, evidence = refined.placed, refined.evidence
        some = slice(None, None, max(len(evidence.points) // POINTS, 1))
        points, distance = evidence.points[some], refined.solution.residuals[some]
        frame = placed.pose.frame()
        local = points @ frame[:, :3].T + frame[:, 3]
        surface = placed.vault.evaluate(local, walls=True)
        own = (surface.component > 0) & (np.abs(distance) < REACH) & placed.vault.plan.holds(local[:, :2])
        parts = Partition.of(placed, points, evidence.weights[some] * own)
        usable = parts.weight > 0
        if usable.sum() < ENOUGH:
            return FITS
        usable &= parts.weight > LIGHT * np.median(parts.weight[usable])
        mean = parts.means(distance[:, None])[:, 0]
        far = usable & (np.abs(mean) > OUTLIER * scatter_of(mean[usable]))
        if far.sum() < FEW_FAR * usable.sum():  # sills and what leans on a vault, no shape of it
            usable &= ~far
        # What parameters could have taken is left in: a fit has no more to take.
        blocks = Blocks(parts.weight, mean, np.empty((len(mean), 0)), parts.place, parts.normal, usable)
        plan = placed.vault.plan
        likely = field_likelihood(blocks, plan, placed.vault.derived_values()["rise"])
        priors = (LEFT_BY_THE_RIGHT, LEFT_BY_ROUGH_STONE, LEFT_BY_A_WRONG_ONE)
        right, stone, wrong = (float(np.logaddexp.reduce(likely + prior, axis=None)) for prior in priors)
        waves = _waves(parts.place[usable], mean[usable], plan)
        alike = 1.0 if waves else _alike(parts.place[usable], mean[usable], plan)
        settled, by_chance = (_log_odds(alike, of) for of in (OF_SETTLED, OF_ROUGH))
        off = float(np.sqrt(np.mean(mean[usable] ** 2)))
        coarse = -0.5 * max((off - ROUGHEST[0]) / ROUGHEST[1], 0.0) ** 2
        known = float(np.logaddexp(right + settled, stone + log(ROUGH) + coarse + by_chance))
        chance = _strange(wrong - known)
        return cls(chance, off, waves, chance)

    def with_stone_beside(self, placed: Placed, site: Site) -> Misfit:
        """The same, of a vault that may be one web of another: then much hangs over its plan that is no part of it.

        What is level there may be a scaffold, or a loft; and where the vault is seen over or under it, it is no stone
        of that, but a lamp, a tie rod or the wall of a window.
        """
        frame = placed.pose.frame()
        local = site.points @ frame[:, :3].T + frame[:, 3]
        bent = (np.abs(site.normals[:, 2]) > STEEP) & (np.abs(site.normals[:, 2]) < LEVEL_NORMAL)
        over = (local[:, 2] > 0) & placed.vault.plan.holds(local[:, :2])
        if (over & bent).sum() < ENOUGH:
            return self
        cell = np.floor(local[over, :2] / COLUMN).astype(np.int64)
        column = np.unique(cell, axis=0, return_inverse=True)[1].ravel()
        on = np.abs(placed.distance(site.points[over])) < REACH
        shown = np.bincount(column, on & (np.abs(site.normals[over, 2]) > STEEP)) > 0
        off, counted = (~on & ~shown[column])[bent[over]], site.counts[over & bent]
        share = float(np.average(off, weights=support(counted)))
        return replace(self, chance=1 - (1 - self.chance) * (1 - _one_web(share)), beside=share)

    def with_ridges(self, placed: Placed, points: NDArray[np.floating]) -> Misfit:
        """The same, where a scan's own points (n, 3) [m] run in ridges: thinned, they are the means of whole waves."""
        points = points[:: max(len(points) // POINTS, 1)]
        frame = placed.pose.frame()
        local = points @ frame[:, :3].T + frame[:, 3]
        surface = placed.vault.evaluate(local, walls=True)
        distance = surface.distance
        own = (surface.component > 0) & (np.abs(distance) < REACH) & placed.vault.plan.holds(local[:, :2])
        ridges = Ridges.of(local[own, :2], distance[own]) if own.sum() > ENOUGH else None
        if ridges is None:
            return self
        return replace(self, chance=RIDGED, off=ridges.deep / sqrt(8), certain=RIDGED, ridges=ridges)

    def with_pockets(self, pockets: int) -> Misfit:
        """The same, where stone goes back behind it in so many places: one may be a door's, several are lunettes."""
        other = IN_POCKETS[min(pockets, len(IN_POCKETS) - 1)]
        return replace(self, chance=1 - (1 - self.chance) * (1 - other), pockets=pockets)

    def with_sign(self, sign: Sign, share: float) -> Misfit:
        """The same, of a vault of which that share speaks against it."""
        other = sign.chance(share)
        return replace(self, chance=1 - (1 - self.chance) * (1 - other), signs=(*self.signs, (sign, share)))

    def with_share(self, share: float) -> Misfit:
        """The same, of vaults that together explain that share of what is bent over the rooms of a scan.

        Where most is left, what was found may be parts of what was not.
        """
        return replace(self, chance=1 - (1 - self.chance) * (1 - part_of_more(share)), share=share)

    @property
    def reason(self) -> str:
        """Why it may be of none of the families; nothing where that is not likely."""
        if self.chance < DOUBTFUL:
            return ""
        if self.ridges:
            apart, deep = 100 * self.ridges.apart, 100 * self.ridges.deep
            return f"it runs in ridges {apart:.0f} cm apart and {deep:.1f} cm deep, as corrugated sheet does"
        if _one_web(self.beside) > DOUBTFUL:
            return f"{self.beside:.0%} of the stone over its plan is more than {100 * REACH:.0f} cm off it"
        if self.pockets > 1:
            return f"the stone goes back behind it in {self.pockets} places, as lunettes do that it does not have"
        for sign, share in self.signs:
            if sign.chance(share) > DOUBTFUL:
                return sign.text.format(share)
        if part_of_more(self.share) > DOUBTFUL:
            return f"{1 - self.share:.0%} of what is bent over the rooms of the scan is not explained"
        waves = f" in {self.waves} waves round the axis" if self.waves else ""
        return f"the stone is {100 * self.off:.1f} cm off it{waves}, more than settlement explains"


FITS = Misfit(0.0, 0.0)
"""Nothing against it."""


def refuse_strangers(misfit: Misfit, vault: Vault) -> None:
    """Refuse a vault of none of the families; a small one sooner, for coffers and niches come in hundreds.

    vault: the nearest.

    Raises:
        NoVaultError: it is.
    """
    small = vault.plan.area < SMALL and misfit.chance > SMALL_REFUSED
    if small or misfit.certain > REFUSED:
        raise NoVaultError(f"no vault found: none of these families: nearest is a {vault.title}, but {misfit.reason}")


def _one_web(beside: float) -> float:
    """Chance that a vault is one web of another, of whose bent stone over the plan that share is no part of it."""
    if beside < BESIDE[0]:
        return 0.0
    return _strange(SURELY * min((beside - BESIDE[0]) / (BESIDE[1] - BESIDE[0]), 2.0))


def part_of_more(share: float) -> float:
    """Chance that what was found are parts of what was not, as they explain that share of what is bent in a scan."""
    return MOST_LEFT * min(max((HALF - share) / (HALF - QUARTER), 0.0), 1.0)


def _strange(odds: float) -> float:
    """Chance of none of the families, by the logarithm of how much better that explains the stone."""
    odds += log(STRANGE / (1 - STRANGE))
    return 1 / (1 + exp(-odds)) if odds > -700 else 0.0


def _waves(place: Array, residual: Array, plan: Plan) -> int:
    """How many waves round the middle of the plan most residuals (m,) of blocks at (m, 3) run in; 0 if in none."""
    across = place[:, :2] - plan.centre
    turn = np.arctan2(across[:, 1], across[:, 0])
    left = residual - residual.mean()
    powers = {n: 2 * abs(np.mean(left * np.exp(1j * n * turn))) ** 2 for n in WAVES}
    most = max(powers, key=lambda n: powers[n])
    return most if powers[most] > OF_VARIANCE * np.mean(left**2) > 0 else 0


def _alike(place: Array, residual: Array, plan: Plan) -> float:
    """How far the residuals (m,) of blocks at (m, 3) are those in the mirrors of the plan and turned by half, 0 to 1.

    The mean size of the three correlations: a family that is wrong is seldom so in one place alone.
    """
    from scipy.spatial import cKDTree

    middle = np.array([*plan.centre, 0.0])
    local, left = place - middle, residual - residual.mean()
    tree = cKDTree(local)
    near = 2 * float(np.median(tree.query(local, [2])[0]))
    found = []
    for mirror in MIRRORS:
        away, other = (np.asarray(column) for column in tree.query(local * mirror))
        both = np.flatnonzero(away < near)
        here, there = left[both], left[other[both]]
        power = max(float(np.sqrt((here**2).sum() * (there**2).sum())), 1e-12)
        if len(both) > ENOUGH / 2:
            found.append(abs(float((here * there).sum())) / power)
    return float(np.mean(found)) if found else 1.0


def _log_odds(alike: float, of: tuple[float, float]) -> float:
    """Logarithm of how much likelier such a likeness is of that mean and spread than of a wrong family."""
    those, wrong = (-0.5 * ((alike - mean) / std) ** 2 - log(std) for mean, std in (of, OF_WRONG))
    return min(those - wrong, MOST_ODDS)

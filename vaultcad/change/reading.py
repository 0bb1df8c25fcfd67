"""A reading of the deformation of a fitted vault, against three references, and which mechanism it resembles.

What a fit has taken into its parameters is no longer in the deviations. The reference "built" therefore leaves the
parameters free, as each way in which the vault may have been built has them (`vaultcad.find.choices`), with what builders
mostly did, its springing level, and its walls, which are where they were at their foot. "fitted" takes the model as it
is. "as built" takes the smooth surface through the stone, from which only what is local is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import exp

import numpy as np
from numpy.typing import NDArray

from vaultcad.change.mechanisms import MECHANISMS, PARTS, Body, shapes
from vaultcad.change.motion import Estimated, Places, Trend, Waves, estimated, mixed, registered
from vaultcad.change.places import Reading, Sights, azimuth, places, readings, wind
from vaultcad.deformation import Against, Deformation, Movement, Resemblance
from vaultcad.find.choices import Choice
from vaultcad.find.likelihood import DOUBT, ENOUGH, near_edges, secants
from vaultcad.find.practice import beforehand
from vaultcad.find.refine import WIDEST, Refined
from vaultcad.fit.freedom import Demands
from vaultcad.fit.settlement import Partition
from vaultcad.fit.solve import POSE, Placed, Solution
from vaultcad.fit.uncertainty import slopes_of_distances

Array = NDArray[np.float64]

SURE = 1.96  # standard deviations of the 95 % of a normal distribution
FARTHEST = 0.06  # m off the model; a block farther off is no stone of this vault
OUTLYING = 5.0  # robust scatters of what a smooth field leaves of a block, beyond which it tells nothing
VERTICAL = 5e-5  # m/m, standard deviation of a scan's vertical: 10 arc seconds, as levelled scanners state it
LIKELY = 0.01  # chance of a way of building, below which it does not count
CAUTION = (
    "A scan shows where the stone stands, not how it came there: what looks like a movement may have been built so.",
    "A settlement of all supports alike, walls that moved bodily, and motion along the surface cannot be seen.",
    "When it moved, and whether it still moves, only a second scan tells.",
)


@dataclass(frozen=True)
class _Stone:
    """Blocks of stone about a vault: deviations (m,) [m] from the fitted one, where they are, and its shapes there."""

    refined: Refined
    blocks: Partition
    usable: NDArray[np.bool_]
    body: Body

    @classmethod
    def of(cls, refined: Refined) -> _Stone | None:
        """Of the points that a fit rests on; None if they are too few."""
        placed, evidence = refined.placed, refined.evidence
        residuals = placed.distance(evidence.points)
        weights = evidence.weights / (1 + (residuals / WIDEST) ** 2) ** 2
        blocks = Partition.of(placed, evidence.points, weights * ~near_edges(placed, evidence.points))
        mean = blocks.means(residuals[:, None])[:, 0]
        usable = (blocks.weight > 0) & (np.abs(mean) < FARTHEST)
        if usable.sum() < ENOUGH:
            return None
        vault = placed.vault
        depth = max(float(-blocks.place[usable, 2].min()), 0.1)
        body = Body(vault.plan.half, max(vault.top, 0.1), depth)
        return cls(refined, blocks, usable, body)

    @property
    def place(self) -> Array:
        return self.blocks.place[self.usable]

    @property
    def normal(self) -> Array:
        return self.blocks.normal[self.usable]

    def means(self, values: Array) -> Array:
        """Over the usable blocks, of values (n, k) of the points."""
        return self.blocks.means(values)[self.usable]

    @property
    def walls(self) -> Sights:
        """Blocks of walls."""
        low = self.place[:, 2] < -0.05
        return Sights(self.place[low], self.normal[low])


def read_deformation(
    refined: Refined,
    choices: Sequence[Choice],
    demands: Demands,
    surface: Callable[[Array], Array] | None = None,
    *,
    registration: float = 0.0,
) -> Deformation | None:
    """The reading of a vault; None where too little stone was seen.

    Args:
        refined: the fit.
        choices: of how it may have been built, the fit's first; without any only the fit's own.
        demands: of the fit.
        surface: displacements (n, 3) [m] of points (n, 3) in the vault's frame, that carry the model onto the stone.
        registration: standard deviation of the registration of the scan's stations [m], where there are several.
    """
    stone = _Stone.of(refined)
    if stone is None:
        return None
    vault, yaw = refined.placed.vault, refined.placed.pose.yaw
    wanted = readings(vault, stone.body, stone.walls)
    at = places(wanted)
    fields, parts = shapes(stone.place, stone.body)
    there, _ = shapes(at.place, stone.body)
    trend = Trend.of_shapes(
        np.einsum("mkc,mc->mk", fields, stone.normal), at.sums(np.einsum("pkc,pc->pk", there, at.way))
    )
    waves = Waves.of(stone.place, stone.normal, at, vault.plan.width)
    deviation = stone.means(refined.placed.distance(refined.points)[:, None])[:, 0]

    def told(id: str, reference: str, mean: Array, std: Array) -> Against:
        figures = zip(wanted, mean, registered(std, registration), strict=True)
        return Against(id, reference, tuple(_movement(one, m, s, yaw) for one, m, s in figures))

    fitted = estimated(deviation, trend, waves)
    ways = _ways(stone, choices, demands)
    built = [(chance, estimated(rest, trend.beside(*known), waves)) for chance, rest, known in ways]
    against = [
        told("built", _built_words(choices), *mixed(built)),
        told("fitted", "the ideal vault as it was fitted", fitted.mean, fitted.std),
    ]
    if surface is not None:
        left = deviation - np.einsum("mc,mc->m", surface(stone.place), stone.normal)
        bare = replace(trend, precision=np.full_like(trend.precision, 1e12))
        local = estimated(left, bare, waves)
        against.append(told("as_built", "the smooth surface through the stone as it stands", local.mean, local.std))
    resembles = _resemblances(stone, ways[0], trend, parts, at, waves)
    return Deformation(tuple(against), resembles, _verdict(against[0], resembles), CAUTION)


_Way = tuple[float, Array, tuple[Array, Array, Array]]
"""Chance of a way of building, deviations (m,) from it as it fits best, and what is known of its unknowns."""


def _ways(stone: _Stone, choices: Sequence[Choice], demands: Demands) -> list[_Way]:
    """The likely ways in which the vault may have been built."""
    refined = stone.refined
    if not choices:
        return [(1.0, *_way(stone, refined.loose))]
    found = []
    for choice in choices:
        if choice.chance >= LIKELY or choice is choices[0]:
            free = demands.freedom(choice.placed.vault, choice.kept)
            found.append((choice.chance, *_way(stone, _at_rest(refined, choice.placed, (*POSE, *free.names), free))))
    return found


def _at_rest(refined: Refined, placed: Placed, names: tuple[str, ...], free: object) -> Solution:
    whole = replace(refined.solution, placed=placed, names=names, free=free, residuals=placed.distance(refined.points))
    return replace(whole, jacobian=slopes_of_distances(whole, refined.points))


def _way(stone: _Stone, solution: Solution) -> tuple[Array, tuple[Array, Array, Array]]:
    residual = stone.means(solution.residuals[:, None])[:, 0]
    return residual, (stone.means(secants(solution, stone.refined.points)), *beforehand(solution))


def _movement(one: Reading, mean: float, std: float, yaw: float) -> Movement:
    over = 1.0 if one.over is None else one.over
    value, limit = float(mean) / over, SURE * float(np.hypot(std, VERTICAL * one.level)) / over
    bearing = None if one.facing is None else azimuth(one.facing, yaw)
    if bearing is not None and one.turns and value < 0:
        bearing = (bearing + 180) % 360
    words = one.words[0 if value >= 0 else 1].format(wind(bearing) if bearing is not None else "")
    size = abs(value) if one.turns else value
    return Movement(one.name, size, limit, "m" if one.over is None else "m/m", words.strip(), bearing)


def _resemblances(
    stone: _Stone, way: _Way, trend: Trend, parts: NDArray[np.str_], at: Places, waves: Waves
) -> tuple[Resemblance, ...]:
    """How far what moved resembles each mechanism: by how likely each alone makes the deviations."""
    _, rest, known = way
    none = at.sums(np.zeros((len(at.figure), 1)))
    moved = _field_on_vault(stone, rest, known, trend)
    found: list[tuple[Estimated, float]] = []
    for one in MECHANISMS:
        mine = np.isin(parts, one.parts)
        only = Trend(trend.slopes[:, mine], trend.precision[mine], trend.mean[mine], trend.figures[:, mine])
        found.append((estimated(rest, only.beside(*known), waves), _explained(moved, trend.slopes[:, mine])))
    del none
    top = max(one.likelihood for one, _ in found)
    raw = [exp((one.likelihood - top) / DOUBT) for one, _ in found]
    rows = [
        Resemblance(one.name, chance / sum(raw), share, one.says)
        for one, chance, (_, share) in zip(MECHANISMS, raw, found, strict=True)
    ]
    return tuple(sorted(rows, key=lambda row: -row.odds))


def _field_on_vault(stone: _Stone, rest: Array, known: tuple[Array, Array, Array], trend: Trend) -> Array:
    """What blocks have moved by, along their normals (m,) [m], with the unknowns of the vault as they are likeliest."""
    whole = trend.beside(*known)
    rough = np.full(len(rest), 0.002**2)
    weighted = whole.slopes / rough[:, None]
    inverse = weighted.T @ whole.slopes + np.diag(whole.precision)
    unknown = np.linalg.solve(inverse, weighted.T @ rest + whole.precision * whole.mean)
    out: Array = rest - whole.slopes[:, : len(known[2])] @ unknown[: len(known[2])]
    return out


def _explained(moved: Array, slopes: Array) -> float:
    """Share (0 to 1) of the squares of motions (m,) that shapes (m, k) tell."""
    if slopes.shape[1] == 0:
        return 0.0
    told = slopes @ np.linalg.lstsq(slopes, moved, rcond=1e-9)[0]
    return float(np.clip(1 - ((moved - told) ** 2).sum() / max(float((moved**2).sum()), 1e-12), 0, 1))


def _built_words(choices: Sequence[Choice]) -> str:
    kinds = sorted({", ".join(kind.id for kind in choice.kinds) for choice in choices if choice.chance >= LIKELY})
    arches = f", with arches {' or '.join(kinds)}" if any(kinds) else ""
    return f"the vault before it moved, springing level, walls plumb from their foot{arches}; all weighed by their odds"


def _verdict(built: Against, resembles: tuple[Resemblance, ...]) -> str:
    first = resembles[0]
    certain = [one for one in built.movements if one.certain and not one.name.startswith("offset")]
    if not certain:
        return "No movement is larger than its limits."
    return (
        f"It resembles {first.mechanism} (odds {first.odds:.0%}): {first.says}. A scan alone cannot tell whether it moved "
        "so, or was built so."
    )


assert all(part in PARTS for one in MECHANISMS for part in one.parts)

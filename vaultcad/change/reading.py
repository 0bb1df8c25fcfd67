"""A reading of the deformation of a fitted vault, against three references, and which mechanism it resembles.

What a fit has taken into its parameters is no longer in the deviations. The reference "built" therefore leaves the
parameters free, as each way in which the vault may have been built has them (`vaultcad.find.choices`), with what
builders mostly did, its springing level, and its walls, which are where they were at their foot. "fitted" takes the
model as it is. "as built" takes the smooth surface through the stone, from which only what is local is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from math import log

import numpy as np
from numpy.typing import NDArray

from vaultcad.change.motion import Trend, Waves, estimated, honest, likelihoods, mixed
from vaultcad.change.places import movement_of, places, readings
from vaultcad.change.stone import Known, Stone
from vaultcad.change.stonework import Stonework
from vaultcad.deformation import Against, Deformation, Resemblance
from vaultcad.find.choices import Choice
from vaultcad.find.likelihood import DOUBT
from vaultcad.find.refine import Refined
from vaultcad.fit.freedom import Demands, Freedom
from vaultcad.fit.solve import Placed, Solution
from vaultcad.fit.uncertainty import loosened
from vaultcad.mechanisms import MECHANISMS, PARTS, shapes

Array = NDArray[np.float64]

HINTS = (
    "How webs such as these moved cannot be told from one scan: the figures are hints, their limits may be too narrow."
)
PLIANT = 5.0  # standard deviations are wider by this where webs give way to a movement; see `docs/measured.md`
UNWEIGHED = 3.0  # standard deviations are wider by this where no way of building could be weighed
LIKELY, MOST_WAYS = 0.02, 4  # chance of a way of building, below which it does not count, and how many do at most
LIKELY_FADING = 0.05  # chance of a way in which walls fade, below which it does not count
CAUTION = (
    "A scan shows where the stone stands, not how it came there: what looks like a movement may have been built so.",
    "A settlement of all supports alike, walls that moved bodily, and motion along the surface cannot be seen.",
    "A crown that has cracked, and sunk as two halves that turn, can be read by 4 mm in 30 too little.",
    "When it moved, and whether it still moves, only a second scan tells.",
)


def read_deformation(
    refined: Refined,
    choices: Sequence[Choice],
    demands: Demands,
    surface: Callable[[Array], Array] | None = None,
    *,
    stonework: Stonework | None = None,
    registration: float = 0.0,
) -> Deformation | None:
    """The reading of a vault; None where too little stone was seen.

    Args:
        refined: the fit.
        choices: of how it may have been built, the fit's first; without any only the fit's own.
        demands: of the fit.
        surface: displacements (n, 3) [m] of points (n, 3) in the vault's frame, that carry the model onto the stone.
        stonework: all points of the site on the vault; without them those alone that the fit rests on.
        registration: standard deviation of the registration of the scan's stations [m], where there are several.
    """
    stone = Stone.of(refined, stonework)
    if stone is None:
        return None
    stone = stone.cleaned()
    vault, yaw = refined.placed.vault, refined.placed.pose.yaw
    wanted = readings(vault, stone.body, stone.walls)
    at = places(wanted)
    seen, parts = stone.slopes, stone.parts
    figures = at.sums(np.einsum("pkc,pc->pk", shapes(at.place, stone.body).fields, at.way))
    trend = Trend.of_shapes(seen, figures, parts)
    waves = Waves.of(stone.place, stone.normal, at, vault.plan.width)
    deviation = stone.deviation

    wider = (PLIANT if vault.pliant else 1.0) * (1.0 if choices else UNWEIGHED)

    def told(id: str, reference: str, mean: Array, std: Array) -> Against:
        figures = zip(wanted, mean, honest(np.hypot(wider * std, stone.misfit), registration), strict=True)
        return Against(id, reference, tuple(movement_of(one, m, s, yaw) for one, m, s in figures))

    ways = borne_out(_ways(stone, choices, demands), trend, waves)
    fadings = [
        (odds, Trend.of_shapes(seen[:, mine], figures[:, mine], parts[mine]))
        for odds, mine in _likely_fadings(ways[0], trend, stone.fadings, waves)
    ]
    fitted = [(odds, estimated(deviation, fading, waves)) for odds, fading in fadings]
    built = [
        (chance * odds, estimated(rest, fading.beside(*known), waves))
        for (chance, rest, known), (odds, fading) in product(ways, fadings)
    ]
    against = [
        told("built", _built_words(choices), *mixed(built)),
        told("fitted", "the ideal vault as it was fitted", *mixed(fitted)),
    ]
    if surface is not None:
        left = deviation - np.einsum("mc,mc->m", surface(stone.place), stone.normal)
        local = estimated(left, trend.only(np.zeros(len(parts), np.bool_)), waves)
        against.append(told("as_built", "the smooth surface through the stone as it stands", local.mean, local.std))
    resembles = _resemblances(ways[0], trend, parts, waves)
    if vault.pliant:
        return Deformation(tuple(against), (), HINTS, _caution(stone, choices))
    return Deformation(tuple(against), resembles, _verdict(against[0], resembles), _caution(stone, choices))


_Way = tuple[float, Array, Known]
"""Chance of a way of building, deviations (m,) from it as it fits best, and what is known of its unknowns."""


def _ways(stone: Stone, choices: Sequence[Choice], demands: Demands) -> list[_Way]:
    """The likely ways in which the vault may have been built."""
    refined = stone.refined
    if not choices:
        free = demands.freedom(refined.placed.vault)
        return [(1.0, *stone.against(_at_rest(refined, refined.placed, free)))]
    found = []
    for choice in choices[:MOST_WAYS]:
        if choice.chance >= LIKELY or choice is choices[0]:
            free = demands.freedom(choice.placed.vault, choice.kept)
            found.append((choice.chance, *stone.against(_at_rest(refined, choice.placed, free))))
    return found


def borne_out(ways: Sequence[_Way], trend: Trend, waves: Waves) -> list[_Way]:
    """Those that the blocks here, finer and with walls, do not rule out.

    Choices rest on few points, and on none near edges: a row of lunettes whose pitch is 10 cm off was as likely there.
    """
    whole = ((rest, trend.beside(*known)) for _, rest, known in ways)
    every = [likelihoods(rest, all_, waves, [np.ones(len(all_.mean), np.bool_)])[0] for rest, all_ in whole]
    return [way for way, one in zip(ways, every, strict=True) if one > max(every) + DOUBT * log(LIKELY)]


def _at_rest(refined: Refined, placed: Placed, free: Freedom) -> Solution:
    there = replace(refined.solution, placed=placed, residuals=placed.distance(refined.points))
    return loosened(there, free, refined.points)


def _odds(way: _Way, trend: Trend, shown: Sequence[NDArray[np.bool_]], waves: Waves) -> list[float]:
    """How likely each part (u,) of the shapes alone makes the deviations."""
    _, rest, known = way
    own = np.ones(len(known[2]), np.bool_)
    likelihood = likelihoods(rest, trend.beside(*known), waves, [np.append(own, mine) for mine in shown])
    raw = np.exp((likelihood - likelihood.max()) / DOUBT)
    return list((raw / raw.sum()).tolist())


def _likely_fadings(
    way: _Way, trend: Trend, fadings: Sequence[NDArray[np.bool_]], waves: Waves
) -> list[tuple[float, NDArray[np.bool_]]]:
    """Of the ways in which walls may fade, each with its shapes (u,), those that are likely, and how likely each is."""
    every = zip(_odds(way, trend, fadings, waves), fadings, strict=True)
    return [(chance, mine) for chance, mine in every if chance >= LIKELY_FADING]


def _resemblances(way: _Way, trend: Trend, parts: NDArray[np.str_], waves: Waves) -> tuple[Resemblance, ...]:
    """How far what moved resembles each mechanism: by how likely each alone makes the deviations."""
    _, rest, known = way
    moved, shown = _moved(rest, known, trend), [np.isin(parts, one.parts) for one in MECHANISMS]
    rows = [
        Resemblance(one.name, chance, _explained(moved, trend.slopes[:, mine]), one.says)
        for one, chance, mine in zip(MECHANISMS, _odds(way, trend, shown, waves), shown, strict=True)
    ]
    return tuple(sorted(rows, key=lambda row: -row.odds))


def _moved(rest: Array, known: tuple[Array, Array, Array], trend: Trend) -> Array:
    """What blocks have moved by, along their normals (m,) [m], with the unknowns of the vault as they are likeliest."""
    whole, own = trend.beside(*known), len(known[2])
    unknown = whole.likeliest(rest, np.ones(len(rest), np.bool_))
    out: Array = rest - whole.slopes[:, :own] @ unknown[:own]
    return out


def _explained(moved: Array, slopes: Array) -> float:
    """Share (0 to 1) of the squares of motions (m,) that shapes (m, k) tell."""
    if slopes.shape[1] == 0:
        return 0.0
    told = slopes @ np.linalg.lstsq(slopes, moved, rcond=1e-9)[0]
    return float(np.clip(1 - ((moved - told) ** 2).sum() / max(float((moved**2).sum()), 1e-12), 0, 1))


def _built_words(choices: Sequence[Choice]) -> str:
    ways = [choice.kinds for choice in choices[:MOST_WAYS] if choice.chance >= LIKELY]
    kinds = dict.fromkeys(" and ".join(dict.fromkeys(kind.id for kind in way)) for way in ways if way)
    arches = f", with {', or '.join(kinds)} arches" if kinds else ""
    return f"the vault before it moved, springing level, walls plumb from their foot{arches}; all weighed by their odds"


def _caution(stone: Stone, choices: Sequence[Choice]) -> tuple[str, ...]:
    """What a reading cannot tell, and what is doubtful about this one."""
    doubts = []
    if not choices:
        doubts.append(
            "No way in which it may have been built could be weighed against others: what the fit holds of its shape "
            f"may be false. All limits are {UNWEIGHED:g} times as wide."
        )
    if stone.refined.placed.vault.pliant:
        doubts.append(
            "Webs such as these take up a movement by their own shape: a fall of the crown can pass for a spread. "
            f"All limits are {PLIANT:g} times as wide."
        )
    if stone.misfit > 0:
        doubts.append(
            f"{100 * stone.strange:.0f} % of the vault's stone lies {1000 * stone.astray:.0f} mm off any vault of this "
            "kind, moved or not: it may be of another kind. All limits are wider by that."
        )
    return (*doubts, *CAUTION)


def _verdict(built: Against, resembles: tuple[Resemblance, ...]) -> str:
    first = resembles[0]
    certain = [one for one in built.movements if one.certain and not one.name.startswith("offset")]
    if not certain:
        return "No movement is larger than its limits."
    return (
        f"It resembles {first.mechanism} (odds {first.told_odds}): {first.says}. A scan alone cannot tell whether it "
        "moved so, or was built so."
    )


assert all(part in PARTS for one in MECHANISMS for part in one.parts)

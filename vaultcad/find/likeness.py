"""What looks alike in a scan before vaults are fitted: one of each kind is searched in full, the others begin there.

That they look alike is a guess that saves time: each is fitted to its own stone, with all families that the first was
compared with, and searched in full itself where the two do not agree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import cos, pi, sin
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.find.choices import Choice
from vaultcad.find.first_guesses import starts
from vaultcad.find.found import Found
from vaultcad.find.misfit import DOUBTFUL
from vaultcad.find.recognise import Start
from vaultcad.fit.freedom import NONE, Demands
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.processes import spread
from vaultcad.survey.soffits import Soffit
from vaultcad.survey.thinned_scan import Site

Array = NDArray[np.float64]
Result = TypeVar("Result")

SIZE = 0.15, 0.3  # m, and share of a size, by which what looks alike may differ: bays of crypts are seldom equal
EQUAL = 0.15, 0.06  # m, and share of a size, by which what is built alike may differ
HEIGHTS = (0.05, 0.25, 0.5, 0.75, 0.98)  # quantiles of a ceiling's heights that are compared
WORTH = 0.01  # chance of a choice from which on it is tried where it looks alike
ROUGHER = 1.3, 1e-3  # times, and m, by which the scatter of what is as near may be larger
SETTLED = 2e-3  # m, likewise where it only looks alike: one bay settles more than the next


def look_of_ceiling(points: Array) -> Array:
    """Sizes (k,) [m] of the stone of a ceiling (n, 3) [m], the same however it is turned: extents and heights."""
    extents = np.sqrt(12 * np.maximum(np.linalg.eigvalsh(np.cov(points[:, :2].T)), 0.0))
    heights = np.quantile(points[:, 2], HEIGHTS)
    return np.concatenate([extents, heights - heights[-1]])


def look_of_soffit(soffit: Soffit) -> Array:
    """Sizes (k,) [m] of the soffit of an arch."""
    return np.array([soffit.length, soffit.width, np.ptp(soffit.curve[:, 1])])


def firsts(looks: Sequence[Array]) -> list[int]:
    """For each of these the number of the one that it begins from: its own where none before it looks alike.

    The first that is as large; if there is none, the first that is not much larger or smaller, and begins from none.
    """
    found: list[int] = []
    for k, look in enumerate(looks):
        own = [j for j, first in enumerate(found) if first == j or not _alike(looks[j], looks[first], EQUAL)]
        equal = (j for j in own if _alike(looks[j], look, EQUAL))
        alike = (j for j in own if found[j] == j and _alike(looks[j], look))
        found.append(next(equal, next(alike, k)))
    return found


def _alike(one: Array, other: Array, within: tuple[float, float] = SIZE) -> bool:
    larger = np.maximum(np.abs(one), np.abs(other))
    return bool((np.abs(one - other) < within[0] + within[1] * larger).all())


def in_turn(first_of: Sequence[int], work: Callable[[int, Result | None], Result]) -> Iterator[tuple[int, Result]]:
    """Work on all cores on what begins from nothing, then on what begins from that: numbers and results.

    first_of: as `firsts` tells.
    """
    done: dict[int, Result] = {}

    def following(numbers: list[int], n: int) -> Result:
        return work(numbers[n], done.get(first_of[numbers[n]]))

    while left := [k for k in range(len(first_of)) if k not in done]:
        ready = [k for k in left if first_of[k] == k or first_of[k] in done]
        for k, result in zip(ready, spread(partial(following, ready), len(ready)), strict=True):
            done[k] = result
            yield k, result


def starts_like(
    first: Found, site: Site, families: Iterable[type[Vault]], demands: Demands = NONE
) -> tuple[Start, ...]:
    """Where those of the families that were fitted to one site begin at another that looks like it.

    As large as there, turned by right angles about its middle; or as large as the site, in the shape that they had.
    """
    tried = set(families)
    return tuple(
        Start((*_carried(h.solution.placed, first.site, site), *_stretched(h.vault, site, demands)), h.kept)
        for h in first.hypotheses
        if type(h.vault) in tried
    )


def _carried(placed: Placed, here: Site, there: Site) -> Iterator[Placed]:
    """A vault from one site to another, turned in each way."""
    pose, vault = placed.pose, placed.vault
    z = pose.z + there.crown - here.crown
    for quarter in range(4):
        turn = there.yaw - here.yaw + quarter * pi / 2
        (x, y), (c, s) = (pose.x, pose.y) - here.centre, (cos(turn), sin(turn))
        a, b = there.centre.tolist()
        x, y = a + c * float(x) - s * float(y), b + s * float(x) + c * float(y)
        yield Placed(vault, Pose(x, y, z, pose.yaw + turn))


def _stretched(vault: Vault, site: Site, demands: Demands) -> Iterator[Placed]:
    """A vault as long and wide as the site, along either axis: its parameters that are lengths are those of a plan."""
    lengths = [p.name for p in vault.parameters() if p.range.unit == "m"]
    seen = set[tuple[float, ...]]()
    for start in starts(type(vault), site, demands):
        sizes = {name: start.vault.values()[name] for name in lengths}
        if (key := (start.pose.yaw, *sizes.values())) in seen:
            continue
        seen.add(key)
        ways = [(sizes, start.pose)]
        if vault.quarter_turn and vault.quarter_turn.exchanged:  # the grid has all arches along one axis
            ways.append((vault.quarter_turn.names(sizes), replace(start.pose, yaw=start.pose.yaw + pi / 2)))
        for plan, pose in ways:
            as_large = vault.replaced(plan)
            yield Placed(as_large, replace(pose, z=site.crown - as_large.top))


def choices_like(first: Found, one: Found) -> tuple[Choice, ...]:
    """The arches and constraints of the first that are worth a fit to one as large; none to one of other sizes."""
    if not _alike(_built(first.placed.vault), _built(one.placed.vault), EQUAL):
        return ()
    return tuple(choice for choice in first.choices if choice.chance > WORTH)


def _built(vault: Vault) -> Array:
    """Sizes (k,) [m] of a vault, however it is turned: the shorter ones of its plan first, then its height."""
    values = vault.values()
    return np.array([*sorted(values[p.name] for p in vault.parameters() if p.range.unit == "m"), vault.top])


def agree(found: Sequence[Found], first: Found) -> bool:
    """Whether what was begun from the first of its kind is one vault of its family, and the stone about as near."""
    same = all(type(one.placed.vault) is type(first.placed.vault) for one in found)
    near = as_near(found, first, SETTLED)
    return same and near and found[0].misfit.chance < max(DOUBTFUL, first.misfit.chance)


def as_near(found: Sequence[Found], other: Found, more: float = ROUGHER[1]) -> bool:
    """Whether it is one vault, from which its stone is not much farther off than that of another, by `more` [m]."""
    return len(found) == 1 and found[0].refined.scatter < ROUGHER[0] * other.refined.scatter + more

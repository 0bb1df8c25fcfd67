"""First guesses: for each family a coarse grid of vaults that fill a site, to be scored and refined."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from itertools import product
from math import hypot, pi

import numpy as np

from families import (
    Annular,
    Barrel,
    Cloister,
    Conch,
    Dome,
    Elliptical,
    Groin,
    Lunette,
    Mirror,
    Pointed,
    Profile,
    Rib,
    Rotunda,
    Sail,
    Segmental,
    Trough,
    Umbrella,
    Vault,
)
from vaultcad.fit.freedom import NONE, SPRINGING, Demands
from vaultcad.fit.solve import Placed
from vaultcad.model import Pose
from vaultcad.survey.thinned_scan import Site

RATIOS = (0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.85, 1.0)  # rise / span
NARROWEST = 0.5  # m; no family spans less
# A quarter turn of the others is one of them again.
DIRECTED = (Barrel, Lunette, Trough, Cloister, Conch, Annular, Umbrella)
COARSE: tuple[type[Profile], ...] = (Segmental, Elliptical, Pointed)  # the others lie between these


def starts(family: type[Vault], site: Site, demands: Demands = NONE) -> Iterator[Placed]:
    """Vaults of a family whose plan is the site's and whose crown is at its crown, along either axis if it has one.

    Sizes that are fixed are as they should be; a yaw that is fixed leaves the one quarter turn that is nearest to it.
    """
    lowest = -np.inf if SPRINGING.name in demands.freed else site.bottom - 0.5
    x, y = site.centre.tolist()
    if site.spans.min() < NARROWEST:
        return
    for quarter in _quarters(family, site, demands):
        spans = site.spans[::-1] if quarter % 2 else site.spans
        for vault, rise in _suited(_possible(GRIDS[family](float(spans[0]), float(spans[1]))), demands):
            z = demands.pose.get("z", site.crown - rise)
            if z >= lowest:
                yield Placed(vault, Pose(x, y, z, site.yaw + quarter * pi / 2))


def _possible(grid: Iterator[tuple[Vault, float]]) -> Iterator[tuple[Vault, float]]:
    """The grid, or nothing where the plan is smaller or larger than the family's may be."""
    with suppress(ValueError):
        yield from grid


def _suited(grid: Iterator[tuple[Vault, float]], demands: Demands) -> Iterator[tuple[Vault, float]]:
    """Vaults of a grid, and their rises [m], that have the sizes that are fixed."""
    if not demands.of_vault:
        yield from grid
        return
    for vault, _ in grid:
        if (suited := demands.suited(vault)) is not None:
            begun = demands.begun(suited)
            if demands.met(begun):
                yield begun, begun.derived_values()["rise"]


def _quarters(family: type[Vault], site: Site, demands: Demands) -> tuple[int, ...]:
    """Quarter turns of the site's axes to try."""
    if "yaw" in demands.pose:
        return (round((demands.pose["yaw"] - site.yaw) / (pi / 2)),)
    if family in (Conch, Annular):  # open to one end
        return (0, 1, 2, 3)
    return (0, 1) if family in DIRECTED or demands.of_vault else (0,)


def _profiles(span: float) -> Iterator[tuple[Profile, float]]:
    for kind, ratio in product(COARSE, RATIOS):
        profile = kind.over(ratio)
        if profile is not None:
            yield profile, profile.rise(span / 2)


def _sail(a: float, b: float) -> Iterator[tuple[Vault, float]]:
    for ratio in np.linspace(0.1, 1, 13).tolist():
        yield Sail(a, b, ratio), ratio * hypot(a, b) / 2


def _barrel(a: float, b: float) -> Iterator[tuple[Vault, float]]:
    for profile, rise in _profiles(a):
        yield Barrel(a, b, profile), rise


def _lunette(a: float, b: float) -> Iterator[tuple[Vault, float]]:
    for profile, rise in _profiles(a):
        if isinstance(profile, Elliptical):  # lies between the others; the lunettes make the grid large
            continue
        for count, width, springing in product(range(1, 7), (0.6, 0.95), (0.1, 0.6)):
            if b / count > 0.8:
                yield Lunette(a, b, profile, count, 0.97, 0.0, width, springing), rise


def _trough(a: float, b: float) -> Iterator[tuple[Vault, float]]:
    for (profile, rise), run in product(_profiles(a), (0.5, 0.75, 1.0, 1.4)):
        ratio = min(max(run * a / b, 0.1), 1.0)
        yield Trough(a, b, profile, ratio, ratio), rise


def _mirror(a: float, b: float) -> Iterator[tuple[Vault, float]]:
    least = min(a, b)
    for run, rise, plane in product((0.25, 0.5, 0.75, 1.0), (0.4, 0.6, 0.8, 1.0), (0.4, 0.7, 1.0)):
        vault = Mirror(a, b, max(run * least / a, 0.1), max(run * least / b, 0.1), rise, plane)
        yield vault, vault.rise


def _groin(a: float, b: float) -> Iterator[tuple[Vault, float]]:
    for kind, ratio in product(COARSE, RATIOS):
        rise = ratio * (a + b) / 2
        profiles = kind.over(rise / a), kind.over(rise / b)
        if profiles[0] is not None and profiles[1] is not None:
            yield Groin(a, b, profiles[0], profiles[1]), rise


def _dome(a: float, b: float) -> Iterator[tuple[Vault, float]]:
    if abs(a - b) < 0.25 * max(a, b):
        for ratio, drum, lean in product((0.3, 0.4, 0.5, 0.65), (0.05, 0.2, 0.4, 0.7, 1.0, 1.5), (0.05, 0.4)):
            profile = Elliptical(ratio)
            vault = Dome((a + b) / 4, profile, drum, lean)
            yield vault, vault.rise


def _own(
    family: type[Cloister | Conch | Annular | Rotunda | Rib | Umbrella],
) -> Callable[[float, float], Iterator[tuple[Vault, float]]]:
    """What the family itself declares."""
    return lambda a, b: ((vault, vault.rise) for vault in family.first_guesses(a, b))


GRIDS = {
    Sail: _sail,
    Barrel: _barrel,
    Lunette: _lunette,
    Trough: _trough,
    Mirror: _mirror,
    Groin: _groin,
    Dome: _dome,
    Cloister: _own(Cloister),
    Conch: _own(Conch),
    Annular: _own(Annular),
    Rotunda: _own(Rotunda),
    Rib: _own(Rib),
    Umbrella: _own(Umbrella),
}

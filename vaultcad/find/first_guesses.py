"""First guesses: for each family a coarse grid of vaults that fill a site, to be scored and refined."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from math import cos, pi, sin

import numpy as np

from families import Vault
from families.declaration.footprint import RECTANGLE, Footprint
from vaultcad.fit.freedom import NONE, SPRINGING, Demands
from vaultcad.fit.solve import Placed
from vaultcad.pose import Pose
from vaultcad.survey.footprints import Ground
from vaultcad.survey.thinned_scan import Site


def starts(family: type[Vault], site: Site, demands: Demands = NONE) -> Iterator[Placed]:
    """Vaults of a family whose plan is the site's and whose crown is at its crown, along either axis if it has one.

    Sizes that are fixed are as they should be; a yaw that is fixed leaves the one quarter turn that is nearest to it.
    """
    lowest = -np.inf if SPRINGING.name in demands.freed else site.bottom - 0.5
    for ground in site.over(family.stands_over):
        if not min(ground.footprint.span_x, ground.footprint.span_y) > 0:
            continue
        for over, yaw in _ways(family, ground, demands):
            for vault in _suited(_possible(family.first_guesses(over)), demands):
                z = demands.pose.get("z", site.crown - vault.top)
                if z >= lowest:
                    (x, y), (c, s) = vault.plan.centre, (cos(yaw), sin(yaw))
                    yield Placed(vault, Pose(ground.x - c * x + s * y, ground.y - s * x - c * y, z, yaw))


def _possible(grid: Iterator[Vault]) -> Iterator[Vault]:
    """The grid, or nothing where the plan is smaller or larger than the family's may be."""
    with suppress(ValueError, ZeroDivisionError):
        yield from grid


def _suited(grid: Iterator[Vault], demands: Demands) -> Iterator[Vault]:
    """Vaults of a grid that have the sizes that are fixed; if none can, with another size changed.

    A plan is guessed too large where clutter hangs beside it, so that no arch over it can have the rise that is fixed.
    """
    if not demands.of_vault:
        yield from grid
        return
    suited = [own for vault in grid if (own := demands.suited(vault)) is not None]
    begun = [vault for vault in map(demands.begun, suited) if demands.met(vault)]
    yield from begun or (near for vault in suited if (near := demands.within_reach(vault)) is not None)


def _ways(family: type[Vault], ground: Ground, demands: Demands) -> Iterator[tuple[Footprint, float]]:
    """The footprint, and the yaw of a vault over it: a rectangle from either side, if that makes a difference."""
    if family.stands_over != RECTANGLE:
        yield ground.footprint, ground.yaw
        return
    if "yaw" in demands.pose:
        quarters: tuple[int, ...] = (round((demands.pose["yaw"] - ground.yaw) / (pi / 2)),)
    else:
        quarters = (0, 1) if family.quarter_turn is None or demands.of_vault else (0,)
    for quarter in quarters:
        yield ground.footprint.turned(quarter), ground.yaw + quarter * pi / 2

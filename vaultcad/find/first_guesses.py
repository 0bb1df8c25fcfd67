"""First guesses: for each family a coarse grid of vaults that fill a site, to be scored and refined."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from math import pi

import numpy as np

from families import Vault
from vaultcad.fit.freedom import NONE, SPRINGING, Demands
from vaultcad.fit.solve import Placed
from vaultcad.model import Pose
from vaultcad.survey.thinned_scan import Site

NARROWEST = 0.5  # m; no family spans less


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
        for vault in _suited(_possible(family.first_guesses(float(spans[0]), float(spans[1]))), demands):
            z = demands.pose.get("z", site.crown - vault.derived_values()["rise"])
            if z >= lowest:
                yield Placed(vault, Pose(x, y, z, site.yaw + quarter * pi / 2))


def _possible(grid: Iterator[Vault]) -> Iterator[Vault]:
    """The grid, or nothing where the plan is smaller or larger than the family's may be."""
    with suppress(ValueError):
        yield from grid


def _suited(grid: Iterator[Vault], demands: Demands) -> Iterator[Vault]:
    """Vaults of a grid that have the sizes that are fixed."""
    if not demands.of_vault:
        yield from grid
        return
    for vault in grid:
        if (suited := demands.suited(vault)) is not None:
            begun = demands.begun(suited)
            if demands.met(begun):
                yield begun


def _quarters(family: type[Vault], site: Site, demands: Demands) -> tuple[int, ...]:
    """Quarter turns of the site's axes to try."""
    if "yaw" in demands.pose:
        return (round((demands.pose["yaw"] - site.yaw) / (pi / 2)),)
    return (0, 1) if family.quarter_turn is None or demands.of_vault else (0,)

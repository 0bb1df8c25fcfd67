"""How thick a vault's masonry is, where a scan shows its back, too: from an attic, or the storey above."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.group_medians import group_medians
from vaultcad.uncertain import Estimate

Array = NDArray[np.float64]

SHELL = 0.04, 0.8  # m, between which a shell's thickness lies
SLOPE = 0.966  # cosine of the slope beyond which a back is told from a floor, which runs along level stone alone
PARALLEL = 0.966  # cosine of the angle between the faces of a shell, at the least
BACKS = 0.5  # of the stone over slopes that must run along the vault: haunches may be filled, floors cross it
CELL = 0.1  # m, of the plan, in which points are taken together
SMALLEST = 0.5  # m², of a back in plan
FINEST = 0.001  # m, that a thickness is unsure by at least
MEANING = "thickness of the masonry, between both faces"


def shell_of(
    vault: Vault, points: Array, normals: Array, stone: Callable[[Array], Array] | None = None
) -> Estimate | None:
    """The thickness [m] of a vault from points (n, 3) [m] of its frame that lie on no vault, and their normals (n, 3).

    The median over the plan, and how much it varies there: by so much a shell of one thickness is off. None where no
    back is seen. stone: displacements (n, 3) [m] of the intrados at points (n, 3), where it has moved.
    """
    over = np.flatnonzero(vault.plan.holds(points[:, :2]))
    surface = vault.evaluate(points[over])
    between = (surface.distance > SHELL[0]) & (surface.distance < SHELL[1]) & (np.abs(surface.normal[:, 2]) < SLOPE)
    if not between.any():
        return None
    at, way, thick = points[over[between]], surface.normal[between], surface.distance[between]
    along = np.abs((way * normals[over[between]]).sum(axis=1)) > PARALLEL
    cell = np.unique(np.floor(at[:, :2] / CELL).astype(np.int64), axis=0, return_inverse=True)[1].reshape(-1)
    covered, backs = len(np.unique(cell)), len(np.unique(cell[along]))
    if backs < BACKS * covered or backs * CELL**2 < SMALLEST:
        return None
    if stone is not None:
        thick = thick - (stone(at - thick[:, None] * way) * way).sum(axis=1)
    _, group = np.unique(cell[along], return_inverse=True)
    middles = group_medians(group, thick[along], backs)
    middle = float(np.median(middles))
    return Estimate(middle, "m", max(1.4826 * float(np.median(np.abs(middles - middle))), FINEST), MEANING)

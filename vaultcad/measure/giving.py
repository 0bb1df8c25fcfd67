"""What abutments that gave way tell of a vault's deviations: a shape of the whole, also where no stone is seen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vaultcad.mechanisms import GIVING, LARGE, Body, shapes

Array = NDArray[np.float64]

UNTOLD = 0.005  # m, standard deviation of what else has moved
INDEPENDENT = 300  # points that tell as much as endless many, as what else has moved is alike nearby


def giving(points: Array, normals: Array, distances: Array, body: Body) -> Callable[[Array], Array]:
    """The field (n, 3) [m] of spreading abutments and a sinking crown that explains distances (m,) [m] best.

    Shapes of `GIVING` by least squares, each part as small as it can be: `LARGE` beforehand. A hole in a corner can be
    told by it, as it is the same movement by which the other corners stand (Heyman 1995).

    Args:
        points: (m, 3) on the ideal vault, in its frame [m].
        normals: (m, 3) there.
        distances: of the stone along them, positive into the stone.
        body: the vault's sizes.
    """
    fields, part, _ = shapes(points, body, GIVING)
    along = np.einsum("mkc,mc->mk", fields, normals)
    _, which, count = np.unique(part, return_inverse=True, return_counts=True)
    told = min(1.0, INDEPENDENT / len(points)) / UNTOLD**2
    sizes = np.linalg.solve(told * along.T @ along + np.diag(count[which] / LARGE**2), told * along.T @ distances)

    def field(there: Array) -> Array:
        found: Array = np.einsum("nkc,k->nc", shapes(there, body, GIVING).fields, sizes)
        return found

    return field

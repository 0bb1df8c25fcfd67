"""Every point of a scan gets its component: the nearest surface of the fitted vault, if it is near enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families.void import kernel
from segmentation.threads import threads
from vaultcad.fit.solve import Placed

CHUNK = 1 << 17  # points that a thread takes at once


@dataclass(frozen=True)
class Labels:
    """For each point of the scan, in its order.

    component: (n,) id of the component, 0 off the vault. vault: (n,) 1-based number of the vault, 0 for none.
    deviation: (n,) signed distance [m] to the model, positive in the stone, NaN off the vault.
    """

    component: NDArray[np.uint16]
    vault: NDArray[np.uint16]
    deviation: NDArray[np.float32]


def label(xyz: NDArray[np.floating], vaults: Sequence[tuple[Placed, float]]) -> Labels:
    """Label points (n, 3) [m] within a tolerance [m] of a vault; points nearer to its walls are not the vault's.

    A point near two vaults is the nearer one's. vaults: where they stand, each with its tolerance.
    """
    n = len(xyz)
    labels = Labels(np.zeros(n, np.uint16), np.zeros(n, np.uint16), np.full(n, np.nan, np.float32))

    def work(start: int) -> None:
        part = slice(start, start + CHUNK)
        for number, (placed, tolerance) in enumerate(vaults, 1):
            _label(xyz[part], placed, tolerance, number, labels, start)

    with threads() as pool:
        list(pool.map(work, range(0, n, CHUNK)))
    return labels


def _label(
    xyz: NDArray[np.floating], placed: Placed, tolerance: float, number: int, labels: Labels, start: int
) -> None:
    """Enter the points of one vault, of those from `start` on, that are not nearer to one before it."""
    frame = placed.pose.frame()
    half = placed.vault.plan.half + tolerance
    mine = kernel.over_plan(np.ascontiguousarray(xyz), frame, half, -tolerance)
    surface = placed.vault.evaluate(xyz[mine], frame=frame, walls=True)
    at = start + mine
    known = np.abs(labels.deviation[at])
    near = (np.abs(surface.distance) <= tolerance) & (surface.component > 0)
    near &= ~(known <= np.abs(surface.distance))
    at = at[near]
    labels.component[at] = surface.component[near]
    labels.vault[at] = number
    labels.deviation[at] = surface.distance[near]

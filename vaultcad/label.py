"""Every point of a scan gets its component: the nearest surface of the fitted vault, if it is near enough."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.solve import Placed

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


def label(xyz: NDArray[np.floating], placed: Placed, tolerance: float, number: int = 1) -> Labels:
    """Label points (n, 3) [m] within `tolerance` [m] of a vault; points nearer to its walls are not the vault's."""
    n = len(xyz)
    component, deviation = np.zeros(n, np.uint16), np.full(n, np.nan, np.float32)
    frame = placed.pose.frame()

    def work(start: int) -> None:
        part = slice(start, start + CHUNK)
        surface = placed.vault.evaluate(xyz[part], frame=frame, walls=True)
        near = (np.abs(surface.distance) <= tolerance) & (surface.component > 0)
        component[part] = np.where(near, surface.component, 0)
        deviation[part] = np.where(near, surface.distance, np.nan)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(work, range(0, n, CHUNK)))
    return Labels(component, np.where(component > 0, number, 0).astype(np.uint16), deviation)

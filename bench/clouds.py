"""The clouds that the benchmarks of segmentation share: seven ideal vaults, and two that have settled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families import Barrel, Dome, Groin, Lunette, Mirror, Sail, Semicircular, Trough, Vault

# The sizes of the paper's Figure 2: radii 3.00 (sail 4.24, lunettes 1.40, dome 5.00 with pendentives 7.08).
IDEALS: tuple[Vault, ...] = (
    Sail(6.0, 6.0, 1.0),
    Barrel(6.0, 9.0),
    Lunette(6.0, 9.6, Semicircular(), 3, 1.0, 0.0, 0.933, 0.0),
    Trough(6.0, 10.0, Semicircular(), 0.6, 0.6),
    Mirror(8.0, 10.0, 0.75, 0.6, 1.0, 1.0),
    Groin(6.0, 6.0),
    Dome(5.0, Semicircular(), 0.4, 0.0),
)
SETTLED = ("groin", "dome")
NOISE = 0.003  # standard deviation of a point along each axis [m]
SETTLEMENT = 0.025  # of the crown [m], falling off smoothly to the corners
SETTLED_NAME = "{} settled"


@dataclass(frozen=True, eq=False)
class Case:
    """A cloud with its truth: points (n, 3) [m], unit normals (n, 3), components (n,), and its family's id."""

    name: str
    family: str
    xyz: NDArray[np.float64]
    normals: NDArray[np.float64]
    truth: NDArray[np.uint16]

    @property
    def components(self) -> int:
        """How many there are to find."""
        return len(np.unique(self.truth))


def ideal(vault: Vault, points: int, seed: int = 1) -> Case:
    """So many points of an ideal vault, even by area."""
    cloud = vault.sample(points, np.random.default_rng(seed))
    return Case(vault.id, vault.id, cloud.xyz, cloud.normals, cloud.component)


def settled(case: Case, seed: int = 2) -> Case:
    """The same cloud with noise, its crown sunk by `SETTLEMENT`; the normals stay those of the ideal vault."""
    rng = np.random.default_rng(seed)
    xyz = case.xyz + NOISE * rng.normal(size=case.xyz.shape)
    plan = (xyz[:, :2] - xyz[:, :2].mean(axis=0)) / np.ptp(xyz[:, :2], axis=0)
    xyz[:, 2] -= SETTLEMENT * np.cos(3.0 * plan[:, 0] + 0.3) * np.cos(3.0 * plan[:, 1] - 0.2)
    return Case(SETTLED_NAME.format(case.name), case.family, xyz, case.normals, case.truth)

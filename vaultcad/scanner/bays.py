"""Several vaults in one virtual scan: rooms side by side, bays along a nave, a nave with its aisles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.scanner.room import ARCH_DEPTH
from vaultcad.scanner.scan import VirtualScan, scan
from vaultcad.scanner.settings import ScannerSettings

Array = NDArray[np.float64]
PARTITION = 0.5  # thickness of the wall between two rooms [m]


@dataclass(frozen=True)
class Bay:
    """A vault of the scene, the middle of its plan [m] before the scene is turned, and how it is scanned."""

    vault: Vault
    x: float
    y: float
    settings: ScannerSettings

    @property
    def half(self) -> Array:
        """(2,) of what belongs to the bay: the plan, and half of the arch or wall to the next [m]."""
        wall = ARCH_DEPTH if self.settings.walls == "piers" else PARTITION
        return np.array([self.vault.plan.half_x, self.vault.plan.half_y]) + wall / 2


@dataclass(frozen=True, eq=False)
class SceneScan:
    """Points of all bays, one bay after the other.

    xyz: (n, 3) [m], relative to `origin` (3,). component: (n,) as in the vault of the bay. bay: (n,) uint16, 1-based
    number of the bay whose vault the point shows, 0 for none. truths: of each bay, see `vaultcad.scanner.truth.case`.
    """

    xyz: Array
    origin: Array
    component: NDArray[np.uint16]
    bay: NDArray[np.uint16]
    truths: tuple[dict[str, Any], ...]

    def __len__(self) -> int:
        return len(self.xyz)


def row(vaults: Sequence[Vault], settings: ScannerSettings, *, y: float = 0.0) -> tuple[Bay, ...]:
    """Bays side by side along x, the first one's plan about x = 0, with an arch or a wall between them."""
    bays: list[Bay] = []
    for vault in vaults:
        new = Bay(vault, 0.0, y, settings)
        bays.append(replace(new, x=bays[-1].x + float(bays[-1].half[0] + new.half[0])) if bays else new)
    return tuple(bays)


def scan_bays(
    bays: Sequence[Bay],
    *,
    yaw: float = 0.0,
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    rng: np.random.Generator,
) -> SceneScan:
    """Scan each bay from stations of its own; what these see of other bays is left out.

    Args:
        bays: where the vaults stand; `yaw` and `origin` of their settings are not used.
        yaw: of the whole scene about the file's z axis [rad].
        origin: of the scene in file coordinates [m].
        rng: for all bays, one after the other.

    Raises:
        ValueError, VaultcadError, MissingLibraryError: as `vaultcad.scanner.scan` does.
    """
    c, s = np.cos(yaw), np.sin(yaw)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    parts, truths = [], []
    for bay in bays:
        virtual = scan(bay.vault, replace(bay.settings, yaw=0.0, origin=(0.0, 0.0, 0.0)), rng=rng)
        own = np.asarray((np.abs(virtual.xyz[:, :2]) < bay.half).all(axis=1))
        parts.append(_of(virtual, own, np.array([bay.x, bay.y, 0.0]), turn))
        x, y, _ = turn @ np.array([bay.x, bay.y, 0.0]) + np.array(origin)
        truth = virtual.truth
        truth["pose"] = {"origin": [x, y, origin[2] + bay.settings.wall_height], "yaw_deg": float(np.degrees(yaw))}
        stations = np.array(truth["stations"]) + np.array([bay.x, bay.y, 0.0])
        truth["stations"] = (stations @ turn.T + origin).tolist()
        truths.append(truth)
    xyz, component = (np.concatenate(column) for column in zip(*parts, strict=True))
    number = np.repeat(np.arange(1, len(bays) + 1, dtype=np.uint16), [len(p[0]) for p in parts])
    return SceneScan(xyz, np.array(origin), component, np.where(component > 0, number, 0), tuple(truths))


def _of(virtual: VirtualScan, own: NDArray[np.bool_], shift: Array, turn: Array) -> tuple[Array, NDArray[np.uint16]]:
    """The bay's own points (k, 3) in the scene, and their components (k,)."""
    return (virtual.xyz[own] + shift) @ turn.T, virtual.component[own]

"""A virtual laser scan of a vault in its room: rays cast at the settled masonry, with the errors of a real scanner."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.scanner import room, truth
from vaultcad.scanner.places import about
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.settle import DeclaredSettlement, draw_settlement
from vaultcad.scanner.shoot import Shots, Target, aim, sweep
from vaultcad.scanner.waves import draw_waves

Array = NDArray[np.float64]

PILOT = 2 * pi / 180  # step [rad] of the sweeps that tell how many beams yield points
FOOTING = 1.5  # the settlement ends this far below the springing, or at the floor [m]
CLEARANCE = 0.3  # of the scanner to vault and walls [m]


@dataclass(frozen=True, eq=False)
class VirtualScan:
    """Points of all stations, one station after the other, each row by row upwards.

    xyz: (n, 3) [m], relative to `origin` (3,). component: (n,), 0 where it shows no vault, else as in
    `vault.components`. intensity: (n,). station: (n,), index in `stations` (k, 3) [m], relative to `origin` too.
    truth: what was scanned and how, see `vaultcad.scanner.truth.case`.
    """

    xyz: Array
    origin: Array
    component: NDArray[np.uint16]
    intensity: NDArray[np.uint16]
    station: NDArray[np.uint8]
    stations: Array
    truth: dict[str, Any]

    def __len__(self) -> int:
        return len(self.xyz)


def scan(vault: Vault, settings: ScannerSettings | None = None, *, rng: np.random.Generator) -> VirtualScan:
    """Scan a vault in a room.

    The same vault, settings and state of `rng` give the same bytes. Room, settlement and stations stay the same when
    only the number of points or the instrument's errors change.

    Raises:
        ValueError: the settings do not suit the vault; names the field, the value and the limit.
        VaultcadError: the vault could not be meshed.
        MissingLibraryError: open3d, or a system library under it, is missing; says how to install it.
    """
    settings = settings or ScannerSettings()
    place, build, settle, surface, pilot, measure, hide = rng.spawn(7)
    for _ in range(settings.visit):  # the room is the same, the scanner is not
        place, pilot, measure, hide = rng.spawn(4)
    stations = _draw_stations(vault, settings, place)
    still = room.build(vault, settings, stations, build)
    ideal = still.vertices[np.unique(still.triangles[still.component > 0])]
    depth = min(FOOTING, settings.wall_height)
    settlement = draw_settlement(ideal, vault.plan, depth, settings.settlement, settle)
    declared = DeclaredSettlement.of(settings, vault.plan, float(ideal[:, 2].max()), depth)
    moved = still.vertices + settlement(still.vertices) + declared(still.vertices)
    target = aim(replace(still, vertices=moved), surface)

    bounds = _bounds(vault, settings)
    step = angular_step(target, stations, settings, bounds, pilot)
    shots, index, reported = shot_from(target, stations, step, settings, bounds, measure)
    shots = replace(shots, xyz=_placed(shots.xyz, settings))
    keep = ~_hidden(shots, _placed(ideal, settings), settings.holes, hide)

    positions = _placed(reported, settings)
    case = truth.case(vault, settings, positions, step, int(keep.sum()))
    origin = np.array(settings.origin)
    return VirtualScan(
        shots.xyz[keep], origin, shots.component[keep], shots.intensity[keep], index[keep], positions, case
    )


def _draw_stations(vault: Vault, settings: ScannerSettings, rng: np.random.Generator) -> Array:
    """Positions (k, 3) in the vault's frame: one near the middle, or several around it.

    Raises:
        ValueError: there is no room for the scanner under the vault.
    """
    count, plan = settings.stations, vault.plan
    angle = rng.uniform(0, 2 * pi) + 2 * pi * np.arange(count) / count + rng.uniform(-0.3, 0.3, count)
    share = rng.uniform(0.1, 0.35, count) if count == 1 else rng.uniform(0.2, 0.5, count)
    height = settings.station_height + rng.uniform(-0.05, 0.05, count) - settings.wall_height
    stations = np.column_stack([about(plan, np.column_stack([share * np.cos(angle), share * np.sin(angle)])), height])
    room_left = -vault.distance(stations, walls=True)
    if (room_left < CLEARANCE).any():
        raise ValueError(
            f"station_height = {settings.station_height:g} m leaves the scanner {room_left.min():.2f} m to the vault; "
            f"it needs {CLEARANCE:g} m"
        )
    return stations


def _bounds(vault: Vault, settings: ScannerSettings) -> Array:
    """Low and high corner of what is kept, in the vault's frame (2, 3) [m]."""
    if not settings.crop:
        return np.array([[-np.inf] * 3, [np.inf] * 3])
    reach = vault.plan.half + max(settings.crop_margin, settings.settlement)
    return np.array([[*-reach, -settings.crop_margin], [*reach, np.inf]])


def angular_step(
    target: Target, stations: Array, settings: ScannerSettings, bounds: Array, rng: np.random.Generator
) -> float:
    """Angular step [rad] that yields about the points wanted, from a coarse sweep: they grow as 1 / step²."""
    component = np.concatenate(
        [s.component for station in stations for s in sweep(target, station, PILOT, settings, bounds, rng)]
    )
    points = len(component) - settings.holes * np.count_nonzero(component)
    return PILOT * sqrt(points / settings.points)


def shot_from(
    target: Target,
    stations: Array,
    step: float,
    settings: ScannerSettings,
    bounds: Array,
    rng: np.random.Generator,
) -> tuple[Shots, NDArray[np.uint8], Array]:
    """Points from all stations (k, 3), the station of each (n,), and where these are reported to stand (k, 3) [m].

    The first is registered rightly, the others a little off.
    """
    chunks, counts, reported = [], [], []
    for k, station in enumerate(stations):
        turn, shift = _registration(settings, rng) if k else (np.eye(3), np.zeros(3))
        found = [
            replace(shots, xyz=(shots.xyz - station) @ turn.T + station + shift)
            for shots in sweep(target, station, step, settings, bounds, rng)
        ]
        chunks += found
        counts.append(sum(len(shots.xyz) for shots in found))
        reported.append(station + shift)
    return _joined(chunks), np.repeat(np.arange(len(counts), dtype=np.uint8), counts), np.array(reported)


def _joined(shots: list[Shots]) -> Shots:
    return Shots(
        np.concatenate([s.xyz for s in shots]),
        np.concatenate([s.component for s in shots]),
        np.concatenate([s.intensity for s in shots]),
    )


def _registration(settings: ScannerSettings, rng: np.random.Generator) -> tuple[Array, Array]:
    """Small turn (3, 3) about a station and shift (3,) [m] by which it was registered wrongly."""
    a, b, c = settings.registration_turn * rng.standard_normal(3)
    skew = np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])
    # Cayley's map keeps it a rotation exactly.
    turn = np.linalg.solve(np.eye(3) - skew / 2, np.eye(3) + skew / 2).astype(np.float64)
    return turn, settings.registration_shift * rng.standard_normal(3)


def _hidden(shots: Shots, ideal: Array, share: float, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Which points (n,) fall into patches that take the given share of the vault's points away.

    The patches are blobs with ragged edges about random points of the vault `ideal` (v, 3).
    """
    on_vault = np.flatnonzero(shots.component > 0)
    missing = np.zeros(len(shots.component), np.bool_)
    count = int(rng.integers(3, 9))
    centres, radii = ideal[rng.integers(len(ideal), size=count)], rng.uniform(0.5, 1.0, count)
    ragged = draw_waves(count=8, shortest=0.3, longest=1.5, rng=rng)
    taken = round(share * len(on_vault))
    if taken:
        xyz = shots.xyz[on_vault]
        depth = 0.15 * ragged(xyz).astype(np.float64)
        depth += np.min([np.linalg.norm(xyz - c, axis=1) / r for c, r in zip(centres, radii, strict=True)], axis=0)
        missing[on_vault[np.argpartition(depth, taken - 1)[:taken]]] = True
    return missing


def _placed(xyz: Array, settings: ScannerSettings) -> Array:
    """Points of the vault's frame in that of the file, less its origin: turned by the yaw, the floor at z = 0."""
    c, s = cos(settings.yaw), sin(settings.yaw)
    turned = np.column_stack([c * xyz[:, 0] - s * xyz[:, 1], s * xyz[:, 0] + c * xyz[:, 1], xyz[:, 2]])
    turned[:, 2] += settings.wall_height
    return turned

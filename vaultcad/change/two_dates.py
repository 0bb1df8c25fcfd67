"""The change of vaults between two scans: at core points over vaults and their walls, and in figures with limits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from vaultcad.change.m3c2 import SURE, Distances, Sheet, m3c2
from vaultcad.change.places import Reading, Sights, movement_of, readings
from vaultcad.change.registration import Registration, registered_on
from vaultcad.deformation import Movement
from vaultcad.errors import VaultcadError
from vaultcad.mechanisms import Body
from vaultcad.model import FittedVault, Model
from vaultcad.pose import Pose

Array = NDArray[np.float64]

SPACING = 0.15  # m, of core points
RADIUS, PER_CYLINDER = (0.1, 0.3), 30  # m, limits of the cylinders about them, and the points that are wanted in one
REACH = 0.25  # m off the vault, within which stone is looked for: no change can be larger
WALLS = 1.6  # m below the springing down to which walls are compared, too
STABLE = 0.5  # share of the height from floor to springing below which walls count as stable
CELL, FEWEST_CORES = 0.5, 4  # m, of vault that is judged at once, and the core points that it needs
ABOUT = 0.3  # m, around a place whose core points are its figure
ALONG = 0.9  # cosine between a figure's way and the normals there at the least
FALSE = 0.02  # chance that anything is reported where nothing changed
MOST_POINTS = 1_500_000  # about a vault of either scan


@dataclass(frozen=True)
class Cells:
    """Parts of a vault: means (c,) of the change [m], their standard deviations (c,) [m], and places (c, 3) [m]."""

    change: Array
    std: Array
    place: Array
    quantile: float  # standard deviations beyond which one of them has changed, allowing for their number

    @property
    def changed(self) -> NDArray[np.bool_]:
        """Which have (c,)."""
        return np.abs(self.change) > self.quantile * self.std

    @property
    def detectable(self) -> float:
        """The change [m] that would have been found in most of them; NaN without any."""
        return float(self.quantile * np.median(self.std)) if len(self.std) else float("nan")


@dataclass(frozen=True)
class VaultChange:
    """The change of one vault, by its number in the model of the first scan.

    cores, normals: (m, 3) in the first scan's local frame, normals into the stone. component: (m,), 0 for walls.
    """

    number: int
    fitted: FittedVault
    cores: Array
    normals: Array
    component: NDArray[np.uint16]
    distances: Distances
    cells: Cells
    movements: tuple[Movement, ...]

    @property
    def changed(self) -> bool:
        """Whether any part of it has."""
        return bool(self.cells.changed.any())


@dataclass(frozen=True)
class ScanChange:
    """What two scans say of a change; the model is that of the first."""

    model: Model
    registration: Registration
    given: bool  # whether they were in one system already
    vaults: tuple[VaultChange, ...]


def compare_scans(
    model: Model,
    before: NDArray[np.floating],
    after: NDArray[np.floating],
    *,
    registered: float | None = None,
    shift: Array | None = None,
    poses: Callable[[], Sequence[Pose]] = lambda: (),
) -> ScanChange:
    """The change from one scan to another of the same vaults.

    Args:
        model: of the first scan.
        before: its points (n, 3) [m], local to the model's origin.
        after: points (k, 3) [m] of the other scan, in its own local frame.
        registered: standard deviation [m] of a registration that was made before, along each axis; None to make one.
        shift: (3,) [m] from the other's local frame to the first's, by their origins.
        poses: where vaults stand in the other scan, asked for where its frame is another.

    Raises:
        VaultcadError: the scans cannot be brought together, or show no part of a vault both.
    """
    moved = np.asarray(after, np.float64) + (np.zeros(3) if shift is None else shift)
    if registered is None:
        registration = _registered(model, np.asarray(before, np.float64), moved, shift, poses)
        moved = registration(moved)
    else:
        registration = Registration.exact(registered)
    vaults = tuple(_of_vault(k, fitted, before, moved, registration) for k, fitted in enumerate(model.vaults, 1))
    if not any(np.isfinite(one.distances.change).any() for one in vaults):
        raise VaultcadError("no part of a vault is in both scans; give two scans of the same vault")
    return ScanChange(model, registration, registered is not None, vaults)


def _registered(
    model: Model, before: Array, after: Array, shift: Array | None, poses: Callable[[], Sequence[Pose]]
) -> Registration:
    springing = min(fitted.pose.z for fitted in model.vaults)
    floor = float(np.quantile(before[:: max(1, len(before) // 100_000), 2], 0.002))
    height = floor + STABLE * max(springing - floor, 0.0)
    back = np.zeros(3) if shift is None else shift

    def starts() -> Iterable[Array]:
        yield np.eye(4)
        for theirs, mine, quarter in product(poses(), model.vaults, range(4)):
            turn = np.eye(4)
            c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[quarter]
            turn[:2, :2] = [[c, -s], [s, c]]
            there = theirs.placement()
            there[:3, 3] += back
            yield mine.pose.placement() @ turn @ np.linalg.inv(there)

    # The other's floor is where its own points say, until it is brought to the first's.
    low = floor_of(after)
    fixed = before[before[:, 2] < height]
    return registered_on(fixed, after[after[:, 2] < low + height - floor], starts())


def floor_of(points: Array) -> float:
    """Height [m] of the lowest of points (n, 3), but for strays."""
    return float(np.quantile(points[:: max(1, len(points) // 100_000), 2], 0.002))


def _of_vault(
    number: int, fitted: FittedVault, before: NDArray[np.floating], after: Array, registration: Registration
) -> VaultChange:
    frame = fitted.pose.frame()
    sheets, walls = [], []
    for points in (before, after):
        local = np.asarray(points, np.float64) @ frame[:, :3].T + frame[:, 3]
        local = local[_about(fitted, local)]
        local = local[:: max(1, -(-len(local) // MOST_POINTS))]
        surface = fitted.vault.evaluate(local, walls=True)
        near = np.abs(surface.distance) < REACH
        offset, normal = surface.distance[near], surface.normal[near]
        sheets.append(Sheet(local[near] - offset[:, None] * normal, offset))
        walls.append((surface.component[near], normal))
    cores, which = _thinned(sheets[0].foot)
    component, normal = walls[0][0][which], walls[0][1][which]
    placement = fitted.pose.placement()
    place, way = cores @ placement[:3, :3].T + placement[:3, 3], normal @ placement[:3, :3].T
    rows = registration.rows(place, way)
    common = np.einsum("mi,ij,mj->m", rows, registration.covariance, rows) + registration.left_at(place) ** 2
    distances = m3c2(cores, sheets[0], sheets[1], _radius(sheets, len(cores)), common)
    wanted = readings(fitted.vault, Body.of(fitted.vault, WALLS), _seen(cores, normal))
    told = (_movement(one, cores, normal, place, distances, rows, registration, fitted.pose.yaw) for one in wanted)
    cells = _cells(cores, component, normal, distances, common)
    return VaultChange(
        number, fitted, place, way, component, distances, cells, tuple(one for one in told if one is not None)
    )


def _about(fitted: FittedVault, local: Array) -> NDArray[np.bool_]:
    """Which points (n, 3) of the vault's frame lie about it."""
    low, high = (np.asarray(end) for end in fitted.vault.plan.box)
    inside = ((local[:, :2] > low - REACH) & (local[:, :2] < high + REACH)).all(axis=1)
    out: NDArray[np.bool_] = inside & (local[:, 2] > -WALLS) & (local[:, 2] < fitted.vault.top + REACH)
    return out


def _seen(cores: Array, normal: Array) -> Sights:
    low = cores[:, 2] < -0.05
    return Sights(cores[low], normal[low])


def _thinned(foot: Array) -> tuple[Array, NDArray[np.int64]]:
    """Core points (m, 3): of the feet, the one nearest to the middle of each cell of a grid; and their indices."""
    cell = np.floor(foot / SPACING).astype(np.int64)
    off = np.linalg.norm(foot - (cell + 0.5) * SPACING, axis=1)
    order = np.lexsort((off, cell[:, 2], cell[:, 1], cell[:, 0]))
    new = np.ones(len(order), np.bool_)
    new[1:] = (np.diff(cell[order], axis=0) != 0).any(axis=1)
    which = np.sort(order[new])
    return foot[which], which


def _radius(sheets: Sequence[Sheet], cores: int) -> float:
    """Of the cylinders [m]: wider where the sparser scan has few points on the surface that the cores stand for."""
    density = min(len(sheet.foot) for sheet in sheets) / max(cores * SPACING**2, SPACING**2)
    return float(np.clip(np.sqrt(PER_CYLINDER / (np.pi * max(density, 1e-9))), *RADIUS))


def _cells(cores: Array, component: NDArray[np.uint16], normal: Array, distances: Distances, common: Array) -> Cells:
    """The vault in parts, walls apart, whose core points are judged together."""
    from scipy.special import ndtri

    use = np.isfinite(distances.change) & (component > 0)
    facing = np.argmax(np.abs(normal[use]), axis=1)
    key = np.column_stack([np.floor(cores[use] / CELL).astype(np.int64), component[use], facing])
    cell = np.unique(key, axis=0, return_inverse=True)[1].ravel()
    count = np.bincount(cell)

    def mean(values: Array) -> Array:
        out: Array = np.bincount(cell, values[use]) / count
        return out

    own = mean(np.maximum((distances.lod / SURE) ** 2 - common, 0.0))
    change = mean(distances.change)
    # At creases and feet core points of a cell differ by more than their limits, as one of them meets another face.
    apart = np.bincount(cell, (distances.change[use] - change[cell]) ** 2) / np.maximum(count - 1, 1)
    std = np.sqrt(np.maximum(own, apart) / count + mean(common))
    place = np.column_stack([mean(column) for column in cores.T])
    full = count >= FEWEST_CORES
    quantile = float(ndtri(1 - FALSE / 2 / max(int(full.sum()), 1)))
    return Cells(change[full], std[full], place[full], quantile)


def _movement(
    one: Reading,
    cores: Array,
    normal: Array,
    place: Array,
    distances: Distances,
    rows: Array,
    registration: Registration,
    yaw: float,
) -> Movement | None:
    """A figure of the change; None where its places were not seen in both scans, or moved along the stone."""
    value, own, reach = 0.0, 0.0, np.zeros(6)
    for at, way in one.terms:
        near = (np.linalg.norm(cores - at, axis=1) < ABOUT) & np.isfinite(distances.change)
        size = float(np.linalg.norm(way))
        along = normal @ way / size
        mine = near & (np.abs(along) > ALONG)
        if not mine.any():
            return None
        parts = size / along[mine]  # of the motion along the way, by what of it is seen along the normal
        value += float((parts * distances.change[mine]).mean())
        own += float((parts**2).mean()) * (
            float((registration.left_at(place[mine]) ** 2).mean()) + _own(distances, mine)
        )
        reach += (parts[:, None] * rows[mine]).mean(axis=0)
    std = float(np.sqrt(own + reach @ registration.covariance @ reach))
    return movement_of(one, value, std, yaw)


def _own(distances: Distances, mine: NDArray[np.bool_]) -> float:
    """Variance [m²] of the mean of some changes by their scatter."""
    change = distances.change[mine]
    return float(np.var(change) / len(change)) if len(change) > 1 else 0.0

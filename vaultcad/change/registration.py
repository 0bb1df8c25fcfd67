"""Two scans of one room brought together on what has not moved, with what that may be off.

Point-to-plane alignment (Chen and Medioni 1992), robust by the loss of Geman and McClure as all fits here, on floor and
the lower half of walls. Relief and the registration of stations within a scan are alike over decimetres, so that points
are no witnesses of their own: the covariance is the sandwich of sums over blocks (Liang and Zeger 1986).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.errors import VaultcadError

Array = NDArray[np.float64]

THINNED = 0.06  # m, cells that stable points are thinned to
BLOCK = 0.5  # m, of stone whose points err together
FEWEST = 300  # thinned points without which nothing is registered
WIDE, NARROW, SCATTERS = 0.3, 0.006, 4.0  # m, scales of the loss at first and at last; and that in scatters
STEPS = 40
STILL = 1e-7  # rad and m
OVERLAP, NEAR = 0.6, 0.2  # share of the points that must be so near [m] to the other scan, for a start
FLAT = 1e-3  # least share of what is known best that is known of any direction: else a scan can slide along itself


@dataclass(frozen=True)
class Registration:
    """How points of one scan go into the other's frame: p -> turn (p - centre) + centre + shift.

    turn: (3, 3). centre, shift: (3,) [m]. covariance: (6, 6) of a further small turn [rad] about the centre, and shift
    [m]. systematic: standard deviation [m] with which blocks of stable stone still differ. reach: root mean square
    distance of that stone from the centre [m]. points: that it rests on.
    """

    turn: Array
    centre: Array
    shift: Array
    covariance: Array
    systematic: float
    reach: float
    points: int

    def __call__(self, points: NDArray[np.floating]) -> Array:
        """Points (n, 3) [m] of the moved scan in the frame of the other."""
        out: Array = (np.asarray(points, np.float64) - self.centre) @ self.turn.T + self.centre + self.shift
        return out

    def rows(self, points: Array, ways: Array) -> Array:
        """(n, 6): how a further turn and shift move points (n, 3) along ways (n, 3)."""
        return np.hstack([np.cross(points - self.centre, ways), ways])

    def left_at(self, points: Array) -> Array:
        """Standard deviations (n,) [m] of what is left at points (n, 3) [m].

        Stations that were registered a little wrongly within their scan are shifted, and turned: the farther from what
        is stable the more they are off.
        """
        away = np.linalg.norm(points - self.centre, axis=1)
        out: Array = self.systematic * np.sqrt((1 + np.maximum(away / self.reach, 1.0) ** 2) / 2)
        return out

    @classmethod
    def exact(cls, error: float = 0.0) -> Registration:
        """Of scans in one system already, to within a shift of `error` [m] along each axis."""
        spread = np.diag([0.0, 0.0, 0.0, *[error**2] * 3])
        return cls(np.eye(3), np.zeros(3), np.zeros(3), spread, 0.0, 1.0, 0)


def registered_on(fixed: Array, moving: Array, starts: Iterable[Array]) -> Registration:
    """The registration of stable points (m, 3) on those of another scan (n, 3) [m].

    starts: motions (4, 4) of `moving` from which to begin; the first under which most points are near, or the best.

    Raises:
        VaultcadError: there are too few points, the scans do not meet, or one can slide along the other.
    """
    from scipy.spatial import cKDTree

    from segmentation.normals import estimate
    from segmentation.voxel import thin

    here, there = (thin(points, THINNED).xyz.astype(np.float64) for points in (fixed, moving))
    normals = estimate(here).astype(np.float64)
    good = np.isfinite(normals).all(axis=1)
    here, normals = here[good], normals[good]
    if min(len(here), len(there)) < FEWEST:
        raise VaultcadError(
            f"{min(len(here), len(there))} places of walls and floor are in both scans, {FEWEST} are needed to "
            "register them; say --registered if they are in one system already"
        )
    tree = cKDTree(here)
    motion = _start(tree, there, starts)
    scale, centre = WIDE, here.mean(axis=0)
    for _ in range(STEPS):
        moved = there @ motion[:3, :3].T + motion[:3, 3]
        apart, found = tree.query(moved, distance_upper_bound=max(scale, THINNED * 2))
        met, nearest = np.isfinite(apart), np.asarray(found)
        left, rows = _rows(moved[met], here[nearest[met]], normals[nearest[met]], centre)
        weights = 1 / (1 + (left / scale) ** 2) ** 2
        hessian = (rows.T * weights) @ rows
        known = np.linalg.eigvalsh(hessian)
        if known[0] < FLAT * known[-1]:
            raise VaultcadError(
                "what is stable in both scans lets one slide along the other; scan walls on two sides, or say "
                "--registered if they are in one system already"
            )
        step = np.asarray(-np.linalg.solve(hessian, rows.T @ (weights * left)), np.float64)
        motion = _moved(step, centre) @ motion
        scatter = 1.4826 * float(np.median(np.abs(left)))
        finer = max(NARROW, min(SCATTERS * scatter, scale * 0.7))
        if finer == scale and np.abs(step).max() < STILL:
            break
        scale = finer
    bread = np.linalg.inv(hessian)
    block = _blocks(moved[met], normals[nearest[met]])
    sums = np.stack([np.bincount(block, column) for column in (rows * (weights * left)[:, None]).T], axis=1)
    covariance = bread @ (sums.T @ sums) @ bread
    turn = motion[:3, :3]
    shift = motion[:3, 3] + turn @ centre - centre
    reach = float(np.sqrt(((here - centre) ** 2).sum(axis=1).mean()))
    return Registration(turn, centre, shift, covariance, _systematic(left, weights, block), reach, int(met.sum()))


def _start(tree: object, moving: Array, starts: Iterable[Array]) -> Array:
    """The first start under which enough points are near, or the best of all."""
    best, most = np.eye(4), -1.0
    some = moving[:: max(1, len(moving) // 4000)]
    for start in starts:
        apart, _ = tree.query(some @ start[:3, :3].T + start[:3, 3])  # type: ignore[attr-defined]
        share = float((apart < NEAR).mean())
        if share > most:
            best, most = start, share
        if share > 0.9:
            break
    if most < OVERLAP:
        raise VaultcadError(
            f"only {most:.0%} of the walls and floor of the second scan lie near those of the first; give two scans of "
            "the same room"
        )
    return best


def _rows(moved: Array, met: Array, normals: Array, centre: Array) -> tuple[Array, Array]:
    """Distances (n,) of points from the planes that they met, and their derivatives (n, 6) by turn and shift."""
    left: Array = ((moved - met) * normals).sum(axis=1)
    return left, np.hstack([np.cross(moved - centre, normals), normals])


def _moved(step: Array, centre: Array) -> Array:
    """The motion (4, 4) by a small turn about a centre and a shift (6,)."""
    a, b, c = step[:3]
    skew = np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])
    motion = np.eye(4)
    # Cayley's map keeps it a rotation exactly.
    motion[:3, :3] = np.linalg.solve(np.eye(3) - skew / 2, np.eye(3) + skew / 2)
    motion[:3, 3] = centre - motion[:3, :3] @ centre + step[3:]
    return motion


def _blocks(points: Array, normals: Array) -> NDArray[np.int64]:
    """The block (n,) of each point: cells that face one way."""
    facing = np.argmax(np.abs(normals), axis=1)
    key = np.column_stack([np.floor(points / BLOCK).astype(np.int64), facing])
    return np.asarray(np.unique(key, axis=0, return_inverse=True)[1].ravel(), np.int64)


def _systematic(left: Array, weights: Array, block: NDArray[np.int64]) -> float:
    """Standard deviation [m] of the means of blocks, by their median: furniture that moved is none."""
    weight = np.bincount(block, weights)
    means = np.bincount(block, weights * left) / np.maximum(weight, 1e-12)
    full = weight > 0.25 * np.median(weight)
    return 1.4826 * float(np.median(np.abs(means[full])))

"""Every point of a scan gets its component: the nearest surface of the fitted vault, if it is near enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families.declaration.vault import Surface
from families.void import kernel
from segmentation.threads import threads
from vaultcad.fit.solve import Placed
from vaultcad.survey.plan_grid import Laid, PlanGrid

CHUNK = 1 << 19  # points that a thread takes at once
CELL = 0.5  # m, edge of cells by which points are told apart that may be a vault's or an arch's
FACE = 0.025  # m; points so near to the face of an arch are its own


@dataclass(frozen=True)
class Labels:
    """For each point of the scan, in its order.

    component: (n,) id of the component, 0 off the vault. vault: (n,) 1-based number of the vault, 0 for none.
    deviation: (n,) signed distance [m] to the model, positive in the stone, NaN off vaults and arches.
    arch: (n,) 1-based number of the arch, 0 for none; none of its points is a vault's.
    """

    component: NDArray[np.uint16]
    vault: NDArray[np.uint16]
    deviation: NDArray[np.float32]
    arch: NDArray[np.uint16]


@dataclass(frozen=True)
class ArchBand:
    """Where the points of an arch lie: about its soffit, a barrel, by `tolerance` [m], and on its faces.

    depth: (2,) of its faces on either side of its span, the barrel's south and north [m]; NaN where it has none.
    curve: (k, 2) of an arch of no kind, whose points lie about it instead: along the span and up from the springing.
    """

    placed: Placed
    tolerance: float
    depth: NDArray[np.float64]
    curve: NDArray[np.float64] | None = None

    @property
    def half(self) -> NDArray[np.float64]:
        """(2,) of the plan in which those points lie [m]."""
        x, y = self.placed.vault.plan.half
        return np.array([x + np.nanmax([self.tolerance, *self.depth]), y + FACE])

    def above(self, local: NDArray[np.float64], surface: Surface) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """How far points (n, 3) in its frame are above its soffit, and off it (n,) [m], NaN where they are not over it.

        surface: the barrel at these.
        """
        if self.curve is None:
            off = np.where(surface.component > 0, surface.distance, np.nan)
            return self.placed.vault.distance(local), off
        along, height = self.curve.T
        above = local[:, 2] - np.interp(local[:, 0], along, height, left=np.nan, right=np.nan)
        above /= np.hypot(1.0, np.interp(local[:, 0], along, np.gradient(height, along)))
        return above, above


def label(xyz: NDArray[np.floating], vaults: Sequence[tuple[Placed, float]], arches: Sequence[ArchBand] = ()) -> Labels:
    """Label points (n, 3) [m] within a tolerance [m] of a vault; points nearer to its walls are not the vault's.

    A point near two vaults is the nearer one's, and so is one near a vault and an arch. vaults: where they stand, each
    with its tolerance.
    """
    n = len(xyz)
    component, vault, arch = (np.zeros(n, np.uint16) for _ in range(3))
    labels = Labels(component, vault, np.full(n, np.nan, np.float32), arch)

    plans = [_corners(placed.pose.frame(), placed.vault.plan.half + tolerance) for placed, tolerance in vaults]
    plans += [_corners(band.placed.pose.frame(), band.half) for band in arches]
    if not plans:
        return labels
    low, high = np.array(plans).min(axis=0)[0], np.array(plans).max(axis=0)[1]

    def work(start: int) -> None:
        laid = Laid.over(PlanGrid.over(low, high, CELL), np.ascontiguousarray(xyz[start : start + CHUNK]))
        about = (laid.numbers_about(*corners) for corners in plans)
        for number, (placed, tolerance) in enumerate(vaults, 1):
            _label(laid.points, next(about), placed, tolerance, number, labels, start)
        for number, band in enumerate(arches, 1):
            _label_arch(laid.points, next(about), band, number, labels, start)

    with threads() as pool:
        list(pool.map(work, range(0, n, CHUNK)))
    return labels


def _corners(frame: NDArray[np.float64], half: NDArray[np.float64]) -> NDArray[np.float64]:
    """South western and north eastern corner (2, 2) [m] about a plan of such half extents (2,) in a frame."""
    corners = np.array([[x, y, 0.0] for x in (-half[0], half[0]) for y in (-half[1], half[1])])
    places = ((corners - frame[:, 3]) @ frame[:, :3])[:, :2]
    return np.array([places.min(axis=0), places.max(axis=0)])


def _over(
    xyz: NDArray[np.floating],
    about: NDArray[np.int32],
    frame: NDArray[np.float64],
    half: NDArray[np.float64],
    low: float,
) -> NDArray[np.int32]:
    """Of the points `about` a plan, by their numbers, those over it and above `low` in its frame [m]."""
    mine: NDArray[np.int32] = about[kernel.over_plan(xyz.take(about, axis=0), frame, half, low)]
    return mine


def _label(
    xyz: NDArray[np.floating],
    about: NDArray[np.int32],
    placed: Placed,
    tolerance: float,
    number: int,
    labels: Labels,
    start: int,
) -> None:
    """Enter the points of one vault, of those from `start` on that are about it, that are not nearer to one before."""
    frame = placed.pose.frame()
    mine = _over(xyz, about, frame, placed.vault.plan.half + tolerance, -tolerance)
    surface = placed.vault.evaluate(xyz[mine], frame=frame, walls=True)
    at = start + mine
    known = np.abs(labels.deviation[at])
    near = (np.abs(surface.distance) <= tolerance) & (surface.component > 0)
    near &= ~(known <= np.abs(surface.distance))
    at = at[near]
    labels.component[at] = surface.component[near]
    labels.vault[at] = number
    labels.deviation[at] = surface.distance[near]


def _label_arch(
    xyz: NDArray[np.floating], about: NDArray[np.int32], band: ArchBand, number: int, labels: Labels, start: int
) -> None:
    """Enter the points of one arch, of those from `start` on that are about it, not nearer to a vault or other arch."""
    vault, frame = band.placed.vault, band.placed.pose.frame()
    y = vault.plan.half[1]
    mine = _over(xyz, about, frame, band.half, -band.tolerance)
    local = xyz[mine] @ frame[:, :3].T + frame[:, 3]
    beyond = np.abs(local[:, 1]) - y
    side = (local[:, 1] > 0).astype(int)
    local[:, 1] = 0.0
    surface = vault.evaluate(local, walls=True)
    above, off = band.above(local, surface)
    face = (np.abs(beyond) < FACE) & (above > 0) & (above < band.depth[side])
    off = np.where(face, beyond, off)
    at = start + mine
    near = face | (np.abs(off) <= band.tolerance)
    near &= ~(np.abs(labels.deviation[at]) <= np.abs(off))
    at = at[near]
    labels.component[at], labels.vault[at], labels.arch[at] = 0, 0, number
    labels.deviation[at] = np.where(face, beyond, surface.distance)[near]

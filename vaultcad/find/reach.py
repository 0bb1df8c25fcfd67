"""How far the stone of a barrel goes along its axis: its end belongs there that a cut through one ceiling guessed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from families import Barrel
from vaultcad.fit.label import label
from vaultcad.fit.solve import Placed
from vaultcad.survey.bays import WALL_CELLS, CeilingGrid, Region
from vaultcad.survey.thinned_scan import turned

Array = NDArray[np.float64]

SHOWN = 0.5  # share of what is mostly seen across a barrel that a strip of it must show
MISSED = 0.4  # m along a barrel over which it may be hidden, as behind a lamp
MOVED = 0.15  # m by which an end must be elsewhere to be worth another fit
BEYOND = 0.4  # m beyond an end in which nothing hangs where a wall stands there


def reach_of(
    barrel: Placed, tolerance: float, others: Sequence[tuple[Placed, float]], over: CeilingGrid
) -> Region | None:
    """The part of a plan over which a barrel's stone hangs; None where its ends are about there, or nothing tells.

    Args:
        barrel: as it was fitted to a part of that.
        tolerance: half of the band that its points lie in [m].
        others: the vaults beside it, and theirs; what is nearer to one of them is none of it.
        over: the ceiling.
    """
    vault, points = barrel.vault, over.points(over.whole)
    if not isinstance(vault, Barrel) or vault.splay:
        return None
    frame = barrel.pose.frame()
    local = points @ frame[:, :3].T + frame[:, 3]
    along, cell, half = local[:, 1], over.cell, vault.length / 2
    most = next(p.range.high for p in vault.parameters() if p.name == "length")
    longest = Placed(vault.replaced({"length": min(2 * float(np.abs(along).max()) + cell, most)}), barrel.pose)
    own = label(points, [*others, (longest, tolerance)]).vault == len(others) + 1
    start = float(along.min())
    strip = np.floor((along - start) / cell).astype(np.int64)
    shown = np.bincount(strip[own], minlength=int(strip.max()) + 1)
    mine = np.unique(strip[np.abs(along) < half])
    good = np.flatnonzero(shown >= max(SHOWN * float(np.median(shown[mine])), 1.0))
    run = _run(good, int(-start / cell), round(MISSED / cell))
    if run is None:
        return None
    ends = start + cell * np.array([run[0], run[1] + 1])
    if (np.abs(ends - [-half, half]) < MOVED).all():
        return None
    return _part(barrel, ends, local, over)


def _run(good: NDArray[np.int64], middle: int, missed: int) -> tuple[int, int] | None:
    """First and last of the strips that go on from about the middle one without many that miss between them."""
    runs = np.split(good, np.flatnonzero(np.diff(good) > missed + 1) + 1) if len(good) else []
    found = (run for run in runs if run[0] - missed <= middle <= run[-1] + missed)
    return next(((int(run[0]), int(run[-1])) for run in found), None)


def _part(barrel: Placed, ends: Array, local: Array, over: CeilingGrid) -> Region:
    """The part of the plan between two places along a barrel [m]: cut by guess where something hangs beyond."""
    half, margin = barrel.vault.plan.half[0], WALL_CELLS * over.cell
    beside = np.abs(local[:, 0]) < half
    goes_on = [
        bool((beside & (beyond > over.cell) & (beyond < BEYOND)).any())
        for beyond in (ends[0] - local[:, 1], local[:, 1] - ends[1])
    ]
    south, north = ends + np.where(goes_on, 0.0, margin) * [-1, 1]
    corners = np.array([[x, y, 0.0] for x in (-half - margin, half + margin) for y in (south, north)])
    place = barrel.pose.placement()
    xy = turned((corners @ place[:3, :3].T + place[:3, 3])[:, :2], over.yaw)
    way = turned(place[None, :2, 1], over.yaw)[0]  # of the barrel's axis
    axis = int(np.argmax(np.abs(way)))
    sides = (0, 1) if way[axis] > 0 else (1, 0)
    cut = tuple((axis, side) for side, on in zip(sides, goes_on, strict=True) if on)
    return Region(over.yaw, xy.min(axis=0), xy.max(axis=0), cut)

"""Ribs in a scan: strips of stone below the lines in which the webs of a fitted vault meet, and below its wall arches.

A rib is told by its cross-section, looked at step by step along the line: a soffit that is flat, deeper than the webs
beside it, between two edges. It counts only where it is seen along most of the line.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from math import isnan, sqrt

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.ribs import DIAGONAL, WALL
from families.void import kernel
from vaultcad.errors import NoVaultError
from vaultcad.find.arches import OF_MEDIAN, TOGETHER, FoundArch
from vaultcad.find.found import Found
from vaultcad.find.soffit_barrel import fitted_soffit
from vaultcad.fit.solve import Placed
from vaultcad.survey.soffits import SIGMA, Soffit, measured
from vaultcad.survey.thinned_scan import Thin

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

STEP = 0.1  # m along a line, in which a rib is looked for
NODES = 200  # places at which the height of a line is taken
INWARDS = 1e-5  # m inside a wall's face where its arch is looked at: webs may rise steeply from it
MIDDLE = {DIAGONAL: (-0.06, 0.06), WALL: (0.035, 0.11)}  # m beside its line where a rib is looked for first
NARROWEST = 0.08  # m, of what is seen of a rib's width
HALF_WIDTH = 0.4  # m, of a rib at most
DEPTH = 0.05, 0.5  # m, of a rib
EVEN = 0.25  # of its depth, by which it may vary
SEEN = 0.6  # share of its steps along which a rib must be seen
MOST = 0.7  # share of a soffit's points that must lie on the arch that is fitted to it
FOOT = 0.15  # share of a line at each end where ribs, webs and walls run into each other
SAME = 0.03  # m; points so near the soffit's height in a step are its own
CROSSING = 0.5  # m about the middle of a line where another rib crosses or meets it
MARGIN = 1e-3  # m beyond the box about a plan, so that rounding loses no point over it
CLEAR = 0.03  # m beyond the edges of a rib where its points may be


@dataclass(frozen=True)
class SeenRib:
    """A rib under a vault: its kind, its soffit, and its depth below the vault's line with how sure that is [m]."""

    kind: str
    soffit: Soffit
    depth: float
    depth_std: float

    def holds(self, points: Array) -> Mask:
        """Which points (n, 3) [m] over or under its strip are no web's, as they may be the rib's."""
        held: Mask = self.soffit.holds(points, CLEAR)
        return held


def ribs_under(placed: Placed, xyz: NDArray[np.floating]) -> tuple[SeenRib, ...]:
    """The ribs under a vault of four corners that points (n, 3) [m] show, the diagonals first."""
    plan = placed.vault.plan
    if len(plan.sides) != 4 or any(side.centre is not None for side in plan.sides):
        return ()
    frame = placed.pose.frame()
    # Of a building's points few are under one of its vaults, which is told without a copy of them all.
    points = xyz[kernel.over_plan(np.ascontiguousarray(xyz), frame, plan.half + MARGIN, 0.0)].astype(np.float64)
    local = points @ frame[:, :3].T + frame[:, 3]
    under = (local[:, 2] > 0) & plan.holds(local[:, :2])
    found = (_rib(placed, kind, start, end, points[under], local[under]) for kind, start, end in _lines(placed.vault))
    return tuple(rib for rib in found if rib is not None)


def rib_arches(found: Found, thin: Thin, xyz: NDArray[np.floating], rng: np.random.Generator) -> Iterator[FoundArch]:
    """The ribs under a vault as arches, by a scan's points, thinned and all of them (n, 3) [m]."""
    if not ribs_under(found.placed, thin.points):
        return
    for rib in ribs_under(found.placed, xyz):
        with suppress(NoVaultError):
            barrel = fitted_soffit(rib.soffit, thin, rng)
            if _follows(barrel, rib.soffit, thin.points):
                yield FoundArch(rib.soffit, barrel, np.full(2, rib.depth), np.full(2, rib.depth_std), rib.kind)


def _follows(barrel: Found, soffit: Soffit, points: Array) -> bool:
    """Whether most of a soffit's points (n, 3) [m] lie on its barrel."""
    along, _ = soffit.local(points)
    own = soffit.holds(points) & (np.abs(points[:, 2] - soffit.height(along)) < SAME)
    return bool(own.any() and (np.abs(barrel.placed.distance(points[own])) < barrel.tolerance).mean() > MOST)


def _lines(vault: Vault) -> Iterator[tuple[str, Array, Array]]:
    """The lines in plan below which ribs are looked for, from one end to the other."""
    corners = vault.corners
    for k in range(2):
        yield DIAGONAL, corners[k], corners[k + 2]
    for k in range(4):
        yield WALL, corners[k], corners[(k + 1) % 4]


def _rib(placed: Placed, kind: str, start: Array, end: Array, points: Array, local: Array) -> SeenRib | None:
    """The rib below one line, of points (n, 3) in the scan's frame and in the vault's."""
    length = float(np.linalg.norm(end - start))
    way = (end - start) / length
    across = np.array([-way[1], way[0]])  # a plan is on the left of its sides
    along, beside = (local[:, :2] - start) @ way, (local[:, :2] - start) @ across
    near = (np.abs(beside) < HALF_WIDTH) & (along > FOOT * length) & (along < (1 - FOOT) * length)
    along, beside, z = along[near], beside[near], local[near, 2]
    below = _below(placed.vault, start + INWARDS * across * (kind == WALL), way, length, along, z)
    left, right = MIDDLE[kind]
    first = (beside > left) & (beside < right) & (below > DEPTH[0]) & (below < DEPTH[1])
    web = (beside > left) & (beside < right) & (np.abs(below) < DEPTH[0])
    steps = np.floor(along / STEP).astype(np.int64)
    # A rib hides the web: where that is seen behind, strays fall from the edge of an arch before it.
    count = int(length / STEP) + 2
    hides = np.bincount(steps[first], minlength=count) > np.bincount(steps[web], minlength=count)
    depths = {k: float(np.median(below[first & (steps == k)])) for k in np.flatnonzero(hides).tolist()}
    if len(depths) * STEP < SEEN * (1 - 2 * FOOT) * length:
        return None
    known = np.array(list(depths.values()))
    depth = float(np.median(known))
    spread = SIGMA * float(np.median(np.abs(known - depth)))
    if spread > EVEN * depth:
        return None
    middle = np.array([depths.get(k, np.nan) for k in range(count)])[steps]
    own = (np.abs(below - middle) < SAME) & (beside > -HALF_WIDTH if kind == DIAGONAL else beside > left - SAME)
    own &= np.abs(along - length / 2) > CROSSING
    if not own.any():  # what hangs at several heights in every step is rafters or rock, and no soffit
        return None
    # Half of what is spread evenly over a width lies within a quarter of that of its middle.
    place = float(np.median(beside[own]))
    width = 4 * float(np.median(np.abs(beside[own] - place)))
    soffit = _soffit(placed, start, end, along, z, own, place, width)
    soffit = measured(measured(soffit, points[near][own]), points[near][own])
    if isnan(soffit.width_std):  # edges of too few points: each step tells of the width by itself
        soffit = replace(soffit, width_std=soffit.width / sqrt(len(known)))
    if not NARROWEST < soffit.width < 2 * HALF_WIDTH:
        return None
    return SeenRib(kind, soffit, depth, OF_MEDIAN * spread / sqrt(max(len(known) * STEP / TOGETHER, 1.0)))


def _below(vault: Vault, start: Array, way: Array, length: float, along: Array, z: Array) -> Array:
    """How far places (n,) along a line at heights (n,) are below the vault's own line, square to that (n,) [m]."""
    at = np.linspace(0.002, 0.998, NODES) * length
    low, high = np.zeros(NODES), np.full(NODES, vault.top + 0.1)
    for _ in range(24):
        half = (low + high) / 2
        room = vault.distance(np.column_stack([start + at[:, None] * way, half])) < 0
        low, high = np.where(room, half, low), np.where(room, high, half)
    slope = np.gradient(low, at)
    lower: Array = (np.interp(along, at, low) - z) / np.sqrt(1 + np.interp(along, at, slope) ** 2)
    return lower


def _soffit(
    placed: Placed, start: Array, end: Array, along: Array, z: Array, own: Mask, beside: float, width: float
) -> Soffit:
    """The strip of a rib in the scan's frame, as it is seen first."""
    pose, (dx, dy) = placed.pose, end - start
    yaw = float(np.arctan2(dy, dx)) + pose.yaw
    length = float(np.hypot(dx, dy))
    middle = (start + end) / 2 + beside * np.array([-dy, dx]) / length
    place = pose.placement()[:2] @ np.array([*middle, 0.0, 1.0])
    steps = np.floor(along[own] / STEP).astype(np.int64)
    curve = [
        (along[own][steps == k].mean() - length / 2, np.median(z[own][steps == k]) + pose.z) for k in np.unique(steps)
    ]
    return Soffit(place, yaw, length, width, np.array(curve))

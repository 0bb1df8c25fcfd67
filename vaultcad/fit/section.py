"""The section of a pier in plan, round, rectangular or compound, by robust least squares."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from vaultcad.fit.solve import robust_cost

Array = NDArray[np.float64]
Distances = Callable[[Array], tuple[Array, Array]]  # of values (k,): residuals (n,) and their slopes (n, k)

SCALES = (0.1, 0.05, 0.02, 0.02, 0.02, 0.02)  # m, of the residuals, step by step: mouldings, then noise
INDEPENDENT = 20  # residuals that say something new; stations that are off each other shift whole sides
SECTORS, CLOSED = 16, 0.75  # of directions about the middle, and the share of them in which stone must be seen
FACED = 0.08  # share of the points that each side of a rectangle has at least
SLENDER = 0.25  # the lesser side of a rectangle by the greater at least
LEAST, WIDEST = 0.08, 2.5  # m, sizes of piers
OWN, STEPPED = 0.7, (0.25, 0.8)  # share of the points within the last scale; of a compound pier's those outermost
OUTER = 0.8  # quantile of a side's points where its outermost face is
BEYOND = 0.05  # m beyond a side's ends where its points are still its own


@dataclass(frozen=True)
class Section:
    """A fitted section. plan: "round", "rectangular", or "compound" if it steps back within its rectangle.

    names: of its values (k,) [m, rad], x and y of the middle first.
    residuals: (n,) distances of its points [m], positive in the stone. covariance: (k, k).
    """

    plan: str
    names: tuple[str, ...]
    values: Array
    residuals: Array
    covariance: Array

    @property
    def cost(self) -> float:
        """Robust mean, 0 to 1."""
        return float(robust_cost(self.residuals, SCALES[-1]).mean())


def section_of(points: Array, normals: Array) -> Section | None:
    """The likelier section of points (n, 2) [m] with normals (n, 2); None if they do not go all around one."""
    found = [section for section in (_round(points), _rectangular(points, normals)) if section is not None]
    return min(found, key=lambda section: section.cost, default=None)


def _round(points: Array) -> Section | None:
    def distances(values: Array) -> tuple[Array, Array]:
        off = points - values[:2]
        away = np.linalg.norm(off, axis=1)
        slopes = np.column_stack([off / np.maximum(away, 1e-9)[:, None], np.full(len(off), 0.5)])
        return values[2] / 2 - away, slopes

    low, high = np.quantile(points, [0.02, 0.98], axis=0)
    found = _rest(distances, np.array([*(low + high) / 2, np.mean(high - low)]))
    own = np.abs(found.residuals) < SCALES[-1]
    off = points[own] - found.values[:2]
    sectors = np.unique(np.floor(np.arctan2(off[:, 1], off[:, 0]) / (2 * pi) * SECTORS))
    sound = len(sectors) >= CLOSED * SECTORS and own.mean() > OWN and LEAST < found.values[2] < WIDEST
    return Section("round", ("x", "y", "diameter"), found.values, found.residuals, found.covariance) if sound else None


def _rectangular(points: Array, normals: Array) -> Section | None:
    doubled = 4 * np.arctan2(normals[:, 1], normals[:, 0])
    yaw = float(np.arctan2(np.sin(doubled).mean(), np.cos(doubled).mean())) / 4
    axes = _axes(yaw)
    frame, facing = points @ axes.T, np.abs(normals @ axes.T)
    axis = facing.argmax(axis=1)
    rows = np.arange(len(points))
    along = frame[rows, axis]
    middle = np.quantile(frame, [0.02, 0.98], axis=0).mean(axis=0)
    side = np.where(along > middle[axis], 1.0, -1.0)
    counts = np.array([[((axis == k) & (side == s)).mean() for s in (-1, 1)] for k in range(2)])
    if counts.min() < FACED:
        return None
    outer = {-1: 1 - OUTER, 1: OUTER}
    ends = np.array([[np.quantile(along[(axis == k) & (side == s)], outer[s]) for s in (-1, 1)] for k in range(2)])

    def distances(values: Array) -> tuple[Array, Array]:
        axes, off = _axes(values[2]), points - values[:2]
        local = off @ axes.T
        slopes = np.zeros((len(points), 5))
        slopes[:, :2] = side[:, None] * axes[axis]
        # Turned, the coordinate along x grows by that along y, which falls by it.
        slopes[:, 2] = -side * np.where(axis == 0, local[:, 1], -local[:, 0])
        slopes[rows, 3 + axis] = 0.5
        return values[3 + axis] / 2 - side * local[rows, axis], slopes

    centre = axes.T @ ends.mean(axis=1)
    found = _rest(distances, np.array([*centre, yaw, *(ends[:, 1] - ends[:, 0])]))
    sizes, local = found.values[3:], (points - found.values[:2]) @ _axes(found.values[2]).T
    own = (np.abs(found.residuals) < SCALES[-1]) & (np.abs(local[rows, 1 - axis]) < sizes[1 - axis] / 2 + BEYOND)
    kept = np.array([[(own & (axis == k) & (side == s)).mean() for s in (-1, 1)] for k in range(2)])
    slender = sizes.min() < SLENDER * sizes.max()
    if kept.min() < FACED / 2 or own.mean() < STEPPED[0] or slender or not LEAST < sizes.min() < sizes.max() < WIDEST:
        return None
    plan = "rectangular" if own.mean() > STEPPED[1] else "compound"
    return Section(plan, ("x", "y", "yaw", "width", "depth"), found.values, found.residuals, found.covariance)


def _axes(yaw: float) -> Array:
    """(2, 2): x and y, turned."""
    return np.array([[cos(yaw), sin(yaw)], [-sin(yaw), cos(yaw)]])


@dataclass(frozen=True)
class _Rest:
    values: Array
    residuals: Array
    covariance: Array


def _rest(distances: Distances, values: Array) -> _Rest:
    """Where Gauss and Newton's steps, reweighted after Geman and McClure (1987), come to rest."""
    for scale in SCALES:
        residuals, slopes = distances(values)
        weight = 1 / (1 + (residuals / scale) ** 2) ** 2
        values = values - np.linalg.lstsq(slopes * np.sqrt(weight)[:, None], residuals * np.sqrt(weight), rcond=None)[0]
    residuals, slopes = distances(values)
    weight = 1 / (1 + (residuals / SCALES[-1]) ** 2) ** 2
    weight /= weight.sum()
    variance = float(weight @ residuals**2) / INDEPENDENT
    covariance = np.asarray(variance * np.linalg.pinv((slopes.T * weight) @ slopes), np.float64)
    return _Rest(values, residuals, covariance)

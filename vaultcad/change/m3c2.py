"""Distances between two clouds along normals, with what can be told from nothing: M3C2 with error propagation.

Lague et al. 2013 take the mean of each cloud in a cylinder about a core point; here the cylinder follows a reference
surface, so that its curvature does not pass for change where one scan is denser on one side. Winiwarter et al. 2021
propagate the errors of points and of the registration by their covariances to a level of detection at each core.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vaultcad.group_medians import group_medians

Array = NDArray[np.float64]

SURE = 1.96  # standard deviations of the 95 % of a normal distribution
FEWEST = 8  # points of either cloud in a cylinder without which it tells nothing
TRIMMED = 3.0  # robust scatters off the median, beyond which a point is a rod or a wire


@dataclass(frozen=True)
class Sheet:
    """Points of a cloud by where they stand on a reference surface, (n, 3) [m], and how far off it (n,) [m]."""

    foot: Array
    offset: Array


@dataclass(frozen=True)
class Cylinders:
    """Means (m,), standard deviations (m,) [m] and numbers (m,) of the points of a cloud about each core."""

    mean: Array
    std: Array
    count: NDArray[np.int64]

    @property
    def variance(self) -> Array:
        """Of the means (m,) [m²]; NaN where there are too few points."""
        return np.where(self.count >= FEWEST, self.std**2 / np.maximum(self.count, 1), np.nan)


@dataclass(frozen=True)
class Distances:
    """Changes (m,) [m] along the normals, their levels of detection (m,) [m] at 95 %, and the numbers of points."""

    change: Array
    lod: Array
    counts: tuple[NDArray[np.int64], NDArray[np.int64]]

    @property
    def significant(self) -> NDArray[np.bool_]:
        """Where the change is larger than its level of detection (m,)."""
        return np.abs(self.change) > self.lod


def m3c2(cores: Array, before: Sheet, after: Sheet, radius: float, common: Array | float = 0.0) -> Distances:
    """Changes at cores (m, 3) on the reference surface, from points within `radius` [m]; NaN where there are few.

    common: variances (m,) [m²] of what is alike within a cylinder: registration, and what it leaves.

    >>> rng = np.random.default_rng(1)
    >>> flat = np.column_stack([rng.uniform(0, 1, (2000, 2)), np.zeros(2000)])
    >>> found = m3c2(np.array([[0.5, 0.5, 0.0]]), Sheet(flat, np.zeros(2000)), Sheet(flat, np.full(2000, 0.01)), 0.2)
    >>> found.change.round(3).tolist(), bool(found.significant[0])
    ([0.01], True)
    """
    a, b = in_cylinders(cores, before, radius), in_cylinders(cores, after, radius)
    lod = SURE * np.sqrt(a.variance + b.variance + common)
    change = np.where(np.isfinite(lod), b.mean - a.mean, np.nan)
    return Distances(change, lod, (a.count, b.count))


def in_cylinders(cores: Array, sheet: Sheet, radius: float) -> Cylinders:
    """What of a cloud stands about each core (m, 3)."""
    from scipy.spatial import cKDTree

    near: Any = cKDTree(sheet.foot).query_ball_point(cores, radius, return_sorted=False)
    sizes = np.array([len(one) for one in near], np.int64)
    core = np.repeat(np.arange(len(cores)), sizes)
    offset = sheet.offset[np.concatenate([np.asarray(one, np.int64) for one in near])] if sizes.any() else np.empty(0)
    middle = group_medians(core, offset, len(cores))
    off = np.abs(offset - middle[core])
    scatter = 1.4826 * group_medians(core, off, len(cores))
    kept = off <= TRIMMED * np.maximum(scatter, 1e-6)[core]
    core, offset = core[kept], offset[kept]
    count = np.bincount(core, minlength=len(cores))
    mean = np.bincount(core, offset, len(cores)) / np.maximum(count, 1)
    square = np.bincount(core, (offset - mean[core]) ** 2, len(cores))
    std = np.sqrt(square / np.maximum(count - 1, 1))
    return Cylinders(np.where(count > 0, mean, np.nan), std, count.astype(np.int64))

"""Figures with what is known of them: deviations from a surface, values with their standard deviation, covariances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan, sqrt

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Deviation:
    """Distances of points to a surface [m]; `within`: share of points not farther than each limit [m].

    mean, rms, median, p95, max: of the distances without their sign; signed_mean: with it, positive into the stone.
    """

    mean: float
    rms: float
    p95: float
    max: float
    within: Mapping[float, float]
    loa: str  # USIBD level of accuracy of the 95 % limit: "LOA10" (coarser than 5 cm) ... "LOA50" (1 mm)
    median: float = nan
    signed_mean: float = nan


# Marks of numbers that one vault alone does not tell: flag -> sign and what it says.
FLAGS: Mapping[str, tuple[str, str]] = {
    "unseen": ("?", "hangs on stone that the scan did not see"),
    "weak": ("~", "is known only roughly"),
    "row": ("=", "is that of all bays of its row"),
}


@dataclass(frozen=True)
class Estimate:
    """One parameter or derived size with its standard deviation in the same unit; None if it was not estimated.

    seen: of what a scan of the whole vault would tell of it, the share (0 to 1) that this scan does. flags: of `FLAGS`.
    """

    value: float
    unit: str
    std: float | None
    meaning: str = ""
    derived: bool = False
    seen: float | None = None
    flags: tuple[str, ...] = ()

    @property
    def marks(self) -> str:
        """The signs of its flags."""
        return "".join(FLAGS[flag][0] for flag in self.flags)


@dataclass(frozen=True, eq=False)
class Covariance:
    """Covariance (k, k) of the k unknowns of a fit, pose first; lengths in m, angles in rad, ratios in 1."""

    names: tuple[str, ...]
    matrix: NDArray[np.float64]

    def std(self, slopes: NDArray[np.float64]) -> float:
        """Standard deviation of a size with these derivatives (k,) by the unknowns."""
        return sqrt(max(float(slopes @ self.matrix @ slopes), 0.0))

    def with_std(self, name: str, std: float) -> Covariance:
        """The same with one unknown as sure as that, and what hangs on it with it; all else is as sure as it was."""
        k = self.names.index(name)
        told, matrix = self.matrix[k], self.matrix.copy()
        if told[k] > 0:
            matrix += np.outer(told, told) * (std**2 - told[k]) / told[k] ** 2
        else:
            matrix[k, k] = std**2
        return Covariance(self.names, matrix)

    def stds(self) -> dict[str, float]:
        """Standard deviation of each unknown."""
        return dict(zip(self.names, np.sqrt(np.maximum(np.diag(self.matrix), 0.0)).tolist(), strict=True))

    def correlations(self) -> NDArray[np.float64]:
        """(k, k) from -1 to 1, 1 on the diagonal; 0 for an unknown that was held."""
        std = np.sqrt(np.maximum(np.diag(self.matrix), 0.0))
        std[std == 0] = np.inf
        out: NDArray[np.float64] = np.clip(self.matrix / np.outer(std, std), -1.0, 1.0)
        np.fill_diagonal(out, 1.0)
        return out

"""Distances of points to a surface, summed up."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.uncertain import Deviation

LIMITS = (0.01, 0.03, 0.06)  # m
LOA = ((0.001, "LOA50"), (0.005, "LOA40"), (0.015, "LOA30"), (0.05, "LOA20"), (np.inf, "LOA10"))


def level_of_accuracy(limit: float) -> str:
    """USIBD level of accuracy (2016) of the distance [m] that 95 % of the points keep."""
    return next(name for top, name in LOA if limit <= top)


def summarise(distances: NDArray[np.floating]) -> Deviation:
    """Of distances (n,) [m], positive into the stone, or without a sign.

    Raises:
        ValueError: there are none.
    """
    if len(distances) == 0:
        raise ValueError("no points to take a deviation of")
    signed = np.asarray(distances, dtype=np.float64)
    d = np.abs(signed)
    p95 = float(np.quantile(d, 0.95))
    return Deviation(
        mean=float(d.mean()),
        rms=float(np.sqrt(np.mean(d * d))),
        p95=p95,
        max=float(d.max()),
        within={limit: float((d <= limit).mean()) for limit in LIMITS},
        loa=level_of_accuracy(p95),
        median=float(np.median(d)),
        signed_mean=float(signed.mean()),
    )

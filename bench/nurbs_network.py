"""Two ways to a free surface, judged on points that neither saw: a network of section curves, and all points at once.

`python bench/nurbs_network.py RESULT ...` takes folders that `vaultcad fit` wrote. Every fifth point is held out. The
network is of smoothing splines through slabs of ± 0.03 m, in both directions of the chart, made to agree where they
cross and blended as Gordon (1969) does: the sum of both skins less the surface through the crossings. Both ways are
compared over the middle of each region's chart, where every slab has points from end to end.
"""

from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, RectBivariateSpline, make_lsq_spline

from vaultcad.labelled_scan import read_labelled_scan
from vaultcad.nurbs.field import Cells, Domain, fitted
from vaultcad.nurbs.outline_reader import outline_of

Array = NDArray[np.float64]
SLAB = 0.03  # m, either side of a section
APART = 0.5  # m, between sections
KNOTS = 0.25  # m, of the curves


def curve(at: Array, reach: Array, low: float, high: float) -> Array:
    """Reach (n,) [m] along a section at every hundredth of it, smoothed."""
    order = np.argsort(at, kind="stable")
    knots = np.linspace(low, high, max(int((high - low) / KNOTS), 2) + 1)
    t = np.concatenate([[low] * 3, knots, [high] * 3])
    spline = make_lsq_spline(np.clip(at[order], low, high), reach[order], t, 3)
    found: Array = spline(np.linspace(low, high, 101))
    return found


def gordon(u: Array, v: Array, reach: Array, low: Array, high: Array) -> RectBivariateSpline:
    """The surface through a network of sections over a rectangle of the chart."""
    fine = [np.linspace(low[k], high[k], 101) for k in (0, 1)]
    lines = [np.linspace(low[k], high[k], max(int((high[k] - low[k]) / APART), 3) + 1) for k in (0, 1)]
    across = np.array([curve(v[m], reach[m], low[1], high[1]) for x in lines[0] for m in [np.abs(u - x) < SLAB]])
    along = np.array([curve(u[m], reach[m], low[0], high[0]) for y in lines[1] for m in [np.abs(v - y) < SLAB]])
    # Where two sections cross they are to agree: on the mean of both.
    one = CubicSpline(fine[1], across, axis=1)(lines[1])
    other = CubicSpline(fine[0], along, axis=1)(lines[0]).T
    both = (one + other) / 2
    across += CubicSpline(lines[1], both - one, axis=1)(fine[1])
    along += CubicSpline(lines[0], (both - other).T, axis=1)(fine[0])
    skins = CubicSpline(lines[0], across)(fine[0]) + CubicSpline(lines[1], along)(fine[1]).T
    crossings = CubicSpline(lines[1], CubicSpline(lines[0], both)(fine[0]), axis=1)(fine[1])
    return RectBivariateSpline(fine[0], fine[1], skins - crossings)


def main(folders: list[str]) -> None:
    """One line a region."""
    print("result component: held-out points, mean distance [mm] of network and of all points at once")
    for folder in folders:
        scan = read_labelled_scan(folder)
        fitted_vault, which = scan.model.vaults[0], scan.of(1)
        xyz, component = scan.in_frame(fitted_vault, which), scan.component[which]
        for region in outline_of(fitted_vault.vault).regions:
            u, v, reach = region.chart.chart(xyz[component == region.component])
            low, high = np.quantile(u, [0.1, 0.9]), np.quantile(v, [0.1, 0.9])
            corners = np.array([low[0], high[0]]), np.array([low[1], high[1]])
            inside = (u > low[0]) & (u < low[1]) & (v > high[0]) & (v < high[1])
            out = inside & (np.arange(len(u)) % 5 == 0)
            seen = inside & ~out
            field = fitted(Domain(*corners), Cells.of(u[seen], v[seen], reach[seen]))
            try:
                network = gordon(u[seen], v[seen], reach[seen], *corners)
            except (ValueError, np.linalg.LinAlgError):
                print(f"{folder} {region.name}: a section has too few points")
                continue
            off = [reach[out] - network.ev(u[out], v[out]), reach[out] - field(u[out], v[out])]
            means = [1000 * float(np.abs(values).mean()) for values in off]
            print(f"{folder} {region.name}: {out.sum()}, {means[0]:.2f}, {means[1]:.2f}")


if __name__ == "__main__":
    main(sys.argv[1:])

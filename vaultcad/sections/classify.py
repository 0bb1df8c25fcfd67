"""Of which kind an arch is, as far as its stone can tell: every kind is fitted, and weighed by how likely it is.

A kind is likely where little motion of the stone explains what is left, and unlikely where it needs an exact choice of
many parameters. What a settlement of centimetres hides stays in the odds.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import exp

import numpy as np
from numpy.typing import NDArray

from vaultcad.measure.setting_out import Way, likely_rules
from vaultcad.sections.arch_curves import KINDS
from vaultcad.sections.field_fit import CurveFit, MovedPoints, as_it_stands, fit_curve
from vaultcad.sections.placed_arch import ArchPoints, PlacedArch
from vaultcad.sections.section import SectionArch

Floats = NDArray[np.float64]

MOST_POINTS = 48  # of an arch; more tell no more, as neighbours have moved together
FEWEST_POINTS = 12
DOUBT = 1.4  # log likelihoods are divided by this, as no settlement is quite such a field


def classified(points: ArchPoints, components: tuple[str, ...] = ()) -> SectionArch | None:
    """The kinds that the points may show, and the likeliest with its sizes; None where there are too few points."""
    if len(points.at) < FEWEST_POINTS:
        return None
    points = _thinned(points)
    middle = points.feet.mean(axis=0)
    rise = float(points.at[:, 1].max() - middle[1])
    moved = MovedPoints.of(points.at - middle, points.normal, points.half_span, max(rise, 1e-2), points.width)
    fits = {kind.name: _fit(PlacedArch(points, kind), moved, rise) for kind in KINDS}
    top = max(fit.likelihood for fit in fits.values())
    weight = {kind.name: kind.share * exp((fits[kind.name].likelihood - top) / DOUBT) for kind in KINDS}
    total = sum(weight.values())
    odds = {name: weight[name] / total for name in sorted(weight, key=lambda name: -weight[name])}
    best = next(iter(odds))
    kind = next(kind for kind in KINDS if kind.name == best)
    placed = PlacedArch(points, kind)
    fit = as_it_stands(fits[best], moved, placed.residuals, placed.slopes, *placed.beforehand())
    return SectionArch(
        best,
        odds,
        likely_rules(_ways(points, fits, odds)),
        dict(placed.sizes(fit)),
        tuple(placed.arcs(fit)),
        placed.line(fit.values),
        fit.rms,
        fit.settlement,
        components,
    )


def _fit(placed: PlacedArch, moved: MovedPoints, rise: float) -> CurveFit:
    """The likeliest of a kind, for a rise [m] as it looks."""
    known = placed.beforehand()
    ways = (fit_curve(moved, placed.residuals, placed.slopes, start, *known) for start in placed.starts(rise))
    return max(ways, key=lambda fit: fit.likelihood)


def _thinned(points: ArchPoints) -> ArchPoints:
    """With neighbours in their means, so that there are not more than `MOST_POINTS`, about evenly along the line."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points.at, axis=0), axis=1))])
    group = np.unique((length / max(length[-1], 1e-9) * MOST_POINTS).astype(int), return_inverse=True)[1]
    count = np.bincount(group)
    at, normal = (
        np.column_stack([np.bincount(group, column) / count for column in values.T])
        for values in (points.at, points.normal)
    )
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return ArchPoints(at, normal, points.feet, points.foot_std, points.width)


def _ways(points: ArchPoints, fits: Mapping[str, CurveFit], odds: Mapping[str, float]) -> Iterator[Way]:
    """How it may have been built, for the rules of setting out."""
    for kind in KINDS:
        placed, fit = PlacedArch(points, kind), fits[kind.name]
        ratio = placed.estimate(fit, placed.ratio, "rise / span", unit="1")
        yield Way(odds[kind.name], kind.profile, ratio.value, ratio.std or 0.0)

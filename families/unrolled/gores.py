"""As how many gores a region is laid flat, so that lengths are true within a limit, and how true they are."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import ceil, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from families.unrolled.developments import Development, developments, strip_net
from families.unrolled.patches import Box, TurnedPatch
from families.unrolled.stretch import largest, measured, net_errors
from families.unrolled.visible import LEAST, Region

if TYPE_CHECKING:
    from shapely import Geometry

MOST_DISTORTED = 0.02  # relative error of lengths on a sheet at the most, the usual limit
METRIC = 1e-3  # and of what is called metric
TRIED = 8  # gores of what is turned by which is guessed how many are needed: the error falls with their square
TRIAL = (129, 9)  # nodes along and across a strip that is only tried
SPARED = 0.005  # share of a strip that may be more distorted, where a web is bent without end
TRIED_WITHIN = 0.85  # share of the limit, on the coarser net of a trial
AT_ONCE = 6  # gores at the most into which a region is cut at once
NARROWEST = 0.06  # [m] of a region, on the mean, that is cut no more
BORDER = 5e-4  # share of a patch by which a chart goes on beyond what shows
ROUNDING = 1e-3
OUTLINE_STEPS = 64  # of an edge of an outline along a whole gore
SIMPLE = 5e-4  # [m] by which an outline may be off its finest


@dataclass(frozen=True, eq=False)
class Chart:
    """One gore, or all, of a region on a sheet of its own.

    spine: along which coordinate its middle line runs. distortion: the largest relative error of its lengths; where it
    is more than the limit on a share of `SPARED` of the surface at the most, that of the rest. beyond: the share where
    it is more. surface: its area [m²].
    """

    region: Region
    development: Development
    spine: int
    distortion: float
    beyond: float
    surface: float

    @property
    def name(self) -> str:
        """Of the component."""
        return self.region.name

    @cached_property
    def outline(self) -> Geometry:
        """Its border on the sheet of its own, a polygon or several [m]."""
        import shapely

        a0, a1, b0, b1 = self.development.box
        low, size = np.array([a0, b0]), np.array([a1 - a0, b1 - b0])
        # Long edges are straight in coordinates, not on the sheet.
        unit = shapely.transform(self.region.area, lambda ab: (ab - low) / size)
        fine = shapely.segmentize(unit, 1 / OUTLINE_STEPS)
        laid = shapely.transform(fine, lambda ab: self.development.flat(*(ab * size + low).T))
        return shapely.make_valid(shapely.simplify(laid, SIMPLE))


def charts(regions: Iterable[Region], limit: float = MOST_DISTORTED) -> Iterator[Chart]:
    """Each region as few gores as keep lengths true within a limit, cut at edges where it is bent both ways.

    A gore is not cut narrower than `NARROWEST`, as next to a point where a web is bent without end. What is alike is
    cut alike.
    """
    known: dict[bytes, list[Chart]] = {}
    for region in regions:
        for part in _connected(region):
            alike = known.setdefault(_likeness(part), [])
            if alike:
                for one in alike:
                    own, box = replace(part, area=one.region.area), one.development.box
                    yield replace(one, region=own, development=developments(part.patch, box, one.spine))
            else:
                alike += _charts(part, limit)
                yield from alike


def _connected(region: Region) -> list[Region]:
    """The parts of a region that hang together."""
    import shapely

    parts = [part for part in shapely.get_parts(region.area) if isinstance(part, shapely.Polygon)]
    return [replace(region, area=part) for part in parts if part.area > LEAST]


def _likeness(region: Region) -> bytes:
    """The same for parts that are one shape: where it is bounded, and how far from each other its points are."""
    import shapely

    a0, b0, a1, b1 = region.area.bounds
    a, b = (grid.ravel() for grid in np.meshgrid(np.linspace(a0, a1, 4), np.linspace(b0, b1, 4)))
    xyz = region.patch.place(a, b)
    apart = np.linalg.norm(xyz[:, None] - xyz, axis=2)
    border = shapely.get_coordinates(region.area)
    return bytes(np.concatenate([apart.ravel(), border.ravel()]).round(5) + 0.0)


def _charts(region: Region, limit: float) -> list[Chart]:
    whole = _charted(region, 0, limit)
    if whole.distortion <= METRIC:
        return [whole]
    a0, a1, b0, b1 = region.patch.box
    along, across = region.patch.creases
    boxes = [(*a, *b) for a in pairwise((a0, *along, a1)) for b in pairwise((b0, *across, b1))]
    parts = [part for box in boxes if (part := _clipped(region, box)).area.area > LEAST]
    cut = _meridian_gores if isinstance(region.patch, TurnedPatch) else _strips
    return [chart for part in parts for chart in cut(part, limit)]


def _meridian_gores(region: Region, limit: float) -> list[Chart]:
    """As few as will do, each as wide as the others."""

    def cut(count: int) -> list[Chart]:
        return [_charted(part, 0, limit) for part in _divided(region, 1, count)]

    def worst(made: list[Chart]) -> float:
        return max(chart.distortion for chart in made)

    count = max(1, ceil(TRIED * sqrt(worst(cut(TRIED)) / limit) - ROUNDING))
    while worst(made := cut(count)) > limit:
        count += 1
    return [chart for chart in made if chart.surface > 0]


def _strips(region: Region, limit: float) -> list[Chart]:
    """Strips either way, of equal width where that does; where a region is bent unevenly, those of its halves."""
    made, waiting = [], [region]
    while waiting:
        part = waiting.pop()
        trials = [_Trial.of(part, spine, limit) for spine in (0, 1)]
        spine = int(trials[1].strips < trials[0].strips)
        count = trials[spine].strips
        if count == 1 or trials[spine].width < 2 * NARROWEST:
            chart = _charted(part, spine, limit)
            if chart.distortion > limit:
                chart = min(chart, _charted(part, 1 - spine, limit), key=lambda one: one.distortion)
            if chart.distortion <= limit or trials[spine].width < 2 * NARROWEST:
                made.append(chart)
                continue
            count = 2
        options = [_divided(part, axis, 2) for axis in (0, 1)]
        totals = [
            sum(min(_Trial.of(half, way, limit).strips for way in (0, 1)) for half in halves) for halves in options
        ]
        if count <= min(AT_ONCE, *totals):
            waiting += _divided(part, 1 - spine, count)
        else:
            waiting += options[int(totals[1] < totals[0])]
    return made


class _Trial(NamedTuple):
    """As how many strips side by side a region would do, by the error that it has as one, and how wide it is [m]."""

    strips: int
    width: float

    @staticmethod
    def of(region: Region, spine: int, limit: float) -> _Trial:
        import shapely

        a0, b0, a1, b1 = region.area.bounds
        nodes, laid = strip_net(region.patch, (a0, a1, b0, b1), spine, TRIAL)
        errors, areas = net_errors(nodes, laid)
        n, m = errors.shape
        shares = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(m) + 0.5) / m, indexing="ij")
        inside = shapely.contains_xy(region.area, a0 + (a1 - a0) * shares[0], b0 + (b1 - b0) * shares[1])
        worst = largest(errors[inside], areas[inside], SPARED)
        long = float(np.linalg.norm(np.ptp(nodes.reshape(-1, 3), axis=0)))
        return _Trial(max(1, ceil(sqrt(worst / (TRIED_WITHIN * limit)) - ROUNDING)), float(areas[inside].sum()) / long)


def _clipped(region: Region, box: Box) -> Region:
    import shapely

    a0, a1, b0, b1 = box
    return replace(region, area=region.area.intersection(shapely.box(a0, b0, a1, b1)))


def _divided(region: Region, axis: int, count: int) -> list[Region]:
    """A region in so many parts along a coordinate, those that are left of it."""
    a0, b0, a1, b1 = region.area.bounds
    edges = np.linspace(*((a0, a1), (b0, b1))[axis], count + 1).tolist()
    boxes = [(low, high, b0, b1) if axis == 0 else (a0, a1, low, high) for low, high in pairwise(edges)]
    parts = [_clipped(region, box) for box in boxes]
    return [part for part in parts if part.area.area > region.area.area * LEAST]


def _charted(region: Region, spine: int, limit: float) -> Chart:
    a0, b0, a1, b1 = region.area.bounds
    low_a, high_a, low_b, high_b = region.patch.box
    more_a, more_b = BORDER * (high_a - low_a), BORDER * (high_b - low_b)
    box = (max(a0 - more_a, low_a), min(a1 + more_a, high_a), max(b0 - more_b, low_b), min(b1 + more_b, high_b))
    laid = developments(region.patch, box, spine)
    errors, areas = measured(region.patch.place, laid.flat, region.area)
    whole = float(areas.sum())
    beyond = float(areas[errors > limit].sum()) / whole if whole else 0.0
    worst = largest(errors, areas, SPARED if 0 < beyond <= SPARED else 0.0)
    return Chart(region, laid, spine, worst, beyond, whole)

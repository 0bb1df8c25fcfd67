"""Where footprints other than a rectangle may lie under a scan's ceiling, told by the way its normals face.

What turns about an upright axis has normals whose horizontal parts all point to that; the webs over a polygon have
them in as many directions as it has sides. Webs that are bent between ribs have them in all directions: there it is the
walls that tell, or the heights round a middle, which go up and down as often as there are ribs. Other scans show none
of this, so that the families over such footprints cost them nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import NDArray

from families.declaration.footprint import DISC, GORED, HALF_DISC, POLYGON, SECTOR, Footprint

Array = NDArray[np.float64]

SLANT = 0.3  # horizontal part of normals that tell a direction, at least
LOOKED_AT, PAIRS = 4000, 300  # points, and pairs of their normals that are tried for an axis
AIM = 0.08  # rad by which normals may miss the axis
FARTHEST = 1.5  # half diagonals of the plan that the axis may be away from its middle
TURNED = 0.5  # share of a ceiling's normals that must point to the axis
EVEN, ROUND = 0.04, 0.6  # of its middle, how much farther or nearer the rim may be; in what share of the directions
WHOLE, HALF = np.radians(75.0), np.radians([110.0, 250.0])  # missing of a disc at the most; of a half disc
RING = np.radians(12.0)  # missing of a ring that is whole
HOLE, FULL = 0.1, 0.45  # inner / outer radius from which on there may be a hole, and may be no disc
SIDES = np.arange(3, 13)
STRIPS = 8  # across a ceiling, in which its height is looked at
CLIMBS, BENT = 0.03, 0.15  # slope of a ramp at least; of what it climbs, how far its crown may be off a straight line
WEBS = 0.3  # how far the normals of a ceiling must keep to the directions of a polygon, 0 to 1
FEWEST_SIDES = 0.85  # of the best number of sides, what a lesser number must reach to be taken
ALIGNED, FEWEST = np.cos(0.2), 10  # with a side, normals of which there must be so many
UPRIGHT, WALLED = 0.1, 0.6  # |nz| of a wall at the most; how far walls must keep to the directions of a polygon
GORES = 0.3  # of what heights at one distance from the middle differ, the share that must be a wave of gores
RINGS = np.linspace(0.25, 0.9, 25)  # between which heights are compared, of how far the ceiling goes
FAR_OFF = 4.5  # medians of what heights differ by, above which they are clutter's


@dataclass(frozen=True)
class Ground:
    """A footprint where it lies: its origin [m] in the scan's local frame, and its x axis [rad]."""

    footprint: Footprint
    x: float
    y: float
    yaw: float


def grounds_of(points: Array, normals: Array, steep: float) -> Mapping[str, tuple[Ground, ...]]:
    """The grounds that a ceiling may stand over, by the shapes of their footprints.

    Args:
        points: (n, 3) of ceiling and walls [m].
        normals: (n, 3) of them, unit.
        steep: |nz| below which a point is rather a wall's.
    """
    slant = np.hypot(normals[:, 0], normals[:, 1])
    telling = np.flatnonzero(slant > SLANT)
    telling = telling[:: max(1, len(telling) // LOOKED_AT)]
    ceiling = np.abs(normals[telling, 2]) > steep
    if ceiling.sum() < PAIRS:
        return {}
    xy, facing = points[telling, :2], normals[telling, :2] / slant[telling, None]
    found: dict[str, tuple[Ground, ...]] = {}
    upper = ceiling & (points[telling, 2] > np.median(points[telling[ceiling], 2]))
    over = points[np.abs(normals[:, 2]) > steep]
    hung = over[:, :2]
    gored = _gored(xy, facing, ceiling, np.abs(normals[telling, 2]) < UPRIGHT, over[:: max(1, len(over) // LOOKED_AT)])
    for shape, ground in (*_turned(xy, facing, ceiling, hung), *_polygons(xy, facing, upper, hung), *gored):
        found[shape] = (*found.get(shape, ()), ground)
    return found


def slopes_of(xy: Array, height: Array, upwards: Array, steep: float) -> tuple[float, float]:
    """By how much a ceiling climbs along x and y, as a ramp's does from end to end; 0 along which it does not.

    Args:
        xy: (n, 2) in plan [m].
        height: (n,) [m].
        upwards: (n,) of the normals.
        steep: |nz| below which a point is rather a wall's.
    """
    hung = np.abs(upwards) > steep
    x, y = (_slope(along, height[hung]) for along in xy[hung].T)
    return x, y


def _slope(along: Array, height: Array) -> float:
    low, high = np.quantile(along, [0.01, 0.99]) if len(along) else (0.0, 0.0)
    strip = np.floor((along - low) / max(high - low, 1e-9) * STRIPS).astype(np.int64)
    tops = [np.quantile(height[strip == k], 0.95) for k in range(STRIPS) if (strip == k).sum() > FEWEST]
    if len(tops) < STRIPS:
        return 0.0
    middle = low + (np.arange(STRIPS) + 0.5) / STRIPS * (high - low)
    slope, start = np.polyfit(middle, tops, 1)
    off = float(np.abs(np.array(tops) - slope * middle - start).max())
    return float(slope) if off < BENT * abs(slope) * (high - low) and abs(slope) > CLIMBS else 0.0


def _turned(xy: Array, facing: Array, ceiling: NDArray[np.bool_], hung: Array) -> Iterator[tuple[str, Ground]]:
    """Disc, half disc or sector about the axis that normals point to; `hung` (m, 2): all places under a ceiling."""
    axis = _axis(xy[ceiling], facing[ceiling])
    if axis is None:
        return
    away = xy - axis
    reach, angle = np.hypot(away[:, 0], away[:, 1]), np.arctan2(away[:, 1], away[:, 0])
    aimed = _misses(away, facing) < AIM * reach
    if aimed[ceiling].mean() < TURNED:
        return
    reach, angle, ceiling = reach[aimed], angle[aimed], ceiling[aimed]
    rim = _rim(reach, angle)
    usual = np.median(rim)
    if (np.abs(np.log(rim / usual)) < EVEN).mean() < ROUND:  # reveals of windows go farther
        return
    outer = np.quantile(reach[reach < (1 + EVEN) * usual], 0.98)
    inner = np.quantile(np.linalg.norm(hung - axis, axis=1), 0.01)
    middle, gap = _gap(angle[ceiling & (reach > FULL * outer)])
    hole, yaw = float(inner / outer), float(np.remainder(middle + 1.5 * pi, 2 * pi)) - pi  # the gap is to the south
    x, y, span = float(axis[0]), float(axis[1]), float(2 * outer)
    if gap < WHOLE and hole < FULL:
        yield DISC, Ground(Footprint(span, span), x, y, 0.0)
    if HALF[0] < gap < HALF[1] and hole < FULL:
        yield HALF_DISC, Ground(Footprint(span, span), x, y, yaw)
    if hole > HOLE:
        covered = 2 * pi if gap < RING else 2 * pi - gap
        yield SECTOR, Ground(Footprint(span, span, hole=hole, angle=covered), x, y, yaw)


def _axis(xy: Array, facing: Array) -> Array | None:
    """The place (2,) that most normals point to: of those where two of them meet the best, then least squares."""
    middle = (xy.min(axis=0) + xy.max(axis=0)) / 2
    size = float(np.linalg.norm(np.ptp(xy, axis=0))) / 2
    i, j = np.random.default_rng(0).integers(len(xy), size=(2, PAIRS))
    cross = facing[i, 0] * facing[j, 1] - facing[i, 1] * facing[j, 0]
    apart = xy[j] - xy[i]
    way = (apart[:, 0] * facing[j, 1] - apart[:, 1] * facing[j, 0]) / np.where(np.abs(cross) < 0.1, np.nan, cross)
    meets = xy[i] + way[:, None] * facing[i]
    meets = meets[np.linalg.norm(meets - middle, axis=1) < FARTHEST * size]
    if len(meets) == 0:
        return None
    some = slice(None, None, max(1, len(xy) // 500))
    aimed = [(_misses(xy[some] - at, facing[some]) < AIM * np.linalg.norm(xy[some] - at, axis=1)).sum() for at in meets]
    best = meets[int(np.argmax(aimed))]
    for _ in range(8):
        away = xy - best
        scale = AIM * np.maximum(np.linalg.norm(away, axis=1), AIM * size)
        weight = 1 / (1 + (_misses(away, facing) / scale) ** 2) ** 2 / scale**2
        across = np.column_stack([-facing[:, 1], facing[:, 0]])
        matrix = (across.T * weight) @ across
        best = np.linalg.solve(matrix + 1e-9 * np.trace(matrix) * np.eye(2), across.T @ (weight * (across * xy).sum(1)))
    return np.asarray(best, np.float64)


def _misses(away: Array, facing: Array) -> Array:
    """How far (n,) [m] normals pass by an axis that places are `away` (n, 2) from."""
    missed: Array = np.abs(away[:, 0] * facing[:, 1] - away[:, 1] * facing[:, 0])
    return missed


def _rim(reach: Array, angle: Array) -> Array:
    """How far places go in each direction in which there are any, of 10° each."""
    order = np.argsort(np.floor(angle / np.radians(10.0)), kind="stable")
    parts = np.split(reach[order], np.flatnonzero(np.diff(np.floor(angle[order] / np.radians(10.0)))) + 1)
    return np.array([np.quantile(part, 0.95) for part in parts if len(part) > 5])


def _gap(angle: Array) -> tuple[float, float]:
    """Middle and width [rad] of the widest range of angles about the axis in which there is nothing."""
    step = np.radians(3.0)
    counts = np.histogram(angle, bins=np.linspace(-pi, pi, 121))[0]
    empty = counts < 0.1 * np.median(counts[counts > 0])
    best, start = (0, 0), 0
    for k, bare in enumerate(np.concatenate([empty, empty])):
        start = start if bare else k + 1
        best = max(best, (min(k + 1 - start, len(empty)), start))
    return float((best[1] + best[0] / 2) * step - pi), float(best[0] * step)


def _polygons(xy: Array, facing: Array, upper: NDArray[np.bool_], hung: Array) -> Iterator[tuple[str, Ground]]:
    """The polygon whose sides the normals of the upper half of a ceiling face."""
    out = facing * np.sign((facing * (xy - (hung.min(axis=0) + hung.max(axis=0)) / 2)).sum(axis=1))[:, None]
    n, yaw, kept = _sides(out[upper])
    if kept >= WEBS:
        yield from _polygon(POLYGON, n, yaw, xy, out, hung)


def _sides(out: Array) -> tuple[int, float, float]:
    """How many directions (m, 2) there are, the turn of the first [rad], and how far all keep to them, 0 to 1."""
    angle = np.arctan2(out[:, 1], out[:, 0])
    moments = np.array([np.exp(1j * n * angle).sum() for n in SIDES]) / max(len(angle), 1)
    kept = np.abs(moments)
    k = int(np.argmax(kept >= FEWEST_SIDES * kept.max()))
    return int(SIDES[k]), float(np.angle(moments[k])) / int(SIDES[k]), float(kept[k])


def _gored(
    xy: Array, facing: Array, ceiling: NDArray[np.bool_], walls: NDArray[np.bool_], over: Array
) -> Iterator[tuple[str, Ground]]:
    """The polygon from whose corners the ribs of an umbrella rise; `over` (m, 3): the ceiling, slanting or not."""
    middle = np.quantile(over[:, :2], [0.005, 0.995], axis=0).mean(axis=0)
    away = xy - middle
    out = facing * np.sign((facing * away).sum(axis=1))[:, None]
    sideways = (away[:, 0] * out[:, 1] - away[:, 1] * out[:, 0]) / np.maximum(np.linalg.norm(away, axis=1), 1e-9)
    angle, aside = np.arctan2(away[ceiling, 1], away[ceiling, 0]), sideways[ceiling]

    def parted(turn: Array) -> float:
        """Normals turn away from the middle of a side; over a cloister vault they turn towards it."""
        return float((np.sin(turn) * aside).sum())

    def smooth(turn: Array) -> float:
        """They turn the least where the ceiling is highest; over a cloister vault they leap there."""
        return float(-(np.cos(turn) * np.abs(aside)).sum())

    sides = _sides(out[walls] if walls.sum() > PAIRS else out[:0])
    waves = _waves(over - [*middle, 0.0])
    for (n, yaw, kept), least, told in ((sides, WALLED, parted), (waves, GORES, smooth)):
        if kept >= least and n > 2 and told(n * (angle - yaw)) > 0:
            yield from _polygon(GORED, n, yaw, xy, out, over[:, :2])
            return


def _waves(away: Array) -> tuple[int, float, float]:
    """How often heights of places (m, 3) from a middle go up and down round that, and where they are highest [rad].

    Third, what share of their differences that is.
    """
    reach, angle, height = np.hypot(away[:, 0], away[:, 1]), np.arctan2(away[:, 1], away[:, 0]), away[:, 2]
    ring = np.digitize(reach, edges := RINGS * np.quantile(reach, 0.95))
    seen = [k for k in range(1, len(RINGS)) if (ring == k).any()]
    looked = (ring > 0) & (ring < len(RINGS))
    if not seen:  # all of it lies about its rim
        return 1, 0.0, 0.0
    usual = [np.median(height[ring == k]) for k in seen]
    off = height[looked] - np.interp(reach[looked], [edges[k - 1 : k + 1].mean() for k in seen], usual)
    most = FAR_OFF * np.median(np.abs(off))
    off = np.clip(off, -most, most)
    counts = (1, 2, *SIDES.tolist())
    waves = [2 * np.mean(off * np.exp(1j * n * angle[looked])) for n in counts]
    k = int(np.argmax(np.abs(waves)))
    share = abs(waves[k]) ** 2 / 2 / max(float(np.mean(off**2)), 1e-12)
    return counts[k], float(np.angle(waves[k])) / counts[k], share


def _polygon(shape: str, n: int, yaw: float, xy: Array, out: Array, hung: Array) -> Iterator[tuple[str, Ground]]:
    """The polygon of n sides, the first of which faces `yaw` [rad]; none of four, which is a rectangle.

    xy, out: (m, 2) places and which way out of the room their stone faces. hung: (k, 2) places under the ceiling.
    """
    if n == 4:
        return
    ways = _ways(yaw, n)
    aligned = [xy[out @ way > ALIGNED] @ way for way in ways]
    seen = [len(reach) > FEWEST for reach in aligned]
    ends = np.array([np.quantile(reach, 0.97) for reach in aligned if len(reach) > FEWEST])
    other = np.arange(n) % 2 * (n % 2 == 0)  # every second side of a crossing's octagon is nearer than its corners
    found, *_ = np.linalg.lstsq(np.column_stack([ways, 1 - other, other])[seen], ends)
    (x, y), radius = found[:2], float(min(found[2:]) if n % 2 == 0 else found[2])
    if radius <= 0:
        return
    diagonal = 1.0
    if n % 2 == 0:  # the corners of a square hang over every second side
        reach = np.quantile((hung - [x, y]) @ ways.T, 0.995, axis=0)
        first, second = float(np.median(reach[::2])), float(np.median(reach[1::2]))
        diagonal = max(first, second) / min(first, second)
        yaw += 2 * pi / n if second < first else 0.0
    yield shape, Ground(Footprint(2 * radius, 2 * radius, sides=n, diagonal=diagonal), float(x), float(y), yaw)


def _ways(yaw: float, count: int) -> Array:
    """Unit vectors (n, 2) in as many directions, the first of them turned by `yaw` [rad]."""
    turns = yaw + 2 * pi * np.arange(count) / count
    return np.column_stack([np.cos(turns), np.sin(turns)])

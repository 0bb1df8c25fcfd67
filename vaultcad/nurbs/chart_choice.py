"""Which chart suits a component: by the part that made it, and by how wide and high its outline is."""

from __future__ import annotations

from dataclasses import replace
from math import cos, hypot, pi, sin

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Part, Turned, Web
from vaultcad.nurbs.charts import (
    AboutCentre,
    AboutRing,
    AboutUpright,
    AlongAxis,
    BetweenRibs,
    Chart,
    Meridians,
    OverPlane,
)

Array = NDArray[np.float64]
DEEPEST = 0.8  # depth of an axis below the springing / half span, at the most
SHALLOWEST = 0.5  # likewise of a centre, at the least: rays to corners on its own level would be level
RIB_STEPS, RIB_POWER = 25, 5  # places along a rib, and power of the polynomial that its chord is taken for
CROWNED = 0.5  # how far below its chord the axis is at the crown, as a share of what it is at the wall beyond that


def chart_of(part: Part | None, name: str, outline: Array) -> Chart:
    """The chart of a component of that name, made by a part, from places (n, 3) [m] of its outline."""
    match part:
        case BarrelPart() if name != part.below:
            across = (outline[:, :2] - part.origin) @ np.array(part.across)
            along = (outline[:, :2] - part.origin) @ np.array(part.along)
            above = outline[:, 2] - part.base - part.slope * along
            return _along(part.origin, part.across, part.base, np.abs(across).max(), above.max(), part.slope)
        case Web():
            return _between_ribs(part)
        case Turned() if name == part.names[0] != part.names[1]:
            start, whole = _start(outline[:, :2] - part.centre)
            return AboutUpright((*part.centre, 0.0), part.curve.half_span, start, whole)
        case Turned() if part.radius:
            start, whole = _start(outline[:, :2] - part.centre)
            out = np.abs(np.hypot(*(outline[:, :2] - part.centre).T) - part.radius).max()
            rise = outline[:, 2].max() - part.base
            depth = _depth(out, rise)
            return AboutRing((*part.centre, part.base - depth), part.radius, start, hypot(out, depth), whole)
        case Turned():
            reach = np.hypot(*(outline[:, :2] - part.centre).T).max()
            return replace(_about(part.centre, part.base, reach, part.curve.rise), round=True)
        case Ball() if len(part.names) == 1:
            reach = np.hypot(*(outline[:, :2] - part.centre).T).max()
            return _about(part.centre, float(outline[:, 2].min()), reach, part.top - float(outline[:, 2].min()))
        case Ball():
            start, _ = _start(outline[:, :2] - part.centre)
            return Meridians((*part.centre, part.z), start, part.radius)
    return _flat(outline)


def _along(
    origin: tuple[float, float], across: tuple[float, float], base: float, half: float, rise: float, slope: float
) -> AlongAxis:
    depth = _depth(half, rise)
    return AlongAxis((*origin, base - depth), across, (hypot(half, depth) + rise + depth) / 2, slope)


def _about(centre: tuple[float, float], base: float, half: float, rise: float) -> AboutCentre:
    depth = max(_depth(half, rise), SHALLOWEST * half)
    return AboutCentre((*centre, base - depth), (hypot(half, depth) + rise + depth) / 2)


def _between_ribs(part: Web) -> BetweenRibs:
    """By the ribs at the edges of a web and the rise of its wall arch."""
    (x, y), start, end = part.centre, np.array(part.start), np.array(part.end)
    size = float(np.hypot(*(end - start)))
    across = (end - start) / size
    depth = _depth(part.reach, part.diagonal.rise)
    share = np.sin(np.linspace(0, pi / 2, RIB_STEPS))
    height = np.array([part.diagonal.height(float(v) * part.reach) for v in share])
    middle = ((start + end) / 2 - part.centre) @ across
    wall = float((start - part.centre) @ [across[1], -across[0]])
    lean = np.arctan2(share * wall, height + depth)
    # Well below the chord, for towards the crown arches on it may be as flat as one likes, and the chord is a point.
    out = np.hypot(share * wall, height + depth) - DEEPEST * (share + CROWNED) / (1 + CROWNED) * size / 2
    chord, mean = (tuple(np.polyfit(lean, values, RIB_POWER).tolist()) for values in (out, share * middle))
    return BetweenRibs((x, y, -depth), (float(across[0]), float(across[1])), part.reach, size / 2, chord, mean)


def _depth(half: float, rise: float) -> float:
    """How far below its springing the centre of a circle through the feet and the crown of an arch lies [m]."""
    if rise >= half:
        return 0.0
    return min((half * half - rise * rise) / (2 * max(rise, 1e-9)), DEEPEST * half)


def _start(xy: Array) -> tuple[float, bool]:
    """From which azimuth [rad] places (n, 2) are reached in one turn, in the middle of the widest gap; if there is one.

    Where they go all round, a turn starts to the west.
    """
    angle = np.sort(np.arctan2(xy[:, 1], xy[:, 0]))
    gaps = np.diff(np.append(angle, angle[0] + 2 * pi))
    k = int(gaps.argmax())
    if gaps[k] < pi / 4:
        return -pi, True
    middle = angle[k] + gaps[k] / 2
    return float(np.arctan2(sin(middle), cos(middle))), False


def _flat(outline: Array) -> OverPlane:
    """Over the plane that suits an outline best; u level, its normal upwards or outwards."""
    origin = outline.mean(axis=0)
    normal = np.linalg.svd(outline - origin, full_matrices=False)[2][2]
    if abs(normal[2]) > 0.5:
        normal, along = normal * np.sign(normal[2]), np.array([1.0, 0.0, 0.0])
        along -= (along @ normal) * normal
    else:
        normal *= np.sign(normal @ [*origin[:2], 0.0] or 1.0)
        along = np.array([-normal[1], normal[0], 0.0])
    along /= np.linalg.norm(along)
    return OverPlane(origin, np.stack([along, np.cross(normal, along), normal]))

"""The surfaces of spheres and of turned profiles about the z axis, over the rectangle of the plan."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import acos, asin, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, Lid, Piece, Turned
from families.declaration.units import MM
from families.solid.barrel_faces import Web
from families.solid.boundary import Loop, Pole, Step
from families.solid.curves import AXES, Conic, Straight, point
from families.solid.surfaces import UP, Drum, Revolved, Round, Sheet
from families.void.profile_outline import Bow, half_outline

Array = NDArray[np.float64]
TOUCH = 1e-6  # [m]
QUARTERS = tuple(k * pi / 2 for k in range(4))


def rounds(piece: Piece, half: Array) -> Iterator[Web]:
    """The surfaces of a piece with a ball or a turned profile, over a plan of half extents (2,) [m]."""
    for part in piece.parts:
        if isinstance(part, Turned):
            for start in QUARTERS:
                yield from _quarter(part, start, half)
        elif isinstance(part, Ball):
            lids = [other.z for other in piece.parts if isinstance(other, Lid)]
            if lids:
                yield from _pendentives(part, min(lids), half)
            else:
                yield _sail(part, half)


def _sail(ball: Ball, half: Array) -> Web:
    """A sphere about the first axis, so that its poles lie beside it."""
    x, y = half.tolist()
    corners = [_on(ball, x * s, y * t) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    loop = [_between(_wall_arch(ball, k, half), corners[k], corners[(k + 1) % 4]) for k in range(4)]
    return Web(Round((0.0, 0.0, MM * ball.z), MM * ball.radius, pole=0, about=pi / 2), loop)


def _pendentives(ball: Ball, lid: float, half: Array) -> Iterator[Web]:
    """The corners of a sphere over a square between its sides and a level circle that reaches them."""
    side = float(half[0])
    radius = sqrt(ball.radius**2 - (lid - ball.z) ** 2)
    if radius > hypot(*half) - TOUCH:
        return
    if half[0] != half[1] or radius < side - TOUCH:
        raise ValueError(f"a ring of {radius:g} m on a plan of {2 * half[0]:g} by {2 * half[1]:g} m leaves its sides")
    reach = sqrt(max(radius**2 - side**2, 0.0))
    for k, start in enumerate(QUARTERS):
        # From the corner up one wall arch to the ring, along the ring, and down the other arch.
        first, second, _ = (_turned(start, axis) for axis in AXES)
        corner = _on(ball, *(side * (first + second))[:2].tolist())
        low, high = (MM * (side * a + reach * b + lid * UP) for a, b in ((first, second), (second, first)))
        steps = (
            (_wall_arch(ball, (k + 1) % 4, half), corner, low),
            (_ring(radius, lid, start), low, high),
            (_wall_arch(ball, (k + 2) % 4, half), high, corner),
        )
        yield Web(
            Round((0.0, 0.0, MM * ball.z), MM * ball.radius, about=start + pi / 4), [_between(*step) for step in steps]
        )


def _quarter(part: Turned, start: float, half: Array) -> Iterator[Web]:
    """A quarter of drum and dome from an azimuth on; its foot is cut where it leaves the plan."""
    middle, end = start + pi / 4, start + pi / 2
    bows = half_outline(part.curve, 0.0, part.curve.half_span, -np.inf)
    wall, springing = part.curve.half_span, part.base + bows[0].at(bows[0].start)[1]
    for low, high in ((part.foot, part.base), (part.base, springing)):
        if high - low > TOUCH:
            drum = Drum(MM * wall, middle)
            up, down = (
                Step(Straight.through(point(_spot(wall, low, azimuth)), 2), MM * a, MM * b)
                for azimuth, a, b in ((end, low, high), (start, high, low))
            )
            yield Web(drum, [*_foot(wall, low, start, half), up, _back(_ring(wall, high, start)), down])
    for bow in bows:
        (u0, z0), (u1, z1) = bow.at(bow.start), bow.at(bow.end)
        meridians = [Conic.of(bow, MM * part.base * UP, _turned(a, AXES[0]), UP) for a in (start, end)]
        flat, _, last = Conic.of(bow, MM * part.base * UP, AXES[0], UP)
        sheet = _sheet(bow, part.base, flat, middle)
        top: Step
        if u1 < TOUCH:
            top = Pole(meridians[0][0], meridians[0][2], meridians[0][2], (end, last), (start, last))
        else:
            top = _back(_ring(u1, part.base + z1, start))
        loop: Loop = [*_foot(u0, part.base + z0, start, half), Step(*meridians[1]), top]
        yield Web(sheet, [*loop, Step(*meridians[0]).reversed])


def _sheet(bow: Bow, base: float, flat: Conic, about: float) -> Sheet:
    if bow.a == bow.b and abs(bow.u) < 1e-12:
        return Round((0.0, 0.0, MM * (base + bow.z)), MM * bow.a, about=about)
    return Revolved(flat, about)


def _wall_arch(ball: Ball, side: int, half: Array) -> Conic:
    """The circle of a sphere in the plane of a side: 0 south, 1 east, 2 north, 3 west."""
    across = 1 - side % 2
    place, sign = half[across], (-1, 1, 1, -1)[side]
    centre = MM * (sign * place * AXES[across] + ball.z * UP)
    x = AXES[1 - across]
    radius = MM * sqrt(ball.radius**2 - place**2)
    return Conic(point(centre), point(x), point(UP), radius, radius)


def _ring(radius: float, z: float, start: float) -> Conic:
    """A level circle about the z axis, its angle from an azimuth on."""
    x, y = (point(_turned(start, axis)) for axis in AXES[:2])
    return Conic((0.0, 0.0, MM * z), x, y, MM * radius, MM * radius)


def _foot(radius: float, z: float, start: float, half: Array) -> Loop:
    """A quarter of a level circle, cut at the sides of the plan."""
    ring, inner = _ring(radius, z, start), np.minimum(half / radius, 1.0)
    stops = [0.0, *sorted({acos(inner[0]), asin(inner[0])} - {0.0, pi / 2}), pi / 2]
    return [Step(ring, a, b) for a, b in pairwise(stops)]


def _back(ring: Conic) -> Step:
    return Step(ring, pi / 2, 0.0)


def _between(path: Conic, start: Array, end: Array) -> Step:
    return Step(path, path.parameter(point(start)), path.parameter(point(end)))


def _on(ball: Ball, x: float, y: float) -> Array:
    """Point (3,) [mm] of the upper half of a sphere."""
    return MM * np.array([x, y, ball.z + sqrt(max(ball.radius**2 - x * x - y * y, 0.0))])


def _spot(radius: float, z: float, azimuth: float) -> Array:
    found: Array = np.multiply(MM, radius * _turned(azimuth, AXES[0]) + z * UP)
    return found


def _turned(azimuth: float, vector: Array) -> Array:
    """A vector (3,) turned about the z axis by a quarter or a part of it."""
    c, s = round(cos(azimuth), 15), round(sin(azimuth), 15)
    x, y, z = vector.tolist()
    return np.array([c * x - s * y, s * x + c * y, z])

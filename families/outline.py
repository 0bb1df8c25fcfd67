"""The outline of a profile as walls and as arcs of circles and ellipses with their angles, ready to be drawn."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import acos, asin, atan2, cos, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from families.profiles import Curve, junction

Point = tuple[float, float]
Array = NDArray[np.float64]
SNAP = 1e-12


@dataclass(frozen=True)
class Bow:
    """Arc of an ellipse about (u, z), half axes a along u and b along z, counterclockwise between eccentric angles."""

    u: float
    z: float
    a: float
    b: float
    start: float
    end: float

    def at(self, angle: float) -> Point:
        """Point (u, z) at an eccentric angle."""
        return self.u + self.a * cos(angle), self.z + self.b * sin(angle)

    def trace(self, angle: Array) -> tuple[Array, Array, Array, Array]:
        """u, z and the unit normal (nu, nz) away from the centre at eccentric angles (n,)."""
        c, s = np.cos(angle), np.sin(angle)
        size = np.hypot(self.b * c, self.a * s)
        return self.u + self.a * c, self.z + self.b * s, self.b * c / size, self.a * s / size


@dataclass(frozen=True)
class Wall:
    """Vertical line at u between two heights [m]."""

    u: float
    start: float
    end: float

    def trace(self, z: Array) -> tuple[Array, Array, Array, Array]:
        """u, z and the unit normal (nu, nz) at heights (n,)."""
        return np.full_like(z, self.u), z, np.ones_like(z), np.zeros_like(z)


def half_outline(curve: Curve, near: float, far: float, low: float) -> tuple[Bow, ...]:
    """The arcs of a curve from the springing to the crown, as far as near <= u <= far and z >= low [m].

    A vertical line from (u, low) to the first of them closes the outline where there is a wall.
    """
    bows = []
    for bow in _whole(curve):
        # Near 1 an arc cosine turns rounding into an angle; there the arc starts at its widest point.
        outer, inner = (far - bow.u) / bow.a, (near - bow.u) / bow.a
        start = max(bow.start, acos(outer) if outer < 1 - SNAP else 0.0, asin(max((low - bow.z) / bow.b, -1.0)))
        end = min(bow.end, acos(min(inner, 1.0))) if near > SNAP else bow.end
        if start < end - SNAP:
            bows.append(replace(bow, start=start, end=end))
    return tuple(bows)


def _whole(curve: Curve) -> tuple[Bow, ...]:
    wall = curve.half_span
    if not curve.arcs:
        return oval(wall, curve.rise, curve.oval) if curve.oval else (Bow(0.0, 0.0, wall, curve.rise, 0.0, pi / 2),)
    *lower, top = curve.arcs
    # Angles are measured from the centres; the crown is where the axis is reached.
    crown = acos(-top.u / top.radius)
    passes = [atan2(junction(curve)[1] - a.z, junction(curve)[0] - a.u) for a in lower]
    starts, ends = [0.0, *passes], [*passes, crown]
    return tuple(
        Bow(a.u, a.z, a.radius, a.radius, start, end) for a, start, end in zip(curve.arcs, starts, ends, strict=True)
    )


def oval(a: float, b: float, pairs: int) -> tuple[Bow, ...]:
    """A quarter of the ellipse of half axes a, b as `pairs` pairs of arcs, all tangent to each other.

    Each pair shares the ellipse's points and tangents at its ends (biarcs, Bolton 1975); six pairs stay within 0.3 mm
    of an ellipse of 2.5 m by 1.6 m, and the distance falls with the cube of their number.
    """
    t = np.linspace(0, pi / 2, pairs + 1)
    points = np.column_stack([a * np.cos(t), b * np.sin(t)])
    tangents = np.column_stack([-a * np.sin(t), b * np.cos(t)])
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    points[[0, -1]], tangents[[0, -1]] = [[a, 0], [0, b]], [[0, 1], [-1, 0]]
    bows = []
    for p, q, d, e in zip(points[:-1], points[1:], tangents[:-1], tangents[1:], strict=True):
        chord, turn = q - p, 2 * (1 - d @ e)
        along = chord @ (d + e)
        reach = (sqrt(along**2 + turn * (chord @ chord)) - along) / turn
        middle = (p + q + reach * (d - e)) / 2
        bows += [_arc(p, d, p, middle), _arc(q, e, middle, q)]
    return tuple(bows)


def _arc(point: Array, tangent: Array, start: Array, end: Array) -> Bow:
    """The arc from start to end that touches a tangent at one of them."""
    normal = np.array([-tangent[1], tangent[0]])
    way = end + start - 2 * point  # from the point to the other end
    radius = float(way @ way / (2 * (normal @ way)))
    u, z = (point + radius * normal).tolist()
    return Bow(u, z, radius, radius, *(atan2(p[1] - z, p[0] - u) for p in (start, end)))

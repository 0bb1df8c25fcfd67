"""The outline of a profile as walls and as arcs of circles and ellipses with their angles, ready to be drawn."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import acos, asin, atan2, cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from families.declaration.profiles import Curve, junction

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


@lru_cache(maxsize=256)
def half_outline(curve: Curve, near: float, far: float, low: float) -> tuple[Bow, ...]:
    """The arcs of a curve from the springing to the crown, as far as near <= u <= far and z >= low [m].

    A vertical line from (u, low) to the first of them closes the outline where there is a wall.
    """
    bows = []
    for bow in _whole(curve):
        # Near 1 an arc cosine turns rounding into an angle; there the arc starts at its widest point.
        outer, inner = (far - bow.u) / bow.a, (near - bow.u) / bow.a
        start = max(
            bow.start, acos(max(outer, -1.0)) if outer < 1 - SNAP else 0.0, asin(max((low - bow.z) / bow.b, -1.0))
        )
        end = min(bow.end, acos(max(min(inner, 1.0), -1.0))) if near > SNAP else bow.end
        if start < end - SNAP:
            bows.append(replace(bow, start=start, end=end))
    return tuple(bows)


def _whole(curve: Curve) -> tuple[Bow, ...]:
    wall = curve.half_span
    if not curve.arcs:
        return (Bow(0.0, 0.0, wall, curve.rise, 0.0, pi / 2),)
    *lower, top = curve.arcs
    # Angles are measured from the centres; the crown is where the axis is reached.
    crown = acos(-top.u / top.radius)
    passes = [atan2(junction(curve)[1] - a.z, junction(curve)[0] - a.u) for a in lower]
    starts, ends = [0.0, *passes], [*passes, crown]
    return tuple(
        Bow(a.u, a.z, a.radius, a.radius, start, end) for a, start, end in zip(curve.arcs, starts, ends, strict=True)
    )

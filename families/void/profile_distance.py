"""Signed distances of places to profiles: walls, arcs, ellipses; to barrels that climb or widen, and to balls."""

from __future__ import annotations

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from families.void.body_table import (
    ARCS,
    BASE,
    CROWN_RISE,
    FLARE,
    HALF_LENGTH,
    HALF_SPAN,
    R1,
    R2,
    RISE,
    SLOPE,
    SPLAY,
    U1,
    U2,
    Z1,
    Z2,
)
from families.void.compiled import apart, inner

Array = NDArray[np.float64]
APEX = 1e-6  # share of its size at its origin that is left of a tapered barrel beyond its apex


@inner
def to_ellipse(u: float, z: float, a: float, b: float) -> tuple[float, float, float]:
    """Signed distance of (u, z), both >= 0, to the ellipse of half axes a, b, and its normal.

    Newton from the left on the convex function of Eberly, "Distance from a point to an ellipse" (2013). A step from
    zero ends left of its root too, and close to it where the point is close to the ellipse.
    """
    u, z = max(u, 1e-12 * a), max(z, 1e-12 * b)  # on an axis the first step would divide by zero
    ru, rz = u / a, z / b
    first = 0.5 * (ru * ru + rz * rz - 1.0) / (ru * ru / (a * a) + rz * rz / (b * b))
    t = max(-a * a + a * u, -b * b + b * z, first)
    for _ in range(60):
        ru, rz = a * u / (t + a * a), b * z / (t + b * b)
        f = ru * ru + rz * rz - 1.0
        slope = -2.0 * (ru * ru / (t + a * a) + rz * rz / (t + b * b))
        if f < 1e-15 or slope == 0.0:
            break
        t -= f / slope
    eu, ez = a * a * u / (t + a * a), b * b * z / (t + b * b)
    nu, nz = eu / (a * a), ez / (b * b)
    size = sqrt(nu * nu + nz * nz)
    nu, nz = nu / size, nz / size
    return (u - eu) * nu + (z - ez) * nz, nu, nz


@inner
def to_profile(u: float, z: float, parts: Array, k: int) -> tuple[float, float, float]:
    """Signed distance of (u, z), u >= 0, to a curve with a wall below its springing; normal (nu, nz)."""
    wall = u - parts[k, HALF_SPAN]
    if parts[k, ARCS] == 0.0:
        if z <= 0.0 or (u < 1e-9 and z < 1e-9):
            return wall, 1.0, 0.0
        return to_ellipse(u, z, parts[k, HALF_SPAN], parts[k, RISE])  # type: ignore[no-any-return]  # numba is untyped
    cu, cz, r = parts[k, U1], parts[k, Z1], parts[k, R1]
    if (
        parts[k, ARCS] == 2.0
        and (cu - parts[k, U2]) * (z - parts[k, Z2]) - (cz - parts[k, Z2]) * (u - parts[k, U2]) > 0.0
    ):
        cu, cz, r = parts[k, U2], parts[k, Z2], parts[k, R2]
    if z <= cz:
        return wall, 1.0, 0.0
    du, dz = u - cu, z - cz
    size = sqrt(du * du + dz * dz)
    arc = size - r
    # A wall may be nearer only below the springing or where the arc leaves it at an angle.
    if arc < wall:
        return wall, 1.0, 0.0
    return arc, du / size, dz / size


@apart
def to_bent(u: float, along: float, z: float, parts: Array, k: int) -> tuple[float, float, float, float]:
    """Signed distance and normal (across, up, along) of a place beside a barrel that is not level or not even.

    Where its arch, as large as it is there, has its nearest point stands for the place itself in the slopes along the
    axis: exact at the surface, and as large as it should be up to the apex.
    """
    # The axis is a parabola: with straight slopes the lower of two crossing barrels would come out at the middle.
    way = along / parts[k, HALF_LENGTH]
    climb = parts[k, SLOPE] - 2.0 * parts[k, CROWN_RISE] * way / parts[k, HALF_LENGTH]
    h = z - parts[k, BASE] - (parts[k, SLOPE] * along + parts[k, CROWN_RISE] * (1.0 - way * way))
    span, size = max(1.0 + parts[k, SPLAY] * along, APEX), max(1.0 + parts[k, FLARE] * along, APEX)
    d, nu, nz = to_profile(u / span, h / size, parts, k)
    foot_u, foot_h = u / span - d * nu, h / size - d * nz
    nu, nz = nu / span, nz / size
    na = -nu * foot_u * parts[k, SPLAY] - nz * (climb + foot_h * parts[k, FLARE])
    steep = sqrt(nu * nu + nz * nz + na * na)
    return d / steep, nu / steep, nz / steep, na / steep


@inner
def to_ball(x: float, y: float, h: float, radius: float) -> tuple[float, float, float, float]:
    """Signed distance and normal of a place from the centre of a ball, above a wall."""
    if h < 0.0:
        size = sqrt(x * x + y * y)
        return size - radius, x / max(size, 1e-300), y / max(size, 1e-300), 0.0
    size = max(sqrt(x * x + y * y + h * h), 1e-300)
    return size - radius, x / size, y / size, h / size

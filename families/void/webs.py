"""Webs in numbers: triangles of arches that stand on diagonals, one in each plane across the way to the wall."""

from __future__ import annotations

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from families.void.body_table import (
    ACROSS_X,
    ACROSS_Y,
    ARCH,
    ARCS,
    BASKET,
    BOW,
    CROWN,
    DEPTH,
    ELLIPTICAL,
    FAR,
    HALF,
    HALF_SPAN,
    HAUNCH,
    MIDDLE,
    POINTED,
    R1,
    R2,
    RISE,
    U1,
    U2,
    Z1,
    Z2,
    X,
    Y,
)
from families.void.compiled import apart, compiled, inner
from families.void.profile_distance import to_ellipse

Array = NDArray[np.float64]
SAME = 1e-9  # [m] beside a rib
FLAT = 1e-6  # rise / half span of an arch that is level
STEP = 1e-5  # of differences on the way to a wall, as a share of it
BESIDE = 0.08  # share of the way to its wall, from there, within which a point's foot on a web is looked for by steps
MOST_FEET, LEAST_LEFT, SETTLED = 8, 0.125, 1e-5  # steps; what of the way to the wall one leaves; and the last step [m]
CENTRE = 1e-9  # share of the way to its wall below which a web is one point


@inner
def _arch(u: float, span: float, rise: float, kind: float, haunch: float) -> tuple[float, float, float]:
    """Centre and radius of the arc over u of an arch as `Profile.arch` has it; no radius: an ellipse."""
    steep = rise > span * (1.0 + SAME)
    if kind == ELLIPTICAL or (steep and (kind < POINTED or kind == BASKET)):
        return 0.0, 0.0, 0.0
    if kind == BASKET:
        small = haunch * rise
        large = (span * span + rise * rise - 2.0 * span * small) / (2.0 * (rise - small))
        if u * (large - small) > (span - small) * large:
            return span - small, 0.0, small
        return 0.0, rise - large, large
    if not steep:
        radius = (span * span + rise * rise) / (2.0 * rise)
        return 0.0, rise - radius, radius
    radius = (span * span + rise * rise) / (2.0 * span)
    return span - radius, 0.0, radius


@inner
def _chord(v: float, parts: Array, k: int) -> tuple[float, float]:
    """Height of the diagonals at a share of the way to the wall, and of the arch that stands on them."""
    u, span, rise = min(v * parts[k, FAR], parts[k, HALF_SPAN]), parts[k, HALF_SPAN], parts[k, RISE]
    low = rise * sqrt(max(1.0 - (u / span) ** 2, 0.0))
    if parts[k, ARCS] > 0.0:
        cu, cz, r = parts[k, U1], parts[k, Z1], parts[k, R1]
        if parts[k, ARCS] == 2.0:  # the haunch as far as to where it passes into the crown
            du, dz = cu - parts[k, U2], cz - parts[k, Z2]
            if u < parts[k, U2] + parts[k, R2] * du / sqrt(du * du + dz * dz):
                cu, cz, r = parts[k, U2], parts[k, Z2], parts[k, R2]
        low = cz + sqrt(max(r * r - (u - cu) ** 2, 0.0))
    if parts[k, BOW] < 0.0:
        return low, v * parts[k, CROWN]
    ridge = parts[k, CROWN] + (rise - parts[k, CROWN]) * (1.0 - v) * (1.0 + parts[k, BOW] * v)
    return low, max(ridge - low, FLAT * v * parts[k, HALF])


@inner
def _section(along: float, across: float, z: float, parts: Array, k: int) -> tuple[float, float, float]:
    """Signed distance of a place in the plane across a web to its arch there, and its normal (across, up)."""
    v = max(along / parts[k, DEPTH], CENTRE)
    low, rise = _chord(v, parts, k)
    span, u, h = v * parts[k, HALF], across - v * parts[k, MIDDLE], z - low
    sign = 1.0 if u >= 0.0 else -1.0
    u = abs(u)
    cu, cz, r = _arch(u, span, rise, parts[k, ARCH], parts[k, HAUNCH])
    foot_u, foot_h = span, 0.0  # where there is no nearer point of the arch, its springing on the rib is the nearest
    if r == 0.0:
        d, nu, nz = to_ellipse(u, max(h, 0.0), span, rise)
        if h > 0.0:
            return d, nu * sign, nz
        foot_u, foot_h = u - d * nu, -d * nz
    else:
        if parts[k, ARCH] == BASKET:  # the arc is that of the nearest point, not of the one above
            small, large = (
                _arch(span, span, rise, BASKET, parts[k, HAUNCH]),
                _arch(0.0, span, rise, BASKET, parts[k, HAUNCH]),
            )
            beyond = (small[0] - large[0]) * (h - large[1]) - (small[1] - large[1]) * (u - large[0]) > 0.0
            cu, cz, r = large if beyond else small
        du, dz = u - cu, h - cz
        size = max(sqrt(du * du + dz * dz), 1e-300)
        if cz + r * dz / size >= 0.0:
            return size - r, sign * du / size, dz / size
    du, dz = foot_u - u, foot_h - h
    size = max(sqrt(du * du + dz * dz), 1e-300)
    return -size, sign * du / size, dz / size


@inner
def _lean(along: float, across: float, z: float, nu: float, nz: float, parts: Array, k: int) -> float:
    """How much the distance to a web grows for each metre towards its wall, at a place on it with its normal there."""
    step = STEP * parts[k, DEPTH]
    v, grown, moved = along / parts[k, DEPTH], parts[k, HALF] / parts[k, DEPTH], parts[k, MIDDLE] / parts[k, DEPTH]
    low, rise = _chord(v, parts, k)
    span, u, h = v * parts[k, HALF], across - v * parts[k, MIDDLE], z - low
    more_low, more_rise = _chord(v + STEP, parts, k)
    less_low, less_rise = _chord(v - STEP, parts, k)
    raised, higher = (more_low - less_low) / (2.0 * step), (more_rise - less_rise) / (2.0 * step)
    if abs(abs(u) - span) + abs(h) < SAME:  # on a rib
        moved += grown if u > 0.0 else -grown
        return -nu * moved - nz * raised  # type: ignore[no-any-return]
    u = abs(u)
    if _arch(u, span, rise, parts[k, ARCH], parts[k, HAUNCH])[2] != 0.0:
        more, less = _section(along + step, across, z, parts, k)[0], _section(along - step, across, z, parts, k)[0]
        return (more - less) / (2.0 * step)  # type: ignore[no-any-return]
    # An ellipse from its equation: differences of its distances, which are found by steps, would be rough.
    gu, gh = u / (span * span), h / (rise * rise)
    gone = -(u * gu * grown / span + h * gh * higher / rise) / max(sqrt(gu * gu + gh * gh), 1e-300)
    return gone - nu * moved - nz * raised  # type: ignore[no-any-return]


@apart
def to_web(x: float, y: float, z: float, parts: Array, k: int) -> tuple[float, float, float, float]:
    """Signed distance and normal of a point to a web; -inf beyond its triangle."""
    tx, ty = parts[k, ACROSS_X], parts[k, ACROSS_Y]
    x, y = x - parts[k, X], y - parts[k, Y]
    across, along = x * tx + y * ty, x * ty - y * tx
    v = along / parts[k, DEPTH]
    if abs(across - v * parts[k, MIDDLE]) > v * parts[k, HALF] + SAME:
        return -inf, 0.0, 0.0, 1.0
    if v < CENTRE:
        return z - _chord(0.0, parts, k)[0], 0.0, 0.0, 1.0
    base = min(along, parts[k, DEPTH])
    off, foot, nu, na, nz = _tangent(base, along, across, z, parts, k)
    beside = (parts[k, DEPTH] - along) / (BESIDE * parts[k, DEPTH])
    if beside < 1.0 and off > along - parts[k, DEPTH]:  # else the wall is nearer
        # Ribs are upright over their feet: what touches a web there says nothing of it a hand's breadth higher.
        first, seen = off, max(1.0 - max(beside, 0.0) ** 2, 0.0)
        for _ in range(MOST_FEET):
            if abs(foot - base) < SETTLED:
                break
            left = parts[k, DEPTH] - base
            base = min(foot, parts[k, DEPTH] - left * LEAST_LEFT)
            base = max(base, (1.0 - 2.0 * BESIDE) * parts[k, DEPTH])
            off, foot, nu, na, nz = _tangent(base, along, across, z, parts, k)
        off = first + seen * (off - first) if off * first > 0.0 else first
    return off, nu * tx + na * ty, nu * ty - na * tx, nz


@inner
def _tangent(
    base: float, along: float, across: float, z: float, parts: Array, k: int
) -> tuple[float, float, float, float, float]:
    """Signed distance of a place to the plane that touches a web in its section at `base`, and its normal.

    Between them how far along the foot on that plane is: a better base. The normal is (across, along, up).
    """
    d, nu, nz = _section(base, across, z, parts, k)
    na = _lean(min(base, (1.0 - 2.0 * STEP) * parts[k, DEPTH]), across - d * nu, z - d * nz, nu, nz, parts, k)
    size = sqrt(1.0 + na * na)
    off = (d + (along - base) * na) / size
    return off, along - off * na / size, nu / size, na / size, nz / size


@inner
def web_height(along: float, across: float, parts: Array, k: int) -> float:
    """Height [m] of a web at a place from its centre to its wall and along that [m]."""
    v = max(along / parts[k, DEPTH], CENTRE)
    low, rise = _chord(v, parts, k)
    span = v * parts[k, HALF]
    u = min(abs(across - v * parts[k, MIDDLE]), span)
    cu, cz, r = _arch(u, span, rise, parts[k, ARCH], parts[k, HAUNCH])
    if r == 0.0:
        return low + rise * sqrt(max(1.0 - (u / span) ** 2, 0.0))  # type: ignore[no-any-return]
    return low + cz + sqrt(max(r * r - (u - cu) ** 2, 0.0))  # type: ignore[no-any-return]


@compiled
def web_heights(along: Array, across: Array, parts: Array) -> Array:
    """Heights (n,) [m] of the one web in a table at places from its centre to its wall and along that (n,) [m]."""
    out = np.empty(len(along))
    for i in range(len(along)):
        out[i] = web_height(along[i], across[i], parts, 0)
    return out


@compiled
def web_arch_rises(v: Array, parts: Array) -> Array:
    """Rises (n,) [m] of the arches of the one web in a table at shares (n,) of the way to its wall."""
    out = np.empty(len(v))
    for i in range(len(v)):
        out[i] = _chord(v[i], parts, 0)[1]
    return out

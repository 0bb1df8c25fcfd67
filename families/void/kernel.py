"""The numeric surface of a vault, compiled: signed distance, component and normal of many points in one pass.

A void is a union of pieces, a piece an intersection of bodies (`families.declaration.pieces`): the signed distance is
the minimum over pieces of the maximum over bodies, exact near the surface (Ricci 1973, constructive geometry with min
and max).
Positive is in the stone, negative in the room.
"""

from __future__ import annotations

from math import hypot, inf, sqrt
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Ceiling, Lid, Part, Piece, Turned, Web
from families.declaration.plan import BOX, CENTRE_X, CENTRE_Y, NOTCH, OTHER, REACH, SHAPE, WITHIN, Plan
from families.declaration.profiles import UNSTILTED, BasketHandle, Curve, Elliptical, Pointed

Array = NDArray[np.float64]

# Columns of the packed table, one row a body.
PIECE, KIND, X, Y, ACROSS_X, ACROSS_Y, BASE, SIDE, CROWN_RISE, HALF_LENGTH, SLOPE, SPLAY, FLARE, RADIUS = range(14)
HALF_SPAN, RISE, STILT, ARCS, U1, Z1, R1, U2, Z2, R2 = range(14, 24)
NAME, NAMING = 24, 28  # four names from 24 on; NAMING says how the name is chosen
FOOT = 29  # height from which on the piece is free of the plan, -inf if it never is
WIDTH = 30

# Those of a web, in places that it has no other use for: kind of its arch, haunch ratio of that, bow of the ridge,
# distance of the wall, middle of that along it, half its length, reach and rise.
ARCH, BOW, DEPTH, MIDDLE, HALF, FAR, CROWN, HAUNCH = (
    SIDE,
    CROWN_RISE,
    HALF_LENGTH,
    SLOPE,
    SPLAY,
    FLARE,
    RADIUS,
    NAME + 1,
)

# BENT: a barrel that is not level or not even; ASIDE, RING: a ball or turned profile that is not about the origin.
BARREL, BENT, BALL, TURNED, CEILING, LID, ASIDE, RING, WEB = range(9)
ALONG, QUARTER, HEIGHT, ONE = range(4)  # NAMING: by the sign along the axis, the corner of the plan, the height, or one
KINDS = UNSTILTED  # ARCH: the place in this row
POINTED, BASKET, ELLIPTICAL = map(KINDS.index, (Pointed, BasketHandle, Elliptical))
BELOW = 2  # which of a barrel's names is that of its walls; 0 if they have none of their own
SAME = 1e-9  # [m] within which two walls are one
FLAT = 1e-6  # rise / half span of an arch that is level
STEP = 1e-5  # of differences on the way to a wall, as a share of it
CENTRE = 1e-9  # share of the way to its wall below which a web is one point
APEX = 1e-6  # share of its size at its origin that is left of a tapered barrel beyond its apex

NO_WALLS = np.empty((0, 5))


def pack(pieces: tuple[Piece, ...], components: tuple[str, ...]) -> Array:
    """Table (bodies, WIDTH) of a void for the kernels below; component ids are 1 + index in `components`."""
    ids = {name: float(i + 1) for i, name in enumerate(components)}
    table = np.array([_row(k, part, ids) for k, piece in enumerate(pieces) for part in piece.parts])
    if any(piece.foot is not None for piece in pieces):
        table[:, FOOT] = [-inf if piece.foot is None else piece.foot for piece in pieces for _ in piece.parts]
    return table


def pack_plan(plan: Plan | None) -> Array:
    """Table (sides, 5) of the walls on a plan (`families.declaration.plan`), of no side if there are none."""
    return NO_WALLS if plan is None else plan.table


def _row(piece: int, part: Part, ids: dict[str, float]) -> list[float]:
    row = [0.0] * WIDTH
    row[PIECE], row[FOOT] = piece, -inf
    match part:
        case BarrelPart():
            bent = part.crown_rise or part.slope or part.splay or part.flare
            row[KIND], row[NAMING] = BENT if bent else BARREL, ALONG
            row[X:BASE] = *part.origin, *part.across
            row[BASE], row[SIDE], row[SLOPE], row[SPLAY] = part.base, part.side, part.slope, part.splay
            row[FLARE], row[CROWN_RISE], row[HALF_LENGTH] = part.flare, part.crown_rise, part.half_length
            row[HALF_SPAN:NAME] = _curve(part.curve)
            row[NAME : NAME + BELOW] = [ids[n] for n in part.names]
            row[NAME + BELOW] = ids[part.below] if part.below else 0.0
            return row
        case Ball():
            row[KIND], row[NAMING], row[BASE], row[R1] = BALL, QUARTER, part.z, part.radius
            row[X], row[Y] = part.centre
            if any(part.centre):
                row[KIND] = ASIDE
        case Turned():
            row[KIND], row[NAMING], row[BASE], row[RADIUS] = TURNED, HEIGHT, part.base, part.radius
            row[X], row[Y] = part.centre
            if part.radius or any(part.centre):
                row[KIND] = RING
            row[HALF_SPAN:NAME] = _curve(part.curve)
        case Web():
            (x, y), (x0, y0), (x1, y1) = part.centre, part.start, part.end
            size = hypot(x1 - x0, y1 - y0)
            tx, ty = (x1 - x0) / size, (y1 - y0) / size
            row[KIND], row[NAMING], row[NAME], row[X], row[Y] = WEB, ONE, ids[part.names[0]], x, y
            row[ACROSS_X], row[ACROSS_Y], row[HALF] = tx, ty, size / 2
            row[DEPTH] = (x0 - x) * ty - (y0 - y) * tx
            row[MIDDLE] = ((x0 + x1) / 2 - x) * tx + ((y0 + y1) / 2 - y) * ty
            row[ARCH], row[HAUNCH] = KINDS.index(type(part.arch)), getattr(part.arch, "haunch_ratio", 0.0)
            row[BOW], row[FAR], row[CROWN] = -1.0 if part.bow is None else part.bow, part.reach, part.rise
            row[HALF_SPAN:NAME] = _curve(part.diagonal)
            return row
        case Ceiling():
            row[KIND], row[BASE] = CEILING, part.z
        case Lid():
            row[KIND], row[BASE] = LID, part.z
            return row
    names = part.names * (4 // len(part.names))
    row[NAME : NAME + 4] = [ids[n] for n in names]
    return row


def _curve(curve: Curve) -> list[float]:
    arcs = [value for a in curve.arcs for value in (a.u, a.z, a.radius)]
    return [curve.half_span, curve.rise, curve.stilt, float(len(curve.arcs)), *arcs, *[0.0] * (6 - len(arcs))]


# Serial, as an optimiser calls it thousands of times on a few thousand points; threads may share a large cloud.
compiled = njit(cache=True, nogil=True, error_model="numpy")
# What only reads its arrays needs no count of references to them: without one it is ten times as fast (numba #1204).
inner = njit(cache=True, nogil=True, error_model="numpy", forceinline=True, _nrt=False)
apart = njit(cache=True, nogil=True, error_model="numpy", _nrt=False)  # what is rare, and would make the rest slower


@inner
def _ellipse(u: float, z: float, a: float, b: float) -> tuple[float, float, float]:
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
def _profile(u: float, z: float, parts: Array, k: int) -> tuple[float, float, float]:
    """Signed distance of (u, z), u >= 0, to a curve with a wall below its springing; normal (nu, nz)."""
    wall = u - parts[k, HALF_SPAN]
    if parts[k, ARCS] == 0.0:
        if z <= 0.0 or (u < 1e-9 and z < 1e-9):
            return wall, 1.0, 0.0
        return _ellipse(u, z, parts[k, HALF_SPAN], parts[k, RISE])  # type: ignore[no-any-return]  # numba is untyped
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
def _bent(u: float, along: float, z: float, parts: Array, k: int) -> tuple[float, float, float, float]:
    """Signed distance and normal (across, up, along) of a place beside a barrel that is not level or not even.

    Where its arch, as large as it is there, has its nearest point stands for the place itself in the slopes along the
    axis: exact at the surface, and as large as it should be up to the apex.
    """
    # The axis is a parabola: with straight slopes the lower of two crossing barrels would come out at the middle.
    way = along / parts[k, HALF_LENGTH]
    climb = parts[k, SLOPE] - 2.0 * parts[k, CROWN_RISE] * way / parts[k, HALF_LENGTH]
    h = z - parts[k, BASE] - (parts[k, SLOPE] * along + parts[k, CROWN_RISE] * (1.0 - way * way))
    span, size = max(1.0 + parts[k, SPLAY] * along, APEX), max(1.0 + parts[k, FLARE] * along, APEX)
    d, nu, nz = _profile(u / span, h / size, parts, k)
    foot_u, foot_h = u / span - d * nu, h / size - d * nz
    nu, nz = nu / span, nz / size
    na = -nu * foot_u * parts[k, SPLAY] - nz * (climb + foot_h * parts[k, FLARE])
    steep = sqrt(nu * nu + nz * nz + na * na)
    return d / steep, nu / steep, nz / steep, na / steep


@inner
def _ball(x: float, y: float, h: float, radius: float) -> tuple[float, float, float, float]:
    """Signed distance and normal of a place from the centre of a ball, above a wall."""
    if h < 0.0:
        size = sqrt(x * x + y * y)
        return size - radius, x / max(size, 1e-300), y / max(size, 1e-300), 0.0
    size = max(sqrt(x * x + y * y + h * h), 1e-300)
    return size - radius, x / size, y / size, h / size


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
        d, nu, nz = _ellipse(u, max(h, 0.0), span, rise)
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
def _web(x: float, y: float, z: float, parts: Array, k: int) -> tuple[float, float, float, float]:
    """Signed distance and normal of a point to a web; -inf beyond its triangle."""
    tx, ty = parts[k, ACROSS_X], parts[k, ACROSS_Y]
    x, y = x - parts[k, X], y - parts[k, Y]
    across, along = x * tx + y * ty, x * ty - y * tx
    v = along / parts[k, DEPTH]
    if abs(across - v * parts[k, MIDDLE]) > v * parts[k, HALF] + SAME:
        return -inf, 0.0, 0.0, 1.0
    if v < CENTRE:
        return z - _chord(0.0, parts, k)[0], 0.0, 0.0, 1.0
    d, nu, nz = _section(along, across, z, parts, k)
    na = _lean(along, across - d * nu, z - d * nz, nu, nz, parts, k)
    size = sqrt(1.0 + na * na)
    return d / size, (nu * tx + na * ty) / size, (nu * ty - na * tx) / size, nz / size


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


@apart
def _aside(x: float, y: float, z: float, parts: Array, k: int) -> tuple[float, float, float, float]:
    """The same of a web, and of a ball or what is turned about another axis than the origin's or as a ring."""
    if parts[k, KIND] == WEB:
        return _web(x, y, z, parts, k)  # type: ignore[no-any-return]
    x, y, h = x - parts[k, X], y - parts[k, Y], z - parts[k, BASE]
    if parts[k, KIND] == ASIDE:
        return _ball(x, y, h, parts[k, R1])  # type: ignore[no-any-return]
    rho = sqrt(x * x + y * y)
    sign = 1.0 if rho >= parts[k, RADIUS] else -1.0
    d, nu, nz = _profile(abs(rho - parts[k, RADIUS]), h, parts, k)
    if rho < 1e-12:
        return d, 0.0, 0.0, 1.0
    nu *= sign / rho
    return d, nu * x, nu * y, nz


@inner
def _body(x: float, y: float, z: float, parts: Array, k: int) -> tuple[float, float, float, float]:
    """Signed distance and normal of a point to the body in row k; -inf where it says nothing."""
    kind = parts[k, KIND]
    if kind <= BENT:
        x, y = x - parts[k, X], y - parts[k, Y]
        u, along = _across(x, y, parts, k)
        sign = 1.0 if u >= 0.0 else -1.0
        if parts[k, SIDE] * sign < 0.0:
            return -inf, 0.0, 0.0, 1.0
        u = abs(u)
        cx, cy = parts[k, ACROSS_X], parts[k, ACROSS_Y]
        if kind == BARREL:
            d, nu, nz = _profile(u, z - parts[k, BASE], parts, k)
            nu *= sign
            return d, nu * cx, nu * cy, nz
        d, nu, nz, na = _bent(u, along, z, parts, k)
        nu *= sign
        return d, nu * cx - na * cy, nu * cy + na * cx, nz
    if kind == BALL:
        return _ball(x, y, z - parts[k, BASE], parts[k, R1])  # type: ignore[no-any-return]
    if kind == TURNED:
        rho = sqrt(x * x + y * y)
        d, nu, nz = _profile(rho, z - parts[k, BASE], parts, k)
        if rho < 1e-12:
            return d, 0.0, 0.0, 1.0
        return d, nu * x / rho, nu * y / rho, nz
    if kind >= ASIDE:
        return _aside(x, y, z, parts, k)  # type: ignore[no-any-return]
    return z - parts[k, BASE], 0.0, 0.0, 1.0


@inner
def _across(x: float, y: float, parts: Array, k: int) -> tuple[float, float]:
    """Place in plan, from the origin of the barrel in row k, across its axis and along it."""
    cx, cy = parts[k, ACROSS_X], parts[k, ACROSS_Y]
    return x * cx + y * cy, y * cx - x * cy


@inner
def _name(x: float, y: float, z: float, parts: Array, row: int) -> int:
    if parts[row, NAMING] == QUARTER:
        k = (1 if x > parts[row, X] else 0) + (2 if y > parts[row, Y] else 0)
    elif parts[row, NAMING] == ONE:
        k = 0
    elif parts[row, NAMING] == HEIGHT:
        k = 1 if z > parts[row, BASE] else 0
    else:
        _, along = _across(x - parts[row, X], y - parts[row, Y], parts, row)
        k = 1 if along > 0.0 else 0
        if parts[row, NAME + BELOW] != 0.0 and z - parts[row, BASE] <= parts[row, SLOPE] * along:
            k = BELOW
    return int(parts[row, NAME + k])


@inner
def _void(x: float, y: float, z: float, parts: Array) -> tuple[float, int, int, float, float, float]:
    """Signed distance, component, row of the body that decides, and normal of one point in the vault's frame."""
    best, best_name, best_row, bx, by, bz = inf, 0, 0, 0.0, 0.0, 1.0
    k: Any = np.int64(0)  # for a literal numba would compile all that takes it once more
    while k < len(parts):
        piece = parts[k, PIECE]
        most, surface, row, last, mx, my, mz = -inf, -inf, -1, k, 0.0, 0.0, 1.0
        while k < len(parts) and parts[k, PIECE] == piece:
            d, nx, ny, nz = _body(x, y, z, parts, k)
            if parts[k, KIND] != LID and (d > surface or row < 0):
                surface, row, mx, my, mz = d, k, nx, ny, nz
            if d > most:
                most, last = d, k
            k += 1
        if most < best:
            best, best_name, best_row, bx, by, bz = most, _name(x, y, z, parts, row), last, mx, my, mz
    return best, best_name, best_row, bx, by, bz


@inner
def _side(x: float, y: float, plan: Array, k: int) -> float:
    """Signed distance of a place in plan to a side, negative where the plan is."""
    if abs(plan[k, SHAPE]) != WITHIN:
        return x * plan[k, CENTRE_X] + y * plan[k, CENTRE_Y] - plan[k, REACH]  # type: ignore[no-any-return]
    x, y = x - plan[k, CENTRE_X], y - plan[k, CENTRE_Y]
    return plan[k, SHAPE] * (sqrt(x * x + y * y) - plan[k, REACH])  # type: ignore[no-any-return]


@inner
def _wall(x: float, y: float, plan: Array) -> float:
    """Signed distance to the walls; see `Plan.distance`."""
    if len(plan) and plan[0, SHAPE] == BOX:
        return max(abs(x) - plan[1, REACH], abs(y) - plan[0, REACH])  # type: ignore[no-any-return]
    most = -inf
    for k in range(len(plan)):
        d = _side(x, y, plan, k)
        if plan[k, SHAPE] == NOTCH:
            d = min(d, _side(x, y, plan, int(plan[k, OTHER])))
        most = max(most, d)
    return most


@inner
def _nearest(x: float, y: float, plan: Array, wall: float) -> int:
    """The side that has the distance to the walls."""
    if plan[0, SHAPE] == BOX:
        if abs(x) - plan[1, REACH] == wall:
            return 1 if x > 0.0 else 3
        return 2 if y > 0.0 else 0
    for k in range(len(plan)):
        if _side(x, y, plan, k) == wall:
            return k
    return 0


@inner
def _room(x: float, y: float, z: float, parts: Array, plan: Array) -> tuple[float, int, int, float, float, float]:
    """The same for the vault on its walls: component 0 on the walls, above and below the springing.

    The row of a wall is -1 less the index of its side.
    """
    d, name, row, nx, ny, nz = _void(x, y, z, parts)
    wall = _wall(x, y, plan)
    # Below the foot of a drum over the sides of the plan there is their wall.
    if wall > d or (z < parts[row, FOOT] and wall > d - SAME):
        side = _nearest(x, y, plan, wall)
        d, name, row, nx, ny, nz = wall, 0, -1 - side, plan[side, CENTRE_X], plan[side, CENTRE_Y], 0.0
        if abs(plan[side, SHAPE]) == WITHIN:
            x, y = x - nx, y - ny
            size = plan[side, SHAPE] * max(sqrt(x * x + y * y), 1e-300)
            nx, ny = x / size, y / size
    return d, name if z >= -1e-9 else 0, row, nx, ny, nz


@inner
def _moved(xyz: Array, i: int, frame: Array) -> tuple[float, float, float]:
    """Point i in the vault's frame."""
    px, py, pz = xyz[i, 0], xyz[i, 1], xyz[i, 2]
    return (
        frame[0, 0] * px + frame[0, 1] * py + frame[0, 2] * pz + frame[0, 3],
        frame[1, 0] * px + frame[1, 1] * py + frame[1, 2] * pz + frame[1, 3],
        frame[2, 0] * px + frame[2, 1] * py + frame[2, 2] * pz + frame[2, 3],
    )


@compiled
def distances(xyz: Array, frame: Array, parts: Array, plan: Array) -> Array:
    """Signed distances (n,) [m] of points (n, 3) to the room; `frame` (3, 4) brings them into the vault's frame."""
    out = np.empty(len(xyz))
    for i in range(len(xyz)):
        x, y, z = _moved(xyz, i, frame)
        out[i] = max(_void(x, y, z, parts)[0], _wall(x, y, plan))
    return out


@compiled
def surface(xyz: Array, frame: Array, parts: Array, plan: Array) -> tuple[Array, NDArray[np.uint16], Array]:
    """Signed distances (n,) [m], components (n,) and normals (n, 3) in the points' frame."""
    n = len(xyz)
    distance, component, normal = np.empty(n), np.empty(n, np.uint16), np.empty((n, 3))
    for i in range(n):
        x, y, z = _moved(xyz, i, frame)
        d, name, _, nx, ny, nz = _room(x, y, z, parts, plan)
        distance[i], component[i] = d, name
        for k in range(3):
            normal[i, k] = nx * frame[0, k] + ny * frame[1, k] + nz * frame[2, k]
    return distance, component, normal


@compiled
def deciding(xyz: Array, frame: Array, parts: Array, plan: Array) -> tuple[NDArray[np.int64], Array]:
    """Rows (n,) of the bodies that decide the distances, negative for walls, and their normals (n, 3)."""
    n = len(xyz)
    rows, normal = np.empty(n, np.int64), np.empty((n, 3))
    for i in range(n):
        x, y, z = _moved(xyz, i, frame)
        _, _, rows[i], nx, ny, nz = _room(x, y, z, parts, plan)
        for k in range(3):
            normal[i, k] = nx * frame[0, k] + ny * frame[1, k] + nz * frame[2, k]
    return rows, normal


@compiled
def to_rows(xyz: Array, frame: Array, parts: Array, plan: Array, rows: NDArray[np.int64]) -> Array:
    """Signed distances (n,) [m] of points (n, 3), each to the one body in its row: what an optimiser differentiates."""
    out = np.empty(len(xyz))
    for i in range(len(xyz)):
        x, y, z = _moved(xyz, i, frame)
        if rows[i] < 0:
            out[i] = _side(x, y, plan, -1 - rows[i])
        else:
            out[i] = _body(x, y, z, parts, rows[i])[0]
    return out


@compiled
def over_plan(xyz: Array, frame: Array, half: Array, lowest: float) -> NDArray[np.int64]:
    """Which points (n, 3) lie within the half extents (2,) of a plan and above `lowest` [m] once `frame` moved them."""
    found = np.empty(len(xyz), np.int64)
    count = 0
    for i in range(len(xyz)):
        px, py, pz = xyz[i, 0], xyz[i, 1], xyz[i, 2]
        x = frame[0, 0] * px + frame[0, 1] * py + frame[0, 2] * pz + frame[0, 3]
        y = frame[1, 0] * px + frame[1, 1] * py + frame[1, 2] * pz + frame[1, 3]
        z = frame[2, 0] * px + frame[2, 1] * py + frame[2, 2] * pz + frame[2, 3]
        if abs(x) < half[0] and abs(y) < half[1] and z > lowest:
            found[count] = i
            count += 1
    return found[:count]

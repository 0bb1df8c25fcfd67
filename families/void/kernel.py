"""The numeric surface of a vault, compiled: signed distance, component and normal of many points in one pass.

A void is a union of pieces, a piece an intersection of bodies (`families.declaration.pieces`): the signed distance is
the minimum over pieces of the maximum over bodies, exact near the surface (Ricci 1973, constructive geometry with min
and max).
Positive is in the stone, negative in the room.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import BOX, CENTRE_X, CENTRE_Y, NOTCH, OTHER, REACH, SHAPE, WITHIN
from families.void.body_table import (
    ACROSS_X,
    ACROSS_Y,
    ASIDE,
    BALL,
    BARREL,
    BASE,
    BELOW,
    BENT,
    FOOT,
    HEIGHT,
    KIND,
    LID,
    NAME,
    NAMING,
    ONE,
    PIECE,
    QUARTER,
    R1,
    RADIUS,
    SIDE,
    SLOPE,
    TURNED,
    WEB,
    X,
    Y,
)
from families.void.compiled import apart, compiled, inner
from families.void.profile_distance import to_ball, to_bent, to_profile
from families.void.webs import to_web

Array = NDArray[np.float64]
SAME = 1e-9  # [m] within which two walls are one


@apart
def _aside(x: float, y: float, z: float, parts: Array, k: int) -> tuple[float, float, float, float]:
    """The same of a web, and of a ball or what is turned about another axis than the origin's or as a ring."""
    if parts[k, KIND] == WEB:
        return to_web(x, y, z, parts, k)  # type: ignore[no-any-return]
    x, y, h = x - parts[k, X], y - parts[k, Y], z - parts[k, BASE]
    if parts[k, KIND] == ASIDE:
        return to_ball(x, y, h, parts[k, R1])  # type: ignore[no-any-return]
    rho = sqrt(x * x + y * y)
    sign = 1.0 if rho >= parts[k, RADIUS] else -1.0
    d, nu, nz = to_profile(abs(rho - parts[k, RADIUS]), h, parts, k)
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
            d, nu, nz = to_profile(u, z - parts[k, BASE], parts, k)
            nu *= sign
            return d, nu * cx, nu * cy, nz
        d, nu, nz, na = to_bent(u, along, z, parts, k)
        nu *= sign
        return d, nu * cx - na * cy, nu * cy + na * cx, nz
    if kind == BALL:
        return to_ball(x, y, z - parts[k, BASE], parts[k, R1])  # type: ignore[no-any-return]
    if kind == TURNED:
        rho = sqrt(x * x + y * y)
        d, nu, nz = to_profile(rho, z - parts[k, BASE], parts, k)
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
def slopes(xyz: Array, frame: Array, parts: Array, plan: Array, moved: Array, outlines: Array, steps: Array) -> Array:
    """Derivatives (n, 4 + k) of the distances of points (n, 3) by place, yaw and k parameters.

    moved, outlines: (k, bodies, WIDTH) and (k, sides, 5), the tables with each parameter a step (k,) larger. The body
    that decides a point's distance still does after a small step, so only that one is asked again, if it has changed.
    """
    n, count = len(xyz), len(steps)
    out = np.zeros((n, 4 + count))
    bodies, sides = np.zeros((count, len(parts)), np.bool_), np.zeros((count, len(plan)), np.bool_)
    for k in range(count):
        for row in range(len(parts)):
            bodies[k, row] = (moved[k, row] != parts[row]).any()
        for row in range(len(plan)):
            sides[k, row] = (outlines[k, row] != plan[row]).any()
    at, rows, here = np.empty((n, 3)), np.empty(n, np.int64), np.empty(n)
    for i in range(n):
        x, y, z = _moved(xyz, i, frame)
        _, _, row, nx, ny, nz = _room(x, y, z, parts, plan)
        for k in range(3):
            out[i, k] = -(nx * frame[0, k] + ny * frame[1, k] + nz * frame[2, k])
        out[i, 3] = nx * y - ny * x
        at[i, 0], at[i, 1], at[i, 2], rows[i] = x, y, z, row
        here[i] = _side(x, y, plan, -1 - row) if row < 0 else _body(x, y, z, parts, row)[0]
    for k in range(count):  # outside, for to take a table out of several costs as much as to ask a body
        table, outline = moved[k], outlines[k]
        for i in range(n):
            x, y, z, row = at[i, 0], at[i, 1], at[i, 2], rows[i]
            if row < 0:
                if sides[k, -1 - row]:
                    out[i, 4 + k] = (_side(x, y, outline, -1 - row) - here[i]) / steps[k]
            elif bodies[k, row]:
                there = _body(x, y, z, table, row)[0]
                # A point just above the axis of one side of a barrel may come to lie behind it, where that body ends.
                out[i, 4 + k] = (there - here[i]) / steps[k] if there > -inf else 0.0
    return out


@compiled
def to_rows(xyz: Array, frame: Array, parts: Array, plan: Array, rows: NDArray[np.int64]) -> Array:
    """Signed distances (n,) [m] of points (n, 3), each to the one body in its row, or below 0 to a side."""
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

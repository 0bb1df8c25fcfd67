"""Heights of smooth pieces of surface ("roofs") over the plan, compiled: which one shows, and where two are as high.

Over the plan every body is a height. The surface of a union of intersections is the maximum over pieces of the minimum
over the roofs of each.
"""

from __future__ import annotations

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from families.solid.cell_loops import is_within, middle, place_on, reach
from families.void import body_table
from families.void.compiled import compiled, inner
from families.void.webs import web_height

Array = NDArray[np.float64]

# Columns of a roof's row.
KIND, X0, Y0, CX, CY, BASE, SLOPE, SPLAY, FLARE, CROWN, LENGTH, SIGN, U, Z, A, B = range(16)
WIDTH = 30
FLAT, DRAWN, TURNED, WEB = range(4)  # a web has its other numbers where the numeric surface has them
WEB_X, WEB_Y, WEB_ACROSS_X, WEB_ACROSS_Y = body_table.X, body_table.Y, body_table.ACROSS_X, body_table.ACROSS_Y
ROUNDING = 1e-13  # of a cosine: a root turns it into a height
APEX = 1e-12  # share of a cone's profile that is left at its apex
HALVINGS = 80  # of an interval in which a root is sought
CLOSE = 1e-15  # [m], places nearer than that are one root
STEP = 1e-6  # [m] beside a place, by which slopes are told
DECIDED = 1e-9  # [m], heights nearer than that do not tell which roof shows


@inner
def height_at(x: float, y: float, roofs: Array, k: int) -> float:
    """Height of roof k above a place."""
    kind = roofs[k, KIND]
    if kind == WEB:
        x, y = x - roofs[k, WEB_X], y - roofs[k, WEB_Y]
        tx, ty = roofs[k, WEB_ACROSS_X], roofs[k, WEB_ACROSS_Y]
        return web_height(x * ty - y * tx, x * tx + y * ty, roofs, k)  # type: ignore[no-any-return]
    x, y = x - roofs[k, X0], y - roofs[k, Y0]
    if kind == FLAT:
        return roofs[k, BASE] + roofs[k, CX] * x + roofs[k, CY] * y  # type: ignore[no-any-return]  # numba is untyped
    z, flare = roofs[k, BASE], 1.0
    if kind == DRAWN:
        u = roofs[k, CX] * x + roofs[k, CY] * y
        along = roofs[k, CX] * y - roofs[k, CY] * x
        way = along / roofs[k, LENGTH]
        z += roofs[k, SLOPE] * along + roofs[k, CROWN] * (1.0 - way * way)
        u /= max(1.0 + roofs[k, SPLAY] * along, APEX)
        flare = 1.0 + roofs[k, FLARE] * along
    else:
        u = sqrt(x * x + y * y) - roofs[k, LENGTH]
    cosine = (roofs[k, SIGN] * u - roofs[k, U]) / roofs[k, A]
    root = 0.0 if cosine > 1.0 - ROUNDING else sqrt(max(1.0 - cosine * cosine, 0.0))
    return z + flare * (roofs[k, Z] + roofs[k, B] * root)  # type: ignore[no-any-return]  # numba is untyped


@compiled
def heights(x: Array, y: Array, roofs: Array, k: int) -> Array:
    """Heights (n,) of roof k over places."""
    out = np.empty(len(x))
    for i in range(len(x)):
        out[i] = height_at(x[i], y[i], roofs, k)
    return out


@inner
def shown_at(x: float, y: float, roofs: Array, rows: NDArray[np.int64], pieces: NDArray[np.int64]) -> int:
    """Which of `rows`, in rising order of their `pieces`, shows over a place."""
    best, best_row, i = -inf, -1, 0
    while i < len(rows):
        piece, least, row = pieces[i], inf, -1
        while i < len(rows) and pieces[i] == piece:
            z = height_at(x, y, roofs, rows[i])
            if z < least:
                least, row = z, i
            i += 1
        if least > best:
            best, best_row = least, row
    return best_row


@compiled
def shown(
    x: Array, y: Array, roofs: Array, rows: NDArray[np.int64], pieces: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Index (n,) in `rows` of the roof that shows over places, and whether no other is as high."""
    found, sure = np.empty(len(x), np.int64), np.empty(len(x), np.bool_)
    for i in range(len(x)):
        found[i] = shown_at(x[i], y[i], roofs, rows, pieces)
        z, sure[i] = height_at(x[i], y[i], roofs, rows[found[i]]), True
        for j in range(len(rows)):
            if j != found[i] and abs(height_at(x[i], y[i], roofs, rows[j]) - z) < DECIDED:
                sure[i] = False
    return found, sure


@inner
def _surely(x: float, y: float, roofs: Array, rows: NDArray[np.int64], pieces: NDArray[np.int64]) -> int:
    """Which of `rows` shows over a place, -1 where another is as high."""
    found = shown_at(x, y, roofs, rows, pieces)
    z = height_at(x, y, roofs, rows[found])
    for j in range(len(rows)):
        if j != found and abs(height_at(x, y, roofs, rows[j]) - z) < DECIDED:
            return -1
    return found  # type: ignore[no-any-return]  # numba is untyped


@compiled
def sole(
    parts: Array,
    edge: Array,
    inside: tuple[Array, Array],
    roofs: Array,
    rows: NDArray[np.int64],
    pieces: NDArray[np.int64],
) -> int:
    """The only one of `rows` that shows over a cell, -1 where others do, too, or it cannot be told.

    Looked at are the boundary, at shares of each part, and places between the middle of the cell and it, at shares of
    each part and of the way there.
    """
    found = -1
    for k in range(len(parts)):
        told = False
        for share in edge:
            x, y = place_on(parts[k], parts[k, 9] + share * (parts[k, 10] - parts[k, 9]))
            here = _surely(x, y, roofs, rows, pieces)
            if here < 0:
                continue
            if found >= 0 and here != found:
                return -1
            found, told = here, True
        if not told:
            return -1
    mx, my = middle(parts)
    for k in range(len(parts)):
        for share in inside[0]:
            ex, ey = place_on(parts[k], parts[k, 9] + share * (parts[k, 10] - parts[k, 9]))
            for ray in inside[1]:
                x, y = mx + ray * (ex - mx), my + ray * (ey - my)
                if is_within(x, y, parts):
                    here = _surely(x, y, roofs, rows, pieces)
                    if here >= 0 and here != found:
                        return -1
    return found


@compiled
def between(way: Array, start: float, end: float, shares: Array, upper: Array, a: int, lower: Array, b: int) -> Array:
    """How much higher (n,) roof a of one table is than roof b of another, at shares of a part of a way."""
    out = np.empty(len(shares))
    for i in range(len(shares)):
        x, y = place_on(way, start + shares[i] * (end - start))
        out[i] = height_at(x, y, upper, a) - height_at(x, y, lower, b)
    return out


@compiled
def change(
    way: Array, start: float, end: float, roofs: Array, rows: NDArray[np.int64], pieces: NDArray[np.int64]
) -> tuple[float, int]:
    """Where on a way what shows at `start` first gives way to another, by halving; and what that is."""
    x, y = place_on(way, start)
    first = shown_at(x, y, roofs, rows, pieces)
    x, y = place_on(way, end)
    after = shown_at(x, y, roofs, rows, pieces)
    low, high = start, end
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        x, y = place_on(way, middle)
        here = shown_at(x, y, roofs, rows, pieces)
        if here == first:
            low = middle
        else:
            high, after = middle, here
    return high, after


@inner
def _between(
    start: tuple[float, float], way: tuple[float, float], low: float, high: float, roofs: Array, a: int, b: int
) -> float:
    """How far from a place along a unit vector roofs a and b are as high (Ridders 1979); NaN where that is not told."""
    (x, y), (dx, dy) = start, way
    g0 = height_at(x + low * dx, y + low * dy, roofs, a) - height_at(x + low * dx, y + low * dy, roofs, b)
    g1 = height_at(x + high * dx, y + high * dy, roofs, a) - height_at(x + high * dx, y + high * dy, roofs, b)
    if g0 * g1 > 0.0:
        return np.nan
    here = inf
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        px, py = x + middle * dx, y + middle * dy
        g = height_at(px, py, roofs, a) - height_at(px, py, roofs, b)
        root = sqrt(g * g - g0 * g1)
        before, here = here, middle if root == 0.0 else middle + (middle - low) * (g if g0 > g1 else -g) / root
        if abs(here - before) < CLOSE:
            break
        px, py = x + here * dx, y + here * dy
        there = height_at(px, py, roofs, a) - height_at(px, py, roofs, b)
        if there == 0.0:
            break
        if (g > 0.0) != (there > 0.0):
            low, g0, high, g1 = middle, g, here, there
        elif (g0 > 0.0) != (there > 0.0):
            high, g1 = here, there
        else:
            low, g0 = here, there
    return here


@compiled
def trace(start: Array, end: Array, share: Array, parts: Array, roofs: Array, a: int, b: int) -> Array:
    """Points (n, 3) at which roofs a and b are as high, beside the chord from start to end.

    At each share of the chord the place is sought square to it, within the loop of a cell; NaN where neither end has
    another roof higher than the other end has.
    """
    out = np.empty((len(share), 3))
    x, y = end[0] - start[0], end[1] - start[1]
    size = sqrt(x * x + y * y)
    x, y = x / size, y / size
    for i in range(len(share)):
        px, py = start[0] + share[i] * size * x, start[1] + share[i] * size * y
        if 0.0 < share[i] < 1.0:
            low, high = reach(px, py, -y, x, parts)
            s = _between((px, py), (-y, x), low, high, roofs, a, b)
            px, py = px - y * s, py + x * s
        elif share[i] == 1.0:
            px, py = end[0], end[1]
        out[i, 0], out[i, 1] = px, py
        out[i, 2] = (height_at(px, py, roofs, a) + height_at(px, py, roofs, b)) / 2
    return out


@compiled
def stray(points: Array, roofs: Array, k: int) -> float:
    """The largest distance of points (n, 3) from roof k."""
    most = 0.0
    for i in range(len(points)):
        x, y, z = points[i]
        dx = (height_at(x + STEP, y, roofs, k) - height_at(x - STEP, y, roofs, k)) / (2 * STEP)
        dy = (height_at(x, y + STEP, roofs, k) - height_at(x, y - STEP, roofs, k)) / (2 * STEP)
        most = max(most, abs(height_at(x, y, roofs, k) - z) / sqrt(1.0 + dx * dx + dy * dy))
    return most

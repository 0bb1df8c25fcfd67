"""Heights of smooth pieces of surface ("roofs") over the plan, compiled: which one shows, and where two are as high.

Over the plan every body is a height. The surface of a union of intersections is the maximum over pieces of the minimum
over the roofs of each.
"""

from __future__ import annotations

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from families.void import kernel
from families.void.kernel import compiled, inner, web_height

Array = NDArray[np.float64]

# Columns of a roof's row.
KIND, X0, Y0, CX, CY, BASE, SLOPE, SPLAY, FLARE, CROWN, LENGTH, SIGN, U, Z, A, B = range(16)
WIDTH = 30
FLAT, DRAWN, TURNED, WEB = range(4)  # a web has its other numbers where the numeric surface has them
WEB_X, WEB_Y, WEB_ACROSS_X, WEB_ACROSS_Y = kernel.X, kernel.Y, kernel.ACROSS_X, kernel.ACROSS_Y
ROUNDING = 1e-13  # of a cosine: a root turns it into a height
APEX = 1e-12  # share of a cone's profile that is left at its apex
HALVINGS = 80  # of an interval in which a root is sought
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
def _on(way: Array, t: float) -> tuple[float, float]:
    """A place on a way: (x0, y0, x1, y1) of a line, or with (cx, cy, radius, start, sweep) behind them of an arc."""
    if way[6] == 0.0:
        return way[0] + t * (way[2] - way[0]), way[1] + t * (way[3] - way[1])
    angle = way[7] + t * way[8]
    return way[4] + way[6] * np.cos(angle), way[5] + way[6] * np.sin(angle)


@compiled
def outline(parts: Array, shares: Array) -> tuple[Array, Array]:
    """Places along parts of ways, each at all shares; behind a part's way stand its start and end."""
    count = len(shares)
    x, y = np.empty(len(parts) * count), np.empty(len(parts) * count)
    for k in range(len(parts)):
        for i in range(count):
            t = parts[k, 9] + shares[i] * (parts[k, 10] - parts[k, 9])
            x[k * count + i], y[k * count + i] = _on(parts[k], t)
    return x, y


@compiled
def within(parts: Array, x: Array, y: Array) -> NDArray[np.bool_]:
    """Whether places (n,) lie on the inner side of all parts of a loop."""
    out = np.ones(len(x), np.bool_)
    for i in range(len(x)):
        for k in range(len(parts)):
            forward = parts[k, 10] > parts[k, 9]
            if parts[k, 6] == 0.0:
                dx, dy = parts[k, 2] - parts[k, 0], parts[k, 3] - parts[k, 1]
                inner_side = dx * (y[i] - parts[k, 1]) - dy * (x[i] - parts[k, 0]) > 0.0
                out[i] &= inner_side == forward
            else:
                dx, dy = x[i] - parts[k, 4], y[i] - parts[k, 5]
                inner_side = dx * dx + dy * dy < parts[k, 6] * parts[k, 6]
                out[i] &= inner_side == ((parts[k, 8] > 0.0) == forward)
    return out


@compiled
def change(
    way: Array, start: float, end: float, roofs: Array, rows: NDArray[np.int64], pieces: NDArray[np.int64]
) -> tuple[float, int]:
    """Where on a way what shows at `start` first gives way to another, by halving; and what that is."""
    x, y = _on(way, start)
    first = shown_at(x, y, roofs, rows, pieces)
    x, y = _on(way, end)
    after = shown_at(x, y, roofs, rows, pieces)
    low, high = start, end
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        x, y = _on(way, middle)
        here = shown_at(x, y, roofs, rows, pieces)
        if here == first:
            low = middle
        else:
            high, after = middle, here
    return high, after


@compiled
def trace(start: Array, end: Array, share: Array, low: Array, high: Array, roofs: Array, a: int, b: int) -> Array:
    """Places (n, 2) at which roofs a and b are as high, beside the chord from start to end.

    At each share of the chord the place is sought square to it, `low` to `high` [m] to its left, by halving; NaN where
    neither end has another roof higher than the other end has.
    """
    out = np.empty((len(share), 2))
    x, y = end[0] - start[0], end[1] - start[1]
    size = sqrt(x * x + y * y)
    x, y = x / size, y / size
    for i in range(len(share)):
        px, py = start[0] + share[i] * size * x, start[1] + share[i] * size * y
        s0, s1 = low[i], high[i]
        g0 = height_at(px - y * s0, py + x * s0, roofs, a) - height_at(px - y * s0, py + x * s0, roofs, b)
        g1 = height_at(px - y * s1, py + x * s1, roofs, a) - height_at(px - y * s1, py + x * s1, roofs, b)
        if g0 * g1 > 0.0:
            out[i] = np.nan
            continue
        for n in range(HALVINGS):
            # Regula falsi in turn with halving: few steps where the difference is smooth, never many.
            s = (s0 + s1) / 2 if n % 3 == 2 or g1 == g0 else s0 - g0 * (s1 - s0) / (g1 - g0)
            if not (s0 < s < s1 or s1 < s < s0):
                s = (s0 + s1) / 2
                if s in (s0, s1):
                    break
            qx, qy = px - y * s, py + x * s
            g = height_at(qx, qy, roofs, a) - height_at(qx, qy, roofs, b)
            if g == 0.0:
                s0 = s1 = s
                break
            if (g > 0.0) == (g0 > 0.0):
                s0, g0 = s, g
            else:
                s1, g1 = s, g
            if abs(s1 - s0) < 1e-15:
                break
        s = (s0 + s1) / 2
        out[i, 0], out[i, 1] = px - y * s, py + x * s
    return out

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
CORNER = 1e-9  # [rad] beyond its ends, to which an arc reaches
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


@inner
def _within(x: float, y: float, parts: Array) -> bool:
    """Whether a place lies on the inner side of all parts of a loop."""
    for k in range(len(parts)):
        forward = parts[k, 10] > parts[k, 9]
        if parts[k, 6] == 0.0:
            dx, dy = parts[k, 2] - parts[k, 0], parts[k, 3] - parts[k, 1]
            if (dx * (y - parts[k, 1]) - dy * (x - parts[k, 0]) > 0.0) != forward:
                return False
        else:
            dx, dy = x - parts[k, 4], y - parts[k, 5]
            if (dx * dx + dy * dy < parts[k, 6] * parts[k, 6]) != ((parts[k, 8] > 0.0) == forward):
                return False
    return True


@compiled
def within(parts: Array, x: Array, y: Array) -> NDArray[np.bool_]:
    """Whether places (n,) lie on the inner side of all parts of a loop."""
    out = np.empty(len(x), np.bool_)
    for i in range(len(x)):
        out[i] = _within(x[i], y[i], parts)
    return out


@compiled
def middle(parts: Array) -> tuple[float, float]:
    """A place well within a loop: the middle or, where an arc bends into it, that of a chord far from the boundary."""
    mx = my = 0.0
    bulges = False
    for k in range(len(parts)):
        bulges |= parts[k, 6] != 0.0 and parts[k, 8] * (parts[k, 10] - parts[k, 9]) < 0.0
        for share in (0.0, 0.5):
            x, y = _on(parts[k], parts[k, 9] + share * (parts[k, 10] - parts[k, 9]))
            mx, my = mx + x / (2 * len(parts)), my + y / (2 * len(parts))
    if not bulges:
        return mx, my
    xs, ys = outline(parts, np.arange(8) / 8)
    n = len(xs)
    found, most = (mx, my), -1.0
    for chord in range(-1, 3 * n):
        k, j = chord // 3, (n // 2, n // 3, n // 4)[chord % 3]
        x, y = (mx, my) if chord < 0 else ((xs[k] + xs[(k + j) % n]) / 2, (ys[k] + ys[(k + j) % n]) / 2)
        if _within(x, y, parts):
            room = ((xs - x) ** 2 + (ys - y) ** 2).min()
            if room > most:
                found, most = (x, y), room
    return found


@compiled
def between(way: Array, start: float, end: float, shares: Array, upper: Array, a: int, lower: Array, b: int) -> Array:
    """How much higher (n,) roof a of one table is than roof b of another, at shares of a part of a way."""
    out = np.empty(len(shares))
    for i in range(len(shares)):
        x, y = _on(way, start + shares[i] * (end - start))
        out[i] = height_at(x, y, upper, a) - height_at(x, y, lower, b)
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


@inner
def _reach(x: float, y: float, dx: float, dy: float, parts: Array) -> tuple[float, float]:
    """How far the boundary of a loop lies behind and ahead of a place along a unit vector; 0 where there is none."""
    low, high = -inf, inf
    for k in range(len(parts)):
        way, start, end = parts[k], parts[k, 9], parts[k, 10]
        if way[6] == 0.0:
            (ax, ay), (bx, by) = _on(way, start), _on(way, end)
            before, after = (ay - y) * dx - (ax - x) * dy, (by - y) * dx - (bx - x) * dy
            if before == after or min(before, after) > 0.0 or max(before, after) < 0.0:
                continue
            share = before / (before - after)
            first = last = (ax + share * (bx - ax) - x) * dx + (ay + share * (by - ay) - y) * dy
        else:
            px, py = x - way[4], y - way[5]
            middle = dx * px + dy * py
            square = middle * middle - px * px - py * py + way[6] * way[6]
            if square < 0.0:
                continue
            first, last = -middle - sqrt(square), -middle + sqrt(square)
        for s in (first, last):
            if way[6] != 0.0:
                angle = np.arctan2(y + s * dy - way[5], x + s * dx - way[4]) - way[7] - (start + end) / 2 * way[8]
                off = (angle + np.pi) % (2 * np.pi) - np.pi
                if abs(off) > abs((end - start) / 2 * way[8]) + CORNER:
                    continue
            if s <= 0.0:
                low = max(low, s)
            if s >= 0.0:
                high = min(high, s)
    return (0.0 if low == -inf else low), (0.0 if high == inf else high)


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
            low, high = _reach(px, py, -y, x, parts)
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

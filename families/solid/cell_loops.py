"""Loops of parts of ways about cells of the plan, compiled: a row a part, its way as numbers, its start and its end."""

from __future__ import annotations

from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray

from families.void.compiled import compiled, inner

Array = NDArray[np.float64]

CORNER = 1e-9  # [rad] beyond its ends, to which an arc reaches


@inner
def place_on(way: Array, t: float) -> tuple[float, float]:
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
            x[k * count + i], y[k * count + i] = place_on(parts[k], t)
    return x, y


@inner
def is_within(x: float, y: float, parts: Array) -> bool:
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
        out[i] = is_within(x[i], y[i], parts)
    return out


@compiled
def middle(parts: Array) -> tuple[float, float]:
    """A place well within a loop: the middle or, where an arc bends into it, that of a chord far from the boundary."""
    mx = my = 0.0
    bulges = False
    for k in range(len(parts)):
        bulges |= parts[k, 6] != 0.0 and parts[k, 8] * (parts[k, 10] - parts[k, 9]) < 0.0
        for share in (0.0, 0.5):
            x, y = place_on(parts[k], parts[k, 9] + share * (parts[k, 10] - parts[k, 9]))
            mx, my = mx + x / (2 * len(parts)), my + y / (2 * len(parts))
    if not bulges:
        return mx, my
    xs, ys = outline(parts, np.arange(8) / 8)
    n = len(xs)
    found, most = (mx, my), -1.0
    for chord in range(-1, 3 * n):
        k, j = chord // 3, (n // 2, n // 3, n // 4)[chord % 3]
        x, y = (mx, my) if chord < 0 else ((xs[k] + xs[(k + j) % n]) / 2, (ys[k] + ys[(k + j) % n]) / 2)
        if is_within(x, y, parts):
            room = ((xs - x) ** 2 + (ys - y) ** 2).min()
            if room > most:
                found, most = (x, y), room
    return found


@inner
def reach(x: float, y: float, dx: float, dy: float, parts: Array) -> tuple[float, float]:
    """How far the boundary of a loop lies behind and ahead of a place along a unit vector; 0 where there is none."""
    low, high = -inf, inf
    for k in range(len(parts)):
        way, start, end = parts[k], parts[k, 9], parts[k, 10]
        if way[6] == 0.0:
            (ax, ay), (bx, by) = place_on(way, start), place_on(way, end)
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

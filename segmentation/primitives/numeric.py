"""The five primitives as flat numbers, compiled: signed distance and gradient.

A primitive is an integer kind and a row of 8 floats: point (3), unit direction (3), and two sizes:

| kind | point | direction | size 6 | size 7 |
|---|---|---|---|---|
| PLANE | a point on it | normal | | |
| SPHERE | centre | | radius [m] | |
| CYLINDER | on the axis | axis | radius [m] | |
| CONE | apex | axis, into the nappe | half angle [rad] | |
| TORUS | centre | axis | major radius [m] | minor radius [m] |

Distances are positive outside (on the side of a plane's normal). Every loop is written out in scalars: numba's array
expressions would cost ten times the compilation.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

PLANE, SPHERE, CYLINDER, CONE, TORUS = range(5)
_TINY = 1e-12

Floats = NDArray[np.float64]


@njit(cache=True, nogil=True)
def gradient(kind: int, row: Floats, x: float, y: float, z: float) -> tuple[float, float, float, float]:
    """Signed distance [m] of one point and the unit normal there; the normal is zero where there is none (a centre, an
    axis).
    """
    a, b, c = row[3], row[4], row[5]
    x -= row[0]
    y -= row[1]
    z -= row[2]
    if kind == PLANE:
        return x * a + y * b + z * c, a, b, c
    if kind == SPHERE:
        length = math.sqrt(x * x + y * y + z * z)
        scale = 1.0 / length if length > _TINY else 0.0
        return length - row[6], x * scale, y * scale, z * scale
    height = x * a + y * b + z * c
    x -= height * a
    y -= height * b
    z -= height * c
    radial = math.sqrt(x * x + y * y + z * z)
    scale = 1.0 / radial if radial > _TINY else 0.0
    x *= scale
    y *= scale
    z *= scale
    if kind == CYLINDER:
        return radial - row[6], x, y, z
    if kind == CONE:
        along, across = math.cos(row[6]), math.sin(row[6])
        if height * along + radial * across < 0.0:
            length = math.hypot(radial, height)
            u = radial / length if length > _TINY else 0.0
            v = height / length if length > _TINY else 0.0
            return length, u * x + v * a, u * y + v * b, u * z + v * c
        return (
            radial * along - height * across,
            along * x - across * a,
            along * y - across * b,
            along * z - across * c,
        )
    tube = math.hypot(radial - row[6], height)
    u = (radial - row[6]) / tube if tube > _TINY else 0.0
    v = height / tube if tube > _TINY else 0.0
    return tube - row[7], u * x + v * a, u * y + v * b, u * z + v * c


@njit(cache=True, nogil=True)
def distances(kinds: NDArray[np.int64], rows: Floats, xyz: Floats, out: Floats, start: int, stop: int) -> None:
    """Signed distances (k, n) [m] of points (n, 3) to k primitives, of the points from `start` to `stop`."""
    for k in range(len(kinds)):
        for i in range(start, stop):
            out[k, i] = gradient(kinds[k], rows[k], xyz[i, 0], xyz[i, 1], xyz[i, 2])[0]


@njit(cache=True, nogil=True)
def supports(
    kinds: NDArray[np.int64],
    rows: Floats,
    xyz: Floats,
    normals: Floats,
    epsilon: float,
    cos_alpha: float,
    out: Floats,
    start: int,
    stop: int,
) -> None:
    """How well each primitive explains each point (k, n): 1 within epsilon / 2, falling to 0 at epsilon; 0 beyond
    alpha.

    A normal that is NaN is always right.
    """
    for k in range(len(kinds)):
        for i in range(start, stop):
            d, a, b, c = gradient(kinds[k], rows[k], xyz[i, 0], xyz[i, 1], xyz[i, 2])
            cosine = abs(a * normals[i, 0] + b * normals[i, 1] + c * normals[i, 2])
            share = 0.0 if cosine < cos_alpha else 2.0 - 2.0 * abs(d) / epsilon
            out[k, i] = min(max(share, 0.0), 1.0)


@njit(cache=True, nogil=True)
def tukey(
    kinds: NDArray[np.int64],
    rows: Floats,
    xyz: Floats,
    normals: Floats,
    owner: NDArray[np.int64],
    epsilon: float,
    cos_alpha: float,
    out: Floats,
) -> None:
    """Weights (t,) of points (t, 3) for the primitives `owner` (t,): Tukey's biweight of the distance; 0 beyond
    alpha.
    """
    for i in range(len(owner)):
        k = owner[i]
        d, a, b, c = gradient(kinds[k], rows[k], xyz[i, 0], xyz[i, 1], xyz[i, 2])
        cosine = abs(a * normals[i, 0] + b * normals[i, 1] + c * normals[i, 2])
        near = 0.0 if cosine < cos_alpha else max(1.0 - (d / epsilon) ** 2, 0.0)
        out[i] = near * near


@njit(cache=True, nogil=True)
def compete(
    kinds: NDArray[np.int64],
    rows: Floats,
    xyz: Floats,
    normals: Floats,
    epsilon: float,
    cos_alpha: float,
    normal_price: float,
    winner: NDArray[np.int64],
    own: Floats,
    rival: Floats,
    start: int,
    stop: int,
) -> None:
    """The cheapest primitive (n,) of each point, -1 where none is within epsilon and alpha, its price and the next
    one's.

    A price is the squared distance over epsilon, plus `normal_price` for a normal that deviates by alpha; inf without
    one.
    """
    for i in range(start, stop):
        winner[i], own[i], rival[i] = -1, math.inf, math.inf
        for k in range(len(kinds)):
            d, a, b, c = gradient(kinds[k], rows[k], xyz[i, 0], xyz[i, 1], xyz[i, 2])
            cosine = abs(a * normals[i, 0] + b * normals[i, 1] + c * normals[i, 2])
            if not abs(d) <= epsilon or cosine < cos_alpha:
                continue
            price = (d / epsilon) ** 2
            if cosine < 1.0:
                price += normal_price * (1.0 - cosine) / (1.0 - cos_alpha)
            if price < own[i]:
                winner[i], own[i], rival[i] = k, price, own[i]
            elif price < rival[i]:
                rival[i] = price


@njit(cache=True, nogil=True)
def gradients(kind: int, row: Floats, xyz: Floats, distance: Floats, normal: Floats) -> None:
    """Signed distances (n,) [m] of points (n, 3) to one primitive and its unit normals (n, 3) there."""
    for i in range(len(xyz)):
        distance[i], normal[i, 0], normal[i, 1], normal[i, 2] = gradient(kind, row, xyz[i, 0], xyz[i, 1], xyz[i, 2])

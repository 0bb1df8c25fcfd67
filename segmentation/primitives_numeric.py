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
def residuals(
    kinds: NDArray[np.int64],
    rows: Floats,
    xyz: Floats,
    normals: Floats,
    distance: Floats,
    cosine: Floats,
    start: int,
    stop: int,
) -> None:
    """Signed distances (k, n) [m] of points (n, 3) to k primitives, and |cos| (k, n) between the normals of both.

    Only of the points from `start` to `stop`, so that threads share the work. With normals (0, 3) only distances are
    written. A normal that is NaN gives a NaN cosine.
    """
    for k in range(len(kinds)):
        for i in range(start, stop):
            d, a, b, c = gradient(kinds[k], rows[k], xyz[i, 0], xyz[i, 1], xyz[i, 2])
            distance[k, i] = d
            if len(normals) > 0:
                cosine[k, i] = abs(a * normals[i, 0] + b * normals[i, 1] + c * normals[i, 2])


@njit(cache=True, nogil=True)
def gradients(kind: int, row: Floats, xyz: Floats, distance: Floats, normal: Floats) -> None:
    """Signed distances (n,) [m] of points (n, 3) to one primitive and its unit normals (n, 3) there."""
    for i in range(len(xyz)):
        distance[i], normal[i, 0], normal[i, 1], normal[i, 2] = gradient(kind, row, xyz[i, 0], xyz[i, 1], xyz[i, 2])

"""Minimal sets: the primitives through a few points with normals, many sets at a time.

Each function takes points and unit normals (s, k, 3) of s sets and gives rows (s, 8) as in `primitives_numeric` and a
mask (s,) of the sets that are not degenerate. No sign of a normal matters. Source: Schnabel, Wahl and Klein 2007,
"Efficient RANSAC for Point-Cloud Shape Detection", section 4.1.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Rows = tuple[Floats, Mask]


def _dot(a: Floats, b: Floats) -> Floats:
    product: Floats = np.einsum("...i,...i->...", a, b)
    return product


def _length(a: Floats) -> Floats:
    length: Floats = np.sqrt(_dot(a, a))
    return length


def cross(a: Floats, b: Floats) -> Floats:
    """Vector products (..., 3), several times as quick as numpy's on short arrays."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    return np.stack((y * w - z * v, z * u - x * w, x * v - y * u), axis=-1)


def _rows(point: Floats, direction: Floats | None, *sizes: Floats) -> Floats:
    rows = np.zeros((len(point), 8))
    rows[:, :3] = point
    if direction is not None:
        rows[:, 3:6] = direction
    for column, size in enumerate(sizes, start=6):
        rows[:, column] = size
    return rows


def _line_meeting(p: Floats, u: Floats, q: Floats, v: Floats) -> tuple[Floats, Floats, Mask]:
    """Parameters of the mutually nearest points of the lines p + s u and q + t v; False where they are parallel."""
    cosine = _dot(u, v)
    sine2 = 1.0 - cosine**2
    apart = sine2 > 1e-6
    sine2 = np.where(apart, sine2, 1.0)
    w = q - p
    wu, wv = _dot(w, u), _dot(w, v)
    return (wu - cosine * wv) / sine2, (cosine * wu - wv) / sine2, apart


def _plane(p: Floats, n: Floats) -> Rows:
    a, b = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    normal = cross(a, b)
    length = _length(normal)
    whole = length > 1e-3 * np.maximum(_dot(a, a), _dot(b, b))
    return _rows(p.mean(axis=1), normal / np.where(whole, length, 1.0)[:, None]), whole


def _sphere(p: Floats, n: Floats) -> Rows:
    s, t, whole = _line_meeting(p[:, 0], n[:, 0], p[:, 1], n[:, 1])
    centre = 0.5 * (p[:, 0] + s[:, None] * n[:, 0] + p[:, 1] + t[:, None] * n[:, 1])
    radius = 0.5 * (_length(p[:, 0] - centre) + _length(p[:, 1] - centre))
    return _rows(centre, None, radius), whole & (radius > 0.0)


def _cylinder(p: Floats, n: Floats) -> Rows:
    axis = cross(n[:, 0], n[:, 1])
    length = _length(axis)
    axis = axis / np.where(length > 0.0, length, 1.0)[:, None]
    offset = _dot(p[:, 1] - p[:, 0], axis)[:, None] * axis
    q = p[:, 1] - offset
    s, t, whole = _line_meeting(p[:, 0], n[:, 0], q, n[:, 1])
    centre = 0.5 * (p[:, 0] + s[:, None] * n[:, 0] + q + t[:, None] * n[:, 1]) + 0.5 * offset
    radius = 0.5 * (np.abs(s) + np.abs(t))
    return _rows(centre, axis, radius), whole & (radius > 0.0)


def _cone(p: Floats, n: Floats) -> Rows:
    planes = np.stack((cross(n[:, 1], n[:, 2]), cross(n[:, 2], n[:, 0]), cross(n[:, 0], n[:, 1])), axis=1)
    det = _dot(n[:, 0], planes[:, 0])
    whole = np.abs(det) > 1e-4
    apex = (_dot(n, p)[..., None] * planes).sum(axis=1) / np.where(whole, det, 1.0)[:, None]
    rays = p - apex[:, None]
    lengths = _length(rays)
    whole &= (lengths > 1e-9).all(axis=1)
    rays = rays / np.where(lengths > 0.0, lengths, 1.0)[..., None]
    axis = cross(rays[:, 1] - rays[:, 0], rays[:, 2] - rays[:, 0])
    length = _length(axis)
    whole &= length > 1e-6
    axis = axis / np.where(length > 0.0, length, 1.0)[:, None]
    axis = np.where(_dot(rays[:, 0], axis) < 0.0, -1.0, 1.0)[:, None] * axis
    angle = np.arccos(np.clip(_dot(rays, axis[:, None]), -1.0, 1.0)).mean(axis=1)
    return _rows(apex, axis, angle), whole & (angle > 0.02) & (angle < 1.55)


def _torus(p: Floats, n: Floats) -> Rows:
    """The axis meets all normal lines: the points of line 0 from which one straight line meets lines 1, 2 and 3 solve a
    quadratic.
    """
    step = _length(p[:, 1] - p[:, 0])[:, None] * n[:, 0]

    def transversal(s: Floats) -> tuple[Floats, Floats, Floats]:
        x = p[:, 0] + s[:, None] * step
        sides = [cross(x - p[:, i], n[:, i]) for i in (1, 2, 3)]
        axis = cross(sides[0], sides[1])
        return x, axis, _dot(axis, sides[2])

    low, mid, high = (transversal(np.full(len(p), s))[2] for s in (-1.0, 0.0, 1.0))
    a, b = 0.5 * (low + high) - mid, 0.5 * (high - low)
    discriminant = b * b - 4.0 * a * mid
    real = (discriminant >= 0.0) & (a != 0.0)
    root, a = np.sqrt(np.where(real, discriminant, 0.0)), np.where(real, a, 1.0)
    trials = [_torus_about(p, *transversal((-b + sign * root) / (2.0 * a))[:2]) for sign in (-1.0, 1.0)]
    first = trials[0][1] <= trials[1][1]
    rows = np.where(first[:, None], trials[0][0], trials[1][0])
    return rows, real & np.isfinite(np.minimum(trials[0][1], trials[1][1]))


def _torus_about(p: Floats, origin: Floats, axis: Floats) -> tuple[Floats, Floats]:
    """Tori with known axes by the circle in the meridian half plane; errors (s,) [m] at the fourth points, inf where
    there is none.
    """
    length = _length(axis)
    whole = length > 0.0
    axis = axis / np.where(whole, length, 1.0)[:, None]
    v = p - origin[:, None]
    height = _dot(v, axis[:, None])
    radial = _length(v - height[..., None] * axis[:, None])
    ax, ay = radial[:, 1] - radial[:, 0], height[:, 1] - height[:, 0]
    bx, by = radial[:, 2] - radial[:, 0], height[:, 2] - height[:, 0]
    a2, b2, det = ax**2 + ay**2, bx**2 + by**2, 2.0 * (ax * by - ay * bx)
    whole &= np.abs(det) > 1e-9 * (a2 + b2)
    det = np.where(whole, det, 1.0)
    across, along = (by * a2 - ay * b2) / det, (ax * b2 - bx * a2) / det
    major, minor = radial[:, 0] + across, np.hypot(across, along)
    whole &= (major > 0.0) & (minor > 0.0)
    rows = _rows(origin + (height[:, 0] + along)[:, None] * axis, axis, major, minor)
    error = np.abs(np.hypot(radial[:, 3] - major, height[:, 3] - height[:, 0] - along) - minor)
    return rows, np.where(whole, error, np.inf)


class MinimalSet(NamedTuple):
    """How many points with normals define a kind, and the function that does."""

    size: int
    function: Callable[[Floats, Floats], Rows]

    def rows(self, points: Floats, normals: Floats) -> Rows:
        """Rows (s, 8) through s sets of points and normals (s, size, 3), and which of them (s,) are primitives."""
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            rows, whole = self.function(points, normals)
        return rows, whole & np.isfinite(rows).all(axis=1)


MINIMAL_SETS = (  # the index is the kind
    MinimalSet(3, _plane),
    MinimalSet(2, _sphere),
    MinimalSet(2, _cylinder),
    MinimalSet(3, _cone),
    MinimalSet(4, _torus),
)

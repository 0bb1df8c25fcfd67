"""Triangles of a scene to be scanned, and the few bodies that furnish it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangle mesh [m]; each triangle has the component of the vault that it shows (0: none) and a reflectance."""

    vertices: Array  # (v, 3)
    triangles: NDArray[np.int64]  # (t, 3)
    component: NDArray[np.uint16]  # (t,)
    reflectance: NDArray[np.float32]  # (t,) 0..1


def plain(vertices: Array, triangles: NDArray[np.integer], reflectance: float) -> Triangles:
    """Triangles that show no vault."""
    count = len(triangles)
    component, bright = np.zeros(count, np.uint16), np.full(count, reflectance, np.float32)
    return Triangles(vertices, triangles.astype(np.int64), component, bright)


def join(parts: Iterable[Triangles]) -> Triangles:
    """All in one."""
    parts = list(parts)
    starts = np.cumsum([0, *(len(p.vertices) for p in parts)])
    return Triangles(
        np.concatenate([p.vertices for p in parts]),
        np.concatenate([p.triangles + start for p, start in zip(parts, starts, strict=False)]),
        np.concatenate([p.component for p in parts]),
        np.concatenate([p.reflectance for p in parts]),
    )


def rectangle(corner: ArrayLike, u: ArrayLike, v: ArrayLike, reflectance: float) -> Triangles:
    """The rectangle from `corner` along the edges u and v (3,) [m]."""
    c, eu, ev = (np.asarray(a, np.float64) for a in (corner, u, v))
    return plain(np.array([c, c + eu, c + eu + ev, c + ev]), np.array([[0, 1, 2], [0, 2, 3]]), reflectance)


def box(low: Sequence[float], high: Sequence[float], reflectance: float) -> Triangles:
    """Closed box between two corners [m], along the axes."""
    return prism([(x, y) for x in (low[0], high[0]) for y in (low[1], high[1])], (low[2], high[2]), reflectance)


def prism(corners: Iterable[ArrayLike], levels: tuple[float, float], reflectance: float) -> Triangles:
    """Closed upright prism over the four corners (2,) [m] of about a rectangle, in any order, between two levels."""
    # From left to right, those in the middle are neither on one edge.
    plan = sorted(tuple(np.asarray(corner, np.float64).tolist()) for corner in corners)
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]
    return plain(np.array([[*xy, z] for xy in plan for z in levels]), np.array(triangles), reflectance)


def tube(
    start: ArrayLike, end: ArrayLike, radii: tuple[float, float], reflectance: float, sides: int = 16
) -> Triangles:
    """Open frustum from `start` to `end` (3,) [m] with a radius at either."""
    a, b = np.asarray(start, np.float64), np.asarray(end, np.float64)
    axis = (b - a) / np.linalg.norm(b - a)
    across = np.cross(axis, [1.0, 0, 0] if abs(axis[0]) < 0.9 else [0, 1.0, 0])
    across /= np.linalg.norm(across)
    angle = np.arange(sides) * (2 * np.pi / sides)
    ring = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * np.cross(axis, across)
    k, n = np.arange(sides), (np.arange(sides) + 1) % sides
    triangles = np.concatenate([np.column_stack([k, n, n + sides]), np.column_stack([k, n + sides, k + sides])])
    return plain(np.concatenate([a + radii[0] * ring, b + radii[1] * ring]), triangles, reflectance)


def split(mesh: Triangles, longest: float) -> Triangles:
    """The same surface with no edge longer than `longest` [m].

    Edges are halved by their length alone, so that triangles which share an edge go on sharing its points.
    """
    xyz, tri, source = mesh.vertices, mesh.triangles, np.arange(len(mesh.triangles))
    while True:
        a, b = tri, tri[:, [1, 2, 0]]
        squared = ((xyz[a] - xyz[b]) ** 2).sum(2)
        marked = squared > longest**2
        if not marked.any():
            return Triangles(xyz, tri, mesh.component[source], mesh.reflectance[source])
        keys = np.minimum(a, b)[marked] * len(xyz) + np.maximum(a, b)[marked]
        edges, index = np.unique(keys, return_inverse=True)
        middle = np.full(tri.shape, -1)
        middle[marked] = len(xyz) + index
        xyz = np.concatenate([xyz, (xyz[edges // len(xyz)] + xyz[edges % len(xyz)]) / 2])
        tri, source = _divide(tri, middle, source)


def _divide(
    tri: NDArray[np.int64], middle: NDArray[np.int64], source: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles split at the given middles (-1: none) of their edges 01, 12, 20; and where each came from."""
    out, origin = [], []
    code = (middle >= 0) @ np.array([1, 2, 4])
    for bits, (turn, pieces) in _PATTERNS.items():
        rows = np.flatnonzero(code == bits)
        corners = np.roll(tri[rows], -turn, 1)
        names = np.concatenate([corners, np.roll(middle[rows], -turn, 1)], 1)
        for piece in pieces:
            out.append(names[:, piece])
            origin.append(source[rows])
    return np.concatenate(out), np.concatenate(origin)


# Which edges are halved (bits 1, 2, 4) -> how far to turn the corners, and the pieces: 0 1 2 corners, 3 4 5 middles.
_ONE = ([0, 3, 2], [3, 1, 2])
_TWO = ([3, 1, 4], [0, 3, 4], [0, 4, 2])
_PATTERNS: dict[int, tuple[int, tuple[list[int], ...]]] = {
    0: (0, ([0, 1, 2],)),
    1: (0, _ONE),
    2: (1, _ONE),
    4: (2, _ONE),
    3: (0, _TWO),
    6: (1, _TWO),
    5: (2, _TWO),
    7: (0, ([0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5])),
}

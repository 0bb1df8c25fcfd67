"""How a patch is laid flat: coordinates on the surface to places (s, t) on a sheet [m], and back.

Planes, cylinders and cones keep all lengths. What is turned lies as gores of a polyconic projection: the middle
meridian is straight and as long as it is, parallels are arcs as long as they are, bent as the cone that touches there
bends them (Snyder 1987, "Map projections", ch. 18). Any other surface is a strip: its middle line and all lines across
it keep their lengths, their angles and their curvature within the surface; on developable ones that keeps all lengths.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from families.unrolled.grid_spline import GridSpline
from families.unrolled.patches import Array, Box, DrawnPatch, LevelPatch, Patch, TurnedPatch

if TYPE_CHECKING:
    from scipy.spatial import KDTree

NODES, ACROSS = 193, 17  # of the net of a strip: along it, and across, an odd number
SEEDS = 33  # of the net from whose nearest node the way back begins, either way
STEP = 1e-6  # of differences on the way back, as a share of the box
TURNS = 60  # steps on the way back at the most
NEAR = 1e-10  # [m] at which it is done
DAMPING, STUCK, TINY = 1e-6, 1e8, 1e-18  # of its steps: the first, what means that none is left, and against none
GAIN = 0.999  # of the distance, that has to be left at the most for a step to be taken


class Development(ABC):
    """A patch, or a gore of it, laid flat: coordinates within a box to places on a sheet of its own."""

    box: Box
    kind: ClassVar[str]

    @abstractmethod
    def flat(self, a: Array, b: Array) -> Array:
        """Places (n, 2) [m] of coordinates (n,)."""

    def coordinates(self, st: Array) -> tuple[Array, Array]:
        """Coordinates (n,), (n,) within the box of places (n, 2), or of the nearest there are.

        Damped Newton steps (Marquardt 1963), as some lines run together at poles and where webs end.
        """
        a0, a1, b0, b1 = self.box
        low, size = np.array([a0, b0]), np.array([a1 - a0, b1 - b0])

        def placed(share: Array) -> Array:
            return self.flat(*(low + size * share).T)

        seeds, tree = self._seeds
        at = seeds[tree.query(st)[1]]
        miss = placed(at) - st
        damping = np.full(len(st), DAMPING)
        open_ = np.arange(len(st))
        for _ in range(TURNS):
            open_ = open_[(np.hypot(*miss[open_].T) > NEAR) & (damping[open_] < STUCK)]
            if not len(open_):
                break
            here, off = at[open_], miss[open_]
            inward = np.where(here > 0.5, -STEP, STEP)
            along, across = (
                (placed(here + inward * way) - off - st[open_]) / inward[:, k, None] for k, way in enumerate(np.eye(2))
            )
            p, q, r = (along**2).sum(axis=1), (along * across).sum(axis=1), (across**2).sum(axis=1)
            p, r = p * (1 + damping[open_]) + TINY, r * (1 + damping[open_]) + TINY
            f, g = (along * off).sum(axis=1), (across * off).sum(axis=1)
            step = -np.stack([r * f - q * g, p * g - q * f], axis=1) / (p * r - q * q)[:, None]
            # At the border of the box a step that leads out goes along it.
            out = ((here <= 0) & (step < 0)) | ((here >= 1) & (step > 0))
            step[out[:, 0], 1] = (-g / r)[out[:, 0]]
            step[out[:, 1], 0] = (-f / p)[out[:, 1]]
            moved = np.clip(here + step, 0.0, 1.0)
            then = placed(moved) - st[open_]
            nearer = np.hypot(*then.T) < GAIN * np.hypot(*off.T)
            at[open_[nearer]], miss[open_[nearer]] = moved[nearer], then[nearer]
            damping[open_] = np.where(nearer, damping[open_] / 10, np.maximum(damping[open_], DAMPING) * 10)
        a, b = (low + size * at).T
        return a, b

    @cached_property
    def _seeds(self) -> tuple[Array, KDTree]:
        from scipy.spatial import KDTree

        a0, a1, b0, b1 = self.box
        inside = (np.arange(SEEDS) + 0.5) / SEEDS
        share = np.stack(np.meshgrid(inside, inside, indexing="ij"), axis=-1).reshape(-1, 2)
        return share, KDTree(self.flat(a0 + (a1 - a0) * share[:, 0], b0 + (b1 - b0) * share[:, 1]))


@dataclass(frozen=True, eq=False)
class Plane(Development):
    """A plane as it is."""

    box: Box
    kind: ClassVar[str] = "plane"

    def flat(self, a: Array, b: Array) -> Array:
        """Places."""
        return np.stack([a, b], axis=1)


@dataclass(frozen=True, eq=False)
class Cylinder(Development):
    """Level or climbing: across its lines lies the length of its right section, along them their own."""

    patch: DrawnPatch
    box: Box
    kind: ClassVar[str] = "cylinder"

    @cached_property
    def _across(self) -> Array:
        """Lengths of the right section by those of the profile."""
        meridian, steep = self.patch.meridian, 1 + self.patch.part.slope**2
        steps = np.sqrt(np.diff(meridian.u) ** 2 + np.diff(meridian.z) ** 2 / steep)
        return np.concatenate([[0.0], np.cumsum(steps)])

    def flat(self, a: Array, b: Array) -> Array:
        """Places."""
        slope = self.patch.part.slope
        if not slope:
            return np.stack([a, b], axis=1)
        z = self.patch.meridian.at(np.abs(a))[1]
        s = np.sign(a) * np.interp(np.abs(a), self.patch.meridian.length, self._across)
        return np.stack([s, b * sqrt(1 + slope**2) + slope * z / sqrt(1 + slope**2)], axis=1)


@dataclass(frozen=True, eq=False)
class Cone(Development):
    """About the place of its apex: every line from there is as long as it is, at angles that add up."""

    patch: DrawnPatch
    box: Box
    kind: ClassVar[str] = "cone"

    @cached_property
    def _rays(self) -> tuple[Array, Array]:
        """By the length of the profile: the way from the apex to it at b = 0, and the angle from the crown."""
        part, meridian = self.patch.part, self.patch.meridian
        axis = 1 / part.splay
        rays = np.stack([meridian.u, np.full_like(meridian.u, axis), meridian.z + part.slope * axis], axis=1)
        far = np.linalg.norm(rays, axis=1)
        unit = rays / far[:, None]
        turn = 2 * np.arcsin(np.linalg.norm(np.diff(unit, axis=0), axis=1) / 2)
        return far, np.concatenate([[0.0], np.cumsum(turn)])

    def flat(self, a: Array, b: Array) -> Array:
        """Places."""
        (far, turn), length, splay = self._rays, self.patch.meridian.length, self.patch.part.splay
        angle = np.sign(a) * np.interp(np.abs(a), length, turn)
        reach = (1 + splay * b) * np.interp(np.abs(a), length, far)
        return np.stack([reach * np.sin(angle), np.sign(splay) * reach * np.cos(angle)], axis=1)


@dataclass(frozen=True, eq=False)
class Gore(Development):
    """Of what is turned, between two angles; its middle meridian runs down the sheet."""

    patch: TurnedPatch
    box: Box
    kind: ClassVar[str] = "gore"

    def flat(self, a: Array, b: Array) -> Array:
        """Places."""
        meridian = self.patch.meridian
        rho = self.patch.radius + np.sign(a) * meridian.at(np.abs(a))[0]
        turn = b - (self.box[2] + self.box[3]) / 2
        bend = turn * meridian.widening(np.abs(a))
        arc = rho * turn
        return np.stack([arc * np.sinc(bend / np.pi), arc * np.sin(bend / 2) * np.sinc(bend / 2 / np.pi) - a], axis=1)


@dataclass(frozen=True, eq=False)
class Strip(Development):
    """Of any surface. spine: the coordinate, 0 or 1, along which its middle line runs."""

    patch: Patch
    box: Box
    spine: int
    kind: ClassVar[str] = "strip"

    @cached_property
    def _spline(self) -> GridSpline:
        _, laid = strip_net(self.patch, self.box, self.spine, (NODES, ACROSS))
        a, b = (np.linspace(*ends, n) for ends, n in zip((self.box[:2], self.box[2:]), laid.shape[:2], strict=True))
        return GridSpline.through(a, b, laid)

    def flat(self, a: Array, b: Array) -> Array:
        """Places."""
        return self._spline(a, b)


def strip_net(patch: Patch, box: Box, spine: int, counts: tuple[int, int]) -> tuple[Array, Array]:
    """Nodes (n, m, 3) of a patch within a box, by a and b, and where they lie as a strip (n, m, 2).

    counts: of nodes along its middle line, which runs along the coordinate `spine`, and across that, an odd number.
    """
    shape = counts if spine == 0 else counts[::-1]
    a, b = (np.linspace(*ends, count) for ends, count in zip((box[:2], box[2:]), shape, strict=True))
    xyz = patch.place(*(grid.ravel() for grid in np.meshgrid(a, b, indexing="ij")))
    nodes = xyz.reshape(*shape, 3)
    # The normals of a web are not known at its wall: those of the net are, from its own lines.
    normals = np.cross(_tangents(nodes.transpose(1, 0, 2)).transpose(1, 0, 2), _tangents(nodes))
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-300)
    if spine == 0:
        return nodes, _laid(nodes, normals)
    return nodes, _laid(nodes.transpose(1, 0, 2), normals.transpose(1, 0, 2)).transpose(1, 0, 2)


def _laid(nodes: Array, normals: Array) -> Array:
    """Nodes (n, m, 3) of a strip laid flat (n, m, 2): its middle line is the middle column."""
    middle = nodes.shape[1] // 2
    spine, across = _Lines(nodes[:, middle], normals[:, middle]), _Lines(nodes, normals)
    angle = _turned(spine.tangents, across.tangents[:, middle], normals[:, middle])
    on, way = spine.walked(0.0), across.walked(spine.headings + angle - across.headings[:, middle])
    laid: Array = on[:, None] + way - way[:, middle : middle + 1]
    return laid


class _Lines:
    """Lines through nodes (..., n, 3) as they run within a surface with these normals.

    From chord to chord they turn as the chords do in the tangent plane of the node between. A line is taken for an arc
    about each node, so that what it turns is shared among both chords by their lengths.

    headings: of the lines at their nodes (..., n), against their first chord [rad]. tangents: likewise, (..., n, 3).
    """

    def __init__(self, nodes: Array, normals: Array) -> None:
        unit, self._size = _chords(nodes)
        share = _shares(self._size)
        turns = _turned(unit[..., :-1, :], unit[..., 1:, :], normals[..., 1:-1, :])
        self._chord_headings = np.concatenate([np.zeros_like(turns[..., :1]), np.cumsum(turns, axis=-1)], axis=-1)
        first, last = -turns[..., :1] * share[..., :1], turns[..., -1:] * (1 - share[..., -1:])
        between = self._chord_headings[..., :-1] + turns * share
        self.headings = np.concatenate([first, between, self._chord_headings[..., -1:] + last], axis=-1)
        self.tangents = _tangents(nodes)

    def walked(self, start: Array | float) -> Array:
        """The nodes (..., n, 2) on a sheet, from 0, where the headings are larger by `start` (...)."""
        heading = self._chord_headings + np.asarray(start)[..., None]
        steps = self._size[..., None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        return np.concatenate([np.zeros_like(steps[..., :1, :]), np.cumsum(steps, axis=-2)], axis=-2)


def _chords(nodes: Array) -> tuple[Array, Array]:
    """Unit vectors (..., n - 1, 3) from node to node of lines (..., n, 3), and how far these are apart."""
    chords = np.diff(nodes, axis=-2)
    size: Array = np.linalg.norm(chords, axis=-1)
    return chords / np.where(size > 0, size, 1.0)[..., None], size


def _shares(size: Array) -> Array:
    """The chord before an inner node as a share of both beside it, (..., n - 2)."""
    both = size[..., :-1] + size[..., 1:]
    shares: Array = size[..., :-1] / np.where(both > 0, both, 1.0)
    return shares


def _tangents(nodes: Array) -> Array:
    """Directions (..., n, 3) of lines (..., n, 3) at their nodes, taken for arcs about each."""
    unit, size = _chords(nodes)
    share = _shares(size)[..., None]
    inner = unit[..., :-1, :] * (1 - share) + unit[..., 1:, :] * share
    ends = [_mirrored(inner[..., k, :], unit[..., k, :])[..., None, :] for k in (0, -1)]
    return np.concatenate([ends[0], inner, ends[1]], axis=-2)


def _mirrored(vector: Array, axis: Array) -> Array:
    """Vectors (..., 3) turned by half a turn about unit vectors."""
    mirrored: Array = 2 * (vector * axis).sum(axis=-1, keepdims=True) * axis - vector
    return mirrored


def _turned(first: Array, second: Array, normal: Array) -> Array:
    """Angles (...) from the one direction (..., 3) to the other about a normal, both seen in the plane across it."""
    up = (first * normal).sum(axis=-1) * (second * normal).sum(axis=-1)
    turned: Array = np.arctan2((np.cross(first, second) * normal).sum(axis=-1), (first * second).sum(axis=-1) - up)
    return turned


def developments(patch: Patch, box: Box, spine: int) -> Development:
    """The patch within a box laid flat. spine: where a strip is needed, the coordinate along which it runs."""
    match patch:
        case LevelPatch():
            return Plane(box)
        case TurnedPatch():
            return Gore(patch, box)
        case DrawnPatch() if patch.straight:
            return Cylinder(patch, box)
        case DrawnPatch() if patch.tapered:
            return Cone(patch, box)
    return Strip(patch, box, spine)

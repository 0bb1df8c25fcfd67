"""The stone as it stands: one smooth displacement of space that carries the ideal vault onto the scan.

It is the same for all components, so that edges they share stay shared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.cubic_grid import add_to_bands, basis
from vaultcad.displacement import RESOLUTION, Displacement
from vaultcad.measure.chessboard import on_black
from vaultcad.measure.giving import giving
from vaultcad.measure.routes import as_built_distance
from vaultcad.mechanisms import Body

Array = NDArray[np.float64]

KNOTS = 0.9  # m, least distance of the knots: a settlement is smoother, a stone or a joint is not the vault's shape
MOST_SPANS = 9  # spans of knots along an axis at the most
ROUGHNESS = (0.02, 0.005, 0.001)  # weights of the squared second differences against one point a coefficient
WITHHELD = 5  # every so many points choose among these weights, and then join the others
BETTER = 0.98  # of the error with a rougher field, that of the smoother one above it, from which on it is taken
REST = 1e-2  # weight of the squared coefficients against that: what no point tells of, as motion along it, is none
CLUTTER = 4.685  # scatters from the surface at which a point no longer counts (Tukey's biweight, 95 % efficient)
MAKING, MEASURING = 6_000, 25_000  # points at the most; more tell no more, see `docs/measured.md`
FEWEST = 100  # points from which on there is a surface


@dataclass(frozen=True)
class AsBuilt:
    """The surface of the stone, and how far points of the scan are from it that had no part in it.

    which: (m,) of the points, by their index. distances: (m,) of those [m], positive into the stone.
    """

    surface: Displacement
    which: NDArray[np.int64]
    distances: Array


def as_built(
    vault: Vault, thinned: Array, points: NDArray[np.floating], tolerance: float, rng: np.random.Generator
) -> AsBuilt | None:
    """The as-built surface of a vault from its points, thinned (n, 3) and all (m, 3), in its own frame [m].

    Space is parted into cubes like a chessboard: thinned points in the black ones make the surface, others in the white
    ones measure it. Points farther than `tolerance` [m] from the ideal vault, as on the faces of an arch, are not its.
    None where they are too few, or so far from it that the surface may fold.
    """
    black = rng.permutation(np.flatnonzero(on_black(thinned)))[:MAKING]
    white = np.sort(rng.permutation(np.flatnonzero(~on_black(points)))[:MEASURING])
    here, there = vault.evaluate(thinned[black]), vault.evaluate(points[white])
    near, white = np.abs(here.distance) <= tolerance, white[np.abs(there.distance) <= tolerance]
    if near.sum() < FEWEST or len(white) < FEWEST:
        return None
    distances, normals = here.distance[near], here.normal[near]
    foot = thinned[black[near]] - distances[:, None] * normals
    surface = displacement(foot, normals, distances, Body.of(vault))
    if surface.may_fold:
        return None
    return AsBuilt(surface, white, as_built_distance(vault, surface, points[white]))


def displacement(points: Array, normals: Array, distances: Array, body: Body) -> Displacement:
    """The field u with n·u(p) = d at points p (n, 3) on the ideal vault, their normals, and distances (n,) there [m].

    Penalised least squares (P-splines, Eilers and Marx 1996) of what the abutments of a vault of these sizes do not
    tell (`giving`): where the scan says nothing the field goes back to that.
    How smooth it is, points that are withheld choose; those that are clutter do not count.

    Raises:
        ValueError: there are no points.
    """
    if len(points) == 0:
        raise ValueError("no points to take a displacement from")
    grid = _Grid.over(points)
    whole = grid.taken(giving(points, normals, distances, body))
    told = np.einsum("nc,nc->n", Displacement(grid.low, grid.step, whole)(points), normals)
    rows = grid.rows(points, normals, distances - told)
    chosen = np.arange(len(points)) % WITHHELD == 0 if len(points) > WITHHELD else np.zeros(len(points), bool)
    shown = grid.equations(rows, np.where(chosen, 0.0, 1.0))
    trials = [rows.off(grid.solved(shown, roughness)) for roughness in ROUGHNESS]
    errors = [float(np.median(np.abs(off[chosen]))) if chosen.any() else 0.0 for off in trials]
    which = next(k for k, error in enumerate(errors) if error * BETTER <= min(errors))
    off = trials[which]
    scatter = 1.4826 * float(np.median(np.abs(off))) + RESOLUTION
    weights = np.square(np.maximum(1 - np.square(off / (CLUTTER * scatter)), 0.0))
    found = grid.solved(grid.equations(rows, weights), ROUGHNESS[which])
    return grid.field(found, whole)


@dataclass(frozen=True)
class _Rows:
    """Equations n·u = d of points, those between the same knots, which hang on the same unknowns, side by side.

    columns: (c, 192) unknowns of each such cell. starts: (c + 1,) where its points begin. factors: (n, 192).
    distances: (n,) [m].
    """

    columns: NDArray[np.int64]
    starts: NDArray[np.int64]
    factors: Array
    distances: Array

    def cells(self) -> Iterator[tuple[NDArray[np.int64], slice]]:
        """Unknowns of each cell, and its points."""
        for columns, start, end in zip(self.columns, self.starts[:-1], self.starts[1:], strict=True):
            yield columns, slice(start, end)

    def off(self, found: Array) -> Array:
        """What is left (n,) [m] with coefficients (count, 3)."""
        unknowns, left = found.ravel(), self.distances.copy()
        for columns, mine in self.cells():
            left[mine] -= self.factors[mine] @ unknowns[columns]
        return left


@dataclass(frozen=True)
class _Equations:
    """Normal equations: lower bands (band + 1, 3 count) and right side (3 count,); points a coefficient."""

    bands: Array
    right: Array
    density: float


@dataclass(frozen=True)
class _Grid:
    """A grid of coefficients, numbered along its shortest axis first, so that equations are narrow bands.

    axes: (3,) of space, by falling number of coefficients. low, step, shape: (3,) along x, y, z.
    """

    axes: NDArray[np.intp]
    low: Array
    step: Array
    shape: NDArray[np.int64]

    @staticmethod
    def over(points: Array) -> _Grid:
        """One coefficient more on each side than there are knots within the box of the points."""
        low, high = points.min(axis=0), points.max(axis=0)
        spans = np.clip(np.floor((high - low) / KNOTS), 1, MOST_SPANS).astype(np.int64)
        # A little wider than the points, so that none is on the outermost knots, past which are no coefficients.
        step = np.maximum((high - low) / spans, 1e-6) * (1 + 1e-6)
        return _Grid(np.argsort(-spans, kind="stable"), (low + high) / 2 - (spans / 2 + 1) * step, step, spans + 3)

    @property
    def count(self) -> int:
        """Of coefficients."""
        return int(self.shape.prod())

    @property
    def band(self) -> int:
        """How far apart the numbers of unknowns are at most that one point brings together."""
        _, middle, short = self.shape[self.axes].tolist()
        return int(3 * (3 * middle * short + 3 * short + 3) + 2)

    def rows(self, points: Array, normals: Array, distances: Array) -> _Rows:
        """What the displacements along the normals hang on."""
        low, step = (np.ascontiguousarray(part[self.axes]) for part in (self.low, self.step))
        a, b, c = self.shape[self.axes].tolist()
        index, weight = basis(np.ascontiguousarray(points[:, self.axes]), low, step, (a, b, c))
        order = np.argsort(index[:, 0], kind="stable")
        _, first = np.unique(index[order, 0], return_index=True)
        columns = (3 * index[order[first], :, None] + np.arange(3)).reshape(len(first), -1)
        factors = (weight[order, :, None] * normals[order, None, :]).reshape(len(points), -1)
        return _Rows(columns, np.append(first, len(points)), factors, distances[order])

    def equations(self, rows: _Rows, weights: Array) -> _Equations:
        """Normal equations over all points, each with its weight."""
        bands, right = np.zeros((self.band + 1, 3 * self.count)), np.zeros(3 * self.count)
        for columns, mine in rows.cells():
            weighted = rows.factors[mine].T * weights[mine]
            add_to_bands(bands, columns, weighted @ rows.factors[mine])
            right[columns] += weighted @ rows.distances[mine]
        return _Equations(bands, right, float(weights.sum()) / self.count)

    def solved(self, equations: _Equations, roughness: float) -> Array:
        """Coefficients (count, 3) in the order of the grid."""
        from scipy.linalg import solveh_banded

        bands = equations.bands.copy()
        for offset, values in self.penalty:
            bands[3 * offset] += roughness * equations.density * np.repeat(values, 3)
        bands[0] += REST * roughness * equations.density
        found: Array = solveh_banded(bands, equations.right, lower=True, overwrite_ab=True)
        return found.reshape(-1, 3)

    @cached_property
    def penalty(self) -> list[tuple[int, Array]]:
        """Squared second differences along each axis: how many numbers below the diagonal, and what is there."""
        shape = self.shape[self.axes].tolist()
        found = []
        for axis, (count, stride) in enumerate(zip(shape, (shape[1] * shape[2], shape[2], 1), strict=True)):
            second = np.diff(np.eye(count), 2, axis=0)
            squares = second.T @ second
            for k in range(3):
                along = np.append(np.diag(squares, -k), np.zeros(k))
                placed = np.broadcast_to(along.reshape([-1 if a == axis else 1 for a in range(3)]), shape)
                found.append((k * stride, placed.ravel()))
        return found

    def taken(self, field: Callable[[Array], Array]) -> Array:
        """Values (nx, ny, nz, 3) of a field where coefficients are: a spline with these is about that field."""
        lines = [low + step * np.arange(n) for low, step, n in zip(self.low, self.step, self.shape, strict=True)]
        places = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
        return field(places.reshape(-1, 3)).reshape(places.shape)

    def field(self, coefficients: Array, whole: Array) -> Displacement:
        """With coefficients (count, 3) in the order of the grid beside those of the whole vault (nx, ny, nz, 3).

        They are rounded as files keep them.
        """
        shaped = coefficients.reshape(*self.shape[self.axes].tolist(), 3)
        both = whole + shaped.transpose(*np.argsort(self.axes).tolist(), 3)
        return Displacement(self.low, self.step, np.rint(both / RESOLUTION) * RESOLUTION + 0.0)

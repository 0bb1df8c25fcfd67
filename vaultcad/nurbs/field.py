"""Reach over two directions as a smooth spline: P-splines (Eilers and Marx 1996), fitted robustly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

Array = NDArray[np.float64]
KNOTS = 0.25  # m, distance of the knots: what is smaller is stones, joints and noise
MOST_SPANS = 48  # of knots, each way
FEWEST_SPANS, FINEST = 8, 0.1  # of knots over a narrow region, unless they would be nearer than that [m]
ROUGH = 3e-4  # weight of squared second differences of neighbouring coefficients against one cell of data a span
FAINT = 1e-9  # weight of the coefficients themselves, so that there is one solution
CELL = 0.02  # m, over which points are taken together
FULL = 4  # points with which a cell has all its weight
CUT = 1.5  # standard deviations from which on a cell counts less (Huber 1964): points are within a band already
LEAST_SCATTER = 5e-4  # m
ROUNDS = 4  # of weighing
HELD = 1e3  # weight of a place that the surface is to pass through against a cell


@njit(cache=True, nogil=True, error_model="numpy")  # type: ignore[untyped-decorator,unused-ignore]
def _evaluate(u: Array, v: Array, low: Array, step: Array, c: Array, out: Array) -> None:
    """Value and both slopes (n, 3) of a uniform bicubic spline; beyond its ends it runs on by their last cubic."""
    n, m = c.shape
    wu, wv, du, dv = np.empty(4), np.empty(4), np.empty(4), np.empty(4)
    for k in range(len(u)):
        x, y = (u[k] - low[0]) / step[0], (v[k] - low[1]) / step[1]
        i, j = min(max(int(np.floor(x)), 0), n - 4), min(max(int(np.floor(y)), 0), m - 4)
        for t, w, d in ((x - i, wu, du), (y - j, wv, dv)):
            s = 1.0 - t
            w[0], w[3] = s * s * s / 6.0, t * t * t / 6.0
            w[1] = (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0
            w[2] = (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0
            d[0], d[3] = -s * s / 2.0, t * t / 2.0
            d[1] = (9.0 * t * t - 12.0 * t) / 6.0
            d[2] = -(9.0 * s * s - 12.0 * s) / 6.0
        value, along, across = 0.0, 0.0, 0.0
        for a in range(4):
            row, slope = 0.0, 0.0
            for b in range(4):
                row += wv[b] * c[i + a, j + b]
                slope += dv[b] * c[i + a, j + b]
            value += wu[a] * row
            along += du[a] * row
            across += wu[a] * slope
        out[k, 0], out[k, 1], out[k, 2] = value, along / step[0], across / step[1]


@njit(cache=True, nogil=True, error_model="numpy")  # type: ignore[untyped-decorator,unused-ignore]
def _accumulate(
    columns: NDArray[np.int64], weights: Array, weight: Array, reach: Array, band: Array, right: Array
) -> None:
    """Add the normal equations of rows to a band (width + 1, n), its diagonal first, and a right side (n,)."""
    n, size = columns.shape
    for k in range(n):
        for a in range(size):
            i, share = columns[k, a], weight[k] * weights[k, a]
            right[i] += share * reach[k]
            for b in range(size):
                j = columns[k, b]
                if j <= i:
                    band[i - j, j] += share * weights[k, b]


class Design(NamedTuple):
    """Of each place the coefficients that its value hangs on (n, 16), and by how much (n, 16)."""

    columns: NDArray[np.int64]
    weights: Array


@dataclass(frozen=True, eq=False)
class Field:
    """Reach [m] as a tensor product of uniform cubic B-splines (de Boor 1978) over u and v [m].

    low, step: (2,) first knot of the domain and distance of the knots. coefficients: (n, m); where u closes after
    `turn` [m], the last three of them are the first.
    """

    low: Array
    step: Array
    coefficients: Array
    turn: float = 0.0

    def values(self, u: Array, v: Array) -> Array:
        """Reach and its slopes by u and v, (n, 3)."""
        if self.turn:
            u = self.low[0] + (u - self.low[0]) % self.turn
        out = np.empty((len(u), 3))
        _evaluate(np.ascontiguousarray(u), np.ascontiguousarray(v), self.low, self.step, self.coefficients, out)
        return out

    def __call__(self, u: Array, v: Array) -> Array:
        """Reach (n,) [m]."""
        found: Array = self.values(u, v)[:, 0]
        return found

    def knots(self, axis: int, low: float, high: float) -> Array:
        """The knots between two places along u (0) or v (1), without these."""
        first, step = self.low[axis], self.step[axis]
        k = np.arange(np.floor((low - first) / step), np.ceil((high - first) / step) + 1)
        found = first + k * step
        inner: Array = found[(found > low + step / 4) & (found < high - step / 4)]
        return inner


@dataclass(frozen=True, eq=False)
class Domain:
    """Where a field is to be fitted: low and high (2,) of u and v [m]; `turn` as in `Field`. knots: their distance."""

    low: Array
    high: Array
    turn: float = 0.0
    knots: float = KNOTS

    @cached_property
    def spans(self) -> NDArray[np.int64]:
        """Of knots along u and v, (2,)."""
        size = self.high - self.low
        spans = np.maximum(size / self.knots, np.minimum(FEWEST_SPANS, size / FINEST))
        return np.clip(np.ceil(spans), 1, MOST_SPANS).astype(np.int64)

    @cached_property
    def step(self) -> Array:
        """Distance of the knots (2,) [m]."""
        step: Array = (self.high - self.low) / self.spans
        return step

    @cached_property
    def _kept(self) -> tuple[int, int]:
        """Coefficients along u and v that are free."""
        n, m = (self.spans + 3).tolist()
        return (n - 3 if self.turn else n), m

    @cached_property
    def _order(self) -> NDArray[np.int64]:
        """Where the coefficients of each place along u stand: those that close go to and fro, so that ends are near."""
        n, _ = self._kept
        k = np.arange(n)
        return np.where(2 * k < n, 2 * k, 2 * (n - 1 - k) + 1) if self.turn else k

    @property
    def _band(self) -> int:
        """Farthest that two coefficients of one span stand from each other."""
        return (7 if self.turn else 3) * self._kept[1] + 3

    def design(self, u: Array, v: Array) -> Design:
        """What values at places are made of."""
        if self.turn:
            u = self.low[0] + (u - self.low[0]) % self.turn
        ends = zip((u, v), self.low, self.step, self.spans, strict=True)
        at = [np.clip((x - low) / step, 0.0, spans) for x, low, step, spans in ends]
        cell = [np.minimum(x.astype(np.int64), spans - 1) for x, spans in zip(at, self.spans, strict=True)]
        w = [_weights(x - k) for x, k in zip(at, cell, strict=True)]
        n, m = self._kept
        rows = self._order[(cell[0][:, None] + np.arange(4)) % n]
        columns = rows[:, :, None] * m + (cell[1][:, None] + np.arange(4))[:, None, :]
        weights = w[0][:, :, None] * w[1][:, None, :]
        return Design(columns.reshape(len(u), 16), weights.reshape(len(u), 16))

    @cached_property
    def _rough(self) -> Array:
        """The penalty as a band: squared second differences of the coefficients along u, along v and across both."""
        n, m = self._kept
        band = np.zeros((self._band + 1, n * m))
        i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
        along = i if self.turn else i[1:-1]
        one, two = np.array([-1.0, 1.0]), np.array([1.0, -2.0, 1.0])
        for around, across, where in (
            (two, np.ones(1), (along, j[: len(along)])),
            (np.ones(1), two, (i[:, 1:-1], j[:, 1:-1])),
            (one, one * 2**0.5, (i[: None if self.turn else -1, :-1], j[: None if self.turn else -1, :-1])),
        ):
            a = np.arange(len(around)) - (len(around) == 3)
            b = np.arange(len(across)) - (len(across) == 3)
            rows = self._order[(where[0].reshape(-1, 1) + a) % n]
            columns = (rows[:, :, None] * m + (where[1].reshape(-1, 1) + b)[:, None, :]).reshape(len(rows), -1)
            weights = np.tile(np.outer(around, across).ravel(), (len(rows), 1))
            _accumulate(columns, weights, np.ones(len(rows)), np.zeros(len(rows)), band, np.zeros(n * m))
        return band

    def solve(self, parts: Sequence[tuple[Design, Array, Array]]) -> Field:
        """The smooth field with the least weighted squares: of each part its design, weights (n,) and reach (n,)."""
        n, m = self._kept
        band, right = ROUGH * self._cells * self._rough, np.zeros(n * m)
        band[0] += FAINT * self._cells
        for design, weight, reach in parts:
            _accumulate(design.columns, design.weights, weight, reach, band, right)
        grid = solveh_banded(band, right, lower=True, check_finite=False).reshape(n, m)[self._order]
        if self.turn:
            grid = np.concatenate([grid, grid[:3]])
        return Field(self.low, self.step, np.ascontiguousarray(grid), self.turn)

    @cached_property
    def _cells(self) -> float:
        """Cells of data over one span."""
        return float(np.prod(np.minimum(self.step, self.knots))) / CELL**2


@dataclass(frozen=True, eq=False)
class Cells:
    """Points taken together over small cells of u and v: means (n,) [m] and weights (n,)."""

    u: Array
    v: Array
    reach: Array
    weight: Array

    @staticmethod
    def of(u: Array, v: Array, reach: Array, size: float = CELL) -> Cells:
        """Of points (n,)."""
        i, j = (np.floor(x / size).astype(np.int64) for x in (u, v))
        i, j = i - i.min(), j - j.min()
        where = i * (j.max() + 1) + j
        count = np.bincount(where)
        full = np.flatnonzero(count)
        a, b, c = (np.bincount(where, x)[full] / count[full] for x in (u, v, reach))
        return Cells(a, b, c, np.minimum(count[full] / FULL, 1.0))


def fitted(domain: Domain, cells: Cells, held: Cells | None = None) -> Field:
    """The field through cells, those far off counting less, that passes places `held` as nearly as it can."""
    design, reach = domain.design(cells.u, cells.v), cells.reach
    robust = np.ones_like(reach)
    through = [] if held is None else [(domain.design(held.u, held.v), HELD * held.weight, held.reach)]
    for _ in range(ROUNDS):
        field = domain.solve([(design, cells.weight * robust, reach), *through])
        if len(reach) == 0:
            break
        off = reach - field(cells.u, cells.v)
        scatter = max(1.4826 * float(np.median(np.abs(off))), LEAST_SCATTER)
        robust = np.minimum(1.0, CUT * scatter / np.maximum(np.abs(off), 1e-12))
    return field


def _weights(t: Array) -> Array:
    """Values (n, 4) of the four cubic B-splines over one span."""
    s = 1 - t
    return np.stack([s**3, 3 * t**3 - 6 * t**2 + 4, 3 * s**3 - 6 * s**2 + 4, t**3], axis=1) / 6

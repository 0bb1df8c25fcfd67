"""Square cells over a scan's plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.plan_kernel import cells
from vaultcad.survey.thinned_scan import CHUNK

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class PlanGrid:
    """`shape` cells of an edge `cell` [m] from the corner `low` (2,) [m] on."""

    low: Array
    cell: float
    shape: tuple[int, int]

    @classmethod
    def over(cls, low: Array, high: Array, cell: float) -> PlanGrid:
        """Cells from one corner (2,) to the other [m] and beyond it."""
        x, y = np.floor((high - low) / cell).astype(int) + 1
        return cls(low, cell, (int(x), int(y)))

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Its corners (2,), (2,) [m]."""
        return self.low, self.low + self.cell * np.array(self.shape)

    @property
    def middles(self) -> Array:
        """(nx * ny, 2) of the cells [m]."""
        return self.places(np.arange(self.shape[0] * self.shape[1]))

    def places(self, number: Ints) -> Array:
        """(n, 2) the middles of cells with these numbers (n,) [m]."""
        places: Array = self.low + self.cell * (np.column_stack(np.divmod(number, self.shape[1])) + 0.5)
        return places

    def numbers(self, points: NDArray[np.floating]) -> Ints:
        """(n,) of the cells that points (n, 2 or 3) [m] lie over; -1 beyond them all."""
        found: Ints = cells(np.ascontiguousarray(points), self.low, self.cell, *self.shape)
        return found

    def holds(self, held: Mask, points: NDArray[np.floating]) -> Mask:
        """Which points (n, 2 or 3) [m] lie over those of its cells that are held (nx * ny,)."""
        beyond = np.append(held.ravel(), False)
        found = np.zeros(len(points), np.bool_)
        low, high = self.low - self.cell, self.low + self.cell * (np.array(self.shape) + 1)
        for k in range(0, len(points), CHUNK):
            x, y = points[k : k + CHUNK, 0], points[k : k + CHUNK, 1]
            # Of the points of a large site most are far away, which is told quickly.
            (near,) = np.nonzero((x > low[0]) & (x < high[0]) & (y > low[1]) & (y < high[1]))
            found[k + near] = beyond[self.numbers(points[k + near])]
        return found


@dataclass(frozen=True)
class Laid:
    """Points of a scan (n, 3) [m] by the cells they lie over: asked for many parts.

    order: (n,) their numbers, by cells. starts: (nx * ny + 1,) where those of each cell begin in it.
    """

    grid: PlanGrid
    points: NDArray[np.floating]
    order: NDArray[np.int32]
    starts: Ints

    @classmethod
    def over(cls, grid: PlanGrid, points: NDArray[np.floating]) -> Laid:
        """All these points over a grid."""
        cells = grid.shape[0] * grid.shape[1]
        number = np.empty(len(points), np.int16 if cells < np.iinfo(np.int16).max else np.int32)
        for k in range(0, len(points), CHUNK):
            number[k : k + CHUNK] = grid.numbers(points[k : k + CHUNK])
        count = np.bincount(number + 1, minlength=cells + 1)  # the first are beyond them all
        return cls(grid, points, np.argsort(number, kind="stable").astype(np.int32), np.cumsum(count))

    def about(self, low: Array, high: Array) -> NDArray[np.floating]:
        """The points over the cells that a rectangle from one corner (2,) to the other [m] touches, in their order."""
        return self.points.take(self.numbers_about(low, high), axis=0)

    def numbers_about(self, low: Array, high: Array) -> NDArray[np.int32]:
        """Their numbers (k,)."""
        nx, ny = self.grid.shape
        ends = (np.floor((end - self.grid.low) / self.grid.cell).clip(0, (nx, ny)).astype(int) for end in (low, high))
        (x0, y0), (x1, y1) = ends
        rows, last = range(x0, min(x1 + 1, nx)), min(y1 + 1, ny)
        mine = [self.order[self.starts[x * ny + y0] : self.starts[x * ny + last]] for x in rows]
        return np.sort(np.concatenate([self.order[:0], *mine]))

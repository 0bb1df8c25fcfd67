"""A smooth displacement of space, by which an ideal vault stands where its stone does.

It is one field for all components, so that edges they share stay shared.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

RESOLUTION = 1e-6  # [m] to which coefficients are kept
MOST_COEFFICIENTS = 300_000  # of one field: ten times those of a vault as large as families allow
LARGEST = 10.0  # [m] that a coefficient may be: masonry that moved farther is no vault
STEEPEST = 0.9  # stretch at which a field might soon fold what it moves
ROUNDS = 6  # in which a displacement is undone: less than a micrometre is left of 3 cm where it is as steep as 0.1
BLOCK = 1 << 16  # points that are worked on at once


@dataclass(frozen=True, eq=False)
class Displacement:
    """Vector field u [m] as a tensor product of uniform cubic B-splines (de Boor 1978), twice smooth everywhere.

    low: (3,) place of the first coefficient [m]. step: (3,) between them [m]. coefficients: (nx, ny, nz, 3) [m];
    beyond the grid they go on as its border does, so that u is constant far from it.

    >>> sunk = Displacement(np.zeros(3), np.ones(3), np.full((1, 1, 1, 3), [0.0, 0.0, -0.02]))
    >>> sunk(np.array([[3.0, 4.0, 5.0]])).round(9).tolist()
    [[0.0, 0.0, -0.02]]
    """

    low: Array
    step: Array
    coefficients: Array

    def __call__(self, points: NDArray[np.floating]) -> Array:
        """Displacements (n, 3) [m] of points (n, 3) [m]."""
        from vaultcad.cubic_grid import values

        return self._in_threads(values, points)

    def jacobian(self, points: NDArray[np.floating]) -> Array:
        """Derivatives (n, 3, 3) of the displacement at points (n, 3) [m]: [:, i, j] is that of u_i by x_j."""
        from vaultcad.cubic_grid import slopes

        return self._in_threads(slopes, points)

    def moved(self, points: NDArray[np.floating]) -> Array:
        """Where points (n, 3) [m] of the ideal vault stand: p + u(p)."""
        return np.asarray(points, np.float64) + self(points)

    def undone(self, points: NDArray[np.floating]) -> Array:
        """Of points (n, 3) [m] where they stand the places (n, 3) p in the ideal vault: p + u(p) is the point.

        Found by p = point - u(p), which each round brings nearer by the `steepness`.

        Raises:
            ValueError: it may fold, so that several places would come to one point.
        """
        self.check()
        there = np.asarray(points, np.float64)
        found = there
        for _ in range(ROUNDS):
            found = there - self(found)
        return found

    @property
    def steepness(self) -> float:
        """Greatest stretch that it can be anywhere [1]; below 1 nothing folds."""
        slopes = (
            np.linalg.norm(np.diff(self.coefficients, axis=axis), axis=3).max(initial=0.0) / self.step[axis]
            for axis in range(3)
        )
        return float(np.linalg.norm(list(slopes)))

    @property
    def may_fold(self) -> bool:
        """Whether it is so steep that places might change their order."""
        return self.steepness > STEEPEST

    def check(self) -> None:
        """Raise ValueError where it may fold."""
        if self.may_fold:
            raise ValueError(f"the as-built surface stretches by up to {self.steepness:.2g}, where it may fold")

    def plain(self) -> dict[str, Any]:
        """As plain values, coefficients in micrometres: a line a row of the grid along z, of x, y, z by turns."""
        nx, ny, nz = self.coefficients.shape[:3]
        whole = np.rint(self.coefficients / RESOLUTION).astype(np.int64).reshape(nx * ny, nz * 3)
        return {
            "low": self.low.tolist(),
            "step": self.step.tolist(),
            "shape": [nx, ny, nz],
            "micrometres": [" ".join(map(str, row)) for row in whole.tolist()],
        }

    @classmethod
    def from_plain(cls, told: Mapping[str, Any]) -> Displacement:
        """The field that `plain` tells of.

        Raises:
            KeyError: something is missing.
            ValueError: a value is none that a field can have, or the field may fold; names it.
        """
        low, step = (_three(name, told[name]) for name in ("low", "step"))
        if not (step > 0).all():
            raise ValueError(f"surface.step = {told['step']!r} is no spacing of a grid; give three lengths above 0")
        shape, rows = told["shape"], told["micrometres"]
        if not _is_shape(shape):
            raise ValueError(f"surface.shape = {shape!r} is no grid; give three whole numbers above 0")
        nx, ny, nz = shape
        if not isinstance(rows, list) or len(rows) != nx * ny:
            raise ValueError(f"surface.micrometres has not the {nx * ny} rows that surface.shape = {shape} tells of")
        values = np.array([_row(row, 3 * nz) for row in rows], np.float64) * RESOLUTION
        if np.abs(values).max() > LARGEST:
            raise ValueError(f"surface.micrometres go beyond {LARGEST:g} m; no stone of a vault moves so far")
        field = cls(low, step, values.reshape(nx, ny, nz, 3))
        field.check()
        return field

    def __eq__(self, other: object) -> bool:
        return self._values == other._values if isinstance(other, Displacement) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._values)

    @cached_property
    def _values(self) -> tuple[tuple[int, ...], bytes]:
        parts = (self.low, self.step, self.coefficients)
        return self.coefficients.shape, b"".join(np.ascontiguousarray(part, np.float64).tobytes() for part in parts)

    def _in_threads(self, compiled: Callable[..., Array], points: NDArray[np.floating]) -> Array:
        from segmentation.threads import threads

        grid = [np.ascontiguousarray(part, np.float64) for part in (self.low, self.step, self.coefficients)]
        xyz = np.ascontiguousarray(points, np.float64)
        if len(xyz) <= BLOCK:
            return compiled(xyz, *grid)
        with threads() as pool:
            blocks = [xyz[start : start + BLOCK] for start in range(0, len(xyz), BLOCK)]
            return np.concatenate(list(pool.map(lambda block: compiled(block, *grid), blocks)))


def _three(name: str, told: Any) -> Array:
    if not isinstance(told, list) or len(told) != 3 or not all(_is_number(value) for value in told):
        raise ValueError(f"surface.{name} = {told!r} is no triple of numbers")
    return np.array(told, np.float64)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and bool(np.isfinite(value))


def _is_shape(told: Any) -> bool:
    whole = isinstance(told, list) and len(told) == 3 and all(type(n) is int and n > 0 for n in told)
    return whole and int(np.prod([float(n) for n in told])) <= MOST_COEFFICIENTS


def _row(told: Any, count: int) -> list[int]:
    try:
        found = [int(value) for value in told.split(" ")]
    except (AttributeError, ValueError):
        raise ValueError(f"surface.micrometres has {told!r:.60}, which is no row of whole numbers") from None
    if len(found) != count:
        raise ValueError(f"surface.micrometres has a row of {len(found)} numbers; surface.shape asks for {count}")
    return found

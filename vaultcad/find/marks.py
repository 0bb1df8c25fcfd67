"""What is known of the level at which a vault springs beside its own stone: where arches beside it spring.

Levels have settled with the stone, so that they belong to the random field in which that has moved: given what its
blocks show, each is told by that field as well, and what is left of it speaks of the unknowns as blocks do.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.fit.settlement import smooth_fields
from vaultcad.fit.solve import POSE, Placed, Solution
from vaultcad.survey.springings import Springing

Array = NDArray[np.float64]

CORNER, HEIGHT = 0.6, 0.7  # m in plan from a corner of a vault, and in height from where it is thought to spring
ALIKE = 0.05, 2.0  # m, and standard deviations, by which levels about one vault may be off their middle
THERE = 0.97  # how often a vault springs where the arches beside it do
ELSEWHERE = 0.3  # m, standard deviation of where it springs if not there


@dataclass(frozen=True)
class Marks:
    """Levels (m,) [m] about a vault and their standard deviations (m,) [m].

    cross: (n, m) of each length of the field, covariances of n blocks, along its vectors, with the levels; own: (m, m).
    """

    level: Array
    std: Array
    cross: tuple[Array, ...]
    own: tuple[Array, ...]

    @classmethod
    def of(
        cls,
        found: Sequence[Springing],
        placed: Placed,
        place: Array,
        normal: Array,
        vectors: Sequence[Array],
        rise: float,
    ) -> Marks:
        """Those of springings that are a vault's, whose blocks are at (n, 3) [m] with normals (n, 3).

        vectors: (n, n) of each length. rise: of the crown above the springing [m].
        """
        mine = _about(found, placed)
        at = np.array([placed.pose.frame() @ (*one.place, 1.0) for one in mine]).reshape(-1, 3)
        at[:, 2] = 0.0
        upward = np.tile([0.0, 0.0, 1.0], (len(mine), 1))
        size = len(place)
        fields = smooth_fields(np.concatenate([place, at]), np.concatenate([normal, upward]), placed.vault.plan, rise)
        return cls(
            np.array([one.place[2] for one in mine]),
            np.array([one.std for one in mine]),
            tuple(axes.T @ field[:size, size:] for axes, field in zip(vectors, fields, strict=True)),
            tuple(field[size:, size:] for field in fields),
        )

    def cases(self) -> Iterator[tuple[float, float]]:
        """Logarithm of the chance, and variance of where the vault springs [m²] about these: there, or elsewhere."""
        if len(self.level):
            yield log(THERE), 0.0
            yield log(1 - THERE), ELSEWHERE**2
        else:
            yield 0.0, 0.0

    def left(
        self, k: int, solution: Solution, strength: Array, weight: Array, slopes: Array, rest: Array
    ) -> tuple[Array, Array, Array]:
        """What blocks do not tell of the levels: residuals (h, m), derivatives (h, m, u), and covariances (h, m, m).

        k: number of the field's length. strength: (h,) variances of its waves [m²]. weight: (h, n) inverse variances of
        the blocks along its vectors. slopes: (n, u), rest: (n,) derivatives and residuals of these.
        """
        cross, known = self.cross[k], slopes.shape[1]
        columns = np.column_stack([slopes, rest, cross])
        products = (cross[:, :, None] * columns[:, None, :]).reshape(len(cross), cross.shape[1] * columns.shape[1])
        by_blocks = strength[:, None, None] * (weight @ products).reshape(len(weight), cross.shape[1], columns.shape[1])
        off = self.level - solution.placed.pose.z
        moved = np.zeros((len(off), known))
        moved[:, POSE.index("z")] = 0.0 if "z" in solution.free.pose else -1.0
        own = strength[:, None, None] * (self.own[k] - by_blocks[:, :, known + 1 :])
        return off - by_blocks[:, :, known], moved - by_blocks[:, :, :known], own + np.diag(self.std**2)


def _about(found: Sequence[Springing], placed: Placed) -> list[Springing]:
    """Those at the corners of a vault that springs at one level, as most of them tell it."""
    vault, frame = placed.vault, placed.pose.frame()
    if not _is_level(vault):
        return []
    mine = []
    for one in found:
        x, y, z = frame @ (*one.place, 1.0)
        if np.hypot(*(vault.corners - (x, y)).T).min() < CORNER and abs(z) < HEIGHT:
            mine.append(one)
    middle = float(np.median([one.place[2] for one in mine])) if mine else 0.0
    return [one for one in mine if abs(one.place[2] - middle) < ALIKE[0] + ALIKE[1] * one.std]


def _is_level(vault: Vault) -> bool:
    """Whether all corners of a vault spring at the level of its pose."""
    return not vault.raised and not vault.lift and vault.values().get("slope", 0.0) == 0.0

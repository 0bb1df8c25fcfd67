"""What a fit's residuals say of the settlement, also of the part that the fit has taken for shape.

A settled vault has moved smoothly: what the residuals show is what is left of that motion after pose and parameters
have taken their share. Here it is a random field of displacements with two parts: waves, as smooth as a Gaussian
process with a length about half the shorter span (Rasmussen and Williams 2006), and, somewhat stronger, the way in
which vaults give, springings outwards and crown down (Heyman 1995). Strength, length and roughness come from the
restricted likelihood (Patterson and Thompson 1971), which sees only what no parameter could have taken, with a weak
prior: real vaults have moved by 2 to 5 cm.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan
from families.declaration.vault import Surface
from vaultcad.fit.solve import Placed, Solution

Array = NDArray[np.float64]

MOST_BLOCKS = 300  # blocks: fewer blur the field, more cost time
FINEST, COARSER = 0.3, 1.1  # m, edge of the smallest blocks, and by how much they grow until there are few enough
OUTLIER = 4.0  # scatters of the residuals beyond which a block is not of the vault
SCATTERS = (0.001, 0.0125)  # m, limits of that scatter
STRENGTHS = np.geomspace(1e-4, 0.06, 28)  # m, standard deviation of the waves along any direction
GIVING = 1.5  # standard deviation of the springings' and the crown's motion / that of the waves
ROUGHNESSES = np.geomspace(1e-4, 0.03, 24)  # m, standard deviation of a block's mean from the smooth field
FAINT = 1e-4  # share of the variance that is let go, to be quick
LENGTHS = (0.3, 0.5, 0.8)  # of the waves / width of the plan
STRENGTH, STRENGTH_SPREAD = 0.01, 0.7  # m, of a vault that has moved by 3 cm at most; spread of its logarithm
LENGTH, LENGTH_SPREAD = 0.5, 0.5  # waves are from one to three spans long; spread of the logarithm
PRIOR: Array = -0.5 * (
    (np.log(np.array(LENGTHS) / LENGTH) / LENGTH_SPREAD)[:, None] ** 2
    + (np.log(STRENGTHS / STRENGTH) / STRENGTH_SPREAD) ** 2
)
"""Logarithm (lengths, strengths) of how likely they are beforehand, up to a constant."""


@dataclass(frozen=True)
class Partition:
    """Points of a vault or its walls in blocks that lie together on one component or one wall.

    block: (n,) that each point lies in. weights: (n,) of the points. place: (m, 3) [m], normal: (m, 3): of the blocks,
    in the vault's frame.
    """

    block: NDArray[np.int64]
    weights: Array
    place: Array
    normal: Array

    @classmethod
    def of(
        cls, placed: Placed, points: Array, weights: Array, most: int = MOST_BLOCKS, layers: float = 1.0
    ) -> Partition:
        """Of points (n, 3) [m] with weights (n,) beside a vault, in so many blocks at most.

        layers: how many times as long and wide as high blocks of walls are.
        """
        frame = placed.pose.frame()
        local = points @ frame[:, :3].T + frame[:, 3]
        surface = placed.vault.evaluate(local, walls=True)
        face = faces(surface)
        cut = local.copy()
        cut[surface.component == 0, 2] *= layers
        block = _blocks(cut, face, most)
        empty = np.empty((0, 3))
        places = cls(block, weights, empty, empty)
        return cls(block, weights, places.means(local), places.means(surface.normal))

    @property
    def weight(self) -> Array:
        """Sum (m,) of the weights of each block."""
        out: Array = np.bincount(self.block, self.weights).astype(np.float64)
        return out

    def means(self, values: Array) -> Array:
        """Weighted means (m, k) of values (n, k) over the blocks."""
        columns = [np.bincount(self.block, self.weights * column) for column in values.T]
        out: Array = np.stack(columns, axis=1) / np.maximum(self.weight, 1e-300)[:, None]
        return out


def faces(surface: Surface) -> NDArray[np.int64]:
    """Number (n,) of the component or the wall that points are nearest to; walls are told apart by where they face."""
    facing = np.argmax(np.abs(surface.normal), axis=1)
    side = 2 * facing + (np.take_along_axis(surface.normal, facing[:, None], axis=1)[:, 0] > 0)
    out: NDArray[np.int64] = np.where(surface.component > 0, surface.component.astype(np.int64) + 6, side)
    return out


def scatter_of(residuals: Array) -> float:
    """Robust standard deviation of the residuals of blocks (m,) [m], within reason."""
    return float(np.clip(1.4826 * np.median(np.abs(residuals)), *SCATTERS)) if len(residuals) else SCATTERS[1]


@dataclass(frozen=True)
class Blocks:
    """Means over blocks of points that lie together on one component or one wall.

    weight: (m,) sum of the weights. residual: (m,) [m]. jacobian: (m, k). place: (m, 3) [m] and normal: (m, 3) in the
    vault's frame. usable: (m,) whether it is part of the vault or its walls.
    """

    weight: Array
    residual: Array
    jacobian: Array
    place: Array
    normal: Array
    usable: NDArray[np.bool_]


def block_means(solution: Solution, points: Array) -> Blocks:
    """Of the points (n, 3) [m] that a solution rests on."""
    parts = Partition.of(solution.placed, points, solution.weights)
    residual = parts.means(solution.residuals[:, None])[:, 0]
    usable = abs(residual) < OUTLIER * scatter_of(residual)
    return Blocks(parts.weight, residual, parts.means(solution.jacobian), parts.place, parts.normal, usable)


def _blocks(local: Array, face: NDArray[np.int64], most: int) -> NDArray[np.int64]:
    """Number (n,) of the block of each point, blocks being as small as so many of them allow."""
    edge = FINEST
    while True:
        cell = np.floor((local - local.min(axis=0, initial=0.0)) / edge).astype(np.int64)
        size = cell.max(axis=0, initial=0) + 1
        key = ((face * size[0] + cell[:, 0]) * size[1] + cell[:, 1]) * size[2] + cell[:, 2]
        if np.count_nonzero(np.diff(np.sort(key))) < most:  # which is sooner told than which block each is
            _, block = np.unique(key, return_inverse=True)
            return np.asarray(block.ravel(), np.int64)
        edge *= COARSER


def motion(blocks: Blocks, plan: Plan, rise: float) -> Array:
    """Covariance (m, m) [m²] of the blocks' motion along their normals, roughness included, given their residuals.

    plan: of the vault. rise: of its crown above the springing [m].
    """
    shapes = smooth_fields(blocks.place, blocks.normal, plan, rise)
    likely = _log_likelihoods(shapes, blocks) + PRIOR[:, :, None]
    share = np.exp(likely - likely.max())
    share /= share.sum()
    # The mean over all that is likely, so that what the scan cannot tell widens the result.
    smooth = np.einsum("l,lij->ij", share.sum(axis=2) @ STRENGTHS**2, np.stack(shapes))
    rough = float(share.sum(axis=(0, 1)) @ ROUGHNESSES**2)
    out: Array = smooth + rough * np.eye(len(smooth))
    return out


def field_likelihood(blocks: Blocks, plan: Plan, rise: float) -> Array:
    """Restricted log likelihood (lengths, strengths, roughnesses) of fields, given the usable blocks' residuals.

    plan: of the vault. rise: of its crown above the springing [m].
    """
    return _log_likelihoods(smooth_fields(blocks.place, blocks.normal, plan, rise), blocks)


def smooth_fields(place: Array, normal: Array, plan: Plan, rise: float) -> list[Array]:
    """Covariances (m, m) of blocks at (m, 3) [m] with normals (m, 3) along these, for waves of each of `LENGTHS`.

    plan: of the vault. rise: of its crown above the springing [m]. They are of unit strength.
    """
    apart = ((place[:, None] - place[None]) ** 2).sum(axis=2)
    alike = normal @ normal.T
    modes = _modes(place, normal, plan, rise)
    return [np.exp(-0.5 * apart / (length * plan.width) ** 2) * alike + modes @ modes.T for length in LENGTHS]


def _modes(place: Array, normal: Array, plan: Plan, rise: float) -> Array:
    """How blocks (m, 3) move along their normals when the springings spread in x and in y, and the crown falls."""
    height = np.clip(place[:, 2] / max(rise, 1e-3), 0, 1)
    x, y = (np.clip(place[:, k] / plan.half[k], -1, 1) for k in (0, 1))
    return GIVING * np.stack([x * (1 - height), y * (1 - height), -height], axis=1) * normal


def _log_likelihoods(shapes: Iterable[Array], blocks: Blocks) -> Array:
    return np.stack([_log_likelihood(shape, blocks) for shape in shapes])


def _log_likelihood(shape: Array, blocks: Blocks) -> Array:
    """Restricted log likelihood (strengths, roughnesses) of the residuals of the usable blocks."""
    usable = blocks.usable
    jacobian, residual = blocks.jacobian[usable], blocks.residual[usable]
    size = np.linalg.norm(jacobian, axis=0)
    basis, _ = np.linalg.qr(jacobian[:, size > 0] / size[size > 0])

    def left(columns: Array) -> Array:
        """What no unknown can take of columns (m, j)."""
        out: Array = columns - basis @ (basis.T @ columns)
        return out

    factor, rest = left(_factor(shape[np.ix_(usable, usable)])), left(residual[:, None])[:, 0]
    values, vectors = np.linalg.eigh(factor.T @ factor)
    values, vectors = values[values > FAINT], vectors[:, values > FAINT]
    squared = (vectors.T @ (factor.T @ rest)) ** 2 / values
    rough = ROUGHNESSES**2
    variance = STRENGTHS[:, None, None] ** 2 * values + rough[:, None]
    smooth = (np.log(variance) + squared / variance).sum(axis=2)
    others = len(rest) - basis.shape[1] - len(values)
    out: Array = -0.5 * (smooth + others * np.log(rough) + max(float(rest @ rest - squared.sum()), 0.0) / rough)
    return out


def _factor(matrix: Array) -> Array:
    """F (m, r) with F Fᵀ equal to a positive semidefinite matrix (m, m) but for `FAINT`, by pivoted Cholesky."""
    left = np.diag(matrix).copy()
    factor = np.zeros_like(matrix)
    rank = 0
    while rank < len(left) and left.max() > FAINT:
        k = int(left.argmax())
        # No BLAS: for products as small as these its threads only wait for each other.
        column = matrix[:, k] - (factor[:, :rank] * factor[k, :rank]).sum(axis=1)
        factor[:, rank] = column / np.sqrt(left[k])
        left -= factor[:, rank] ** 2
        rank += 1
    return factor[:, :rank]

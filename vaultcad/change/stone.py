"""The stone of a vault and its walls, in blocks that lie together, as a reading of its movement takes it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vaultcad.change.motion import Trend
from vaultcad.change.places import Sights
from vaultcad.change.stonework import Stonework
from vaultcad.change.strays import with_most, without_strays
from vaultcad.find.likelihood import ENOUGH, near_edges, secants
from vaultcad.find.practice import beforehand
from vaultcad.find.refine import WIDEST, Refined
from vaultcad.fit.settlement import Partition
from vaultcad.fit.solve import Solution
from vaultcad.mechanisms import Body, shapes

Array = NDArray[np.float64]
Known = tuple[Array, Array, Array]
"""Derivatives (m, u) of the deviations of blocks by unknowns, precisions (u,) and means (u,) of these beforehand."""

FARTHEST = 0.06  # m off the model; a block farther off is no stone of this vault
ROUNDED = 0.1  # m from an edge, where stone is rounded and plastered
BLOCKS = 500  # of stone at the most
LAYERS = 2.0  # times as long as high are blocks of walls: what moves them is told by how it fades downwards
OUTLYING, LEAST = 5.0, 0.0008  # robust scatters of what the shapes leave of blocks, beyond which one is none; least [m]
STRANGE = 0.05  # share of the vault's stone in blocks that are none, from which on the vault is not quite this


@dataclass(frozen=True)
class Stone:
    """Blocks of stone about a vault: where they are, and the motions of its shapes there.

    moved: (b, k) by how much each shape moves each block along its normals, usable or not: a mean over its points, for
    walls fade within a block or two. parts: (k,) whose each shape is. fadings: the shapes (k,) of each way in which
    walls may fade. calmer: (n,) what is to be added to the deviations of the points that the fit rests on [m] to have
    those of all the site's points about each. strange: share (0 to 1) of the vault's stone that was left out, as
    nothing explains it; astray: by how much it is off what does, root mean square [m].
    """

    refined: Refined
    blocks: Partition
    usable: NDArray[np.bool_]
    body: Body
    moved: Array
    parts: NDArray[np.str_]
    fadings: Sequence[NDArray[np.bool_]]
    calmer: Array
    strange: float = 0.0
    astray: float = 0.0

    @classmethod
    def of(cls, refined: Refined, stonework: Stonework | None = None) -> Stone | None:
        """Of the points that a fit rests on, and all of the site about these; None if they are too few."""
        placed, evidence = refined.placed, refined.evidence
        vault, frame = placed.vault, placed.pose.frame()
        local = evidence.points @ frame[:, :3].T + frame[:, 3]
        surface = vault.evaluate(local, walls=True)
        own = placed.distance(evidence.points)
        residuals = own if stonework is None else stonework.told(evidence.points, surface.component, own)
        weights = evidence.weights / (1 + (residuals / WIDEST) ** 2) ** 2
        weights = weights * ~near_edges(placed, evidence.points, ROUNDED)
        blocks = Partition.of(placed, evidence.points, weights, BLOCKS, LAYERS)
        blocks = without_strays(blocks, residuals)
        mean = blocks.means(residuals[:, None])[:, 0]
        usable = (blocks.weight > 0) & (np.abs(mean) < FARTHEST)
        if usable.sum() < ENOUGH:
            return None
        body = Body.of(vault, float(-blocks.place[usable, 2].min()))
        shown = shapes(local, body)
        moved = blocks.means(np.einsum("nkc,nc->nk", shown.fields, surface.normal))
        return cls(refined, blocks, usable, body, moved, shown.part, shown.alternatives(), residuals - own)

    def cleaned(self) -> Stone:
        """Without blocks that no shape of a mechanism and no other size of the vault explains: furniture, frames."""
        rest, known = self.against(self.refined.loose)
        none = np.empty((0, self.slopes.shape[1]))
        whole = Trend.of_shapes(self.slopes, none, self.parts).beside(*known)
        left = rest
        for _ in range(3):
            near = np.abs(left) < OUTLYING * max(LEAST, 1.4826 * float(np.median(np.abs(left))))
            left = rest - whole.slopes @ whole.likeliest(rest, near)
        usable = self.usable.copy()
        usable[np.flatnonzero(usable)[~near]] = False
        weight = np.where(self.place[:, 2] > 0, self.blocks.weight[self.usable], 0.0)  # walls have doors and cupboards
        off = weight * ~near
        astray = float(np.sqrt(off @ left**2 / max(float(off.sum()), 1e-12)))
        return replace(self, usable=usable, strange=float(off.sum() / max(float(weight.sum()), 1e-12)), astray=astray)

    @property
    def misfit(self) -> float:
        """Standard deviation of all figures [m], as the vault is not quite of this family, or was built otherwise.

        Stone is left out where furniture and frames hide it. Where much of the vault is, it is the vault that is wrong.
        """
        return self.astray if self.strange > STRANGE else 0.0

    @property
    def place(self) -> Array:
        """Where the usable blocks are (m, 3) [m], in the vault's frame."""
        return self.blocks.place[self.usable]

    @property
    def normal(self) -> Array:
        """Their normals (m, 3)."""
        return self.blocks.normal[self.usable]

    @property
    def slopes(self) -> Array:
        """By how much each shape moves the usable blocks (m, k)."""
        return self.moved[self.usable]

    @property
    def deviation(self) -> Array:
        """How far the usable blocks are off the fit (m,) [m]."""
        refined = self.refined
        whole = refined.placed.distance(refined.points) + self.calmer
        out: Array = self.blocks.means(whole[:, None])[self.usable, 0]
        return out

    def against(self, solution: Solution) -> tuple[Array, Known]:
        """What usable blocks are off a solution (m,) [m], and what is known of its unknowns."""
        residuals = solution.residuals + self.calmer
        blocks = with_most(self.blocks, residuals)
        residual = blocks.means(residuals[:, None])[self.usable, 0]
        slopes = blocks.means(secants(solution, self.refined.points))[self.usable]
        return residual, (slopes, *beforehand(solution))

    @property
    def walls(self) -> Sights:
        """Blocks of walls."""
        low = self.place[:, 2] < -0.05
        return Sights(self.place[low], self.normal[low])

"""The arches between the vaults of a scan: each soffit is fitted as a barrel as long as the arch is wide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from vaultcad.errors import NoVaultError
from vaultcad.find.found import Found
from vaultcad.find.misfit import DOUBTFUL
from vaultcad.find.soffit_barrel import fitted_soffit
from vaultcad.fit.label import ArchBand
from vaultcad.survey.soffits import SIGMA, SOFFIT, Soffit
from vaultcad.survey.springings import Springing
from vaultcad.survey.thinned_scan import Thin

Array = NDArray[np.float64]

BESIDE = 0.3  # m beyond a soffit's edges where the vaults beside it are
NEXT = 0.03, 0.25  # m beyond its edges where the vault beside it is looked for
STEP = 0.1  # m along it, in which that must be
DEPTH = 0.05, 0.8  # m by which a vault beside an arch is above it; more is a wall on it
TOGETHER = 1.0  # m along an arch, within which the stone is off by as much
OF_MEDIAN = sqrt(pi / 2)  # standard deviation of a median of n that are spread normally / theirs / √n
HAUNCH, SEEN = 0.7, 0.5  # of its half span on which it is measured, and the share of that where it must be
IN_LINE, APART = 0.3, 2.0  # m that arches of an arcade are out of line, and between their ends, at most


@dataclass(frozen=True)
class FoundArch:
    """An arch. barrel: its soffit. depth: (2,) by which it stands out on its south and its north [m], or NaN.

    depth_std: (2,) their standard deviations [m], likewise. line: of a vault's, the kind that it runs along as a rib.
    """

    soffit: Soffit
    barrel: Found
    depth: Array
    depth_std: Array
    line: str = ""

    def is_along(self, other: FoundArch) -> bool:
        """Whether another lies where this one does, or touches it."""
        along, across = self.soffit.local(other.soffit.place[None])
        turned = abs(np.sin(self.soffit.yaw - other.soffit.yaw))
        reach = max(IN_LINE, (self.soffit.width + other.soffit.width) / 2)
        return bool(abs(along[0]) < self.soffit.length / 2 and abs(across[0]) < reach and turned < IN_LINE)

    def faces(self, others: Sequence[FoundArch]) -> Array:
        """(2,) how deep its own faces are [m], as deep as the lesser; NaN for an arcade's, whose are the wall's.

        Where no vault is seen beside it, those of arches like it tell.
        """
        known = self.depth[np.isfinite(self.depth)]
        if len(known) < 2 and any(self._is_in_line(other.soffit) for other in others if other is not self):
            return np.full(2, np.nan)
        if not len(known):
            alike = np.array([other.depth for other in others if self.soffit.is_like(other.soffit)])
            known = alike[np.isfinite(alike)]
        return np.full(2, known.min(initial=np.inf) if len(known) else np.nan)

    def band(self, depth: Array) -> ArchBand:
        """Where its points lie, with faces (2,) so deep [m]: about its barrel, or its stone if that is far off."""
        soffit, placed = self.soffit, self.barrel.placed
        if self.barrel.misfit.chance < DOUBTFUL:
            return ArchBand(placed, self.barrel.tolerance, depth)
        middle, _ = soffit.local(np.array([[placed.pose.x, placed.pose.y]]))
        return ArchBand(placed, SOFFIT, depth, soffit.whole_curve() - [middle[0], placed.pose.z])

    def _is_in_line(self, other: Soffit) -> bool:
        """Whether another arch goes on where this one ends."""
        along, across = self.soffit.local(other.place[None])
        gap = abs(along[0]) - (self.soffit.length + other.length) / 2
        return bool(abs(across[0]) < IN_LINE and -IN_LINE < gap < APART)

    def beside(self, vaults: Sequence[Found]) -> tuple[int, int]:
        """The numbers, from 1, of the vaults to its south and north; 0 for none."""
        return self._beside(-1, vaults), self._beside(1, vaults)

    def _beside(self, side: int, vaults: Sequence[Found]) -> int:
        """The lowest of the vaults on a side whose crown is above its springing."""
        yaw, pose = self.soffit.yaw, self.barrel.placed.pose
        reach = self.soffit.width / 2 + BESIDE
        place = np.array([[pose.x - side * reach * np.sin(yaw), pose.y + side * reach * np.cos(yaw), pose.z]])
        crowns = {}
        for number, one in enumerate(vaults, 1):
            frame = one.placed.pose.frame()
            local = place @ frame[:, :3].T + frame[:, 3]
            if one.placed.vault.plan.holds(local[:, :2])[0] and local[0, 2] < one.placed.vault.top:
                crowns[number] = one.placed.pose.z + one.placed.vault.top
        return min(crowns, key=lambda number: crowns[number], default=0)


def find_arch(
    soffit: Soffit,
    thin: Thin,
    hung: Array,
    rng: np.random.Generator,
    like: FoundArch | None = None,
    feet: Sequence[Springing] = (),
) -> FoundArch:
    """The arch over a soffit; `hung` (n, 3) [m] are the ceilings, `like` is an arch whose soffit looks like it.

    feet: where it springs.

    Raises:
        NoVaultError: an arch of no kind comes near, or it is a lintel.
    """
    if soffit.is_level:
        raise NoVaultError(f"no arch found: a soffit {soffit.length:.1f} m long is level, as that of a door")
    barrel = fitted_soffit(soffit, thin, rng, None if like is None else like.barrel, feet)
    return FoundArch(soffit, barrel, *_depth(soffit, barrel, hung))


def _depth(soffit: Soffit, barrel: Found, hung: Array) -> tuple[Array, Array]:
    """(2,) how far the vaults on either side stand above an arch [m], and how sure; NaN where none does along much.

    By the median of what is seen of them; within `TOGETHER` all of it errs together, as the stone that settled does.
    """
    along, across = soffit.local(hung)
    near = np.abs(along) < HAUNCH * soffit.length / 2
    depth, std = np.full(2, np.nan), np.full(2, np.nan)
    for k, side in enumerate((-1, 1)):
        beyond = side * across - soffit.width / 2
        mine = np.flatnonzero(near & (beyond > NEXT[0]) & (beyond < NEXT[1]))
        over = _over(soffit, barrel, hung[mine])
        close = (over > DEPTH[0]) & (over < DEPTH[1])
        steps = np.unique(np.floor(along[mine[close]] / STEP))
        if len(steps) * STEP > SEEN * HAUNCH * soffit.length:
            depth[k] = float(np.median(over[close]))
            spread = SIGMA * np.median(np.abs(over[close] - depth[k]))
            std[k] = OF_MEDIAN * spread / sqrt(max(len(steps) * STEP / TOGETHER, 1.0))
    return depth, std


def _over(soffit: Soffit, barrel: Found, points: Array) -> Array:
    """How far points (n, 3), brought to the arch's middle, are above it (n,) [m]."""
    along, _ = soffit.local(points)
    level = soffit.place + along[:, None] * np.array([np.cos(soffit.yaw), np.sin(soffit.yaw)])
    return barrel.placed.distance(np.column_stack([level, points[:, 2]]))

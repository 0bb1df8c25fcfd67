"""The arches between the vaults of a scan: each soffit is fitted as a barrel as long as the arch is wide."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray

from families.kinds.barrel import Barrel
from vaultcad.errors import NoVaultError
from vaultcad.find.found import Found, likeliest_of
from vaultcad.find.likeness import agree, choices_like, starts_like
from vaultcad.find.recognise import recognise
from vaultcad.find.refine import refine
from vaultcad.fit.freedom import Demands
from vaultcad.survey.soffits import SIGMA, Soffit
from vaultcad.survey.springings import Springing
from vaultcad.survey.thinned_scan import STEEP, UPRIGHT, Site, Thin, turned

Array = NDArray[np.float64]

BELOW = 1.0  # m of the piers under a soffit's ends that tell its span
BESIDE = 0.3  # m beyond those ends where the piers' faces may be
WITHIN = 0.02  # m within its edges from which on a point is the soffit's
ENDS = 0.1  # m between the points that tie its edges
NEXT = 0.03, 0.25  # m beyond its edges where the vault beside it is looked for
DEPTH = 0.05, 0.8  # m by which a vault beside an arch is above it; more is a wall on it
TOGETHER = 1.0  # m along an arch, within which the stone is off by as much
OF_MEDIAN = sqrt(pi / 2)  # standard deviation of a median of n that are spread normally / theirs / √n
HAUNCH, SEEN = 0.7, 0.5  # of its half span on which it is measured, and the share of that where it must be
MOST, LEVEL = (0.1, 0.9), 0.03  # most of a soffit, and the share of its length in whose height a lintel's lies
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
        """(2,) how deep its own faces are [m], as deep as the lesser; NaN for an arcade's, whose are the wall's."""
        known = self.depth[np.isfinite(self.depth)]
        if len(known) < 2 and any(self._is_in_line(other.soffit) for other in others if other is not self):
            return np.full(2, np.nan)
        return np.full(2, known.min(initial=np.inf) if len(known) else np.nan)

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
    low, high = np.quantile(soffit.curve[:, 1], MOST)
    if high - low < LEVEL * soffit.length:
        raise NoVaultError(f"no arch found: a soffit {soffit.length:.1f} m long is level, as that of a door")
    barrel = fitted_soffit(soffit, thin, rng, None if like is None else like.barrel, feet)
    return FoundArch(soffit, barrel, *_depth(soffit, barrel, hung))


def fitted_soffit(
    soffit: Soffit, thin: Thin, rng: np.random.Generator, like: Found | None = None, feet: Sequence[Springing] = ()
) -> Found:
    """The barrel of a soffit, as long as that is wide; `like` is one from which it can begin, `feet` where it springs.

    Raises:
        NoVaultError: an arch of no kind comes near.
    """
    site = _site(soffit, thin)
    demands = Demands(sizes={"length": soffit.width, "slope": 0.0, "splay": 0.0}, pose={"yaw": soffit.yaw})
    barrel = _barrel(site, rng, demands, like, feet)
    if like is not None and not agree([barrel], like):
        barrel = _barrel(site, rng, demands, None, feet)
    return barrel


def _barrel(
    site: Site, rng: np.random.Generator, demands: Demands, like: Found | None, feet: Sequence[Springing]
) -> Found:
    """The barrel of a soffit, begun from one like it if there is one.

    Raises:
        NoVaultError: an arch of no kind comes near.
    """
    known = starts_like(like, site, (Barrel,), demands) if like else ()
    hypotheses = recognise(site, rng, families=(Barrel,), demands=demands, known=known)
    refined = refine(hypotheses[0], site, rng, demands=demands, known=like.refined.kept if like else None)
    found = Found(site, hypotheses, refined, refined.tolerance)
    return likeliest_of(found, demands, rng, choices_like(like, found) if like else (), feet)


def _site(soffit: Soffit, thin: Thin) -> Site:
    """The stone of an arch, and of its piers a little."""
    low, crown = float(soffit.curve[:, 1].min()), float(soffit.curve[:, 1].max())
    mine = soffit.holds(thin.points, -WITHIN, BESIDE)
    mine &= (thin.points[:, 2] > low - BELOW) & (thin.points[:, 2] < crown + WITHIN)
    points, normals = thin.points[mine], thin.normals[mine]
    steep = np.abs(normals[:, 2]) < STEEP
    along = np.arange(-soffit.length / 2, soffit.length / 2, ENDS) + ENDS / 2
    local = np.array([(u, side * soffit.width / 2) for side in (-1, 1) for u in along])
    ends = np.column_stack([turned(local, -soffit.yaw) + soffit.place, np.full(len(local), low - BELOW - 1.0)])
    half = np.array([soffit.length, soffit.width]) / 2
    middle = turned(soffit.place[None], soffit.yaw)[0]
    walled = np.array([[(np.abs(normals[:, 2]) < UPRIGHT).any()] * 2, [False, False]])
    return Site(
        points=points,
        normals=normals,
        weights=np.where(steep, 0.4, 1.0),
        yaw=soffit.yaw,
        low=middle - half,
        high=middle + half,
        walled=walled,
        bottom=float(points[:, 2].min(initial=low)),
        crown=crown,
        spacing=thin.spacing,
        ends=ends,
        counts=thin.counts[mine],
    )


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
        steps = np.unique(np.floor(along[mine[close]] / ENDS))
        if len(steps) * ENDS > SEEN * HAUNCH * soffit.length:
            depth[k] = float(np.median(over[close]))
            spread = SIGMA * np.median(np.abs(over[close] - depth[k]))
            std[k] = OF_MEDIAN * spread / sqrt(max(len(steps) * ENDS / TOGETHER, 1.0))
    return depth, std


def _over(soffit: Soffit, barrel: Found, points: Array) -> Array:
    """How far points (n, 3), brought to the arch's middle, are above it (n,) [m]."""
    along, _ = soffit.local(points)
    level = soffit.place + along[:, None] * np.array([np.cos(soffit.yaw), np.sin(soffit.yaw)])
    return barrel.placed.distance(np.column_stack([level, points[:, 2]]))

"""A scan parted by what hangs in it: ceilings that go on in plan, with the walls about them, and arches between.

Patches whose outlines touch in plan are one ceiling, however far a drum lifts the one over the other; soffits of
arches, the walls between rooms, and what hangs above another ceiling part them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vaultcad.survey.backs import below_backs
from vaultcad.survey.bays import check_grid
from vaultcad.survey.dome_rims import is_dome
from vaultcad.survey.part_kernel import own
from vaultcad.survey.patches import SLENDER, Patches, hung_and_other
from vaultcad.survey.plan_grid import Laid, PlanGrid
from vaultcad.survey.soffits import Soffit, soffits_of
from vaultcad.survey.thinned_scan import UPRIGHT, Thin

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Mask = NDArray[np.bool_]

CELL = 0.1, 1.5  # m and spacings; edge of the plan's cells, at least
COARSE = 0.5  # m, edge of cells by which points are told apart that may be a part's
TOUCH, DRUM = 0.35, 0.45  # m between two patches of one ceiling in plan at most; where a drum lifts one of them
PENDENTIVE = 0.8  # m² in plan of what hangs under a drum, and of the dome on it, at least
DRUM_STEEP = 0.5  # mean |nz| of a part of a drum at most
LINTEL = 0.7  # share of a patch that is level, from which on it bears no drum, and is a lintel if it is small
CONTACT = 15  # pairs of cells, one of either patch, that touch: a few where only corners do
LEVEL = 0.8  # m between two patches in height where they touch, of one ceiling before drums are looked for
OVER = 0.3  # share of the lesser patch's plan from which on it hangs over or under another
LEAST = 1.5  # m², of a ceiling
LEVEL_NORMAL = np.cos(np.radians(10.0))  # |nz| of what is level, at least
PIER = 0.5  # m beyond a soffit's ends where ceilings are still parted
AROUND = 0.6  # m about a ceiling that belongs to it: its haunches and walls
ABOVE = 0.3  # m above a ceiling that belongs to it
FACE = 0.04  # m beyond its soffit in which an arch's faces lie
REVEAL = 0.35  # m beyond its soffit's ends where the faces of its piers are
INNER = 0.01  # m within its edges from which on all is an arch's


@dataclass(frozen=True)
class Ceiling:
    """One ceiling. area: [m²], along the stone. part: whose points are its own.

    points: (n, 3) of its patches [m]. level: (n,) where it is level there.
    """

    points: Array
    level: Mask
    area: float
    part: Part


@dataclass(frozen=True)
class Part:
    """A part of the plan: the cells that are held (nx, ny).

    bottom, top: (nx, ny) heights [m] between which its points lie. arches: whose points are not.
    """

    grid: PlanGrid
    held: Mask
    bottom: Array
    top: Array
    arches: tuple[Soffit, ...]

    def holds(self, points: NDArray[np.floating], margin: float = -INNER) -> Mask:
        """Which points (n, 3) [m] are its own, and no arch's; `margin` [m]: by how much those are wider."""
        strips = np.array([arch.strip(margin, REVEAL) for arch in self.arches]).reshape(-1, 6)
        grid, points = self.grid, np.ascontiguousarray(points)
        found: Mask = own(points, grid.low, grid.cell, self.held, self.bottom, self.top, strips)
        return found

    def own(self, laid: Laid) -> NDArray[np.floating]:
        """Its own of all points of a scan, in their order."""
        about = laid.about(*self.grid.bounds)
        return about.compress(self.holds(about), axis=0)

    def thinned(self, thin: Thin) -> Thin:
        """Its points of a thinned scan; none of the faces of arches."""
        mine = self.holds(thin.points)
        (upright,) = np.nonzero(mine & (np.abs(thin.normals[:, 2]) < UPRIGHT))
        mine[upright] = self.holds(thin.points[upright], FACE)
        return thin.only(mine)


@dataclass(frozen=True)
class Parting:
    """The ceilings of a scan, the largest first, and the soffits of the arches between them.

    hung: the patches of all that hangs over rooms.
    """

    ceilings: tuple[Ceiling, ...]
    soffits: tuple[Soffit, ...]
    hung: Patches

    def laid(self, xyz: NDArray[np.floating]) -> Laid:
        """The points (n, 3) [m], as the parts and the ends of soffits ask for their own."""
        corners = np.array([ceiling.part.grid.bounds for ceiling in self.ceilings]).reshape(-1, 2, 2)
        ends = [s.place + side * s.length for s in self.soffits for side in (-1, 1)]
        corners = np.concatenate([corners, np.repeat(np.reshape(ends, (-1, 1, 2)), 2, axis=1)])
        low, high = corners[:, 0].min(axis=0, initial=np.inf), corners[:, 1].max(axis=0, initial=-np.inf)
        grid = PlanGrid.over(low, high, COARSE) if len(corners) else PlanGrid(np.zeros(2), COARSE, (0, 0))
        return Laid.over(grid, xyz)

    @property
    def is_parted(self) -> bool:
        """Whether there is more than one room under one ceiling."""
        return len(self.ceilings) > 1 or bool(self.soffits)


def parted(thin: Thin, xyz: NDArray[np.floating]) -> Parting:
    """Part a scan, from its thinned points and all of them (n, 3) [m].

    Raises:
        NoVaultError: rooms far from each other are in one scan.
    """
    patches, others = hung_and_other(thin)
    if patches.count:
        check_grid(PlanGrid.over(*patches.bounds, CELL[0]).shape, len(thin.points), CELL[0])
    soffits, arches = soffits_of(patches, xyz)
    hung = patches.only(~arches)
    if hung.count == 0:
        return Parting((), soffits, patches)
    plan = _Plan.of(hung, others)
    number = plan.ceilings(soffits)
    areas = np.bincount(number, hung.areas)
    chosen = [k for k in np.argsort(-areas, kind="stable").tolist() if areas[k] >= LEAST]
    parts = plan.parts([number == k for k in chosen], soffits)
    found = []
    for k, mine in zip(chosen, parts, strict=True):
        own = (number == k)[hung.patch]
        level = np.abs(hung.normals[own, 2]) > LEVEL_NORMAL
        found.append(Ceiling(hung.points[own], level, float(areas[k]), mine))
    return Parting(tuple(found), soffits, patches)


@dataclass(frozen=True)
class _Plan:
    """Patches over the cells of a plan: of each cell and patch over it the mean height [m]; each (k,).

    others: what hangs over no room.
    """

    patches: Patches
    others: Patches
    grid: PlanGrid
    column: Ints
    patch: Ints
    height: Array

    @classmethod
    def of(cls, patches: Patches, others: Patches) -> _Plan:
        low, high = patches.bounds
        grid = PlanGrid.over(low - AROUND, high + AROUND, max(CELL[0], CELL[1] * patches.spacing))
        return cls(patches, others, grid, *patches.over(grid))

    def ceilings(self, soffits: tuple[Soffit, ...]) -> Ints:
        """(count,) the ceiling of each patch; soffits part them, and so do the piers at their ends."""
        number = np.arange(self.patches.count)
        for reach, lifted in ((TOUCH, False), (DRUM, True)):
            number = self._linked(number, *self._touching(soffits, reach), lifted=lifted)
        return number

    @cached_property
    def _lintels(self) -> Mask:
        """(count,) which patches are heads of doors and windows, small and level, which hold no ceilings together."""
        level = np.abs(self.patches.normals[:, 2]) > LEVEL_NORMAL
        share = np.bincount(self.patches.patch, level, self.patches.count) / np.bincount(self.patches.patch)
        found: Mask = (share > LINTEL) & (self.patches.areas < LEAST)
        return found

    @cached_property
    def _broad(self) -> Mask:
        """(k,) of which cells the patch is no narrow strip, as cornices are."""
        found: Mask = (self.patches.widths >= SLENDER)[self.patch]
        return found

    def _touching(self, soffits: tuple[Soffit, ...], reach: float) -> tuple[Ints, Ints]:
        """Pairs of cells (n,), (n,) of two patches, no farther than that in plan [m], no soffit between or over them.

        What hangs under a soffit, as a tie rod does, is near both ceilings beside it.
        """
        from scipy.spatial import cKDTree

        places = self.grid.places(self.column)
        a, b = cKDTree(places).query_pairs(reach, output_type="ndarray").T
        other = (self.patch[a] != self.patch[b]) & ~self._lintels[self.patch[a]] & ~self._lintels[self.patch[b]]
        a, b = a[other], b[other]
        under = _in_soffits(soffits, np.column_stack([places, self.height]))
        middle = np.column_stack([(places[a] + places[b]) / 2, np.minimum(self.height[a], self.height[b])])
        free = ~under[a] & ~under[b] & ~_in_soffits(soffits, middle)
        return a[free], b[free]

    def _linked(self, number: Ints, a: Ints, b: Ints, *, lifted: bool) -> Ints:
        """(count,) new numbers of groups that were numbered: of those that touch much, and do not lie over, one.

        lifted: whether one of them has to be above all of the other, as a dome on a drum; else they touch in height.
        """
        group = number[self.patch]
        near = (group[a] != group[b]) & ((np.abs(self.height[a] - self.height[b]) < LEVEL) | lifted)
        pair = np.sort(np.column_stack([group[a[near]], group[b[near]]]), axis=1)
        links, which, touching = np.unique(pair, axis=0, return_inverse=True, return_counts=True)
        which = which.ravel()
        columns = {int(k): set(self.column[group == k].tolist()) for k in np.unique(group)}
        # A dome is joined with its pendentives before anything below these.
        first = [self._gap(group, pair) for pair in links] if lifted else -touching
        for k in np.argsort(first, kind="stable"):
            if lifted and not self._lifts(group, links[k], np.concatenate([a[near], b[near]])[np.tile(which == k, 2)]):
                continue
            i, j = sorted((int(number[links[k, 0]]), int(number[links[k, 1]])))
            lesser = min(len(columns[i]), len(columns[j]))
            if i != j and touching[k] >= min(CONTACT, lesser) and len(columns[i] & columns[j]) < OVER * lesser:
                columns[i] |= columns[j]
                number = np.where(number == j, i, number)
        return number

    def _gap(self, group: Ints, pair: Ints) -> float:
        """How far the higher one of a pair of groups begins above the top of the other [m]."""
        heights = [self.height[group == k] for k in pair.tolist()]
        return float(max(np.min(height) for height in heights) - min(np.max(height) for height in heights))

    def _lifts(self, group: Ints, pair: Ints, contact: Ints) -> bool:
        """Whether one of a pair of groups is a dome on a drum over the other, of whose cells those in `contact` touch.

        It is above all of that, and over no ceiling, as a storey would be. A drum stands on the top of pendentives: a
        vault against the wall of a higher room touches that with its springing. Nor are they level, as lintels. A drum
        itself may be in parts.
        """
        upper, lower = sorted(pair.tolist(), key=lambda k: -float(self.height[group == k].max()))
        bottom = float(self.height[group == upper].min())
        mine, under = self.column[group == upper], self.height[group == lower]
        below = np.isin(mine, self.column[(group != upper) & (self.height < bottom)])
        large = min(len(mine), len(under)) * self.grid.cell**2 > PENDENTIVE
        if not large or bottom <= float(under.max()) or float(below.mean()) >= OVER:
            return False
        level = np.abs(self._normals(group == lower)) > LEVEL_NORMAL
        touching = contact[(group[contact] == lower) & self._broad[contact]]  # a cornice goes all round below
        if level.mean() >= LINTEL or not len(touching) or np.median(self.height[touching]) < np.median(under):
            return False
        is_drum = np.abs(self._normals(group == upper)).mean() < DRUM_STEEP
        cells = np.column_stack(np.divmod(mine, self.grid.shape[1]))
        return bool(is_drum) or is_dome(cells, self.height[group == upper], self.grid.cell)

    def _normals(self, mine: Mask) -> Array:
        """The upward parts (n,) of the normals of a group, by its mask over the cells."""
        upward: Array = self.patches.normals[np.isin(self.patches.patch, self.patch[mine]), 2]
        return upward

    def parts(self, ceilings: list[Mask], soffits: tuple[Soffit, ...]) -> list[Part]:
        """The part of each ceiling, told by masks (count,) of patches: where it is the nearest one of its storey."""
        owner = np.full(self.patches.count, -1)
        for k, mask in enumerate(ceilings):
            owner[mask] = k
        own = owner[self.patch]
        columns = [np.unique(self.column[own == k]) for k in range(len(ceilings))]
        crowns = [float(self.height[own == k].max()) for k in range(len(ceilings))]
        found = []
        for k, crown in enumerate(crowns):
            grid, tops = self._tops(own, k)
            over = {other: _overlap(columns[k], columns[other]) for other in tops}
            beside = [self._away(tops[other]) for other in tops if not over[other]]
            below = [tops[other] for other in tops if over[other] and crowns[other] < crown]
            # Half way to the next one; what is as far from both is both's.
            nearest = np.min(beside, axis=0) if beside else np.inf
            held = self._away(tops[k]) < np.minimum(AROUND, nearest + self.grid.cell / 1e6)
            bottom = np.nan_to_num(np.fmax.reduce(below) if below else np.full(grid.shape, np.nan), nan=-np.inf) + ABOVE
            lowest = np.array([[*np.zeros(2), float(self.height[own == k].min())]])
            arches = tuple(one for one in soffits if one.parts(lowest).any() and one.reaches(*grid.bounds, REVEAL))
            top = np.minimum(below_backs(tops[k], self.others, grid), crown + ABOVE)
            found.append(Part(grid, held, bottom, top, arches))
        return found

    def _tops(self, own: Ints, k: int) -> tuple[PlanGrid, dict[int, Array]]:
        """The cells about a ceiling, and the heights over them (nx, ny) [m] of all that reach there, NaN elsewhere.

        own: (n,) the ceiling of each cell and patch. Only these cells: a site has many ceilings, each in a small part.
        """
        at = np.column_stack(np.divmod(self.column, self.grid.shape[1]))
        margin = int(np.ceil(AROUND / self.grid.cell)) + 1
        low, high = at[own == k].min(axis=0) - margin, at[own == k].max(axis=0) + margin
        x, y = (high - low + 1).tolist()
        grid = PlanGrid(self.grid.low + low * self.grid.cell, self.grid.cell, (x, y))
        near = np.flatnonzero(((at >= low) & (at <= high)).all(axis=1) & (own >= 0))
        tops = {int(number): np.full((x, y), np.nan) for number in np.unique(own[near])}
        for number, top in tops.items():
            mine = near[own[near] == number]
            i, j = (at[mine] - low).T
            np.fmax.at(top, (i, j), self.height[mine])
        return grid, tops

    def _away(self, top: Array) -> Array:
        """How far cells (nx, ny) are from those that a ceiling hangs over [m]."""
        from scipy.ndimage import distance_transform_edt

        return np.asarray(distance_transform_edt(np.isnan(top)) * self.grid.cell, np.float64)


def _in_soffits(soffits: tuple[Soffit, ...], places: Array) -> Mask:
    """Which places (n, 3) [m] lie over or under soffits, or the piers at their ends, in the storey of these."""
    found = np.zeros(len(places), np.bool_)
    for soffit in soffits:
        found |= soffit.holds(places, along=PIER) & soffit.parts(places)
    return found


def _overlap(one: Ints, other: Ints) -> bool:
    """Whether of two ceilings, the cells (n,), (m,) that they hang over, one lies over the other; so it does itself."""
    return len(np.intersect1d(one, other, assume_unique=True)) > OVER * min(len(one), len(other))

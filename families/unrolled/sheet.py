"""The unrolled intrados of a vault: one sheet with all its components, and the ways there and back."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from families.declaration.vault import Vault
from families.unrolled.gores import MOST_DISTORTED, Chart, charts
from families.unrolled.layout import Placement, layout
from families.unrolled.patches import Array, Patch
from families.unrolled.visible import regions

if TYPE_CHECKING:
    from shapely import Geometry, STRtree

KEPT = 64  # sheets that are remembered
BESIDE = 0.02  # [m] from a gore within which a place on the sheet is still its own, less than half of the gap


@dataclass(frozen=True, eq=False)
class Leaf:
    """A gore, or a whole component, where it lies on the sheet. component: 1 + its index in the vault's."""

    chart: Chart
    placement: Placement
    component: int

    @property
    def name(self) -> str:
        """Of the component."""
        return self.chart.name

    @cached_property
    def outline(self) -> Geometry:
        """Its border on the sheet [m]."""
        import shapely

        return shapely.transform(self.chart.outline, self.placement.placed)

    def flat(self, a: Array, b: Array) -> Array:
        """Places (n, 2) [m] on the sheet of coordinates (n,) of its patch."""
        return self.placement.placed(self.chart.development.flat(a, b))

    def surface(self, st: Array) -> Array:
        """The points (n, 3) [m] of the ideal surface, in the vault's frame, that lie at places (n, 2)."""
        return self.chart.region.patch.place(*self.chart.development.coordinates(self.placement.back(st)))


@dataclass(frozen=True, eq=False)
class Sheet:
    """All of a vault's intrados on one sheet [m], as it is seen from above: each part is turned as it lies in plan."""

    vault: Vault
    leaves: tuple[Leaf, ...]

    @cached_property
    def bounds(self) -> tuple[float, float, float, float]:
        """The least s and t, the largest s and t [m]."""
        import shapely

        s0, t0, s1, t1 = shapely.total_bounds([leaf.outline for leaf in self.leaves]).tolist()
        return s0, t0, s1, t1

    @property
    def distortion(self) -> float:
        """The largest relative error of lengths on it; on the share `beyond` of the surface it is more than allowed."""
        return max((leaf.chart.distortion for leaf in self.leaves), default=0.0)

    @property
    def beyond(self) -> float:
        """On what share of the surface lengths are less true than they were to be, next to points of a web."""
        whole = sum(leaf.chart.surface for leaf in self.leaves)
        return sum(leaf.chart.beyond * leaf.chart.surface for leaf in self.leaves) / whole if whole else 0.0

    def lay(self, xyz: NDArray[np.floating], component: NDArray[np.integer]) -> tuple[Array, NDArray[np.int32]]:
        """Where points (n, 3) [m] in the vault's frame lie on the sheet (n, 2), by their feet on their component (n,).

        Also the index (n,) of the leaf. Points of no component, or one that does not show, are at NaN, of leaf -1.
        """
        place, leaf = np.full((len(xyz), 2), np.nan), np.full(len(xyz), -1, np.int32)
        points = np.asarray(xyz, dtype=np.float64)
        for number, found in self._parts.items():
            mine = np.flatnonzero(component == number)
            if len(mine):
                place[mine], leaf[mine] = self._laid(found, points[mine])
        return place, leaf

    def lift(self, st: NDArray[np.floating]) -> tuple[Array, NDArray[np.int32]]:
        """The points (n, 3) [m] of the ideal surface, in the vault's frame, at places (n, 2) of the sheet.

        Also the index (n,) of the leaf; off all leaves by more than `BESIDE` points are NaN, of leaf -1.
        """
        import shapely

        places = np.asarray(st, dtype=np.float64)
        xyz, leaf = np.full((len(places), 3), np.nan), np.full(len(places), -1, np.int32)
        points = shapely.points(places)
        at, which = self._tree.query_nearest(points, max_distance=BESIDE, all_matches=False)
        leaf[at] = which
        for k in np.unique(which).tolist():
            mine = leaf == k
            xyz[mine] = self.leaves[k].surface(places[mine])
        return xyz, leaf

    def normals(self, xyz: Array) -> Array:
        """Unit normals (n, 3) into the stone at points (n, 3) of the surface."""
        return self.vault.evaluate(xyz).normal

    @cached_property
    def _tree(self) -> STRtree:
        import shapely

        return shapely.STRtree([leaf.outline for leaf in self.leaves])

    @cached_property
    def _parts(self) -> dict[int, list[_Part]]:
        """By component: its patches, each with the leaves that show of it."""
        found: dict[int, dict[int, list[int]]] = defaultdict(lambda: defaultdict(list))
        for k, leaf in enumerate(self.leaves):
            found[leaf.component][leaf.chart.region.row].append(k)
        return {
            number: [_Part.of([self.leaves[k].chart for k in own], own) for own in rows.values()]
            for number, rows in found.items()
        }

    def _laid(self, parts: list[_Part], xyz: Array) -> tuple[Array, NDArray[np.int32]]:
        feet, distance = parts[0].patch.feet(xyz)
        which = np.zeros(len(xyz), np.int32)
        # All bodies of a component are of one piece of the void, where the farthest in the stone decides.
        for k, part in enumerate(parts[1:], 1):
            foot, off = part.patch.feet(xyz)
            mine = off > distance
            feet[mine], distance[mine], which[mine] = foot[mine], off[mine], k
        place, leaf = np.empty((len(xyz), 2)), np.empty(len(xyz), np.int32)
        for k, part in enumerate(parts):
            own = which == k if len(parts) > 1 else slice(None)
            a, b = part.patch.coordinates(feet[own])
            leaves, a, b = part.leaf(a, b)
            laid = np.empty((len(a), 2))
            for number in part.leaves:
                here = leaves == number if len(part.leaves) > 1 else slice(None)
                laid[here] = self.leaves[number].flat(a[here], b[here])
            place[own], leaf[own] = laid, leaves
        return place, leaf


@dataclass(frozen=True, eq=False)
class _Part:
    """A patch and the leaves that show of it.

    reach: of the charts, along a and b. cells: between all edges of what shows, a and b, the leaf there or nearest.
    """

    patch: Patch
    leaves: list[int]
    reach: tuple[tuple[float, float], tuple[float, float]]
    a: Array
    b: Array
    cells: NDArray[np.int32]

    @staticmethod
    def of(charts: list[Chart], leaves: list[int]) -> _Part:
        boxes = np.array([chart.region.area.bounds for chart in charts])[:, [0, 2, 1, 3]]
        a, b = np.unique(boxes[:, :2]), np.unique(boxes[:, 2:])
        laid = np.array([chart.development.box for chart in charts])
        x, y = (a[1:, None] + a[:-1, None]) / 2, (b[1:] + b[:-1]) / 2
        beyond = [
            np.maximum(np.maximum(a0 - x, x - a1), 0) / (a[-1] - a[0])
            + np.maximum(np.maximum(b0 - y, y - b1), 0) / (b[-1] - b[0])
            for a0, a1, b0, b1 in boxes
        ]
        cells = np.array(leaves, np.int32)[np.argmin(beyond, axis=0)]
        reach = (laid[:, 0].min(), laid[:, 1].max()), (laid[:, 2].min(), laid[:, 3].max())
        return _Part(charts[0].region.patch, leaves, reach, a, b, cells)

    def leaf(self, a: Array, b: Array) -> tuple[NDArray[np.int32], Array, Array]:
        """The leaves (n,) of coordinates, and these, drawn in where they are beyond."""
        a, b = np.clip(a, *self.reach[0]), np.clip(b, *self.reach[1])
        i = np.clip(np.searchsorted(self.a, a, side="right") - 1, 0, len(self.a) - 2)
        j = np.clip(np.searchsorted(self.b, b, side="right") - 1, 0, len(self.b) - 2)
        return self.cells[i, j], a, b


@lru_cache(maxsize=KEPT)
def unrolled(vault: Vault, limit: float = MOST_DISTORTED) -> Sheet:
    """The sheet of a vault, always the same for the same vault. limit: relative error of lengths on it at the most.

    >>> from families import Barrel
    >>> sheet = unrolled(Barrel(span=4, length=6))
    >>> [round(value, 3) for value in sheet.bounds]  # half the circumference of a circle, by its length
    [-3.142, -3.0, 3.142, 3.0]
    >>> sheet.lift(np.array([[0.0, 1.0]]))[0].round(6).tolist()
    [[0.0, 1.0, 2.0]]
    """
    made = list(charts(regions(vault), limit))
    numbers = {name: k for k, name in enumerate(vault.components, 1)}
    places = layout(made, vault.plan.centre)
    return Sheet(
        vault, tuple(Leaf(chart, place, numbers[chart.name]) for chart, place in zip(made, places, strict=True))
    )

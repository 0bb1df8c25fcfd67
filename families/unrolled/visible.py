"""Which part of a patch shows under which name, as areas in its coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, pi
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import Ball, BarrelPart, Part, Turned
from families.declaration.plan import NOTCH, SHAPE, Plan
from families.declaration.vault import Vault
from families.unrolled.patches import Array, Box, Patch, patch
from families.void import body_table, kernel

if TYPE_CHECKING:
    from shapely import Geometry

STEPS = 97  # of the net on which limits are traced, either way
TOUCHING = 1e-6  # [m] by which a body may stand before another and still show
SLIVER = 1e-3  # share of the coordinates of a patch
SILENT = 1e3  # [m]; distances beyond that are of bodies that say nothing
LEAST = 1e-4  # [m²] of a region, in its coordinates


@dataclass(frozen=True, eq=False)
class Region:
    """A patch where it shows under one name. area: in its coordinates; row: of its body in the vault's table."""

    name: str
    patch: Patch
    area: Geometry
    row: int


def regions(vault: Vault) -> Iterator[Region]:
    """All that shows of a vault."""
    pieces, plan = vault.pieces(), vault.plan
    table = body_table.pack(pieces, vault.components)
    table[:, body_table.SIDE] = np.where(table[:, body_table.KIND] <= body_table.BENT, 0.0, table[:, body_table.SIDE])
    bodies = [(piece.foot, part) for piece in pieces for part in piece.parts]
    for row, (foot, part) in enumerate(bodies):
        found = patch(part, plan, 0.0 if isinstance(part, BarrelPart) else foot or 0.0)
        if found is not None:
            net = _Net(found, [part for _, part in bodies], plan, table)
            for name, box in _named(found):
                area = net.shown(row, box, foot)
                if area.area > LEAST:
                    yield Region(name, found, area, row)


def _named(found: Patch) -> Iterator[tuple[str, Box]]:
    """The names of a patch and the boxes of its coordinates in which each holds, as the kernel chooses them."""
    part, (a0, a1, b0, b1) = found.part, found.box
    match part:
        case Ball() if len(part.names) == 4:
            turns = ((pi / 2, pi), (-pi, -pi / 2), (0.0, pi / 2), (-pi / 2, 0.0))  # from north, counterclockwise
            yield from ((name, (a0, a1, *turn)) for name, turn in zip(part.names, turns, strict=True))
        case Turned() if part.names[0] != part.names[1]:
            spring = found.meridian.springing  # type: ignore[attr-defined]  # a turned patch has one
            yield part.names[1], (a0, min(a1, spring), b0, b1)
            yield part.names[0], (spring, max(a1, spring), b0, b1)
        case BarrelPart():
            spring = found.meridian.springing if part.below else inf  # type: ignore[attr-defined]  # likewise
            south, north = part.names
            ends = ((south, b0, b1),) if south == north else ((south, b0, 0.0), (north, 0.0, b1))
            for name, start, end in ends:
                yield name, (max(a0, -spring), min(a1, spring), start, end)
            if a1 > spring:
                yield part.below, (spring, a1, b0, b1)
            if a0 < -spring:
                yield part.below, (a0, -spring, b0, b1)
        case _:
            yield part.names[0], found.box  # type: ignore[union-attr]  # a lid has no patch


class _Net:
    """Points all over a patch, and how far they are from the other bodies and the sides of the plan."""

    def __init__(self, found: Patch, parts: Sequence[Part], plan: Plan, table: Array) -> None:
        a0, a1, b0, b1 = found.box
        self.a, self.b = np.linspace(a0, a1, STEPS), np.linspace(b0, b1, STEPS)
        a, b = (grid.ravel() for grid in np.meshgrid(self.a, self.b, indexing="ij"))
        self.xyz = np.ascontiguousarray(found.place(a, b))
        self.parts, self.table, self.plan = parts, table, body_table.pack_plan(plan)

    def shown(self, row: int, box: Box, foot: float | None) -> Geometry:
        """Where the body in a row of the table shows, within a box of coordinates."""
        import shapely
        from scipy.ndimage import binary_dilation

        a0, a1, b0, b1 = box
        area: Geometry = shapely.box(a0, b0, a1, b1)
        if a1 - a0 <= 0 or b1 - b0 <= 0:
            return shapely.Polygon()
        limits = [(np.minimum.reduce(limit) > TOUCHING, limit) for limit in self._limits(row, foot)]
        alive = np.ones((STEPS, STEPS), bool)
        for beyond, limit in sorted(limits, key=lambda one: -int(one[0].sum())):
            # What the others leave of the net may keep to this one without tracing.
            if (beyond & binary_dilation(alive, np.ones((3, 3), bool))).any():
                keeps = [self._traced(values) for values in limit if values.min() <= TOUCHING]
                area = area.intersection(shapely.union_all(keeps)) if keeps else shapely.Polygon()
                alive &= ~beyond
        return _without_slivers(area, box)

    def _limits(self, row: int, foot: float | None) -> Iterator[list[Array]]:
        """Each as values (STEPS, STEPS) of which one has to be at most `TOUCHING` where the body shows."""
        height = self.xyz[:, 2].reshape(STEPS, STEPS)
        free = [] if foot is None else [foot - height]
        inward = 0.0 if foot is None else 2 * TOUCHING  # below a drum the walls on the plan's edge are the plan's
        yield [-height]
        notch = []
        for k in range(len(self.plan)):
            away = self._distance(-1 - k) + inward
            if self.plan[k, SHAPE] == NOTCH:
                notch.append(away)
            else:
                yield [away, *free]
        if notch:
            yield [*notch, *free]
        piece = self.table[row, body_table.PIECE]
        for k in np.flatnonzero(self.table[:, body_table.PIECE] == piece).tolist():
            if k != row:
                yield [self._distance(k), *self._silence(k)]
        for other in np.unique(self.table[self.table[:, body_table.PIECE] != piece, body_table.PIECE]):
            rows = np.flatnonzero(self.table[:, body_table.PIECE] == other).tolist()
            yield [-self._distance(k) for k in rows]

    def _distance(self, row: int) -> Array:
        """To a body or, below 0, a side of the plan [m]."""
        rows = np.full(len(self.xyz), row)
        found = kernel.to_rows(self.xyz, np.eye(3, 4), self.table, self.plan, rows)
        clipped: Array = np.clip(found, -SILENT, SILENT).reshape(STEPS, STEPS)
        return clipped

    def _silence(self, row: int) -> Iterator[Array]:
        """How far the points are from where a cove says nothing, on the other side of its axis [m]."""
        part = self.parts[row]
        if isinstance(part, BarrelPart) and part.side:
            across = (self.xyz[:, :2] - part.origin) @ np.array(part.across)
            yield (part.side * across).reshape(STEPS, STEPS)

    def _traced(self, values: Array) -> Geometry:
        """Where values are at most `TOUCHING`, in coordinates."""
        import shapely
        from contourpy import FillType, contour_generator

        lines: Any = contour_generator(self.b, self.a, values, fill_type=FillType.OuterOffset)
        points, offsets = lines.filled(-2 * SILENT, TOUCHING)
        found = []
        for row, ends in zip(points, offsets, strict=True):
            rings: list[NDArray[np.float64]] = [row[i:j, ::-1] for i, j in pairwise(ends)]
            found.append(shapely.Polygon(rings[0], rings[1:]))
        return shapely.make_valid(shapely.union_all(shapely.make_valid(np.array(found, dtype=object))))


def _without_slivers(area: Geometry, box: Box) -> Geometry:
    """An area without what is thinner than `SLIVER` of its box, as where all lines of a patch meet at a side."""
    import shapely

    a0, a1, b0, b1 = box
    low, size = np.array([a0, b0]), np.array([a1 - a0, b1 - b0])
    unit = shapely.transform(area, lambda ab: (ab - low) / size)
    kept = unit.intersection(unit.buffer(-SLIVER / 2, join_style="mitre").buffer(2 * SLIVER, join_style="mitre"))
    return shapely.transform(kept, lambda ab: ab * size + low)

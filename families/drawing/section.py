"""An ideal vault cut through its middle: the room's outline, found on the numeric surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby, pairwise
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from families.declaration.palette import Colour, colour
from families.declaration.plan import Plan, Side
from families.declaration.vault import Vault
from families.drawing.looks import CLOSER, MOST_DOTS, OUTSIDE, SLAB
from families.drawing.sheet import Drawing, Floats
from families.void.columns import heights

OUTLINE_STEPS = 241  # an odd number, so that one of them is at the crown
INSIDE = 1 - 1e-9
ON_PLAN = 1e-9  # [m]
Outline = tuple[Floats, NDArray[np.uint16]]


@dataclass(frozen=True)
class CutPlane:
    """A vertical section through the middle: across which axis (0 or 1), its letter, and to which side it looks."""

    axis: int
    letter: str
    looks: int

    @property
    def across(self) -> int:
        """The axis that is drawn from left to right."""
        return 1 - self.axis

    def drawn(self, points: Floats) -> Floats:
        """Points (n, 3) as the section shows them, (n, 2)."""
        return points[:, [self.across, 2]]

    def near(self, points: Floats, at: float = 0.0) -> NDArray[np.intp]:
        """Which of the points (n, 3) lie within the slab about the section, or one beside it; thinned."""
        found = np.flatnonzero(np.abs(points[:, self.axis] - at) < SLAB)
        return found[:: max(1, -(-len(found) // MOST_DOTS))]

    def chords(self, vault: Vault, at: float = 0.0) -> list[tuple[float, float]]:
        """Where the section enters and leaves the plan [m], once or more often."""
        return chords(vault.plan, self.axis, at)

    def clear(self, vault: Vault, at: float = 0.0) -> tuple[float, float]:
        """Where it enters the plan first and leaves it last [m]."""
        found = self.chords(vault, at)
        return found[0][0], found[-1][1]

    def closer(self, vault: Vault) -> float:
        """Where it is cut a second time [m], nearer to the wall that it looks to."""
        low, high = vault.plan.box
        return CLOSER * float((high if self.looks > 0 else low)[self.axis])


PLANES = (CutPlane(1, "A", +1), CutPlane(0, "B", -1))


def chords(plan: Plan, axis: int, at: float) -> list[tuple[float, float]]:
    """Between which values of the other coordinate a plan lies where one coordinate is `at` [m], in their order."""
    met = sorted(value for side in plan.sides for value in _crossings(side, axis, at))
    found: list[tuple[float, float]] = []
    for low, high in pairwise(met):
        middle = np.full((1, 2), at)
        middle[0, 1 - axis] = (low + high) / 2
        if high - low < ON_PLAN or plan.distance(middle)[0] > ON_PLAN:
            continue
        joins = found and low - found[-1][1] < ON_PLAN
        found.append((found.pop()[0] if joins else low, high))
    return found


def _crossings(side: Side, axis: int, at: float) -> Iterator[float]:
    """Where a side of a plan has one coordinate `at` [m]: its other coordinate."""
    a, b = side.start, side.end
    if side.centre is None:
        if min(a[axis], b[axis]) - ON_PLAN <= at <= max(a[axis], b[axis]) + ON_PLAN and a[axis] != b[axis]:
            yield a[1 - axis] + (at - a[axis]) / (b[axis] - a[axis]) * (b[1 - axis] - a[1 - axis])
    elif (gap := abs(at - side.centre[axis])) < side.radius:
        reach = sqrt(side.radius**2 - gap**2)
        # Also where the circle goes on beyond its arc: what lies between two of them is within the plan or it is not.
        yield from (side.centre[1 - axis] - reach, side.centre[1 - axis] + reach)


def section(vault: Vault, plane: CutPlane, points: Floats | None = None) -> Drawing:
    """The room cut at the crown in the components' colours, in grey nearer to a wall; the points (n, 3) [m] near."""
    cuts, behind = (outlines(vault, plane.across, at) for at in (0.0, plane.closer(vault)))
    reach = np.concatenate([line for line, _ in (*cuts, *behind)])
    drawing = Drawing(reach.min(axis=0), reach.max(axis=0), f"Section {plane.letter}–{plane.letter}: {vault.title}")
    for line, _ in behind:
        drawing.line(line, "closer")
    for line, component in cuts:
        for row, shade, name in stretches(vault, line, component):
            drawing.line(row, "intrados" if shade else "edge", shade, name)
    if points is not None:
        drawing.dots(plane.drawn(points[plane.near(points)]), "scan")
    measured(drawing, vault, plane)
    return drawing


def measured(drawing: Drawing, vault: Vault, plane: CutPlane) -> None:
    """Add to a section the line of the springing, the clear widths and the rise."""
    rise, out = vault.derived_values()["rise"], OUTSIDE * drawing.margin
    right = float(drawing.high[0]) + out
    drawing.line(((drawing.low[0] - out, 0.0), (right, 0.0)), "springing")
    foot = float(drawing.low[1]) - out
    for low, high in plane.chords(vault):
        drawing.dimension((low, foot), (high, foot))
    drawing.dimension((right, vault.lift), (right, vault.lift + rise))


def stretches(vault: Vault, line: Floats, component: NDArray[np.uint16]) -> Iterator[tuple[Floats, Colour | None, str]]:
    """The parts of a line (n, 2) that are of one component (n - 1,) each, its colour and name; a wall has no colour."""
    for k, run in groupby(range(len(component)), key=lambda i: int(component[i])):
        stretch = list(run)
        shade, name = (colour(k), vault.components[k - 1]) if k else (None, "wall")
        yield line[stretch[0] : stretch[-1] + 2], shade, name


def outlines(vault: Vault, across: int, at: float, steps: int = OUTLINE_STEPS) -> list[Outline]:
    """The room's outlines where the other coordinate is `at` [m], one wherever that crosses the plan.

    Each from springing to springing: (n, 2) [m], `steps` of them over the plan, and the component of each stretch
    between, 0 on a wall.
    """
    return [_outline(vault, across, at, chord, steps) for chord in chords(vault.plan, 1 - across, at)]


def _outline(vault: Vault, across: int, at: float, chord: tuple[float, float], steps: int) -> Outline:
    left, right = chord
    middle, half = (left + right) / 2, (right - left) / 2

    def placed(u: Floats) -> Floats:
        places = np.full((len(u), 2), at)
        places[:, across] = middle + INSIDE * (u - middle)
        return places

    # Closer where arches are steep.
    u = middle + half * np.sin(np.linspace(-np.pi / 2, np.pi / 2, steps))
    line = np.concatenate([[[left, 0.0]], np.column_stack([u, heights(vault, placed(u))]), [[right, 0.0]]])
    between, z = ((line[:-1] + line[1:]) / 2).T
    return line, vault.evaluate(np.column_stack([placed(between), z]), walls=True).component

"""An ideal vault cut through its middle: the room's outline, found on the numeric surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from families.declaration.palette import Colour, colour
from families.declaration.plan import Plan
from families.declaration.vault import Vault
from families.drawing.looks import CLOSER, MOST_DOTS, OUTSIDE, SLAB
from families.drawing.sheet import Drawing, Floats
from families.void import upright
from families.void.upright import OUTLINE_STEPS, Outline, Upright


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
    return upright.chords(plan, Upright.along_axis(1 - axis, at))


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
    """The room's outlines where the other coordinate is `at` [m], see `families.void.upright.outlines`."""
    return upright.outlines(vault, Upright.along_axis(across, at), steps)

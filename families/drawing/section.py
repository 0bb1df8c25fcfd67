"""An ideal vault cut through its middle: the room's outline, found on the numeric surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from families.declaration.palette import Colour, colour
from families.declaration.vault import Vault
from families.drawing.looks import CLOSER, MOST_DOTS, OUTSIDE, SLAB
from families.drawing.sheet import Drawing, Floats

OUTLINE_STEPS, HALVINGS = 241, 40  # an odd number, so that one of them is at the crown
INSIDE = 1 - 1e-9


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

    def clear(self, vault: Vault, at: float = 0.0) -> tuple[float, float]:
        """Where the section enters and leaves the plan [m]."""
        return chord(vault.corners, self.axis, at)

    def closer(self, vault: Vault) -> float:
        """Where it is cut a second time [m], nearer to the wall that it looks to."""
        along = vault.corners[:, self.axis]
        return CLOSER * float(along.max() if self.looks > 0 else along.min())


PLANES = (CutPlane(1, "A", +1), CutPlane(0, "B", -1))


def chord(corners: Floats, axis: int, at: float) -> tuple[float, float]:
    """Between which values of the other coordinate a plan of corners (n, 2) lies where one coordinate is `at` [m]."""
    a, b = corners, np.roll(corners, -1, axis=0)
    reach = b[:, axis] - a[:, axis]
    crossed = (np.minimum(a, b)[:, axis] <= at) & (at <= np.maximum(a, b)[:, axis]) & (reach != 0)
    share = (at - a[crossed, axis]) / reach[crossed]
    found = a[crossed, 1 - axis] + share * (b - a)[crossed, 1 - axis]
    return float(found.min()), float(found.max())


def section(vault: Vault, plane: CutPlane, points: Floats | None = None) -> Drawing:
    """The room cut at the crown in the components' colours, in grey nearer to a wall; the points (n, 3) [m] near."""
    low, high = plane.clear(vault)
    rise = vault.derived_values()["rise"]
    drawing = Drawing((low, 0.0), (high, rise), f"Section {plane.letter}–{plane.letter}: {vault.title}")
    closer, _ = outline(vault, plane.across, plane.closer(vault))
    drawing.line(closer, "closer")
    line, component = outline(vault, plane.across, 0.0)
    for row, shade, name in stretches(vault, line, component):
        drawing.line(row, "intrados" if shade else "edge", shade, name)
    if points is not None:
        drawing.dots(plane.drawn(points[plane.near(points)]), "scan")
    measured(drawing, vault, plane)
    return drawing


def measured(drawing: Drawing, vault: Vault, plane: CutPlane) -> None:
    """Add to a section the line of the springing, the clear width and the rise."""
    (low, high), rise, out = plane.clear(vault), vault.derived_values()["rise"], OUTSIDE * drawing.margin
    right = float(drawing.high[0]) + out
    drawing.line(((drawing.low[0] - out, 0.0), (right, 0.0)), "springing")
    foot = float(drawing.low[1]) - out
    drawing.dimension((low, foot), (high, foot))
    drawing.dimension((right, 0.0), (right, rise))


def stretches(vault: Vault, line: Floats, component: NDArray[np.uint16]) -> Iterator[tuple[Floats, Colour | None, str]]:
    """The parts of a line (n, 2) that are of one component (n - 1,) each, its colour and name; a wall has no colour."""
    for k, run in groupby(range(len(component)), key=lambda i: int(component[i])):
        stretch = list(run)
        shade, name = (colour(k), vault.components[k - 1]) if k else (None, "wall")
        yield line[stretch[0] : stretch[-1] + 2], shade, name


def outline(vault: Vault, across: int, at: float, steps: int = OUTLINE_STEPS) -> tuple[Floats, NDArray[np.uint16]]:
    """The room's outline where the other coordinate is `at` [m], from springing to springing.

    (n, 2) [m], `steps` of them over the plan, and the component of each stretch between, 0 on a wall. The highest point
    over each place is found by halving on the numeric surface.
    """
    left, right = chord(vault.corners, 1 - across, at)
    middle, half = (left + right) / 2, (right - left) / 2

    def placed(u: Floats, z: Floats) -> Floats:
        points = np.full((len(u), 3), at)
        points[:, across], points[:, 2] = middle + INSIDE * (u - middle), z
        return points

    # Closer where arches are steep.
    u = middle + half * np.sin(np.linspace(-np.pi / 2, np.pi / 2, steps))
    low, high = np.zeros(steps), np.full(steps, vault.derived_values()["rise"] + 1.0)
    for _ in range(HALVINGS):
        z = (low + high) / 2
        room = vault.distance(placed(u, z)) < 0
        low, high = np.where(room, z, low), np.where(room, high, z)
    line = np.concatenate([[[left, 0.0]], np.column_stack([u, low]), [[right, 0.0]]])
    between = (line[:-1] + line[1:]) / 2
    return line, vault.evaluate(placed(*between.T), walls=True).component

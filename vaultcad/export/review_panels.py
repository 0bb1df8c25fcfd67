"""The drawings of a review: plan, map of deviations, and sections of one vault with the scan's points."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.export.drawing import OFF_CENTRE, PLANES, CutPlane, cut
from vaultcad.export.geometry import bodies, loops, shell
from vaultcad.export.palette import colour
from vaultcad.model import FittedVault

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]

SLICE = 0.03  # [m] to either side of a section from which points are shown
BESIDE = 0.6  # of the way to the wall: where the second cut of a section is
WALLS = (-0.4, 0.1)  # [m] above the springing: the points of walls that the plan shows
AROUND = 0.1  # of the larger side of what is drawn, left free around it
CELLS = (90, 75, 60, 50, 40, 30, 20)  # of the map along the longer side of the plan; the first in which
PER_CELL = 4  # points lie in most cells that have any
GROWN = 10  # deviations in sections are drawn so many times
LIMITS = (5, 10, 20, 30, 50, 100, 200, 500)  # [mm] that a map may end at
INK, SOFT = "#222222", "#8a8a8a"


@dataclass(frozen=True)
class Seen:
    """A vault with what the scan shows around it.

    points: (n, 3) [m] in its frame. component: (n,), 0 off this vault. deviation: (n,) [m], signed.
    """

    fitted: FittedVault
    thickness: float
    points: Floats
    component: NDArray[np.integer]
    deviation: Floats

    @property
    def vault(self) -> Vault:
        """The ideal vault."""
        return self.fitted.vault

    @cached_property
    def half(self) -> Floats:
        """Half extents (2,) of the plan [m]."""
        return np.array([self.vault.plan.half_x, self.vault.plan.half_y])

    @cached_property
    def on(self) -> NDArray[np.bool_]:
        """Which points (n,) are the vault's."""
        return (self.component > 0) & np.isfinite(self.deviation)

    @property
    def walls(self) -> Floats:
        """Points (m, 3) of the walls under this vault, at its springing."""
        x, y, z = self.points.T
        half_x, half_y = self.half + self.around
        here = (np.abs(x) < half_x) & (np.abs(y) < half_y) & (z > WALLS[0]) & (z < WALLS[1])
        walls: Floats = self.points[here & ~self.on]
        return walls

    @cached_property
    def limit(self) -> float:
        """Deviation [mm] at the ends of the scale: 98 % of the points are nearer."""
        most = 1000 * float(np.quantile(np.abs(self.deviation[self.on]), 0.98)) if self.on.any() else 0.0
        return float(next((limit for limit in LIMITS if limit >= most), LIMITS[-1]))

    @cached_property
    def top(self) -> float:
        """Height of the extrados over the springing [m]."""
        return self.vault.derived_values()["rise"] + self.thickness

    @cached_property
    def around(self) -> float:
        """What is left free around a drawing [m]."""
        return AROUND * max(2 * float(self.half.max()), self.top)

    @cached_property
    def side(self) -> float:
        """Of the square [m] into which plan and sections fit at one scale, with what is left free around them."""
        return max(2 * float(self.half.max()), self.top) + 2 * self.around

    @cached_property
    def shades(self) -> Floats:
        """Colours (m, 3) of the vault's points."""
        table = np.array([colour(k).unit for k in range(len(self.vault.components) + 1)])
        shades: Floats = table[self.component[self.on]]
        return shades

    @property
    def colours(self) -> dict[str, Any]:
        """How deviations [mm] are coloured."""
        return {"cmap": "RdBu", "vmin": -self.limit, "vmax": self.limit}

    def edges(self) -> Iterator[Floats]:
        """Borders (n, 2) of the components in plan, closed; without what of them lies in the mouths of lunettes."""
        mesh = shell(self.vault, self.thickness)
        for k in range(1, len(self.vault.components) + 1):
            for row in loops(mesh.triangles[mesh.component == k]):
                yield np.clip(mesh.vertices[[*row, row[0]], :2], -self.half, self.half)


def plan(axes: Axes, seen: Seen) -> None:
    """The vault's points in the colours of their components, the walls under it, the model's edges."""
    dots(axes, seen.walls[:, :2], c=SOFT, s=0.6)
    dots(axes, seen.points[seen.on, :2], c=seen.shades, s=1.5)
    _edges(axes, seen)
    for plane in PLANES:
        end = np.zeros(2)
        end[plane.across] = seen.half[plane.across] + 0.35 * seen.around
        axes.plot(*np.array([-end, end]).T, color=INK, linewidth=0.8, dashes=(12, 3, 2, 3))
        for sign in (-1, 1):
            x, y = sign * end * (1 + 0.2 * seen.around / end.max())
            axes.text(x, y, plane.letter, ha="center", va="center", weight="bold")
    axes.set_title("Plan: components; grey: walls at the springing")
    _framed(axes, seen, -seen.half, seen.half)


def deviations(axes: Axes, scale: Axes, seen: Seen) -> None:
    """Mean deviation a cell of the plan, with its scale [mm]; hatched where the scan saw nothing of the model."""
    for row in seen.edges():
        axes.fill(*row.T, facecolor="white", edgecolor=SOFT, hatch="/////", linewidth=0, zorder=-1)
    (x, y), (right, top) = seen.points[seen.on, :2].T, seen.half.tolist()
    ends = [[-right, right], [-top, top]]
    for along in CELLS:
        cells = [ceil(along * half / max(right, top)) for half in (right, top)]
        counts, *_ = np.histogram2d(x, y, cells, ends)
        if (counts >= PER_CELL).sum() > 0.5 * (counts > 0).sum():
            break
    sums, *_ = np.histogram2d(x, y, cells, ends, weights=1000 * seen.deviation[seen.on])
    mean = np.ma.masked_where(counts == 0, sums / np.maximum(counts, 1))
    extent = (-right, right, -top, top)
    picture = axes.imshow(mean.T, origin="lower", extent=extent, interpolation="nearest", **seen.colours)
    scale.figure.colorbar(picture, cax=scale, extend="both")
    scale.set_title("mm")
    _edges(axes, seen)
    axes.set_title("Deviation: red into the room, blue into the stone; hatched: no points on it")
    _framed(axes, seen, -seen.half, seen.half)


def section(axes: Axes, seen: Seen, plane: CutPlane) -> None:
    """The stone cut at the crown and, behind it, nearer to the wall that the section looks to; the points near both.

    Those at the crown come a second time in colour, with their deviations drawn larger.
    """
    across, half = [plane.across, 2], seen.half
    cuts = ((BESIDE * plane.looks * half[plane.axis], SOFT, 0.0), (OFF_CENTRE, INK, 0.35))
    for at, ink, fill in cuts:
        for body in bodies(seen.vault, seen.thickness):
            for row in cut(body, plane.axis, at):
                face = (*colour(body.id).unit, fill)
                axes.fill(*row[:, across].T, facecolor=face, edgecolor=ink, linewidth=0.7)
        near = (np.abs(seen.points[:, plane.axis] - at) < SLICE) & (seen.points[:, 2] > -0.6 * seen.around)
        dots(axes, seen.points[near][:, across], c=ink, s=1.5)
    near &= seen.on
    if near.any():
        mine, d = seen.points[near], seen.deviation[near]
        moved = mine + (GROWN - 1) * d[:, None] * seen.vault.evaluate(mine).normal
        dots(axes, moved[:, across], c=1000 * d, s=5, **seen.colours)
    axes.axhline(0, color=SOFT, linewidth=0.6, dashes=(8, 3))
    axes.set_title(f"Section {plane.letter}–{plane.letter} at the crown, grey nearer the wall; deviations × {GROWN}")
    _framed(axes, seen, np.array([-half[plane.across], 0.0]), np.array([half[plane.across], seen.top]))


def dots(axes: Axes, points: Floats, **look: Any) -> None:
    """Points (n, 2)."""
    axes.scatter(points[:, 0], points[:, 1], linewidths=0, **look)


def bar(axes: Axes, x: float, y: float, length: float) -> None:
    """A scale bar from a place, so long [m]."""
    axes.plot([x, x + length], [y, y], color=INK, linewidth=2.5, solid_capstyle="butt")
    axes.text(x + length, y, f"  {length:g} m", va="center")


def _edges(axes: Axes, seen: Seen) -> None:
    for row in seen.edges():
        axes.plot(*row.T, color=INK, linewidth=0.9)


def _framed(axes: Axes, seen: Seen, low: Floats, high: Floats) -> None:
    """A side of `seen.side` from left to right, so that all panels have one scale, with a bar instead of axes."""
    middle = float(low[0] + high[0]) / 2
    axes.set_xlim(middle - seen.side / 2, middle + seen.side / 2)
    axes.set_ylim(low[1] - seen.around, high[1] + seen.around)
    axes.set_aspect("equal")
    axes.set_axis_off()
    bar(axes, low[0], low[1] - 0.85 * seen.around, 1.0 if seen.side > 3 else 0.5)

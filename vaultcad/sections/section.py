"""What a section is: plane, lines, arches with how sure they are; plain values that files and sheets are made of.

Within a section a point is (u, z) [m]: u along the plane's direction from its origin, z above the vault's springing.
A level section shows (x, y) of the vault's frame instead.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import degrees

import numpy as np
from numpy.typing import NDArray

from families.void.upright import Upright
from vaultcad.uncertain import Deviation, Estimate

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Level:
    """A level plane at a height above the springing [m]."""

    z: float

    def off(self, points: Floats) -> Floats:
        """Distances (n,) [m] of points (n, 3) from the plane, positive above."""
        return np.asarray(points[:, 2] - self.z, np.float64)

    def drawn(self, points: Floats) -> Floats:
        """Points (n, 3) as the section shows them, (n, 2)."""
        return np.asarray(points[:, :2], np.float64)

    def placed(self, drawn: Floats) -> Floats:
        """Points (n, 3) in space of (x, y) (n, 2)."""
        return np.column_stack([drawn, np.full(len(drawn), self.z)])


@dataclass(frozen=True)
class SectionPlane:
    """A plane in the vault's frame, of a kind ("across", "diagonal", ...), under a name of its own in the vault."""

    kind: str
    name: str
    cut: Upright | Level

    @property
    def told(self) -> str:
        """In words where it is."""
        if isinstance(self.cut, Level):
            return f"level, {self.cut.z:+.2f} m from the springing"
        x, y = self.cut.origin
        return f"through {x:.2f}, {y:.2f} m towards {round(degrees(self.cut.azimuth), 1) % 360:g}°"


@dataclass(frozen=True, eq=False)
class ProfileRun:
    """The stone's line without a gap: line (n, 2) [m]; std (n,) [m] across it; component (n,)."""

    line: Floats
    std: Floats
    component: NDArray[np.uint16]


@dataclass(frozen=True, eq=False)
class ModelLine:
    """A model's line: (n, 2) [m], and the component of each stretch between (n - 1,), 0 on a wall."""

    line: Floats
    component: NDArray[np.uint16]


@dataclass(frozen=True)
class SectionArc:
    """An arc of a circle: centre and radius [m], and the angles from the u axis [rad] at which it starts and ends.

    It runs counterclockwise.
    """

    u: Estimate
    z: Estimate
    radius: Estimate
    start: float
    end: float

    def points(self, step: float = 0.02) -> Floats:
        """Along it, (n, 2) [m], at most so far apart [rad]."""
        angle = np.linspace(self.start, self.end, 2 + int(abs(self.end - self.start) / step))
        centre = np.array([self.u.value, self.z.value])
        return np.asarray(centre + self.radius.value * np.column_stack([np.cos(angle), np.sin(angle)]), np.float64)


@dataclass(frozen=True, eq=False)
class SectionArch:
    """An arch in a section, as it stands: of which kind it may be, its sizes, and the arcs that it is drawn with.

    odds: kind of `arch_curves.KINDS` -> chance, the likeliest first. rules: setting-out rule -> chance, likewise.
    sizes: `span`, `rise`, `middle`, `springing`, `springing_left`, `springing_right` and what else its kind has [m].
    arcs: from left to right, none for an ellipse. line: the likeliest curve, (n, 2) [m]. rms: of the profile from it
    [m]. settlement: standard deviation of the motion that this takes [m].
    components: names of the parts of the vault that it runs through.
    """

    kind: str
    odds: Mapping[str, float]
    rules: Mapping[str, float]
    sizes: Mapping[str, Estimate]
    arcs: tuple[SectionArc, ...]
    line: Floats
    rms: float
    settlement: float
    components: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class SectionPart:
    """What is no whole arch: an arc of a circle, or straight; the line (n, 2) [m] that was fitted, and its rms [m]."""

    form: str
    arc: SectionArc | None
    line: Floats
    rms: float
    components: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Section:
    """One cut through a vault or an arch between vaults.

    vault, arch: number from 1, 0 for none. placement: (4, 4), brings points (x, y, z) of the vault's frame to the
    scan's coordinates with z up [m]. points: of the scan within the slab and on the vault. deviation: of them from the
    ideal model; bias, median: with their sign, positive into the stone [m]. None and NaN where there are no points.
    as_built: none where the model has no surface.
    """

    id: str
    vault: int
    arch: int
    plane: SectionPlane
    placement: Floats
    slab: float
    grid: float
    profile: tuple[ProfileRun, ...]
    ideal: tuple[ModelLine, ...]
    as_built: tuple[ModelLine, ...]
    arches: tuple[SectionArch, ...]
    parts: tuple[SectionPart, ...]
    names: tuple[str, ...]
    points: int
    deviation: Deviation | None
    bias: float
    median: float
    scanned: Floats = field(default_factory=lambda: np.empty((0, 2)))  # some of the points, for drawings
    scanned_deviation: Floats = field(default_factory=lambda: np.empty(0))  # (n,) of these [m]

    def in_scan(self, drawn: Floats) -> Floats:
        """Points (n, 3) [m] in the scan's coordinates of those in the section (n, 2)."""
        points = self.plane.cut.placed(drawn)
        out: Floats = points @ self.placement[:3, :3].T + self.placement[:3, 3]
        return out

"""What every vault is made of: its void is a union of convex pieces, each an intersection of a few bodies.

The numeric surface (`families.void.kernel`) and the B-Rep (`families.solid.brep`) both read this one description. All
in the vault's frame: origin at the centre of the plan on the springing, z up [m].
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from families.declaration.profiles import Curve

Direction = Literal["x", "y"]


@dataclass(frozen=True)
class BarrelPart:
    """Profile `curve` drawn across `across`, running along the other direction; walls stand below its springing.

    |across - centre| is the curve's u; `base` its springing. With `side` = +1 or -1 it is one cove: u counts from
    `centre` to that side only, and there is nothing on the other. `crown_rise` lifts the axis from 0 at
    |along| = `half_length` to that much at the middle, along a parabola. `names` are the components at along < 0
    and along > 0 (twice the same name if it is one).
    """

    across: Direction
    curve: Curve
    names: tuple[str, str]
    centre: float = 0.0
    base: float = 0.0
    side: int = 0
    crown_rise: float = 0.0
    half_length: float = 1.0

    @property
    def top(self) -> float:
        """Highest point [m]."""
        return self.base + self.curve.rise + self.crown_rise

    def lift(self, along: float) -> float:
        """Height [m] of the axis above `base` at a place along it."""
        return self.crown_rise * (1 - (along / self.half_length) ** 2)

    def grown(self, thickness: float) -> BarrelPart:
        """With all radii larger by `thickness` [m]."""
        return replace(self, curve=self.curve.grown(thickness))


@dataclass(frozen=True)
class Ball:
    """Sphere about (0, 0, z), upper part; below its centre a wall. `quarters`: one component a corner of the plan."""

    z: float
    radius: float
    names: tuple[str, ...]

    @property
    def top(self) -> float:
        """Highest point [m]."""
        return self.z + self.radius

    def grown(self, thickness: float) -> Ball:
        """With a radius larger by `thickness` [m]."""
        return replace(self, radius=self.radius + thickness)


@dataclass(frozen=True)
class Turned:
    """Profile `curve` turned about the z axis on `base`; below it, down to `foot`, a cylinder named `names[0]`."""

    curve: Curve
    base: float
    foot: float
    names: tuple[str, str]

    @property
    def top(self) -> float:
        """Highest point [m]."""
        return self.base + self.curve.rise

    def grown(self, thickness: float) -> Turned:
        """With all radii larger by `thickness` [m]."""
        return replace(self, curve=self.curve.grown(thickness))


@dataclass(frozen=True)
class Ceiling:
    """Horizontal plane at z; the void is below."""

    z: float
    names: tuple[str]

    @property
    def top(self) -> float:
        """Highest point [m]."""
        return self.z

    def grown(self, thickness: float) -> Ceiling:
        """Higher by `thickness` [m]."""
        return replace(self, z=self.z + thickness)


@dataclass(frozen=True)
class Lid:
    """Horizontal cut at z that bounds a piece where another takes over; no surface of the vault, so it never grows."""

    z: float

    @property
    def top(self) -> float:
        """Highest point [m]."""
        return self.z

    def grown(self, thickness: float) -> Lid:
        """Itself."""
        return self


Part = BarrelPart | Ball | Turned | Ceiling | Lid


@dataclass(frozen=True)
class Piece:
    """Intersection of parts: one convex piece of the void."""

    parts: tuple[Part, ...]

    def grown(self, thickness: float) -> Piece:
        """All parts grown by `thickness` [m], some a little more, so that crowns which meet still do.

        Arcs about a centre off the axis, as in a pointed barrel, gain more than the thickness at the crown.
        """
        parts = [p.grown(thickness) for p in self.parts]
        for k, part in enumerate(self.parts):
            if isinstance(part, BarrelPart):
                level = max(
                    grown.top
                    for grown, other in zip(parts, self.parts, strict=True)
                    if isinstance(other, BarrelPart) and abs(other.top - part.top) < 1e-9
                )
                parts[k] = part.grown(part.curve.thickness_below(level - part.base - part.crown_rise))
        return Piece(tuple(parts))


@dataclass(frozen=True)
class Plan:
    """Half extents of the vault's plan [m], and whether the stone may stand on the walls beyond (its extrados does)."""

    half_x: float
    half_y: float
    on_wall_x: bool = False
    on_wall_y: bool = False

    @property
    def half(self) -> NDArray[np.float64]:
        """(2,) half extents [m]."""
        return np.array([self.half_x, self.half_y])

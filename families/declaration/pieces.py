"""What every vault is made of: its void is a union of convex pieces, each an intersection of a few bodies.

The numeric surface (`families.void.kernel`) and the B-Rep (`families.solid.brep`) both read this one description. All
in the vault's frame: origin at the centre of the plan on the springing, z up [m].
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from families.declaration.plan_sides import Side, Vector
from families.declaration.profiles import Curve, Profile


@dataclass(frozen=True)
class BarrelPart:
    """Profile `curve` drawn across the direction `across` (a unit vector), running along what is left of that.

    `origin` lies on the axis, across = along = 0 there; walls stand below the springing at the height `base`. With
    `side` = +1 or -1 it is one cove: there is nothing on the other side of the axis. At a place along the axis the
    half span is 1 + `splay` · along, heights above the springing 1 + `flare` · along times the profile's, and the axis
    is higher by `slope` · along. `crown_rise` lifts the axis from 0 at |along| = `half_length` to that much at the
    middle, along a parabola. `names` are the components at along < 0 and along > 0 (twice the same name if it is one),
    `below` that of the walls below `base`, where they have one of their own.
    """

    across: Vector
    curve: Curve
    names: tuple[str, str]
    origin: Vector = (0.0, 0.0)
    base: float = 0.0
    side: int = 0
    crown_rise: float = 0.0
    half_length: float = 1.0
    slope: float = 0.0
    splay: float = 0.0
    flare: float = 0.0
    below: str = ""

    @property
    def along(self) -> Vector:
        """Unit vector along the axis."""
        return -self.across[1], self.across[0]

    @property
    def top(self) -> float:
        """Highest point [m] at along = 0."""
        return self.base + self.curve.rise + self.crown_rise

    def local(self, x: float, y: float) -> Vector:
        """A place in plan as (across, along) [m]."""
        (cx, cy), (x, y) = self.across, (x - self.origin[0], y - self.origin[1])
        return cx * x + cy * y, cx * y - cy * x

    def lift(self, along: float) -> float:
        """Height [m] of the axis above `base` at a place along it."""
        return self.slope * along + self.crown_rise * (1 - (along / self.half_length) ** 2)

    def grown(self, thickness: float) -> BarrelPart:
        """With all radii larger by `thickness` [m]."""
        return replace(self, curve=self.curve.grown(thickness))


def cove(wall: Side, curve: Curve, name: str, side: int = 1, *, base: float = 0.0, below: str = "") -> BarrelPart:
    """One side of a barrel along a wall, its half span inwards from that; `side`: whether across is out of the plan."""
    (x, y), inset = wall.normal, wall.offset - curve.half_span
    origin = (x * inset, y * inset)
    return BarrelPart((side * x, side * y), curve, (name, name), origin, base, side, below=below)


@dataclass(frozen=True)
class Ball:
    """Sphere about `centre` at height z, upper part; below that a wall. `names`: one, or one a quarter of plan."""

    z: float
    radius: float
    names: tuple[str, ...]
    centre: Vector = (0.0, 0.0)

    @property
    def top(self) -> float:
        """Highest point [m]."""
        return self.z + self.radius

    def grown(self, thickness: float) -> Ball:
        """With a radius larger by `thickness` [m]."""
        return replace(self, radius=self.radius + thickness)


@dataclass(frozen=True)
class Turned:
    """Profile `curve` turned about the upright axis through `centre`, its own axis at `radius` from that.

    With `radius` = 0 a dome, else an annular barrel. It stands on `base`; the walls below are named `names[0]`.
    """

    curve: Curve
    base: float
    names: tuple[str, str]
    centre: Vector = (0.0, 0.0)
    radius: float = 0.0

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


@dataclass(frozen=True)
class Web:
    """Field between two diagonal ribs and a wall, over the triangle `centre`, `start`, `end`; beyond it says nothing.

    `start` and `end` are those of the wall, the plan on the left. At a share v of the way from the centre to it both
    diagonals are as high as `diagonal` is at v · `reach` [m], and an arch of the kind `arch` stands on them, as high as
    the ridge: from the crown of the diagonals to that of the wall arch, whose rise is `rise`, straight or, the more
    `bow` is than 0, as a parabola, which it is at 1. Where the ridge would be lower than the diagonals it is as high.
    Without a `bow` the arch rises as the wall arch does, in proportion to its span.
    """

    start: Vector
    end: Vector
    diagonal: Curve
    reach: float
    arch: Profile
    rise: float
    names: tuple[str]
    centre: Vector = (0.0, 0.0)
    bow: float | None = 0.0

    @property
    def top(self) -> float:
        """A height [m] above all of it."""
        return self.diagonal.rise + self.rise if self.bow is None else max(self.diagonal.rise, self.rise)

    def grown(self, thickness: float) -> Web:
        """Ribs and wall arch with all radii larger by `thickness` [m], over the same triangle."""
        return replace(self, diagonal=self.diagonal.grown(thickness), rise=self.rise + thickness)


Part = BarrelPart | Ball | Turned | Ceiling | Lid | Web


@dataclass(frozen=True)
class Piece:
    """Intersection of parts: one convex piece of the void.

    It stands within the vault's plan, unless it has a `foot`: from that height [m] up it is free of the plan, as a drum
    is on its pendentives, and its stone may overhang.
    """

    parts: tuple[Part, ...]
    foot: float | None = None

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
        return Piece(tuple(parts), self.foot)

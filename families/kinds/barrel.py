"""Barrel vault: a profile drawn along an axis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Annotated, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from families.declaration.constraints import Constraint
from families.declaration.footprint import Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import BarrelPart, Piece
from families.declaration.plan import Axis, Plan
from families.declaration.profiles import Profile, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import coarse_arches, drawn_arch
from families.declaration.vault import Vault

ABREAST = tuple(k / 32 - 1 for k in range(65))  # shares of the half span at which the highest place of an end is sought
CLEAR = 1.5  # tolerances that a lining is nearer to the axis than an upright wall would be
LINING = 0.02  # points of a lining below the springing / those above it, from which on it is one
MOSTLY = 0.5  # share of all points there that they must be
ROUND = 0.5  # share of what stands as far out under the springing that must be on it, too, where a wall would be off it


@dataclass(frozen=True)
class Barrel(Vault):
    """Profile across x, drawn along y, level and parallel; or up a ramp, or wider towards the north as over a splay.

    On a ramp the springing is that of the lower end; over a splay arches stay of their kind and grow with their span.
    """

    id: ClassVar[str] = "barrel"
    title: ClassVar[str] = "barrel vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("botte", "volta a botte"),
        "fr": ("berceau", "voûte en berceau"),
        "de": ("tonne", "tonnengewölbe"),
        "es": ("cañón", "bóveda de cañón"),
    }
    roof_type: ClassVar[str] = "BARREL_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {"rise": "rise_ratio"}
    quarter_turn: ClassVar[Symmetry | None] = None

    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("level", "the axis is level", {"slope": 0.0}, rare=True),
        Constraint("parallel", "the walls are parallel", {"splay": 0.0}, rare=True),
    )
    usual: ClassVar[Mapping[str, tuple[float, float]]] = {"slope": (0.0, 0.2), "splay": (0.0, 0.15)}
    half_turn: ClassVar[Symmetry] = Symmetry(negated=("slope", "splay"))

    span: Annotated[float, Range(0.5, 40, "m", "clear width at the springing, across the axis")] = 5.0
    length: Annotated[float, Range(0.1, 100, "m", "extent along the axis")] = 8.0
    profile: Profile = Semicircular()
    slope: Annotated[float, Range(-1, 1, "1", "rise of the axis towards the north / length")] = 0.0
    splay: Annotated[float, Range(-0.8, 0.8, "1", "north end wider than the middle / span; the south end narrower")] = (
        0.0
    )

    @derived("m", "crown above the springing")
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return self.profile.rise(self.axis.half_span)

    @derived("m", "radius of curvature at the crown")
    def radius(self) -> float:
        """Radius of curvature at the crown [m]."""
        return self.profile.curve(self.axis.half_span).crown_radius

    @property
    def components(self) -> tuple[str, ...]:
        """One."""
        return ("barrel",)

    @Once
    def plan(self) -> Plan:
        """Span by length; the springings stand on the walls."""
        return self.over(self.span / 2, self.length / 2, on_wall_x=True, taper=self.splay)

    @Once
    def axis(self) -> Axis:
        """Of the barrel, between the walls that it stands on."""
        return self.plan.axes[0]

    @property
    def lift(self) -> float:
        """What the ramp climbs from the lowest corner to the middle [m]."""
        if not self.slope:
            return 0.0
        (x, y), (a, b) = self.axis.origin, self.axis.across
        return float((-self.slope * ((self.corners - (x, y)) @ (-b, a))).max())

    @Once
    def top(self) -> float:
        """The highest place of its ends [m], where a ramp has climbed and what splays has grown."""
        (part,), plan = self.pieces()[0].parts, self.plan
        assert isinstance(part, BarrelPart)
        shares = ABREAST if self.skew is not None and (self.slope or self.splay) else (0.0,)
        heights = []
        for share, wall in product(shares, (plan.sides[0], plan.sides[2])):
            across, along = (nx * x + ny * y for nx, ny in (wall.normal,) for x, y in (part.across, part.along))
            aside = share * part.curve.half_span
            (x, y), (nx, ny) = part.origin, wall.normal
            place = (wall.offset - nx * x - ny * y - aside * across) / (along + aside * part.splay * across)
            heights.append(part.base + part.lift(place) + (1 + part.flare * place) * part.curve.height(abs(aside)))
        return max(heights)

    def pieces(self) -> tuple[Piece, ...]:
        """One barrel."""
        axis = self.axis
        part = BarrelPart(
            axis.across,
            self.profile.curve(axis.half_span),
            ("barrel", "barrel"),
            axis.origin,
            base=self.lift,
            slope=self.slope,
            splay=axis.splay,
            flare=axis.splay if self.skew is None else self.splay / axis.half_length,
        )
        return (Piece((part,)),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """All arches, level or as steep as the ceiling, parallel or as wide as the ground at either end."""
        for slope, splay in product(dict.fromkeys((0.0, over.slope_y)), dict.fromkeys((0.0, over.splay_y))):
            for profile in coarse_arches():
                yield cls(over.span_x, over.span_y, profile, slope, splay)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Longer than wide, with any arch."""
        span = rng.uniform(2.5, 7)
        return cls(span, span * rng.uniform(1, 2.2), drawn_arch(rng))

    def contradiction(self, points: NDArray[np.float64], own: NDArray[np.float64], tolerance: float) -> str:
        """Its cylinder goes on below its springing, narrower again, as the lining of a tunnel or a pipe does."""
        if self.splay or not len(own):
            return ""
        origin, across = np.array(self.axis.origin), np.array(self.axis.across)
        climb = self.slope * np.array([-across[1], across[0]])
        seen = np.column_stack([(own[:, :2] - origin) @ across, own[:, 2] - (own[:, :2] - origin) @ climb])
        (x, z, power), *_ = np.linalg.lstsq(np.column_stack([2 * seen, np.ones(len(seen))]), (seen**2).sum(axis=1))
        radius = float(np.sqrt(max(power + x**2 + z**2, 0.0)))
        if (
            radius < CLEAR * tolerance or np.sqrt(np.mean((np.hypot(*(seen - [x, z]).T) - radius) ** 2)) > tolerance
        ):  # not one arc
            return ""
        aside = np.abs((points[:, :2] - origin) @ across - x)
        up = points[:, 2] - (points[:, :2] - origin) @ climb - z
        upright = radius - CLEAR * tolerance  # nearer to the axis there is no wall
        away, half = np.hypot(aside, up) - radius, np.sqrt(radius**2 - upright**2)
        beside = (np.abs(up) < half) & (up < -z) & (aside > self.span / 2 - tolerance)
        if beside.any() and (np.abs(away[beside]) < tolerance).mean() < ROUND:  # walls, but for their feet
            return ""
        below = (up < -half) & (aside > radius / 2)
        below &= away > -tolerance  # what stands within, as stairs do, is neither wall nor lining
        lining = below & (away < tolerance) & (aside < upright)
        if lining.sum() <= max(LINING * len(own), MOSTLY * below.sum()):
            return ""
        return (
            f"a cylinder of {radius:.2f} m radius that goes on below its springing, where the walls of a room would "
            "stand: the lining of a tunnel, or a pipe"
        )

"""Barrel vault: a profile drawn along an axis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from families.declaration.parameters import Range, derived
from families.declaration.pieces import BarrelPart, Piece
from families.declaration.plan import Axis, Plan
from families.declaration.profiles import Profile, Semicircular
from families.declaration.vault import Vault


@dataclass(frozen=True)
class Barrel(Vault):
    """Profile across x, drawn along y."""

    id: ClassVar[str] = "barrel"
    title: ClassVar[str] = "barrel vault"
    aliases: ClassVar[dict[str, tuple[str, ...]]] = {
        "it": ("botte", "volta a botte"),
        "fr": ("berceau", "voûte en berceau"),
        "de": ("tonne", "tonnengewölbe"),
        "es": ("cañón", "bóveda de cañón"),
    }

    span: Annotated[float, Range(0.5, 40, "m", "clear width at the springing, across the axis")] = 5.0
    length: Annotated[float, Range(0.5, 100, "m", "extent along the axis")] = 8.0
    profile: Profile = Semicircular()

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

    @property
    def plan(self) -> Plan:
        """Span by length; the springings stand on the walls."""
        return self.over(self.span / 2, self.length / 2, on_wall_x=True)

    @property
    def axis(self) -> Axis:
        """Of the barrel, between the walls that it stands on."""
        return self.plan.axes[0]

    def pieces(self) -> tuple[Piece, ...]:
        """One barrel."""
        axis = self.axis
        curve = self.profile.curve(axis.half_span)
        return (Piece((BarrelPart(axis.across, curve, ("barrel", "barrel"), axis.origin, splay=axis.splay),)),)

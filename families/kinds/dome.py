"""Dome on drum and pendentives over a square."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from typing import Annotated, ClassVar

from families.declaration.constraints import Constraint
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Ball, Lid, Piece, Turned
from families.declaration.plan import Plan
from families.declaration.profiles import Profile, Semicircular
from families.declaration.vault import Vault

CORNERS = ("south_west", "south_east", "north_west", "north_east")


@dataclass(frozen=True)
class Dome(Vault):
    """Pendentive sphere through the corners of the square 2 r, drum r x h_d on its ring, turned dome on top.

    R_p = r √2 where it springs vertically, more where its centre lies below the springing.

    All are concentric. The ring lies where the sphere has the radius r, which is as high as the wall arches' crowns.
    """

    id: ClassVar[str] = "dome"
    title: ClassVar[str] = "dome on drum and pendentives"
    aliases: ClassVar[dict[str, tuple[str, ...]]] = {
        "it": ("cupola", "cupola su tamburo", "cupola su pennacchi"),
        "fr": ("coupole", "coupole sur pendentifs", "dôme"),
        "de": ("kuppel", "pendentifkuppel", "tambourkuppel"),
        "es": ("cúpula", "media naranja", "cúpula sobre pechinas"),
    }
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("upright-pendentives", "the pendentives spring vertically, R = r √2", {"pendentive_ratio": 0.0}),
        Constraint("no-drum", "the dome stands on the pendentives", {"drum_ratio": 0.0}),
    )

    radius: Annotated[float, Range(0.5, 30, "m", "radius of drum and dome, half the side of the square")] = 3.0
    profile: Profile = Semicircular()
    drum_ratio: Annotated[float, Range(0, 3, "1", "height of the drum / radius; 0 is none")] = 0.4
    pendentive_ratio: Annotated[
        float, Range(0, 1.2, "1", "centre of the pendentives below the springing / radius; 0 springs vertically")
    ] = 0.0

    @derived("m", "crown of the dome above the drum")
    def dome_rise(self) -> float:
        """Crown of the dome above the drum [m]."""
        return self.profile.rise(self.drum_radius)

    @derived("m", "height of the drum")
    def drum_height(self) -> float:
        """Height of the drum [m]."""
        return self.drum_ratio * self.radius

    @derived("m", "radius of the sphere of the pendentives")
    def pendentive_radius(self) -> float:
        """Radius of the sphere of the pendentives [m]."""
        return self.radius * sqrt(2 + self.pendentive_ratio**2)

    @derived("m", "height of the ring on the pendentives above the springing")
    def ring_height(self) -> float:
        """Height of the ring on the pendentives above the springing [m]."""
        narrower = 1 - (self.drum_radius / self.radius) ** 2
        return self.radius * (sqrt(1 + self.pendentive_ratio**2 + narrower) - self.pendentive_ratio)

    @derived("m", "crown of the dome above the springing")
    def rise(self) -> float:
        """Crown of the dome above the springing [m]."""
        return self.ring_height + self.drum_height + self.dome_rise

    @cached_property
    def drum_radius(self) -> float:
        """Radius of drum and dome [m]: as wide as fits between the walls, if these are askew."""
        return min(wall.offset for wall in self.plan.sides)

    @property
    def components(self) -> tuple[str, ...]:
        """Dome, drum if there is one, four pendentives."""
        return ("dome", *(("drum",) if self.drum_ratio else ()), *(f"pendentive_{c}" for c in CORNERS))

    @property
    def plan(self) -> Plan:
        """The square."""
        return self.over(self.radius, self.radius)

    def pieces(self) -> tuple[Piece, ...]:
        """The ball of the pendentives below the ring; drum and dome as one turned profile."""
        ring, centre = self.ring_height, -self.pendentive_ratio * self.radius
        curve = self.profile.curve(self.drum_radius)
        names = ("drum" if self.drum_ratio else "dome", "dome")
        return (
            Piece((Ball(centre, self.pendentive_radius, tuple(f"pendentive_{c}" for c in CORNERS)), Lid(ring))),
            Piece((Turned(curve, ring + self.drum_height, names),), foot=ring),
        )

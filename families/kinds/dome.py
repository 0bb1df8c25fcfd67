"""Dome on drum and pendentives over a square."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import asin, degrees, sqrt
from typing import Annotated, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from families.declaration.constraints import Constraint
from families.declaration.footprint import Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Ball, Lid, Piece, Turned
from families.declaration.plan import Plan
from families.declaration.profiles import Elliptical, Profile, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import drawn_arch, either
from families.declaration.vault import Vault

CREASE = 8.0  # degrees between dome and pendentives at the ring, else they are one sphere: a sail
NO_DRUM = 0.03  # height of the drum / radius below which there is none
SQUARE = 0.25  # of the longer side that the sides of its plan may differ by
BARE = 0.2  # points for each area on pendentives / on the dome and its drum below which there are none
SAMPLES = 4000  # of the whole intrados, by which the areas of its parts are known
CORNERS = ("south_west", "south_east", "north_west", "north_east")


@dataclass(frozen=True)
class Dome(Vault):
    """Pendentive sphere through the corners of the square 2 r, drum r x h_d on its ring, turned dome on top.

    R_p = r √2 where it springs vertically, more where its centre lies below the springing.

    All are concentric. The ring lies where the sphere has the radius r, which is as high as the wall arches' crowns.
    """

    id: ClassVar[str] = "dome"
    title: ClassVar[str] = "dome on drum and pendentives"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("cupola", "cupola su tamburo", "cupola su pennacchi"),
        "fr": ("coupole", "coupole sur pendentifs", "dôme"),
        "de": ("kuppel", "pendentifkuppel", "tambourkuppel"),
        "es": ("cúpula", "media naranja", "cúpula sobre pechinas"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (
        ("drum", "the cylinder between pendentives and dome"),
        ("pendentive", "spherical triangle that leads from a corner of the square to the ring of the drum"),
    )
    roof_type: ClassVar[str] = "DOME_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {
        "dome_rise": "rise_ratio",
        "drum_height": "drum_ratio",
        "pendentive_radius": "pendentive_ratio",
    }
    held: ClassVar[Mapping[str, str]] = {"rise": "drum_ratio"}
    usual: ClassVar[Mapping[str, tuple[float, float]]] = {"pendentive_ratio": (0.15, 0.15)}
    raised: ClassVar[tuple[str, ...]] = ("profile",)
    quarter_turn: ClassVar[Symmetry | None] = Symmetry()
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

    @Once
    def drum_radius(self) -> float:
        """Radius of drum and dome [m]: as wide as fits between the walls, if these are askew."""
        return min(wall.offset for wall in self.plan.sides)

    @property
    def components(self) -> tuple[str, ...]:
        """Dome, drum if there is one, four pendentives."""
        return ("dome", *(("drum",) if self.drum_ratio else ()), *(f"pendentive_{c}" for c in CORNERS))

    @Once
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

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Over a plan that is about square: flat and steep domes, low and high drums."""
        if over.square(SQUARE):
            for ratio, drum, lean in product((0.3, 0.4, 0.5, 0.65), (0.05, 0.2, 0.4, 0.7, 1.0, 1.5), (0.05, 0.4)):
                yield cls(over.radius, Elliptical(ratio), drum, lean)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """With a drum or without one; most pendentives spring vertically."""
        return cls(
            rng.uniform(1.4, 3.5),
            drawn_arch(rng, "semicircular", "segmental", "pointed"),
            either(rng, 0.25, 0.0, 0.2, 0.7),
            either(rng, 0.6, 0.0, 0.1, 0.5),
        )

    @property
    def itself(self) -> bool:
        """Whether it has a drum, or another curve than its pendentives: with neither it is a sail."""
        curve = self.profile.curve(self.radius)
        if self.drum_ratio > NO_DRUM or not curve.arcs:
            return True
        arc = curve.arcs[0]
        dome = degrees(asin(min(1.0, max(-1.0, -arc.z / arc.radius))))  # slopes at the ring, from the vertical
        pendentives = degrees(asin((self.ring_height + self.pendentive_ratio * self.radius) / self.pendentive_radius))
        return abs(dome - pendentives) > CREASE or len(curve.arcs) > 1 or abs(arc.u) > 0

    def contradiction(self, points: NDArray[np.float64], own: NDArray[np.float64], tolerance: float) -> str:
        """Nothing was scanned of its pendentives: it stands on a round room."""
        turned = [self.components.index(name) + 1 for name in ("dome", "drum") if name in self.components]
        above = np.isin(self.evaluate(own).component, turned)
        there = np.isin(self.sample(SAMPLES, np.random.default_rng(0)).component, turned)

        def seen(mask: NDArray[np.bool_], possible: NDArray[np.bool_]) -> float:
            return float(mask.sum()) / max(int(possible.sum()), 1)

        if there.all() or seen(~above, ~there) >= BARE * seen(above, there):
            return ""
        return (
            f"a dome of {self.radius:.2f} m radius, but nothing of the pendentives that it would stand on; "
            "over a round room it is a rotunda"
        )

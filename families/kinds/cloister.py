"""Cloister vault over a polygon: on its own walls, on a drum, or over a square crossing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import cos, hypot, pi, sin, sqrt
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.constraints import Constraint
from families.declaration.footprint import CORNERED, POLYGON, Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Ball, BarrelPart, Lid, Piece, cove
from families.declaration.plan import Plan
from families.declaration.plan_sides import Vector
from families.declaration.profiles import Arc, Curve, Elliptical, Profile, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import drawn_arch, either
from families.declaration.vault import Vault

WALLS, PENDENTIVES, SQUINCHES = range(3)  # what it stands on: `crossing`
CORNERS = (("south_west", -1, -1), ("south_east", 1, -1), ("north_west", -1, 1), ("north_east", 1, 1))
EIGHT = 8  # webs over a crossing


@dataclass(frozen=True)
class Cloister(Vault):
    """Webs of one rise over the sides of a polygon of inradius r; the first side faces east, and the others follow.

    Over a square crossing of the side 2 r it has eight sides, on pendentives of a sphere through the corners,
    R = r √2, or on squinches, cones with their apex there; between these and the webs may stand a drum.
    """

    id: ClassVar[str] = "cloister"
    title: ClassVar[str] = "cloister vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("volta a padiglione poligonale", "padiglione ottagonale", "tiburio"),
        "fr": ("arc de cloître polygonal", "coupole à pans"),
        "de": ("polygonales klostergewölbe", "klosterkuppel"),
        "es": ("bóveda de paños", "cimborrio"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (
        ("web", "one of the fields of a cloister vault, which rises from a side of its polygon"),
        ("drum", "the walls between pendentives or squinches and the webs"),
        ("squinch", "conical arch across a corner of the square, which carries a side of the octagon"),
    )
    roof_type: ClassVar[str] = "PAVILION_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {"drum_height": "drum_ratio", "rise": "rise_ratio"}
    usual: ClassVar[Mapping[str, tuple[float, float]]] = {"diagonal_ratio": (1.0, 0.05)}
    raised: ClassVar[tuple[str, ...]] = ("profile",)
    quarter_turn: ClassVar[Symmetry | None] = None
    four_corners: ClassVar[bool] = False
    stands_over: ClassVar[str] = POLYGON
    variants: ClassVar[tuple[str, ...]] = ("crossing",)
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("regular", "all sides are as far from the middle", {"diagonal_ratio": 1.0}, rare=True),
        Constraint("no-drum", "the webs stand on the walls, pendentives or squinches", {"drum_ratio": 0.0}),
    )

    sides: Annotated[int, Range(3, 12, "1", "webs and sides of the polygon; over a crossing always 8")] = 8
    radius: Annotated[float, Range(0.5, 30, "m", "distance of the first side from the middle")] = 3.0
    profile: Profile = Semicircular()
    drum_ratio: Annotated[float, Range(0, 3, "1", "height of the drum / radius; 0 is none")] = 0.0
    diagonal_ratio: Annotated[
        float, Range(0.88, 1.13, "1", "distance of every second side / radius, where their number is even")
    ] = 1.0
    crossing: Annotated[int, Range(0, 2, "1", "0 on its own walls, 1 on pendentives, 2 on squinches of a square")] = 0

    @derived("m", "height of the drum")
    def drum_height(self) -> float:
        """Height of the drum [m]."""
        return self.drum_ratio * self.radius

    @derived("m", "foot of the drum above the springing, on pendentives or squinches")
    def ring_height(self) -> float:
        """Foot of the drum above the springing [m]."""
        if self.crossing == PENDENTIVES:
            return self._on_sphere(self.radius * min(1.0, self.diagonal_ratio))
        return self._squinch if self.crossing == SQUINCHES else 0.0

    @derived("m", "crown above the springing")
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return self.ring_height + self.drum_height + self.profile.rise(self.radius)

    @property
    def webs(self) -> int:
        """How many there are: eight over a crossing."""
        return EIGHT if self.crossing else self.sides

    @property
    def components(self) -> tuple[str, ...]:
        """The webs counterclockwise from the east, the drum if there is one, what stands in the corners."""
        below = {WALLS: "", PENDENTIVES: "pendentive", SQUINCHES: "squinch"}[self.crossing]
        corners = (f"{below}_{name}" for name, _, _ in CORNERS if below)
        return (*(f"web_{k + 1}" for k in range(self.webs)), *(("drum",) if self.drum_ratio else ()), *corners)

    @property
    def polygon(self) -> Plan:
        """The region within its webs; side k faces the angle 2 π k / n from the east."""
        n, step = self.webs, 2 * pi / self.webs
        far = [self.radius * (self.diagonal_ratio if n % 2 == 0 and k % 2 else 1.0) for k in range(n)]

        def corner(k: int) -> Vector:
            """Between sides k - 1 and k."""
            a, b, p, q = (k - 1) * step, k * step, far[k - 1], far[k]
            return (p * sin(b) - q * sin(a)) / sin(step), (q * cos(a) - p * cos(b)) / sin(step)

        return Plan.polygon(tuple(corner(k) for k in range(n)), True)

    @Once
    def plan(self) -> Plan:
        """The polygon, on its walls; the square of the crossing."""
        return Plan.rectangle(self.radius, self.radius) if self.crossing else self.polygon

    def pieces(self) -> tuple[Piece, ...]:
        """The webs meet over the polygon; what carries them reaches into the corners of the square."""
        polygon, rise, ring = self.polygon, self.profile.rise(self.radius), self.ring_height
        base, below = ring + self.drum_height, "drum" if self.drum_ratio else ""
        webs = tuple(
            cove(side, self.profile.arch(side.offset, rise), f"web_{k + 1}", base=base, below=below)
            for k, side in enumerate(polygon.sides)
        )
        if self.crossing == WALLS:
            return (Piece(webs),)
        if self.crossing == SQUINCHES:
            return (Piece(webs, foot=ring), *(self._squinches(ring)))
        corners = max(hypot(*side.start) for side in polygon.sides)
        ball = Ball(0.0, self.radius * sqrt(2), tuple(f"pendentive_{name}" for name, _, _ in CORNERS))
        return Piece(webs, foot=self._on_sphere(corners)), Piece((ball, Lid(ring)))

    def _on_sphere(self, radius: float) -> float:
        """Height at which the sphere of the pendentives has a radius [m]."""
        return sqrt(2 * self.radius**2 - radius**2)

    @property
    def _squinch(self) -> float:
        """Length, half span and rise of a squinch [m], from its corner to its side of the octagon."""
        return self.radius * (sqrt(2) - self.diagonal_ratio)

    def _squinches(self, ring: float) -> Iterator[Piece]:
        """A cone in each corner, which ends under the octagon."""
        size, lean = self._squinch, sqrt(0.5)
        end = 1.5 * size
        upright = Curve(end, 2 * ring + end, 2 * ring, (Arc(0.0, 2 * ring, end),))  # beyond it there is no squinch
        for name, x, y in CORNERS:
            names, inwards = (f"squinch_{name}",) * 2, (-x * lean, -y * lean)
            corner = (x * self.radius, y * self.radius)
            arch = (corner[0] + size * inwards[0], corner[1] + size * inwards[1])
            across = (inwards[1], -inwards[0])
            cone = BarrelPart(
                across, Semicircular().curve(size), names, arch, splay=1 / size, flare=1 / size, half_length=size
            )
            yield Piece((cone, BarrelPart(inwards, upright, names, corner, side=1), Lid(ring)))

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Flat and steep ones; where there are the corners of a square, with drums or without."""
        if over.diagonal < CORNERED:
            for ratio in (0.2, 0.35, 0.5, 0.7):
                yield cls(over.sides, over.radius, Elliptical(ratio))
        elif over.sides == EIGHT:
            for crossing, ratio, drum in product((PENDENTIVES, SQUINCHES), (0.3, 0.5, 0.7), (0.0, 0.2, 0.5, 0.8)):
                yield cls(EIGHT, over.radius, Elliptical(ratio), drum, crossing=crossing)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Mostly octagons, half of them over a crossing."""
        crossing = int(rng.choice([WALLS, WALLS, PENDENTIVES, SQUINCHES]))
        return cls(
            int(rng.choice([6, 8, 8, 8, 5, 12])),
            rng.uniform(1.5, 4),
            drawn_arch(rng, "semicircular", "segmental", "pointed"),
            either(rng, 0.5, 0.0, 0.2, 0.7) if crossing else 0.0,
            crossing=crossing,
        )

    @property
    def itself(self) -> bool:
        """Whether it is no rectangle: that is a trough."""
        return self.webs != 4

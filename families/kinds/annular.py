"""Annular vault: a barrel that runs round an upright axis, as over an ambulatory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import cos, pi
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.constraints import Constraint
from families.declaration.footprint import SECTOR, Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Piece, Turned
from families.declaration.plan import Plan
from families.declaration.plan_sides import Vector
from families.declaration.profiles import Elliptical, Profile, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import drawn_arch
from families.declaration.vault import Vault

COARSE_RISES = (0.2, 0.3, 0.4, 0.5, 0.75)  # over its span, of those that a fit looks for first


@dataclass(frozen=True)
class Annular(Vault):
    """Profile across a circular axis of radius R, over an angle about the y axis, which it lies across."""

    id: ClassVar[str] = "annular"
    title: ClassVar[str] = "annular vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("volta anulare", "botte anulare"),
        "fr": ("voûte annulaire", "berceau annulaire", "berceau tournant"),
        "de": ("ringtonne", "ringgewölbe"),
        "es": ("bóveda anular", "cañón anular"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (("axis", "the circle in plan along which the barrel runs"),)
    roof_type: ClassVar[str] = "BARREL_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {"span": "span_ratio", "rise": "rise_ratio"}
    quarter_turn: ClassVar[Symmetry | None] = None
    half_turn: ClassVar[Symmetry | None] = None
    four_corners: ClassVar[bool] = False
    stands_over: ClassVar[str] = SECTOR
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("whole-ring", "it runs all the way round its axis", {"angle": 2 * pi}, rare=True),
    )

    radius: Annotated[float, Range(0.5, 60, "m", "radius of the axis in plan")] = 6.0
    span_ratio: Annotated[float, Range(0.05, 1.8, "1", "clear width at the springing / radius")] = 0.6
    angle: Annotated[float, Range(0.3, 2 * pi, "rad", "that it covers about the axis; a full turn is a ring")] = pi
    profile: Profile = Semicircular()

    @derived("m", "clear width at the springing, across the axis")
    def span(self) -> float:
        """Clear width at the springing [m]."""
        return self.span_ratio * self.radius

    @derived("m", "crown above the springing")
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return self.profile.rise(self.span / 2)

    @property
    def components(self) -> tuple[str, ...]:
        """One."""
        return ("barrel",)

    @property
    def _centre(self) -> Vector:
        """Of the axis: where it has to be for the origin to lie in the middle of what the plan covers along y."""
        half = self.angle / 2
        lowest = self.radius + (-self.span / 2 if half < pi / 2 else self.span / 2)
        return 0.0, -(self.radius + self.span / 2 + lowest * cos(half)) / 2

    @Once
    def plan(self) -> Plan:
        """A sector of a ring; its ends are open."""
        return Plan.sector(self.radius - self.span / 2, self.radius + self.span / 2, self.angle, on_wall=True).moved(
            *self._centre
        )

    def pieces(self) -> tuple[Piece, ...]:
        """One turned profile."""
        curve = self.profile.curve(self.span / 2)
        return (Piece((Turned(curve, 0.0, ("barrel", "barrel"), self._centre, self.radius),)),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Flat and steep ones."""
        outer, inner = over.radius, over.hole * over.radius
        for ratio in COARSE_RISES:
            yield cls((outer + inner) / 2, 2 * (outer - inner) / (outer + inner), over.angle, Elliptical(ratio))

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Ambulatories about an apse, and whole rings."""
        radius = rng.uniform(3, 8)
        angle = float(rng.choice([pi / 2, 2 * pi / 3, pi, pi, 2 * pi]))
        return cls(radius, rng.uniform(2, 4) / radius, angle, drawn_arch(rng, "semicircular", "segmental", "pointed"))

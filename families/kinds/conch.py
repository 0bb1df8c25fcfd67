"""Conch: half a dome over an apse."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.footprint import HALF_DISC, Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Piece, Turned
from families.declaration.plan import Plan
from families.declaration.plan_sides import Vector
from families.declaration.profiles import Elliptical, Profile, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import drawn_arch
from families.declaration.vault import Vault

COARSE_RISES = (0.2, 0.3, 0.4, 0.5, 0.65)  # over its span, of those that a fit looks for first


@dataclass(frozen=True)
class Conch(Vault):
    """Profile turned over half a circle of radius r, open to the south; on the half cylinder of the apse."""

    id: ClassVar[str] = "conch"
    title: ClassVar[str] = "conch"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("catino", "semicupola", "catino absidale", "conca"),
        "fr": ("cul-de-four d'abside", "conque", "demi-coupole"),
        "de": ("konche", "halbkuppel", "kalotte"),
        "es": ("cuarto de esfera", "bóveda de horno", "concha"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (("conch", "half a dome over an apse"),)
    roof_type: ClassVar[str] = "DOME_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {"rise": "rise_ratio"}
    quarter_turn: ClassVar[Symmetry | None] = None
    half_turn: ClassVar[Symmetry | None] = None
    four_corners: ClassVar[bool] = False
    stands_over: ClassVar[str] = HALF_DISC

    radius: Annotated[float, Range(0.5, 30, "m", "radius of the apse at the springing")] = 3.0
    profile: Profile = Semicircular()

    @derived("m", "crown above the springing")
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return self.profile.rise(self.radius)

    @property
    def components(self) -> tuple[str, ...]:
        """One."""
        return ("conch",)

    @property
    def _centre(self) -> Vector:
        """Of the circle: on the open side, half a radius south of the middle of the plan."""
        return 0.0, -self.radius / 2

    @Once
    def plan(self) -> Plan:
        """Half a disc, its straight side to the south."""
        return Plan.half_disc(self.radius, on_wall=True).moved(*self._centre)

    def pieces(self) -> tuple[Piece, ...]:
        """A dome, of which the plan leaves a half."""
        return (Piece((Turned(self.profile.curve(self.radius), 0.0, ("conch", "conch"), self._centre),)),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Flat and steep ones."""
        for ratio in COARSE_RISES:
            yield cls(over.radius, Elliptical(ratio))

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Mostly quarters of a sphere."""
        return cls(rng.uniform(1.5, 4.5), drawn_arch(rng, "semicircular", "semicircular", "segmental", "pointed"))

"""Trough vault: a barrel closed by two pavilion heads; with no ridge left a cloister vault."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.constraints import Constraint
from families.declaration.footprint import Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import BarrelPart, Piece, cove
from families.declaration.plan import Plan
from families.declaration.plan_sides import Side
from families.declaration.profiles import Profile, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import coarse_arches, drawn_arch, either
from families.declaration.vault import Vault


def _equal_heads(vault: Trough) -> dict[str, float]:
    """The run of one head by that of the other."""
    return {"north_ratio": vault.south_ratio}


@dataclass(frozen=True)
class Trough(Vault):
    """Barrel across x along y with a head at either end; common springing and rise."""

    id: ClassVar[str] = "trough"
    title: ClassVar[str] = "trough vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("botte con teste di padiglione", "padiglione", "volta a padiglione"),
        "fr": ("arc de cloître", "voûte en arc de cloître"),
        "de": ("muldengewölbe", "klostergewölbe"),
        "es": ("esquifada", "bóveda esquifada", "rincón de claustro"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (
        ("head", "the curved end of a trough vault, like a quarter of a cloister vault"),
    )
    roof_type: ClassVar[str] = "USERDEFINED"  # PAVILION_ROOF is a hipped roof, no cloister vault
    ratios: ClassVar[Mapping[str, str]] = {
        "rise": "rise_ratio",
        "south_run": "south_ratio",
        "north_run": "north_ratio",
    }
    quarter_turn: ClassVar[Symmetry | None] = None
    half_turn: ClassVar[Symmetry] = Symmetry(exchanged=("south", "north"))
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("no-ridge", "the heads meet in one point: a cloister", {"south_ratio": 1.0, "north_ratio": 1.0}),
        Constraint("equal-heads", "both heads have the same run", follows=_equal_heads),
    )

    span_x: Annotated[float, Range(0.5, 40, "m", "clear width at the springing, across the barrel")] = 5.0
    span_y: Annotated[float, Range(0.5, 100, "m", "clear length at the springing")] = 8.0
    profile: Profile = Semicircular()
    south_ratio: Annotated[float, Range(0.1, 1, "1", "run of the southern head / half of span_y")] = 0.6
    north_ratio: Annotated[float, Range(0.1, 1, "1", "run of the northern head / half of span_y")] = 0.6

    @derived("m", "crown above the springing")
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return self.profile.rise(self.plan.axes[0].half_span)

    @derived("m", "run of the southern head")
    def south_run(self) -> float:
        """Run of the southern head [m]."""
        return self.south_ratio * self.plan.sides[0].offset

    @derived("m", "run of the northern head")
    def north_run(self) -> float:
        """Run of the northern head [m]."""
        return self.north_ratio * self.plan.sides[2].offset

    @property
    def cloister(self) -> bool:
        """Whether the heads meet in one point, so that the barrel falls apart into two webs."""
        return self.south_ratio == 1 and self.north_ratio == 1

    @property
    def components(self) -> tuple[str, ...]:
        """Barrel and two heads; four webs if no ridge is left."""
        return ("west", "east", "south", "north") if self.cloister else ("barrel", "south", "north")

    @Once
    def plan(self) -> Plan:
        """The rectangle; the stone stands on all four walls."""
        return self.over(self.span_x / 2, self.span_y / 2, on_wall_x=True, on_wall_y=True)

    def pieces(self) -> tuple[Piece, ...]:
        """Intersection of the barrel with the two heads."""
        plan, rise = self.plan, self.rise
        south, east, north, west = plan.sides

        def web(name: str, wall: Side, run: float, side: int) -> BarrelPart:
            return cove(wall, self.profile.arch(run, rise), name, side)

        heads = web("south", south, self.south_run, -1), web("north", north, self.north_run, 1)
        if self.cloister:
            return (Piece((web("west", west, west.offset, -1), web("east", east, east.offset, 1), *heads)),)
        axis = plan.axes[0]
        curve = self.profile.curve(axis.half_span)
        barrel = BarrelPart(axis.across, curve, ("barrel", "barrel"), axis.origin, splay=axis.splay)
        return (Piece((barrel, *heads)),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """All arches, with steep and flat heads."""
        span_x, span_y = over.span_x, over.span_y
        for profile, run in product(coarse_arches(), (0.5, 0.75, 1.0, 1.4)):
            ratio = min(max(run * span_x / span_y, 0.1), 1.0)
            yield cls(span_x, span_y, profile, ratio, ratio)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """A cloister vault now and then; most heads equal."""
        span = rng.uniform(3, 6)
        profile = drawn_arch(rng, "semicircular", "segmental", "basket-handle", "elliptical")
        if rng.random() < 0.2:
            return cls(span, span * rng.uniform(0.9, 1.1), profile, 1.0, 1.0)
        length = span * rng.uniform(1.3, 2.2)
        south = min(0.95, rng.uniform(0.7, 1.2) * span / length)
        return cls(span, length, profile, south, either(rng, 0.7, south, 0.8 * south, south))

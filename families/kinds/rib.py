"""Rib vault: quadripartite, diagonals and wall arches with profiles of their own, webs between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import hypot
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.constraints import Constraint
from families.declaration.footprint import Footprint
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Piece, Web
from families.declaration.plan import Plan
from families.declaration.profiles import UNSTILTED, BasketHandle, Pointed, Profile, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import COARSE_RISES, either
from families.declaration.vault import Vault

SIDES = ("south", "east", "north", "west")
ONE_ARC = tuple(kind for kind in UNSTILTED if kind is not BasketHandle)


def _level_ridges(vault: Rib) -> dict[str, float]:
    """The wall arches as high as the crown, where their profiles have a rise to choose."""
    found = {}
    for name, profile, span in (
        ("rise_ratio_x", vault.profile_x, vault.span_x),
        ("rise_ratio_y", vault.profile_y, vault.span_y),
    ):
        ranges = [p.range for p in profile.parameters() if p.name == "rise_ratio"]
        if ranges:
            found[name] = min(max(vault.rise / span, ranges[0].low), ranges[0].high)
    return found


@dataclass(frozen=True)
class Rib(Vault):
    """Diagonal ribs of `profile_diagonal` from corner to corner, wall arches of `profile_x` across x and `profile_y`.

    Between them stand webs of arches of the wall arch's kind, as high as a ridge from the crown to the wall arch.
    """

    id: ClassVar[str] = "rib"
    title: ClassVar[str] = "rib vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("crociera costolonata", "volta costolonata", "volta a crociera ogivale"),
        "fr": ("croisée d'ogives", "voûte d'ogives"),
        "de": ("kreuzrippengewölbe", "kreuzrippe"),
        "es": ("bóveda de crucería", "crucería simple"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (
        ("web", "one of the fields between two diagonals and a wall arch"),
        ("diagonal", "a rib from corner to corner over the crown"),
        ("ridge", "the line from the crown to that of a wall arch"),
    )
    roof_type: ClassVar[str] = "USERDEFINED"
    ratios: ClassVar[Mapping[str, str]] = {
        "rise": "rise_ratio_diagonal",
        "rise_x": "rise_ratio_x",
        "rise_y": "rise_ratio_y",
    }
    usual: ClassVar[Mapping[str, tuple[float, float]]] = {"ridge_bow": (0.5, 0.3)}
    alike: ClassVar[tuple[str, ...]] = ("profile_x", "profile_y")
    # On a stilt a web would not meet its ribs; the haunches of a basket handle vanish where it is no higher than they.
    arch_kinds: ClassVar[Mapping[str, tuple[type[Profile], ...]]] = {
        "profile_x": ONE_ARC,
        "profile_y": ONE_ARC,
        "profile_diagonal": UNSTILTED,
    }
    quarter_turn: ClassVar[Symmetry | None] = Symmetry(exchanged=("x", "y"))
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("straight-ridges", "the ridges are straight", {"ridge_bow": 0.0}, rare=True),
        Constraint("level-ridges", "the wall arches are as high as the crown", follows=_level_ridges),
    )

    span_x: Annotated[float, Range(0.5, 40, "m", "clear width at the springing along x")] = 5.0
    span_y: Annotated[float, Range(0.5, 40, "m", "clear width at the springing along y")] = 5.0
    profile_x: Profile = Pointed(0.71)
    profile_y: Profile = Pointed(0.71)
    profile_diagonal: Profile = Semicircular()
    ridge_bow: Annotated[float, Range(0, 1, "1", "bend of the ridges: 0 straight, 1 level at the crown")] = 0.0

    @derived("m", "crown above the springing, the rise of the diagonals")
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return self.profile_diagonal.rise(self._half_diagonal)

    @derived("m", "rise of the arch across x, over the southern and northern walls")
    def rise_x(self) -> float:
        """Rise of the arch across x [m]."""
        return self.profile_x.rise(self.span_x / 2)

    @derived("m", "rise of the arch across y, over the western and eastern walls")
    def rise_y(self) -> float:
        """Rise of the arch across y [m]."""
        return self.profile_y.rise(self.span_y / 2)

    @property
    def _half_diagonal(self) -> float:
        return sum(hypot(*side.start) for side in self.plan.sides) / 4

    @property
    def components(self) -> tuple[str, ...]:
        """Four webs."""
        return tuple(f"web_{side}" for side in SIDES)

    @property
    def plan(self) -> Plan:
        """The rectangle of the wall arches."""
        return self.over(self.span_x / 2, self.span_y / 2)

    def pieces(self) -> tuple[Piece, ...]:
        """The webs, each over its quarter of the plan."""
        reach = self._half_diagonal
        curve = self.profile_diagonal.curve(reach)
        arches = ((self.profile_x, self.rise_x), (self.profile_y, self.rise_y)) * 2
        webs = (
            Web(wall.start, wall.end, curve, reach, *arch, (f"web_{name}",), bow=self.ridge_bow)
            for name, wall, arch in zip(SIDES, self.plan.sides, arches, strict=True)
        )
        return (Piece(tuple(webs)),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Semicircular and flatter diagonals under pointed wall arches."""
        for diagonal, arch in product((0.35, 0.5), [r for r in COARSE_RISES if r >= 0.5]):
            profile = Pointed(arch)
            yield cls(over.span_x, over.span_y, profile, profile, Pointed.over(diagonal) or Semicircular())

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Pointed wall arches about as high as the semicircular diagonals."""
        span_x = rng.uniform(3, 7)
        span_y = span_x * rng.uniform(0.6, 1.2)
        rise = hypot(span_x, span_y) / 2 * either(rng, 0.5, 1.0, 0.8, 1.0)
        arch_x, arch_y = (Pointed(min(max(rise / span, 0.5), 1.5)) for span in (span_x, span_y))
        return cls(span_x, span_y, arch_x, arch_y, Semicircular())

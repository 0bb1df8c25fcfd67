"""Umbrella vault: a dome of webs between ribs that rise from the corners of a polygon."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import cos, hypot, pi, sin
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.footprint import GORED, Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Piece, Web
from families.declaration.plan import Plan
from families.declaration.profiles import UNSTILTED, Elliptical, Profile, Segmental, Semicircular
from families.declaration.ribs import RibLine, diagonals, wall_arches
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import drawn_arch
from families.declaration.vault import Vault


@dataclass(frozen=True)
class Umbrella(Vault):
    """Ribs of `profile_diagonal` to the corners of a regular polygon of inradius r, wall arches of `profile`, webs.

    The webs are as curved everywhere as at their wall arches. The first side faces east, and the others follow
    counterclockwise.
    """

    id: ClassVar[str] = "umbrella"
    title: ClassVar[str] = "umbrella vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("volta a ombrello", "cupola a ombrello", "volta a creste e vele"),
        "fr": ("voûte en parapluie", "coupole côtelée"),
        "de": ("schirmgewölbe", "schirmkuppel"),
        "es": ("bóveda de gallones", "cúpula gallonada"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (("web", "one of the fields between two ribs and a wall arch"),)
    roof_type: ClassVar[str] = "DOME_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {"rise": "rise_ratio_diagonal", "arch_rise": "rise_ratio"}
    quarter_turn: ClassVar[Symmetry | None] = None
    pliant: ClassVar[bool] = True
    arch_kinds: ClassVar[Mapping[str, tuple[type[Profile], ...]]] = {
        "profile": UNSTILTED,  # on a stilt a web would not meet its ribs
        "profile_diagonal": UNSTILTED,
    }
    four_corners: ClassVar[bool] = False
    stands_over: ClassVar[str] = GORED

    sides: Annotated[int, Range(3, 12, "1", "webs and sides of the polygon")] = 8
    radius: Annotated[float, Range(0.5, 30, "m", "distance of the sides from the middle")] = 3.0
    profile: Profile = Segmental(0.3)
    profile_diagonal: Profile = Semicircular()

    @derived("m", "crown above the springing, the rise of the ribs")
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return self.profile_diagonal.rise(self._reach)

    @property
    def top(self) -> float:
        """The highest place of the ridges, which may climb from the crown before they fall to the walls [m]."""
        curve, reach, climb = self.profile_diagonal.curve(self._reach), self._reach, self.arch_rise / self._reach
        level = [arc.u + arc.radius * climb / hypot(1.0, climb) for arc in curve.arcs]
        if not level:
            level = [reach * (climb * reach) / hypot(curve.rise, climb * reach)]
        return max(curve.height(u) + climb * u for u in (0.0, reach, *(min(max(u, 0.0), reach) for u in level)))

    @derived("m", "rise of the wall arches")
    def arch_rise(self) -> float:
        """Rise of the wall arches [m]."""
        return self.profile.rise(self._reach * sin(pi / self.sides))

    @property
    def _reach(self) -> float:
        """Length of the ribs in plan [m]."""
        return self.radius / cos(pi / self.sides)

    @property
    def components(self) -> tuple[str, ...]:
        """The webs counterclockwise from the east."""
        return tuple(f"web_{k + 1}" for k in range(self.sides))

    @Once
    def plan(self) -> Plan:
        """The polygon."""
        step, reach = 2 * pi / self.sides, self._reach
        return Plan.polygon(
            tuple((reach * cos((k - 0.5) * step), reach * sin((k - 0.5) * step)) for k in range(self.sides))
        )

    def pieces(self) -> tuple[Piece, ...]:
        """The webs, each over its share of the plan."""
        reach, rise = self._reach, self.arch_rise
        curve = self.profile_diagonal.curve(reach)
        webs = (
            Web(wall.start, wall.end, curve, reach, self.profile, rise, (name,), bow=None)
            for name, wall in zip(self.components, self.plan.sides, strict=True)
        )
        return (Piece(tuple(webs)),)

    def rib_lines(self) -> tuple[RibLine, ...]:
        """Those from the corners to the crown, and the wall arches."""
        sides, names = self.plan.sides, [f"{k + 1}" for k in range(self.sides)]
        curve = self.profile_diagonal.curve(self._reach)
        return (*diagonals(sides, names, curve), *wall_arches(sides, names, [self.profile] * self.sides))

    @property
    def itself(self) -> bool:
        """Whether it is over no square: that is a rib vault."""
        return self.sides != 4

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Flat and steep ones."""
        for rise, arch in product((0.25, 0.4, 0.55, 0.8), repeat=2):
            yield cls(over.sides, over.radius, Elliptical(arch), Elliptical(rise))

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Six to twelve webs."""
        kinds = "semicircular", "segmental", "pointed"
        return cls(int(rng.choice([6, 8, 12])), rng.uniform(1.5, 4), drawn_arch(rng, *kinds), drawn_arch(rng, *kinds))

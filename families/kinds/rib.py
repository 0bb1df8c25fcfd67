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
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Piece, Web
from families.declaration.plan import Plan
from families.declaration.profiles import UNSTILTED, BasketHandle, Pointed, Profile, Segmental, Semicircular
from families.declaration.ribs import CORNERS, SIDES, RibLine, diagonals, ridges, wall_arches
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import COARSE_RISES, either
from families.declaration.vault import Vault

LOOKED = (0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 0.95)  # shares of the way to a wall, where ridges are held against diagonals
ONE_ARC = tuple(kind for kind in UNSTILTED if kind is not BasketHandle)
SHARE = 0.5  # of the way to the corners, where its diagonals are looked at
CREASED = 0.97  # cosine between the webs beside a diagonal, above which they are one surface, such as a sail
OTHERWISE = 0.02  # of the rise, what its diagonals are off those of two crossing barrels at least
BESIDE = 0.01  # of the way to a corner, how far from a diagonal its webs are looked at
BEGUN = 0.4  # where the bend of the ridges is looked for first


def _bent(vault: Rib) -> dict[str, float]:
    """Ridges that are bent a little."""
    return {"ridge_bow": BEGUN}


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
    supple: ClassVar[bool] = True
    pliant: ClassVar[bool] = True
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("straight-ridges", "the ridges are straight", {"ridge_bow": 0.0}, begins=_bent, rare=True),
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

    @property
    def top(self) -> float:
        """The crown, or that of a wall arch which is higher [m]."""
        return max(self.rise, self.rise_x, self.rise_y)

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

    @Once
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

    def rib_lines(self) -> tuple[RibLine, ...]:
        """Diagonals, wall arches, and ridges that are nowhere lower than the diagonals; none over free corners."""
        if self.skew is not None:
            return ()
        sides, reach = self.plan.sides, self._half_diagonal
        arches, rises = (self.profile_x, self.profile_y) * 2, (self.rise_x, self.rise_y) * 2
        curve = self.profile_diagonal.curve(reach)
        lines = ridges(sides, SIDES, self.rise, rises, self.ridge_bow)
        shown = (line for line in lines if all(line.height(v) > curve.height(v * reach) for v in LOOKED))
        return (*diagonals(sides, CORNERS, curve), *wall_arches(sides, SIDES, arches), *shown)

    @property
    def itself(self) -> bool:
        """Whether there are creases along its diagonals, and others than a groin vault's."""
        return self._creased and self._unlike_barrels

    @property
    def _creased(self) -> bool:
        """Whether the webs beside a diagonal face different ways."""
        (x, y), reach = self.plan.sides[0].end, self._half_diagonal
        z = self.profile_diagonal.curve(reach).height(SHARE * reach)
        beside = [[SHARE * x - side * y, SHARE * y + side * x, z] for side in (-BESIDE, BESIDE)]
        one, other = self.evaluate(np.array(beside)).normal
        return float(one @ other) < CREASED

    @property
    def _unlike_barrels(self) -> bool:
        """Whether the diagonals run otherwise than barrels of the wall arches would cross, domical or not."""
        half_spans = self._half_diagonal, self.span_x / 2, self.span_y / 2
        arches = self.profile_diagonal, self.profile_x, self.profile_y
        curves = [arch.curve(half_span) for arch, half_span in zip(arches, half_spans, strict=True)]
        domical = self.rise - max(self.rise_x, self.rise_y)

        def off(share: float) -> float:
            own, *barrels = (curve.height(share * curve.half_span) for curve in curves)
            return abs(own - max(barrels) - domical * (1 - share**2))

        return max(map(off, (0.25, 0.5, 0.75, 0.9))) > OTHERWISE * self.rise

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Semicircular and flatter diagonals, pointed wall arches of one rise / span, ridges straight and bent."""
        arches = [Pointed(ratio) for ratio in COARSE_RISES if ratio >= 0.5]
        for diagonal, arch, bow in product((Semicircular(), Segmental(0.4)), arches, (0.0, 0.7)):
            yield cls(over.span_x, over.span_y, arch, arch, diagonal, bow)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Pointed wall arches, as high as mostly semicircular diagonals, or lower under ridges that are bent."""
        span_x = rng.uniform(3, 7)
        span_y = max(2.5, span_x * rng.uniform(0.6, 1.2))
        diagonal = Semicircular() if rng.random() < 0.7 else Segmental(rng.uniform(0.35, 0.48))
        lower = either(rng, 0.5, 1.0, 0.85, 1.0)
        rise = lower * diagonal.rise(hypot(span_x, span_y) / 2)
        arch_x, arch_y = (Pointed(min(max(rise / span, 0.5), 1.5)) for span in (span_x, span_y))
        bow = 0.0 if lower == 1.0 else float(rng.uniform(0.4, 1.0))
        return cls(span_x, span_y, arch_x, arch_y, diagonal, bow)

"""Groin vault: two barrels that cross; the higher one shows."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import hypot
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.constraints import Constraint
from families.declaration.footprint import Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import BarrelPart, Piece
from families.declaration.plan import Axis, Plan
from families.declaration.profiles import Curve, Elliptical, Profile, Semicircular, Stilted
from families.declaration.ribs import CORNERS, SIDES, RibLine, diagonals, ridges, wall_arches
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import COARSE_KINDS, COARSE_RISES, drawn_arch, either
from families.declaration.vault import Vault

EQUALLY_HIGH = 0.8  # the lower barrel rises to this share of the higher, else it is a row of lunettes
SAME_HEIGHT = 0.005  # [m] within which barrels are so equally high that groins are straight but for the crown
BEGUN_KINDS: tuple[type[Profile], ...] = (*COARSE_KINDS, Stilted)  # of arches in first guesses: steep ones are stilted
BEGUN = 0.02  # where a crown rise or an offset is looked for first


def _raised(vault: Groin) -> dict[str, float]:
    """A crown that rises a little."""
    return {"crown_rise_ratio": BEGUN}


def _outside_x(vault: Groin) -> dict[str, float]:
    """Springings a little inside the wall arches, which stay where they are."""
    return {"offset_x_ratio": BEGUN, "span_x": 2 * vault.plan.half_x / (1 + 2 * BEGUN)}


def _outside_y(vault: Groin) -> dict[str, float]:
    """Springings a little inside the wall arches, which stay where they are."""
    return {"offset_y_ratio": BEGUN, "span_y": 2 * vault.plan.half_y / (1 + 2 * BEGUN)}


def _equal_rises(vault: Groin) -> dict[str, float]:
    """The rise of one barrel by that of the other, where its profile has one to choose."""
    for name, profile, rise, span in (
        ("rise_ratio_y", vault.profile_y, vault.rise_x, 2 * vault.axes[1].half_span),
        ("rise_ratio_x", vault.profile_x, vault.rise_y, 2 * vault.axes[0].half_span),
    ):
        ranges = [p.range for p in profile.parameters() if p.name == "rise_ratio"]
        if ranges:
            return {name: min(max(rise / span, ranges[0].low), ranges[0].high)}
    return {}


def _level_crown(rise: float) -> dict[str, float]:
    """A rise is that of both barrels, the crown being level."""
    return {"rise_x": rise, "rise_y": rise, "crown_rise": 0.0}


@dataclass(frozen=True)
class Groin(Vault):
    """Barrel of `profile_x` across x along y, crossed by one of `profile_y` across y along x.

    `crown_rise_ratio` lifts the crown at the middle above the wall arches (domical); the wall arches may stand
    outside the rectangle of the springings by an offset.
    """

    id: ClassVar[str] = "groin"
    title: ClassVar[str] = "groin vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("crociera", "volta a crociera"),
        "fr": ("voûte d'arêtes", "arêtes"),
        "de": ("kreuzgratgewölbe", "kreuzgewölbe", "kreuzgrat"),
        "es": ("arista", "bóveda de arista", "crucería"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (
        ("web", "one of the fields of a groin vault, between two groins and a wall arch"),
        ("groin", "the edge where two barrels meet"),
    )
    roof_type: ClassVar[str] = "USERDEFINED"
    ratios: ClassVar[Mapping[str, str]] = {
        "rise_x": "rise_ratio_x",
        "rise_y": "rise_ratio_y",
        "crown_rise": "crown_rise_ratio",
        "offset_x": "offset_x_ratio",
        "offset_y": "offset_y_ratio",
    }
    stands_for: ClassVar[Mapping[str, Callable[[float], Mapping[str, float]]]] = {"rise": _level_crown}
    usual: ClassVar[Mapping[str, tuple[float, float]]] = {
        "offset_x_ratio": (0.04, 0.03),
        "offset_y_ratio": (0.04, 0.03),
        "crown_rise_ratio": (0.08, 0.05),
    }
    alike: ClassVar[tuple[str, ...]] = ("profile_x", "profile_y")
    quarter_turn: ClassVar[Symmetry | None] = Symmetry(exchanged=("x", "y"))
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint(
            "level-crown",
            "the crown is as high as the wall arches",
            {"crown_rise_ratio": 0.0},
            begins=_raised,
            rare=True,
        ),
        Constraint(
            "flush-x",
            "the wall arches in x stand over the springings",
            {"offset_x_ratio": 0.0},
            begins=_outside_x,
            rare=True,
        ),
        Constraint(
            "flush-y",
            "the wall arches in y stand over the springings",
            {"offset_y_ratio": 0.0},
            begins=_outside_y,
            rare=True,
        ),
        Constraint("equal-rises", "both barrels are equally high", follows=_equal_rises),
    )

    span_x: Annotated[float, Range(0.5, 40, "m", "clear width at the springing along x")] = 5.0
    span_y: Annotated[float, Range(0.5, 40, "m", "clear width at the springing along y")] = 5.0
    profile_x: Profile = Semicircular()
    profile_y: Profile = Semicircular()
    crown_rise_ratio: Annotated[float, Range(0, 0.3, "1", "crown above the higher wall arch / its rise")] = 0.0
    offset_x_ratio: Annotated[float, Range(0, 0.3, "1", "wall arches outside the springings in x / span_x")] = 0.0
    offset_y_ratio: Annotated[float, Range(0, 0.3, "1", "wall arches outside the springings in y / span_y")] = 0.0

    @derived("m", "rise of the arch across x, over the southern and northern walls")
    def rise_x(self) -> float:
        """Rise of the arch across x [m]."""
        return self.profile_x.rise(self.axes[0].half_span)

    @derived("m", "rise of the arch across y, over the western and eastern walls")
    def rise_y(self) -> float:
        """Rise of the arch across y [m]."""
        return self.profile_y.rise(self.axes[1].half_span)

    @derived("m", "crown at the middle above the springing")
    def rise(self) -> float:
        """Crown at the middle above the springing [m]."""
        return max(self.rise_x, self.rise_y) + self.crown_rise

    @derived("m", "crown at the middle above the higher wall arch")
    def crown_rise(self) -> float:
        """Crown at the middle above the higher wall arch [m]."""
        return self.crown_rise_ratio * max(self.rise_x, self.rise_y)

    @derived("m", "distance of the western and eastern wall arches outside the springings")
    def offset_x(self) -> float:
        """Distance of the western and eastern wall arches outside the springings [m]."""
        return self.offset_x_ratio * self.span_x

    @derived("m", "distance of the southern and northern wall arches outside the springings")
    def offset_y(self) -> float:
        """Distance of the southern and northern wall arches outside the springings [m]."""
        return self.offset_y_ratio * self.span_y

    @property
    def components(self) -> tuple[str, ...]:
        """Four webs."""
        return ("web_south", "web_north", "web_west", "web_east")

    @Once
    def plan(self) -> Plan:
        """The rectangle of the wall arches."""
        return self.over(self.span_x / 2 + self.offset_x, self.span_y / 2 + self.offset_y)

    @Once
    def axes(self) -> tuple[Axis, Axis]:
        """Of the barrel across x and of that across y, between their springings."""
        half_x, half_y = self.span_x / 2, self.span_y / 2
        over_x, over_y = self.over(half_x, half_y + self.offset_y), self.over(half_x + self.offset_x, half_y)
        return over_x.axes[0], over_y.axes[1]

    def _farthest(self, axis: Axis) -> float:
        """How far along an axis the farthest corner is [m]: nowhere in the plan is the crown lower than springings."""
        (x, y), (a, b) = axis.origin, axis.across
        return max(abs(a * (side.start[1] - y) - b * (side.start[0] - x)) for side in self.plan.sides)

    def pieces(self) -> tuple[Piece, ...]:
        """Two barrels, both with their axes lifted by as much at the middle."""
        crown_rise = self.crown_rise

        def barrel(axis: Axis, profile: Profile, names: tuple[str, str]) -> Piece:
            part = BarrelPart(
                axis.across,
                profile.curve(axis.half_span),
                names,
                axis.origin,
                crown_rise=crown_rise,
                half_length=axis.half_length if self.skew is None else self._farthest(axis),
                splay=axis.splay,
            )
            return Piece((part,))

        axis_x, axis_y = self.axes
        return (
            barrel(axis_x, self.profile_x, ("web_south", "web_north")),
            barrel(axis_y, self.profile_y, ("web_east", "web_west")),
        )

    def rib_lines(self) -> tuple[RibLine, ...]:
        """Groins, wall arches, and the level crowns of both barrels, where the groins are straight in plan.

        Those of semicircles and ellipses are that, if they are equally high and flush over a rectangle: ellipses, too.
        """
        domical = self.crown_rise_ratio or self.offset_x_ratio or self.offset_y_ratio
        round_ = all(isinstance(arch, Semicircular | Elliptical) for arch in self.profiles.values())
        if domical or not round_ or self.skew is not None or abs(self.rise_x - self.rise_y) > SAME_HEIGHT:
            return ()
        sides, rises = self.plan.sides, (self.rise_x, self.rise_y)
        return (
            *diagonals(sides, CORNERS, Curve(hypot(*sides[0].start), min(rises))),
            *wall_arches(sides, SIDES, (self.profile_x, self.profile_y) * 2),
            *ridges(sides, SIDES, self.rise, rises * 2),
        )

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Arches equally high, of one kind in both directions or of two."""
        span_x, span_y = over.span_x, over.span_y
        for kind_x, kind_y, ratio in product(BEGUN_KINDS, BEGUN_KINDS, COARSE_RISES):
            rise = ratio * (span_x + span_y) / 2
            profiles = kind_x.over(rise / span_x), kind_y.over(rise / span_y)
            if profiles[0] is not None and profiles[1] is not None:
                yield cls(span_x, span_y, profiles[0], profiles[1])

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """About square, with arches of any kind."""
        span_x = rng.uniform(3, 7)
        span_y = span_x * either(rng, 0.3, 1.0, 0.85, 1.2)
        profile, other = drawn_arch(rng), drawn_arch(rng)
        # Most crowns are level: the second arch takes the rise of the first, if its kind can.
        level = type(other).over(profile.rise(span_x / 2) / span_y)
        chosen = level if level is not None and rng.random() < 0.8 else profile
        return cls(
            span_x,
            span_y,
            profile,
            chosen,
            crown_rise_ratio=either(rng, 0.6, 0.0, 0.03, 0.15),
            offset_x_ratio=either(rng, 0.7, 0.0, 0.02, 0.06),
            offset_y_ratio=either(rng, 0.7, 0.0, 0.02, 0.06),
        )

    @property
    def itself(self) -> bool:
        """Whether its barrels are about equally high."""
        return min(self.rise_x, self.rise_y) >= EQUALLY_HIGH * max(self.rise_x, self.rise_y)

"""Barrel vault with lunettes: a barrel cut by transverse barrels, a row of them on either side."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.constraints import Constraint
from families.declaration.footprint import Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import BarrelPart, Piece
from families.declaration.plan import Axis, Plan
from families.declaration.profiles import Elliptical, Profile, Segmental, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import coarse_arches, drawn_arch, either
from families.declaration.vault import Vault

LOWER = 0.95  # lunettes stay below this share of their barrel's rise, else they are groin vaults in a row
HIGH = 0.93  # and from this share on they may be
NARROWEST = 0.8  # m, of the length that each lunette has in first guesses


@dataclass(frozen=True)
class Lunette(Vault):
    """Barrel across x along y; `count` lunettes a side at equal distances, opposite each other.

    A lunette's width is a share of the widest that fits between its neighbours and under the barrel's crown; its
    springing a share of the height then left, so that every combination is a vault.
    """

    id: ClassVar[str] = "lunette"
    title: ClassVar[str] = "barrel vault with lunettes"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("lunettata", "volta a botte lunettata", "botte lunettata", "botte con lunette"),
        "fr": ("berceau à lunettes", "voûte à lunettes", "lunettes"),
        "de": ("stichkappentonne", "tonne mit stichkappen", "stichkappen"),
        "es": ("lunetos", "bóveda de lunetos", "cañón con lunetos"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (
        ("lunette", "small transverse vault that cuts into a barrel, often over a window"),
    )
    roof_type: ClassVar[str] = "BARREL_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {
        "rise": "rise_ratio",
        "pitch": "pitch_ratio",
        "shift": "shift_ratio",
        "lunette_span": "width_ratio",
        "lunette_springing": "springing_ratio",
    }
    quarter_turn: ClassVar[Symmetry | None] = None
    half_turn: ClassVar[Symmetry] = Symmetry(negated=("shift_ratio", "shift"))
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint(
            "centred-row", "the row of lunettes is in the middle of the length", {"shift_ratio": 0.0}, rare=True
        ),
        Constraint("even-row", "the lunettes share the length evenly", {"pitch_ratio": 1.0}),
        Constraint("common-springing", "the lunettes spring with the barrel", {"springing_ratio": 0.0}),
    )

    span: Annotated[float, Range(0.5, 40, "m", "clear width at the springing, across the axis")] = 5.0
    length: Annotated[float, Range(0.5, 100, "m", "extent along the axis")] = 9.0
    profile: Profile = Segmental(0.45)
    count: Annotated[int, Range(1, 12, "1", "lunettes on either side")] = 3
    pitch_ratio: Annotated[float, Range(0.3, 1, "1", "distance between lunettes x their number / length")] = 1.0
    shift_ratio: Annotated[float, Range(-1, 1, "1", "shift of the row along y / the slack at its ends")] = 0.0
    width_ratio: Annotated[float, Range(0.2, 1, "1", "width of a lunette / the widest that fits")] = 0.8
    springing_ratio: Annotated[float, Range(0, 1, "1", "springing of a lunette / the highest that fits")] = 0.3
    lunette_profile: Profile = Semicircular()

    @derived("m", "crown of the barrel above its springing")
    def rise(self) -> float:
        """Crown of the barrel above its springing [m]."""
        return self.profile.rise(self.axis.half_span)

    @derived("m", "radius of curvature of the barrel at the crown")
    def radius(self) -> float:
        """Radius of curvature of the barrel at the crown [m]."""
        return self.profile.curve(self.axis.half_span).crown_radius

    @derived("m", "distance between the centres of neighbouring lunettes")
    def pitch(self) -> float:
        """Distance between the centres of neighbouring lunettes [m]."""
        return self.pitch_ratio * self.length / self.count

    @derived("m", "shift of the row of lunettes along y")
    def shift(self) -> float:
        """Shift of the row of lunettes along y [m]."""
        return self.shift_ratio * (self.length - self.count * self.pitch) / 2

    @derived("m", "clear width of a lunette")
    def lunette_span(self) -> float:
        """Clear width of a lunette [m]."""
        # A profile's rise grows in proportion to its span, so the widest under the crown follows from a unit arch.
        unit = self.lunette_profile.curve(0.5).rise
        return self.width_ratio * min(self.pitch, self.rise / unit)

    @derived("m", "crown of a lunette above its springing")
    def lunette_rise(self) -> float:
        """Crown of a lunette above its springing [m]."""
        return self.lunette_profile.curve(self.lunette_span / 2).rise

    @derived("m", "springing of a lunette above that of the barrel")
    def lunette_springing(self) -> float:
        """Springing of a lunette above that of the barrel [m]."""
        return self.springing_ratio * (self.rise - self.lunette_rise)

    @property
    def positions(self) -> tuple[float, ...]:
        """Centres of the lunettes along the axis [m]."""
        return tuple(self.shift + (k - (self.count - 1) / 2) * self.pitch for k in range(self.count))

    @property
    def components(self) -> tuple[str, ...]:
        """The barrel, then the lunettes in pairs from south to north."""
        return ("barrel", *(f"lunette_{side}_{k + 1}" for k in range(self.count) for side in ("west", "east")))

    @Once
    def plan(self) -> Plan:
        """Span by length; the springings stand on the walls."""
        return self.over(self.span / 2, self.length / 2, on_wall_x=True)

    @Once
    def axis(self) -> Axis:
        """Of the barrel, between the walls that it stands on."""
        return self.plan.axes[0]

    def pieces(self) -> tuple[Piece, ...]:
        """The barrel and one transverse barrel for each pair of lunettes."""
        axis = self.axis
        (x, y), (cx, cy) = axis.origin, axis.across
        barrel = BarrelPart(
            axis.across, self.profile.curve(axis.half_span), ("barrel", "barrel"), axis.origin, splay=axis.splay
        )
        curve, springing = self.lunette_profile.curve(self.lunette_span / 2), self.lunette_springing
        lunettes = (
            BarrelPart(
                barrel.along,
                curve,
                (f"lunette_east_{k}", f"lunette_west_{k}"),
                (x - cy * place, y + cx * place),
                springing,
            )
            for k, place in enumerate(self.positions, 1)
        )
        return (Piece((barrel,)), *(Piece((part,)) for part in lunettes))

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """One to six lunettes a side, narrow or wide, low or high."""
        span_x, span_y = over.span_x, over.span_y
        for profile in coarse_arches():
            if isinstance(profile, Elliptical):  # lies between the others; the lunettes make the grid large
                continue
            for count, width, springing in product(range(1, 7), (0.6, 0.95), (0.1, 0.6)):
                if span_y / count > NARROWEST:
                    yield cls(span_x, span_y, profile, count, 0.97, 0.0, width, springing)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """One to four lunettes a side, most rows even and centred."""
        count, ratio = int(rng.integers(1, 5)), either(rng, 0.6, 1.0, 0.8, 0.98)
        plain = cls(
            span=rng.uniform(3.2, 7),
            length=count * rng.uniform(max(2, 2.6 / count), 3.2) / ratio,
            profile=drawn_arch(rng, "semicircular", "segmental", "basket-handle", "elliptical"),
            count=count,
            pitch_ratio=ratio,
            shift_ratio=either(rng, 0.6, 0.0, -0.8, 0.8),
            width_ratio=rng.uniform(0.6, 0.95),
            springing_ratio=0.0,
            lunette_profile=drawn_arch(rng, "semicircular", "segmental", "pointed"),
        )
        # Lunettes reach well up into the barrel, at least to half its rise.
        crown = rng.uniform(0.5, 0.85) * plain.rise
        springing = (crown - plain.lunette_rise) / (plain.rise - plain.lunette_rise)
        return replace(plain, springing_ratio=max(0.0, springing))

    @property
    def itself(self) -> bool:
        """Whether its lunettes are lower than the barrel."""
        return self.lunette_springing + self.lunette_rise <= LOWER * self.rise

    @property
    def may_be_several(self) -> bool:
        """Whether it might be a row of groin vaults."""
        return self.count > 1 and self.lunette_springing + self.lunette_rise > HIGH * self.rise

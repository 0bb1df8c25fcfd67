"""Rotunda: a dome on a round wall or drum, without pendentives; or a dome scanned alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.constraints import Constraint
from families.declaration.footprint import DISC, Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Piece, Turned
from families.declaration.plan import Plan
from families.declaration.profiles import Elliptical, Profile, Semicircular
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import drawn_arch
from families.declaration.vault import Vault


@dataclass(frozen=True)
class Rotunda(Vault):
    """Profile turned over a circle of radius r, on a drum r x h_d or on the walls."""

    id: ClassVar[str] = "rotunda"
    title: ClassVar[str] = "dome over a round room"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("rotonda", "cupola su pianta circolare", "calotta"),
        "fr": ("rotonde", "coupole sur plan circulaire"),
        "de": ("rotunde", "kuppel über rundem raum"),
        "es": ("cúpula sobre planta circular",),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (("drum", "the cylinder under a dome"),)
    roof_type: ClassVar[str] = "DOME_ROOF"
    ratios: ClassVar[Mapping[str, str]] = {"drum_height": "drum_ratio", "rise": "rise_ratio"}
    raised: ClassVar[tuple[str, ...]] = ("profile",)
    quarter_turn: ClassVar[Symmetry | None] = Symmetry()
    four_corners: ClassVar[bool] = False
    stands_over: ClassVar[str] = DISC
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("no-drum", "the dome stands on the walls, or was scanned alone", {"drum_ratio": 0.0}, rare=True),
    )

    radius: Annotated[float, Range(0.5, 30, "m", "radius of dome and drum")] = 3.0
    profile: Profile = Semicircular()
    drum_ratio: Annotated[float, Range(0, 3, "1", "height of the drum / radius; 0 is none")] = 0.0

    @derived("m", "height of the drum")
    def drum_height(self) -> float:
        """Height of the drum [m]."""
        return self.drum_ratio * self.radius

    @derived("m", "crown above the springing")
    def rise(self) -> float:
        """Crown above the springing [m]."""
        return self.drum_height + self.profile.rise(self.radius)

    @property
    def components(self) -> tuple[str, ...]:
        """Dome, and drum if there is one."""
        return ("dome", "drum") if self.drum_ratio else ("dome",)

    @Once
    def plan(self) -> Plan:
        """The circle; the stone stands on the wall."""
        return Plan.disc(self.radius, on_wall=True)

    def pieces(self) -> tuple[Piece, ...]:
        """One turned profile."""
        curve, names = self.profile.curve(self.radius), ("drum" if self.drum_ratio else "dome", "dome")
        return (Piece((Turned(curve, self.drum_height, names),)),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Flat and steep domes; a scan tells no drum from the wall under it."""
        for ratio in (0.2, 0.3, 0.4, 0.5, 0.65):
            yield cls(over.radius, Elliptical(ratio))

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Without a drum, which a scan does not tell from the wall under it."""
        return cls(rng.uniform(1.5, 4.5), drawn_arch(rng, "semicircular", "segmental", "pointed"))

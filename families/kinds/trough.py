"""Trough vault: a barrel closed by two pavilion heads; with no ridge left a cloister vault."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from families.declaration.constraints import Constraint
from families.declaration.parameters import Range, derived
from families.declaration.pieces import BarrelPart, Piece, cove
from families.declaration.plan import Plan, Side
from families.declaration.profiles import Profile, Semicircular
from families.declaration.vault import Vault


def _equal_heads(vault: Trough) -> dict[str, float]:
    """The run of one head by that of the other."""
    return {"north_ratio": vault.south_ratio}


@dataclass(frozen=True)
class Trough(Vault):
    """Barrel across x along y with a head at either end; common springing and rise."""

    id: ClassVar[str] = "trough"
    title: ClassVar[str] = "trough vault"
    aliases: ClassVar[dict[str, tuple[str, ...]]] = {
        "it": ("botte con teste di padiglione", "padiglione", "volta a padiglione"),
        "fr": ("arc de cloître", "voûte en arc de cloître"),
        "de": ("muldengewölbe", "klostergewölbe"),
        "es": ("esquifada", "bóveda esquifada", "rincón de claustro"),
    }
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

    @property
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

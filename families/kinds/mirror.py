"""Mirror vault: coves on four sides and a plane between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from math import sqrt
from typing import Annotated, ClassVar, Self

import numpy as np

from families.declaration.constraints import Constraint
from families.declaration.footprint import Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Ceiling, Piece, cove
from families.declaration.plan import Plan
from families.declaration.profiles import circle_through, segmental
from families.declaration.symmetry import Symmetry
from families.declaration.usual_arches import either
from families.declaration.vault import Vault

NARROWEST_PLANE = 0.1  # the plane is at least this share of the shorter span, else coves all but meet: a trough
SIDES = (("south", 0, -1), ("north", 2, 1), ("west", 3, -1), ("east", 1, 1))  # and of the plan, and as a part


def _equal_coves(vault: Mirror) -> dict[str, float]:
    """The run of the coves in y by that in x, or as near as can be."""
    return {"run_y_ratio": min(max(vault.run_x / (vault.span_y / 2), 0.1), 1.0)}


@dataclass(frozen=True)
class Mirror(Vault):
    """Trough cut by a horizontal plane.

    The coves are arcs of run S and rise H, R = (S² + H²) / (2 H): S is the run of a cove from the wall to where it
    would be level, H its rise there. With `plane_ratio` = 1 the plane touches them there; below 1 it cuts them, and R
    is free of the run and rise that remain visible.
    """

    id: ClassVar[str] = "mirror"
    title: ClassVar[str] = "mirror vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("specchio", "schifo", "gavetta", "volta a specchio", "volta a schifo"),
        "fr": ("voûte en miroir", "arc de cloître à plafond", "voussure à plafond"),
        "de": ("spiegelgewölbe",),
        "es": ("espejo", "bóveda de espejo", "artesa"),
    }
    glossary: ClassVar[tuple[tuple[str, str], ...]] = (
        ("cove", "curved strip between a wall and the level field of a mirror vault; S is its run, H its rise"),
    )
    roof_type: ClassVar[str] = "USERDEFINED"
    ratios: ClassVar[Mapping[str, str]] = {
        "run_x": "run_x_ratio",
        "run_y": "run_y_ratio",
        "cove_rise": "rise_ratio",
        "rise": "plane_ratio",
    }
    quarter_turn: ClassVar[Symmetry | None] = Symmetry(exchanged=("x", "y"))
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("tangent-plane", "the plane touches the coves where they are level", {"plane_ratio": 1.0}),
        Constraint("quarter-coves", "the coves spring vertically, R = S = H", {"rise_ratio": 1.0}),
        Constraint("equal-coves", "all coves have the same run", follows=_equal_coves),
    )

    span_x: Annotated[float, Range(0.5, 40, "m", "clear width at the springing along x")] = 5.0
    span_y: Annotated[float, Range(0.5, 100, "m", "clear width at the springing along y")] = 7.0
    run_x_ratio: Annotated[float, Range(0.1, 1, "1", "run S of the coves in x / half of span_x")] = 0.5
    run_y_ratio: Annotated[float, Range(0.1, 1, "1", "run S of the coves in y / half of span_y")] = 0.4
    rise_ratio: Annotated[float, Range(0.2, 1, "1", "rise H of the whole coves / the smaller run")] = 0.8
    plane_ratio: Annotated[float, Range(0.2, 1, "1", "height of the plane / H; 1 touches the coves")] = 1.0

    @derived("m", "run S of the whole coves in x, up to where they are level")
    def run_x(self) -> float:
        """Run S of the whole coves in x [m]."""
        return self.run_x_ratio * self.span_x / 2

    @derived("m", "run S of the whole coves in y, up to where they are level")
    def run_y(self) -> float:
        """Run S of the whole coves in y [m]."""
        return self.run_y_ratio * self.span_y / 2

    @derived("m", "rise H of the whole coves")
    def cove_rise(self) -> float:
        """Rise H of the whole coves [m]."""
        return self.rise_ratio * min(self.runs)

    @derived("m", "height of the plane above the springing")
    def rise(self) -> float:
        """Height of the plane above the springing [m]."""
        return self.plane_ratio * self.cove_rise

    @derived("m", "radius R = (S² + H²) / (2 H) of the coves in x")
    def radius_x(self) -> float:
        """Radius of the coves in x [m]."""
        return circle_through(self.run_x, self.cove_rise)

    @derived("m", "radius R = (S² + H²) / (2 H) of the coves in y")
    def radius_y(self) -> float:
        """Radius of the coves in y [m]."""
        return circle_through(self.run_y, self.cove_rise)

    @property
    def components(self) -> tuple[str, ...]:
        """Four coves and the plane."""
        return (*(f"cove_{name}" for name, _, _ in SIDES), "plane")

    @Once
    def plan(self) -> Plan:
        """The rectangle; the stone stands on all four walls."""
        return self.over(self.span_x / 2, self.span_y / 2, on_wall_x=True, on_wall_y=True)

    @Once
    def runs(self) -> tuple[float, ...]:
        """Run S of the whole coves on the southern, eastern, northern and western walls [m]."""
        shares = (self.run_y_ratio, self.run_x_ratio) * 2
        return tuple(share * wall.offset for share, wall in zip(shares, self.plan.sides, strict=True))

    def pieces(self) -> tuple[Piece, ...]:
        """Intersection of four coves and the plane."""
        walls, runs, rise = self.plan.sides, self.runs, self.cove_rise
        coves = (cove(walls[k], segmental(runs[k], rise), f"cove_{name}", side) for name, k, side in SIDES)
        return (Piece((*coves, Ceiling(self.rise, ("plane",)))),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """Narrow and wide coves, flat and steep, touched by the plane or cut."""
        span_x, span_y = over.span_x, over.span_y
        least = min(span_x, span_y)
        for run, rise, plane in product((0.25, 0.5, 0.75, 1.0), (0.4, 0.6, 0.8, 1.0), (0.4, 0.7, 1.0)):
            runs = max(run * least / span_x, 0.1), max(run * least / span_y, 0.1)
            yield cls(span_x, span_y, *runs, rise, plane)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """Most coves equally wide."""
        span_x, span_y = rng.uniform(3, 6), rng.uniform(3.5, 8)
        run = rng.uniform(0.25, 0.65) * min(span_x, span_y) / 2
        return cls(
            span_x,
            span_y,
            2 * run / span_x,
            either(rng, 0.6, 1.0, 0.85, 1.1) * 2 * run / span_y,
            rise_ratio=either(rng, 0.4, 1.0, 0.6, 1),
            plane_ratio=either(rng, 0.5, 1.0, 0.6, 0.9),
        )

    @property
    def itself(self) -> bool:
        """Whether there is a plane."""

        def visible(run: float, radius: float) -> float:
            """Run of a cove up to the plane [m]."""
            centre = self.cove_rise - radius
            return run - sqrt(max(0.0, radius**2 - (self.rise - centre) ** 2))

        plane_x = self.span_x - 2 * visible(self.run_x, self.radius_x)
        plane_y = self.span_y - 2 * visible(self.run_y, self.radius_y)
        return min(plane_x, plane_y) >= NARROWEST_PLANE * min(self.span_x, self.span_y)

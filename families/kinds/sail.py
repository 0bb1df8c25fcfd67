"""Sail vault: a sphere over a rectangle, through its corners."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Annotated, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from families.declaration.constraints import Constraint
from families.declaration.footprint import Footprint
from families.declaration.once import Once
from families.declaration.parameters import Range, derived
from families.declaration.pieces import Ball, Piece
from families.declaration.plan import Plan
from families.declaration.plan_sides import Vector
from families.declaration.profiles import circle_through
from families.declaration.symmetry import Symmetry
from families.declaration.vault import Vault

ROUND = 0.15  # points of the sphere beyond the plan / in it from which on the plan is round


@dataclass(frozen=True)
class Sail(Vault):
    """Sphere of radius R = (d² + h²) / (2 h) through the corners, d half the diagonal and h the rise above them.

    Through four free corners, which lie on no circle, as nearly as can be.
    """

    id: ClassVar[str] = "sail"
    title: ClassVar[str] = "sail vault"
    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "it": ("vela", "volta a vela"),
        "fr": ("voûte en pendentifs", "cul-de-four"),
        "de": ("hängekuppel", "böhmische kappe", "stutzkuppel"),
        "es": ("bóveda vaída", "vaída", "baída"),
    }
    roof_type: ClassVar[str] = "USERDEFINED"
    ratios: ClassVar[Mapping[str, str]] = {"rise": "rise_ratio"}
    quarter_turn: ClassVar[Symmetry | None] = Symmetry(exchanged=("x", "y"))
    constraints: ClassVar[tuple[Constraint, ...]] = (
        Constraint("hemisphere", "the sphere's centre lies on the springing", {"rise_ratio": 1.0}),
    )

    span_x: Annotated[float, Range(0.5, 40, "m", "clear width of the plan along x")] = 5.0
    span_y: Annotated[float, Range(0.5, 40, "m", "clear width of the plan along y")] = 5.0
    rise_ratio: Annotated[float, Range(0.1, 1, "1", "rise above the corners / half diagonal; 1 is a hemisphere")] = 0.8

    @property
    def _half_diagonal(self) -> float:
        if self.skew is None:
            return hypot(self.span_x, self.span_y) / 2
        x, y = self._centre
        return sqrt(sum((a - x) ** 2 + (b - y) ** 2 for a, b in self.corners.tolist()) / 4)

    @property
    def _centre(self) -> Vector:
        """That of the circle which comes nearest to all corners (Kåsa 1976); their mean is the origin."""
        if self.skew is None:
            return 0.0, 0.0
        xy = self.corners
        x, y = np.linalg.solve(xy.T @ xy, xy.T @ (xy**2).sum(axis=1) / 2).tolist()
        return x, y

    @derived("m", "crown above the corners")
    def rise(self) -> float:
        """Crown above the corners [m]."""
        return self.rise_ratio * self._half_diagonal

    @derived("m", "radius of the sphere")
    def radius(self) -> float:
        """Radius of the sphere [m]."""
        return circle_through(self._half_diagonal, self.rise)

    @property
    def components(self) -> tuple[str, ...]:
        """One."""
        return ("sail",)

    @Once
    def plan(self) -> Plan:
        """The rectangle."""
        return self.over(self.span_x / 2, self.span_y / 2)

    def pieces(self) -> tuple[Piece, ...]:
        """A ball."""
        return (Piece((Ball(self.rise - self.radius, self.radius, ("sail",), self._centre),)),)

    @classmethod
    def first_guesses(cls, over: Footprint) -> Iterator[Self]:
        """All rises."""
        for ratio in np.linspace(0.1, 1, 13).tolist():
            yield cls(over.span_x, over.span_y, ratio)

    @classmethod
    def drawn(cls, rng: np.random.Generator) -> Self:
        """About square."""
        span = rng.uniform(3, 6.5)
        return cls(span, span * rng.uniform(0.85, 1.2), rng.uniform(0.35, 1))

    def contradiction(self, points: NDArray[np.float64], own: NDArray[np.float64], tolerance: float) -> str:
        """Its sphere goes on beyond its plan, as a dome's does over a round plan."""
        centre = self.rise - self.radius
        beyond = (self.plan.distance(points[:, :2]) > tolerance) & (points[:, 2] > centre)
        off = np.abs(np.linalg.norm(points - [*self._centre, centre], axis=1) - self.radius)
        if (beyond & (off < tolerance)).sum() <= ROUND * len(own):
            return ""
        return (
            f"a sphere of {self.radius:.2f} m radius that goes on beyond any square under it: a dome over a round "
            "room, which is a rotunda"
        )

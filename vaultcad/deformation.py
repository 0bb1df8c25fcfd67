"""What is told of how a vault has moved, as plain values: figures with limits, and which mechanism they resemble."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Movement:
    """One figure of a movement.

    value: [m], or a rotation [m/m]. limit: what it may be off with 95 % certainty, same unit. unit: "m" or "m/m".
    direction: in words, which way it goes. azimuth: [deg] clockwise from the scan's +y axis of where that is; None for
    what has none.
    """

    name: str
    value: float
    limit: float
    unit: str
    direction: str
    azimuth: float | None = None

    @property
    def certain(self) -> bool:
        """Whether it is larger than its limit."""
        return abs(self.value) > self.limit


@dataclass(frozen=True)
class Against:
    """All figures against one reference: its id, and in words what it is."""

    id: str
    reference: str
    movements: tuple[Movement, ...]

    def movement(self, name: str) -> Movement | None:
        """The figure of that name."""
        return next((one for one in self.movements if one.name == name), None)


@dataclass(frozen=True)
class Resemblance:
    """How far a movement resembles a mechanism: its odds against the others, and the share of the variance it tells."""

    mechanism: str
    odds: float
    share: float
    says: str

    @property
    def told_odds(self) -> str:
        """In words: no reading is surer of a mechanism than 99 in 100."""
        return "over 99 %" if self.odds > 0.99 else f"{100 * self.odds:.0f} %"


@dataclass(frozen=True)
class Deformation:
    """A reading of the deformation of a vault. caution: sentences on what it cannot tell."""

    against: tuple[Against, ...]
    resembles: tuple[Resemblance, ...]
    verdict: str
    caution: tuple[str, ...]

    def of(self, id: str) -> Against | None:
        """The figures against the reference of that id."""
        return next((one for one in self.against if one.id == id), None)


def deformation_of(told: Mapping[str, Any] | None) -> Deformation | None:
    """The reading that `dataclasses.asdict` tells of; None for none."""
    if not told:
        return None
    against = tuple(Against(**{**one, "movements": _all(Movement, one["movements"])}) for one in told["against"])
    return Deformation(against, _all(Resemblance, told["resembles"]), told["verdict"], tuple(told["caution"]))


def _all(kind: Any, rows: Any) -> tuple[Any, ...]:
    return tuple(kind(**row) for row in rows)

"""The ways in which vaults are known to give, each as a few displacement fields whose sizes a reading estimates.

Nobody knows how a movement fades down a wall or up a haunch: each mechanism has several shapes, and which of them it is
the scan says. Walls of a room fade in one way: given all at once, shapes that hardly differ where stone is seen would
part at the springing, where none is. Spreading abutments let the crown sink (Heyman, "The stone skeleton", 1995;
Ochsendorf, "The masonry arch on spreading supports", 2006), so that mechanism has the shapes of a sinking crown, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from families import Vault

Array = NDArray[np.float64]

LARGE = 0.05  # m, standard deviation of all shapes of a part beforehand: vaults that stand have moved by centimetres
SHORT = 0.75  # m below the springing in which a movement of walls may fade
TWICE = 2.0  # times that, or to the floor
LOWEST = 0.1  # m, rise of a vault and depth of its walls at the least
EVERY_WAY = -1  # of a shape that is there however walls fade


@dataclass(frozen=True)
class Body:
    """A vault by its sizes: half extents (2,) of its plan [m], rise [m], and how far down its walls are seen [m]."""

    half: Array
    rise: float
    depth: float

    @classmethod
    def of(cls, vault: Vault, depth: float = SHORT) -> Body:
        """Of a vault whose walls are seen so far down [m]."""
        return cls(vault.plan.half, max(vault.top, LOWEST), max(depth, LOWEST))


Fields = Callable[[Array, Body], Iterator[tuple[int, Array]]]
"""Fields (n, 3) at points (n, 3), each with the number of the way in which walls fade that it has."""


def _upwards(points: Array, body: Body) -> Array:
    out: Array = np.clip(points[:, 2] / max(body.rise, 1e-3), 0, 1)
    return out


def _over_plan(points: Array, body: Body, axis: int) -> Array:
    out: Array = np.clip(points[:, axis] / body.half[axis], -1, 1)
    return out


def _along(axis: int, values: Array) -> Array:
    """Displacements (n, 3) along an axis."""
    field = np.zeros((len(values), 3))
    field[:, axis] = values
    return field


def _fading(points: Array, body: Body) -> Iterator[tuple[int, Array]]:
    """From 1 at the springing to 0 at the crown, and down the walls: with a hinge at the springing, and without.

    Each with its number; the last two bend the vault alone.

    Halves of an arch that turn as bodies move in proportion to the height, as walls do that turn about their foot.
    """
    up, below = _upwards(points, body), points[:, 2] < 0
    ends = sorted({min(reach, body.depth) for reach in (SHORT, TWICE * SHORT, body.depth)})
    for k, end in enumerate(ends):
        down = np.clip(1 + points[:, 2] / end, 0, 1)
        for smooth, fading in enumerate((down, down**2 * (3 - 2 * down))):
            yield 2 * k + smooth, np.where(below, fading, 1 - up)
    yield EVERY_WAY, up * (1 - up)
    yield EVERY_WAY, up**2 * (1 - up)


def _spreading(axis: int) -> Fields:
    """What stands between walls that part goes along in proportion to its place, or as halves that move as bodies."""

    def fields(points: Array, body: Body) -> Iterator[tuple[int, Array]]:
        across = _over_plan(points, body, axis)
        for way, fading in _fading(points, body):
            yield way, _along(axis, across * fading)
            yield way, _along(axis, (across - across**3) * fading)

    return fields


def _leaning(axis: int) -> Fields:
    def fields(points: Array, body: Body) -> Iterator[tuple[int, Array]]:
        for way, fading in _fading(points, body):
            yield way, _along(axis, fading)

    return fields


def _sinking(points: Array, body: Body) -> Iterator[tuple[int, Array]]:
    up = _upwards(points, body)
    x, y = (1 - _over_plan(points, body, axis) ** 2 for axis in (0, 1))
    for across in (x, x**2, y, y**2, x * y, (x * y) ** 2):
        yield EVERY_WAY, _along(2, -across * up)
        yield EVERY_WAY, _along(2, -across * up**2)


def _tilting(points: Array, body: Body) -> Iterator[tuple[int, Array]]:
    for axis in (0, 1):
        yield EVERY_WAY, _along(2, -_over_plan(points, body, axis))


def _twisting(points: Array, body: Body) -> Iterator[tuple[int, Array]]:
    yield EVERY_WAY, _along(2, -_over_plan(points, body, 0) * _over_plan(points, body, 1))


PARTS: Mapping[str, Fields] = {
    "spread x": _spreading(0),
    "spread y": _spreading(1),
    "sinking": _sinking,
    "tilt": _tilting,
    "twist": _twisting,
    "lean x": _leaning(0),
    "lean y": _leaning(1),
}
"""Fields of which mechanisms are made."""

GIVING = ("spread x", "spread y", "sinking")  # of abutments that give way


@dataclass(frozen=True)
class Mechanism:
    """A mechanism by its parts of `PARTS`, none of which stands for waves without any; and what goes with it."""

    name: str
    parts: tuple[str, ...]
    says: str


MECHANISMS: tuple[Mechanism, ...] = (
    Mechanism(
        "spreading of the abutments",
        GIVING,
        "the springings move apart and the crown sinks; cracks open at the crown on the intrados, "
        "at the haunches on the extrados",
    ),
    Mechanism(
        "sinking of the crown",
        ("sinking",),
        "the crown sinks between springings that stay; as from flat centring, creep of the mortar, or load",
    ),
    Mechanism(
        "one-sided settlement",
        ("tilt",),
        "one support sinks against the other; cracks run along the vault at the crown and over the lower haunch",
    ),
    Mechanism("twist", ("twist",), "two opposite corners sink against the other two; cracks run along a diagonal"),
    Mechanism(
        "leaning to one side", ("lean x", "lean y"), "opposite walls lean the same way, and the vault sways with them"
    ),
    Mechanism("local bulges", (), "uneven waves and bulges that none of the other mechanisms tells"),
)


class Shapes(NamedTuple):
    """All fields of `PARTS` at points: (n, k, 3) [m], of unit size; (k,) whose each is, and (k,) how it fades."""

    fields: Array
    part: NDArray[np.str_]
    fading: NDArray[np.int64]

    def alternatives(self) -> list[NDArray[np.bool_]]:
        """The shapes (k,) of each way in which walls may fade."""
        ways = range(int(self.fading.max()) + 1)
        return [(self.fading == way) | (self.fading == EVERY_WAY) for way in ways]


def shapes(points: Array, body: Body, parts: Iterable[str] = PARTS) -> Shapes:
    """Those of some of `PARTS` at points (n, 3) in the vault's frame [m]."""
    found = [(name, way, field) for name in parts for way, field in PARTS[name](points, body)]
    names, ways, all_ = zip(*found, strict=True)
    return Shapes(np.stack(all_, axis=1), np.array(names), np.array(ways, np.int64))

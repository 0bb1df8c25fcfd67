"""Where ways are parted into pieces, by what two surfaces show on both sides of them."""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from math import hypot
from typing import NamedTuple

from families.declaration.plan_sides import Vector
from families.solid.envelope import Skin
from families.solid.plan_cells import SAME_PLACE, Ground, Part

SAME_STOP = 1e-9  # [m]
ROUNDED = 1e-5  # [m]
POLE = -1  # stands for a way that ends at a pole
Piece = tuple[int, int]  # of a way, from one of its stops to the next


class Sides(NamedTuple):
    """The roofs on the left and on the right of a piece; -1 where there is none."""

    left: int = -1
    right: int = -1

    @property
    def inner(self) -> int:
        """The roof at the edge of a region."""
        return max(self)


Shown = dict[Piece, Sides]


@dataclass
class Stops:
    """Parameters at which the ways of a ground stop, in rising order."""

    ground: Ground
    at: dict[int, list[float]] = field(default_factory=dict)

    def add(self, at: Iterable[tuple[int, float]]) -> None:
        """More stops, by ways and parameters."""
        found: dict[int, list[float]] = defaultdict(list)
        for way, t in at:
            found[way].append(t)
        for way, ends in found.items():
            self.at[way] = self._apart(way, sorted({*ends, *self.at.get(way, [])}))

    def _apart(self, way: int, at: list[float]) -> list[float]:
        """Stops at one place once."""
        kept: list[float] = []
        (a, b), (c, d) = self.ground.ways[way].start, self.ground.ways[way].end
        size = hypot(c - a, d - b)
        for t in at:
            if not kept or (t - kept[-1]) * size > SAME_STOP:
                kept.append(t)
            elif t == 1.0:
                kept[-1] = t
        return kept

    def pieces(self, part: Part) -> Iterator[Piece]:
        """Those of a part, forwards."""
        stops = self.at[part.way]
        first, last = nearest_stop(stops, part.start), nearest_stop(stops, part.end)
        for k in range(min(first, last), max(first, last)):
            yield part.way, k

    def seen(self, skin: Skin) -> Shown:
        """What a skin shows on both sides of each piece."""
        found: Shown = {}
        for region in skin.regions:
            for part in region.loop:
                if isinstance(part, Part):
                    for piece in self.pieces(part):
                        left, right = found.get(piece, (-1, -1))
                        found[piece] = Sides(region.roof, right) if part.end > part.start else Sides(left, region.roof)
        return found

    def join(self, seen: tuple[Shown, Shown], poles: Iterable[Vector], forced: set[Piece]) -> tuple[Shown, Shown]:
        """Drop the stops at which nothing changes: there only a cut of the plan is passed. What is seen then.

        seen: what two skins show. poles: places at which all ways end. forced: pieces at whose starts ways stop anyhow.
        """
        above, below = seen
        ends = self._edge_ends(seen)
        for pole in poles:
            ends[_rounded(*pole)].add(POLE)
        joined: tuple[Shown, Shown] = ({}, {})
        for way, stops in self.at.items():
            kept: list[float] = []
            before: tuple[Sides | None, Sides | None] = (None, None)
            for k, stop in enumerate(stops):
                here = above.get((way, k)), below.get((way, k))
                passed = here == before and (way, k) not in forced and here != (None, None)
                if passed and not ends.get(_rounded(*self.ground.ways[way].at(stop)), set()) - {way}:
                    continue
                for found, sides in zip(joined, here, strict=True):
                    if sides is not None:
                        found[way, len(kept)] = sides
                if here != (None, None) or before != (None, None):
                    kept.append(stop)
                before = here
            self.at[way] = kept
        return joined

    def _edge_ends(self, seen: tuple[Shown, Shown]) -> dict[tuple[int, int], set[int]]:
        """The ways along which an edge ends at a place, by all that this may be rounded to."""
        found: dict[tuple[int, int], set[int]] = defaultdict(set)
        for way, stops in self.at.items():
            edges = [
                any(len(set(shown[way, k])) > 1 for shown in seen if (way, k) in shown) for k in range(len(stops) - 1)
            ]
            for k, stop in enumerate(stops):
                if (k > 0 and edges[k - 1]) == (k < len(edges) and edges[k]):
                    continue
                x, y = self.ground.ways[way].at(stop)
                (x0, y0), (x1, y1) = _rounded(x - SAME_PLACE, y - SAME_PLACE), _rounded(x + SAME_PLACE, y + SAME_PLACE)
                for place in {(x0, y0), (x0, y1), (x1, y0), (x1, y1)}:
                    found[place].add(way)
        return found

    def span(self, piece: Piece) -> tuple[float, float]:
        """Parameters of its way at which a piece starts and ends."""
        way, k = piece
        return self.at[way][k], self.at[way][k + 1]


def nearest_stop(stops: list[float], t: float) -> int:
    """Which of rising stops is nearest to a parameter."""
    k = bisect_left(stops, t)
    if k == len(stops) or (k and t - stops[k - 1] < stops[k] - t):
        return k - 1
    return k


def _rounded(x: float, y: float) -> tuple[int, int]:
    return round(x / ROUNDED), round(y / ROUNDED)

"""The walls that stand along the sides of a plan, straight or round, with their doors and windows, as triangles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, pi, sqrt

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.plan import Plan
from families.declaration.plan_sides import Side
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.triangles import Triangles, prism, rectangle

Array = NDArray[np.float64]

WALL, DOOR = 0.6, 0.25  # reflectance
REVEAL = 0.35  # depth of the jambs of doors and windows [m]
MARGIN = 0.2  # masonry left around an opening [m]
ROUNDNESS = 0.0003  # m, that a piece of a round wall may be flatter than its arc


@dataclass(frozen=True)
class Opening:
    """Door or window in a wall: along the wall from s0 to s1, from z0 to z1 [m]."""

    s0: float
    s1: float
    z0: float
    z1: float
    closed: bool  # by a leaf; else rays go out and never return


@dataclass(frozen=True)
class Wall:
    """A wall on a side of a plan: places by the way along its face from the middle, and by the depth behind that [m].

    Along a straight one the way leads to the east, or where there is none to the north.
    """

    side: Side

    @property
    def half_length(self) -> float:
        """Half of the length of its face [m]."""
        if self.side.centre is None:
            (ax, ay), (bx, by) = self.side.start, self.side.end
            return float(np.hypot(bx - ax, by - ay)) / 2
        return self.side.radius * abs(self._angles[1] - self._angles[0]) / 2

    @property
    def _angles(self) -> tuple[float, float]:
        """Of an arc's start and end about its centre [rad]."""
        assert self.side.centre is not None
        ends = np.array([self.side.start, self.side.end]) - self.side.centre
        first, last = np.arctan2(ends[:, 1], ends[:, 0]).tolist()
        return first, first + (last - first) % (2 * pi) if self.side.inside else first - (first - last) % (2 * pi)

    def at(self, along: float, depth: float) -> Array:
        """The place (2,) [m] of a point."""
        if self.side.centre is None:
            start, end = sorted((self.side.start, self.side.end))
            way = (np.array(end) - start) / np.hypot(end[0] - start[0], end[1] - start[1])
            place: Array = (np.array(start) + end) / 2 + along * way + depth * np.array(self.side.normal)
            return place
        first, last = self._angles
        angle = (first + last) / 2 + along / self.side.radius * (1.0 if self.side.inside else -1.0)
        reach = self.side.radius + (depth if self.side.inside else -depth)
        turned: Array = np.array(self.side.centre) + reach * np.array([np.cos(angle), np.sin(angle)])
        return turned

    def pieces(self, start: float, end: float) -> Iterator[tuple[float, float]]:
        """A way from start to end [m], cut up where the wall is round."""
        count = 1
        if self.side.centre is not None:
            count = max(1, ceil((end - start) / sqrt(8 * self.side.radius * ROUNDNESS)))
        return pairwise(np.linspace(start, end, count + 1).tolist())

    def panels(
        self, s: tuple[float, float], z: tuple[float, float], depth: tuple[float, float], bright: float
    ) -> Iterator[Triangles]:
        """Rectangles between two corners given along the wall, in height and in depth behind its face."""
        for first, last in self.pieces(*s) if s[0] < s[1] else [s]:
            corner = np.array([*self.at(first, depth[0]), z[0]])
            ways = [
                np.array([*self.at(last, depth[0]), z[0]]) - corner,
                np.array([*self.at(first, depth[1]), z[0]]) - corner,
                np.array([0.0, 0.0, z[1] - z[0]]),
            ]
            u, v = sorted((way for way in ways if way.any()), key=lambda way: int(np.abs(way).argmax()))
            yield rectangle(corner, u, v, bright)

    def built(self, levels: tuple[float, float], openings: list[Opening]) -> Iterator[Triangles]:
        """All of it between two levels [m], cut up along the edges of its openings, with their jambs and leaves."""
        length = self.half_length
        cuts_s = sorted({-length, length, *(v for o in openings for v in (o.s0, o.s1))})
        cuts_z = sorted({*levels, *(v for o in openings for v in (o.z0, o.z1))})
        for s in pairwise(cuts_s):
            for z in pairwise(cuts_z):
                if not any(o.s0 <= s[0] < o.s1 and o.z0 <= z[0] < o.z1 for o in openings):
                    yield from self.panels(s, z, (0, 0), WALL)
        for o in openings:
            for end in (o.s0, o.s1):
                yield from self.panels((end, end), (o.z0, o.z1), (0, REVEAL), WALL)
            for level in (o.z0, o.z1):
                yield from self.panels((o.s0, o.s1), (level, level), (0, REVEAL), WALL)
            if o.closed:
                yield from self.panels((o.s0, o.s1), (o.z0, o.z1), (0.8 * REVEAL, 0.8 * REVEAL), DOOR)

    def bar(self, depth: tuple[float, float], levels: tuple[float, float], bright: float) -> Iterator[Triangles]:
        """A bar along all of it, between two depths and two levels [m]."""
        for s in self.pieces(-self.half_length, self.half_length):
            yield prism([self.at(along, d) for along in s for d in depth], levels, bright)


def walls_of(plan: Plan, behind: float = 0.0) -> tuple[tuple[Wall, ...], ...]:
    """The walls about a plan in pairs that are opposite to each other, west and east first; `behind` its sides [m]."""
    if behind:
        plan = Plan(tuple(replace(side, on_wall=True) for side in plan.sides), plan.reflex).grown(behind)
    walls = [Wall(side) for side in (plan.sides[-1], *plan.sides[:-1])]
    half = (len(walls) + 1) // 2
    return tuple(tuple(walls[k::half]) for k in range(half))


def draw_openings(vault: Vault, settings: ScannerSettings, rng: np.random.Generator) -> dict[Wall, list[Opening]]:
    """Doors and windows by wall; those that would cut into the vault or into each other are left out."""
    pairs = walls_of(vault.plan)
    found: dict[Wall, list[Opening]] = {wall: [] for pair in pairs for wall in pair}
    for k in range(settings.openings):
        wall = any_of(pairs, rng)
        length = wall.half_length
        door = k % 2 == 0
        width = rng.uniform(0.8, 1.2)
        height = rng.uniform(2.0, 2.3) if door else rng.uniform(0.7, 1.5)
        sill = -settings.wall_height + (0.0 if door else rng.uniform(0.9, settings.wall_height + 0.8))
        middle = rng.uniform(-1, 1) * max(0.0, length - width / 2 - MARGIN)
        new = Opening(middle - width / 2, middle + width / 2, sill, sill + height, closed=door)
        clear = all(
            new.s1 + MARGIN < o.s0 or o.s1 + MARGIN < new.s0 or new.z1 + MARGIN < o.z0 or o.z1 + MARGIN < new.z0
            for o in found[wall]
        )
        if clear and width / 2 + MARGIN < length and _in_wall(vault, wall, new):
            found[wall].append(new)
    return found


def any_of(pairs: tuple[tuple[Wall, ...], ...], rng: np.random.Generator) -> Wall:
    """One of the walls."""
    pair = pairs[int(rng.integers(len(pairs)))]
    return pair[int(rng.integers(2)) % len(pair)]


def _in_wall(vault: Vault, wall: Wall, opening: Opening) -> bool:
    """Whether an opening lies in bare wall: below the springing, or under a wall arch."""
    if opening.z1 < -MARGIN:
        return True
    s = (opening.s0, opening.s1, opening.s0, opening.s1, (opening.s0 + opening.s1) / 2)
    z = (opening.z0, opening.z0, opening.z1, opening.z1, opening.z1)
    points = np.array([[*wall.at(along, 0.0), max(up, 0.01)] for along, up in zip(s, z, strict=True)])
    return bool((vault.distance(points) < -MARGIN).all())

"""The faces of a body between two skins: roofs, the walls at which a skin steps, and the body's sides."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from families.declaration.plan_sides import Vector
from families.declaration.units import MM
from families.solid.bodies import Void
from families.solid.boundary import Loop, Pole, Step
from families.solid.envelope import SAME_HEIGHT, Line, Skin
from families.solid.face_net import ONE, Net, Patch, near
from families.solid.heights import between, change, shown
from families.solid.laid_curves import laid
from families.solid.plan_cells import Ground, Part, Way
from families.solid.plane_regions import regions
from families.solid.roofs import Plane, Roof
from families.solid.seamless import seamless
from families.solid.walls import Wall, Walls
from families.solid.way_stops import Piece, Shown, Sides, Stops, nearest_stop

Array = NDArray[np.float64]
BETWEEN = np.array([0.13, 0.31, 0.5, 0.69, 0.87])  # shares of an edge at which heights on both sides are compared
OUTSIDE = 1e-5  # [m] beyond a side, where it is looked what stands there
LOOKS = 24  # places along a side at which it is looked what stands beyond


@dataclass
class Faces:
    """What is to be added to a net; `beyond` is the void without its plan, where walls shall be told from sides."""

    net: Net
    ground: Ground
    top: Skin
    bottom: Skin
    beyond: Void | None = None
    walls: Walls = field(default_factory=Walls)
    _levels: dict[float, Plane] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Lay all steps."""
        self.outer = Skin(self.ground)
        self.stops = Stops(self.ground)
        self.stops.add(self._ends())
        self.above, self.below = self.stops.seen(self.top), self.stops.seen(self.bottom)
        crossings = self._crossings(self.top, self.above), self._crossings(self.bottom, self.below)
        forced = [*crossings[0], *crossings[1], *self._changes_beyond()]
        if forced:
            self.stops.add(forced)
            self.above, self.below = self.stops.seen(self.top), self.stops.seen(self.bottom)
        forced += self._line_ends()
        self.above, self.below = self.stops.join(
            (self.above, self.below),
            [roof.pole[0] for roof in (*self.top.roofs, *self.bottom.roofs) if roof.pole is not None],
            {(way, nearest_stop(self.stops.at[way], t)) for way, t in forced},
        )
        self.roofs: tuple[dict[int, Loop], dict[int, Loop]] = (defaultdict(list), defaultdict(list))
        for skin, seen, steps, upper in (
            (self.top, self.above, self.roofs[0], True),
            (self.bottom, self.below, self.roofs[1], False),
        ):
            self._lines(skin, steps)
            self._inner(skin, seen, steps, upper)
        self._outer()

    def close(self) -> None:
        """Add all faces."""
        patches = [
            *self._roof_patches(self.top, self.roofs[0], flipped=False),
            *self._roof_patches(self.bottom, self.roofs[1], flipped=True),
            *self._wall_patches(self.walls.loops),
        ]
        self._add(patches)

    def show(self) -> None:
        """Add the roofs of the top and the walls of the void, not the sides at which its plan ends."""
        walls = self._wall_patches([wall for wall in self.walls.loops if wall.shown])
        self._add([*self._roof_patches(self.top, self.roofs[0], flipped=False), *walls])

    def _add(self, patches: list[Patch]) -> None:
        for patch in seamless(patches, self.net):
            self.net.add(patch)

    # Where the pieces of ways begin and end.

    def _ends(self) -> Iterator[tuple[int, float]]:
        for skin in (self.top, self.bottom):
            for region in skin.regions:
                for part in region.loop:
                    if isinstance(part, Part):
                        yield from ((part.way, part.start), (part.way, part.end))

    def _line_ends(self) -> Iterator[tuple[int, float]]:
        """Where lines within cells reach their boundaries."""
        for skin in (self.top, self.bottom):
            for region in skin.regions:
                for before, after in pairwise([*region.loop, region.loop[0]]):
                    if isinstance(before, Part) and not isinstance(after, Part):
                        yield before.way, before.end
                    elif isinstance(after, Part) and not isinstance(before, Part):
                        yield after.way, after.start

    def _middle(self, piece: Piece) -> Vector:
        start, end = self.stops.span(piece)
        return self.ground.ways[piece[0]].at((start + end) / 2)

    def _apart_by(self, piece: Piece, upper: tuple[Skin, int], lower: tuple[Skin, int]) -> list[float]:
        """How much higher one roof is than another `BETWEEN` the ends of a piece."""
        way, (start, end) = self.ground.ways[piece[0]], self.stops.span(piece)
        (one, a), (other, b) = upper, lower
        return between(way.row, start, end, BETWEEN, one.table, a, other.table, b).tolist()  # type: ignore[no-any-return]

    def _crossings(self, skin: Skin, seen: Shown) -> Iterator[tuple[int, float]]:
        """Where the two sides of a wall are as high: where they cross, or touch as a pendentive does its octagon."""
        for piece, (left, right) in seen.items():
            if left == right or left < 0 or right < 0:
                continue
            miss = self._apart_by(piece, (skin, left), (skin, right))
            way, (start, end) = self.ground.ways[piece[0]], self.stops.span(piece)

            def off(t: float, way: Way = way, left: int = left, right: int = right) -> float:
                place = way.at(t)
                return skin.height(left, *place) - skin.height(right, *place)

            if max(map(abs, miss)) > SAME_HEIGHT:
                yield from ((piece[0], t) for t in (start, end) if abs(off(t)) < SAME_HEIGHT)
            if min(miss) > -SAME_HEIGHT or max(miss) < SAME_HEIGHT:
                continue
            at = start + BETWEEN * (end - start)
            for j, (here, there) in enumerate(pairwise(miss)):
                if here * there < 0:
                    yield piece[0], float(brentq(off, at[j], at[j + 1], xtol=1e-15))

    def _changes_beyond(self) -> Iterator[tuple[int, float]]:
        """Where what stands beyond a side of the plan changes."""
        if self.beyond is None:
            return
        there = {piece: self._outside(piece, sides) for piece, sides in self.above.items() if -1 in sides}
        for piece, (rows, owners) in there.items():
            before = there.get((piece[0], piece[1] - 1))
            if before is not None and not np.array_equal(before[0], rows):
                yield piece[0], self.stops.span(piece)[0]
            if len(rows) < 2:
                continue
            way, (start, end) = self.ground.ways[piece[0]], self.stops.span(piece)
            at = start + (end - start) * (np.arange(LOOKS) + 0.5) / LOOKS
            label, sure = shown(*way.places(at), self.outer.table, rows, owners)
            at, label = at[sure], label[sure]
            if len(at):
                yield from self._touches(piece, self.above[piece].inner, int(rows[label[0]]), int(rows[label[-1]]))
            for j in np.flatnonzero(np.diff(label)).tolist():
                yield piece[0], change(way.row, at[j], at[j + 1], self.outer.table, rows, owners)[0]

    def _touches(self, piece: Piece, roof: int, first: int, last: int) -> Iterator[tuple[int, float]]:
        """The ends of a side at which what stands beyond comes up to the roof, as an arch does under a ring."""
        middle = self._middle(piece)
        for t, label in zip(self.stops.span(piece), (first, last), strict=True):
            place = self.ground.ways[piece[0]].at(t)
            gap, off = (abs(self.top.height(roof, *at) - self.outer.height(label, *at)) for at in (place, middle))
            if gap < SAME_HEIGHT < off:
                yield piece[0], t

    def _outside(self, piece: Piece, sides: Sides) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The roofs of the void beyond a side, and the pieces to which they belong."""
        assert self.beyond is not None
        pieces = self.beyond.over(*self._beside(piece, sides))
        rows = [self.outer.number(roof) for roofs in pieces for roof in roofs]
        owners = [k for k, roofs in enumerate(pieces) for _ in roofs]
        return np.array(rows, np.int64), np.array(owners, np.int64)

    def _beside(self, piece: Piece, sides: Sides) -> Vector:
        """A place just beyond a side."""
        x, y = self._middle(piece)
        nx, ny = self.ground.ways[piece[0]].right(x, y)
        step = OUTSIDE if sides.left >= 0 else -OUTSIDE
        return x + step * nx, y + step * ny

    # Steps along the edges of roofs.

    def _lines(self, skin: Skin, steps: dict[int, Loop]) -> None:
        """Where roofs meet within cells."""
        known: dict[Line, Step] = {}
        for region in skin.regions:
            for along in region.loop:
                if not isinstance(along, Part):
                    line = along.line
                    step = known.setdefault(line, Step(line.spline, 0.0, line.spline.end))
                    steps[region.roof].append(step if along.forward else step.reversed)

    def _inner(self, skin: Skin, seen: Shown, steps: dict[int, Loop], upper: bool) -> None:
        """Where roofs meet, or step, along the ways."""
        for piece, (left, right) in seen.items():
            if left == right or left < 0 or right < 0:
                continue
            miss = self._apart_by(piece, (skin, left), (skin, right))
            if _none(miss):
                step = self._step(skin, (left, right), piece)
                steps[left].append(step)
                steps[right].append(step.reversed)
                continue
            here, there = self._step(skin, (left,), piece), self._step(skin, (right,), piece)
            steps[left].append(here)
            steps[right].append(there.reversed)
            higher = miss[2] > 0
            lower, top = (there, here) if higher else (here, there)
            roof = skin.roofs[left if higher else right]
            # Not of the extrados, which has none of the room's names, nor below stone that overhangs.
            own = (not upper or self.beyond is not None) and not isinstance(roof, Plane)
            level = roof.springing if own else None
            self._wall(piece, lower, top, left=higher == upper, shown=own, level=level)

    def _outer(self) -> None:
        """Along the edge of the plan, and where nothing stands beyond a wall."""
        for piece, sides in self.above.items():
            if -1 not in sides:
                continue
            roof, floor = sides.inner, self.below[piece].inner
            left = sides.left >= 0
            top = self._step(self.top, (roof,), piece)
            self.roofs[0][roof].append(top if left else top.reversed)
            level = _none(self._apart_by(piece, (self.top, roof), (self.bottom, floor)))
            foot = top if level else self._step(self.bottom, (floor,), piece)
            self.roofs[1][floor].append(foot if left else foot.reversed)
            if foot is top:
                continue
            for lower, upper, own in self._strips(piece, sides, foot, top):
                springing = self.top.roofs[roof].springing if own else None
                self._wall(piece, lower, upper, left=left, shown=own, level=springing)

    def _strips(self, piece: Piece, sides: Sides, foot: Step, top: Step) -> Iterator[tuple[Step, Step, bool]]:
        """A side parted by height: as high as the void goes on it is the plan's, above it is the void's own wall."""
        if self.beyond is None or self.beyond.goes_on(*self._beside(piece, sides)):
            yield foot, top, False
            return
        rows, owners = self._outside(piece, sides)
        if not len(rows):
            free = self.beyond.free
            if free is None or max(foot.places[0][2], foot.places[2][2]) > MM * free:
                yield foot, top, True
                return
            # Below it stands the wall of the plan.
            middle = self._step(self.outer, (self.outer.number(self._planes(free)),), piece)
            yield foot, middle, False
            yield middle, top, True
            return
        way, (start, end) = self.ground.ways[piece[0]], self.stops.span(piece)
        places = way.places(start + BETWEEN * (end - start))
        found, sure = shown(*places, self.outer.table, rows, owners)
        label = int(rows[found[sure.argmax()]])  # where they touch, it cannot be told
        over, floor = (self.outer, label), (self.bottom, self.below[piece].inner)
        if max(self._apart_by(piece, over, (self.top, sides.inner))) > -SAME_HEIGHT:
            yield foot, top, False
        elif min(self._apart_by(piece, over, floor)) < SAME_HEIGHT:
            yield foot, top, True
        else:
            middle = self._step(self.outer, (label,), piece)
            yield foot, middle, False
            yield middle, top, True

    def _step(self, skin: Skin, roofs: tuple[int, ...], piece: Piece) -> Step:
        """The step over a piece, forwards, on roofs that are as high there: exact on one of them, else laid through."""
        way, (start, end) = self.ground.ways[piece[0]], self.stops.span(piece)
        places = way.at(start), way.at(end)
        for roof in roofs:
            first, last = ((MM * x, MM * y, MM * skin.height(roof, x, y)) for x, y in places)
            if (step := skin.roofs[roof].exact(way, start, end, (first, last))) is not None:
                return step

        def points(share: Array) -> Array:
            a, b = way.places(start + (1 - np.cos(np.pi * share)) / 2 * (end - start))
            return np.stack([a, b, skin.heights(roofs[0], a, b)], axis=1)

        spline = laid(points, skin.table, roofs[0])
        if spline is None:
            x, y = way.at((start + end) / 2)
            raise ValueError(f"a surface has no edge at ({x:.3f}, {y:.3f}) m; change a parameter a little")
        return Step(spline, 0.0, spline.end)

    def _wall(self, piece: Piece, lower: Step, upper: Step, *, left: bool, shown: bool, level: float | None) -> None:
        """Upright between two steps over a piece, the body on its left or right; parted at a level [m]."""
        start, end = self.stops.span(piece)
        sheet, turned = self.walls.over(self.ground.ways[piece[0]], (start + end) / 2)
        wall = Wall(sheet, left == turned, shown)
        if level is not None and lower.places[1][2] < MM * level - ONE < MM * level + ONE < upper.places[1][2]:
            middle = self._step(self.outer, (self.outer.number(self._planes(level)),), piece)
            self.walls.bound(wall._replace(above=True), middle, upper, turned)
            upper = middle
        self.walls.bound(wall, lower, upper, turned)

    def _planes(self, z: float) -> Plane:
        """One plane a height."""
        return self._levels.setdefault(z, Plane(z))

    # Faces.

    def _roof_patches(self, skin: Skin, steps: dict[int, Loop], *, flipped: bool) -> Iterator[Patch]:
        for number, loop in steps.items():
            roof = skin.roofs[number]
            for loops in self._closed(_plan, loop):
                yield Patch(roof.sheet, [_with_pole(roof, one) for one in loops], flipped)

    def _wall_patches(self, walls: Iterable[Wall]) -> Iterator[Patch]:
        chosen = list(walls)
        loops = self.net.cut([self.walls.loops[wall] for wall in chosen])
        for wall, loop in zip(chosen, loops, strict=True):
            for found in self._closed(wall.sheet.parameters, loop):
                yield Patch(wall.sheet, found, wall.flipped)

    def _closed(self, parameters: Any, steps: Loop) -> list[list[Loop]]:
        """The regions that steps bound, less those that run back and forth."""
        ends = [self.net.ends(step) for step in steps]
        kept: list[tuple[Step, tuple[int, int]]] = []
        back: dict[tuple[int, int], list[int]] = defaultdict(list)
        dropped: set[int] = set()
        for k, (a, b) in enumerate(ends):
            if a == b:
                dropped.add(k)
                continue
            for j in back.get((b, a), ()):
                if j not in dropped and near(steps[j].places[1], steps[k].places[1]):
                    dropped |= {j, k}
                    break
            else:
                back[a, b].append(k)
        kept = [(step, end) for k, (step, end) in enumerate(zip(steps, ends, strict=True)) if k not in dropped]
        return regions(parameters, [step for step, _ in kept], [end for _, end in kept]) if kept else []


def _plan(points: Array) -> Array:
    return points[:, :2]


def _none(heights: list[float]) -> bool:
    return max(heights) < SAME_HEIGHT and min(heights) > -SAME_HEIGHT


def _with_pole(roof: Roof, loop: Loop) -> Loop:
    """A loop with the line of parameters that is one point, where it passes that."""
    if roof.pole is None:
        return loop
    (x, y), running = (MM * value for value in roof.pole[0]), roof.pole[1]
    found: Loop = []
    for k, step in enumerate(loop):
        found.append(step)
        apex = step.places[2]
        if abs(apex[0] - x) < ONE and abs(apex[1] - y) < ONE:
            ends = []
            for beside in (step, loop[(k + 1) % len(loop)]):
                at = roof.sheet.parameters(np.array([apex]))[0]
                at[running] = roof.sheet.parameters(beside.points(0.5))[0, running]
                ends.append((float(at[0]), float(at[1])))
            found.append(Pole(step.path, step.end, step.end, ends[0], ends[1]))
    return found

"""Loops without needless vertices: where two edges alone meet that run on along one line or circle, they become one."""

from __future__ import annotations

from collections import defaultdict
from math import floor

import numpy as np
from numpy.typing import NDArray

from families.solid.boundary import Loop, Pole, Step
from families.solid.curves import Conic, Simple, Straight
from families.solid.face_net import Net, Patch

Array = NDArray[np.float64]
SAME_CURVE = 1e-6  # [mm]
SAME_WAY = 1e-9  # of directions
WIDEST = 3.0  # [rad] that an arc may become
Edge = tuple[int, int, int, int, int]  # its vertices, and its middle [0.1 mm]


def seamless(patches: list[Patch], net: Net) -> list[Patch]:
    """The same patches with such vertices left out, in all of them alike."""
    leaving: dict[int, dict[Edge, Step]] = defaultdict(dict)
    for patch in patches:
        for loop in patch.loops:
            for step in loop:
                start, end = net.ends(step)
                edge = _edge(start, end, step)
                leaving[start].setdefault(edge, step)
                leaving[end].setdefault(edge, step.reversed)
    group: dict[Edge, Edge] = {}
    width: dict[Edge, float] = {}

    def root(edge: Edge) -> Edge:
        while group.get(edge, edge) != edge:
            edge = group[edge]
        return edge

    dropped: set[int] = set()
    for vertex, steps in leaving.items():
        if len(steps) != 2:
            continue
        (a, first), (b, last) = steps.items()
        if root(a) == root(b) or not _go_on(first, last):
            continue
        total = sum(width.get(root(edge), _width(step)) for edge, step in steps.items())
        if total < WIDEST:
            one, other = root(a), root(b)
            group[other] = one
            width[one] = total
            dropped.add(vertex)
    if not dropped:
        return patches
    return [
        Patch(patch.sheet, [_folded(loop, dropped, net) for loop in patch.loops], patch.flipped) for patch in patches
    ]


def _edge(start: int, end: int, step: Step) -> Edge:
    x, y, z = step.places[1]
    return min(start, end), max(start, end), floor(10 * x + 0.5), floor(10 * y + 0.5), floor(10 * z + 0.5)


def _go_on(first: Step, last: Step) -> bool:
    """Whether two steps that leave one vertex are the two ways along one line or circle."""
    a, b = first.path, last.path
    if isinstance(first, Pole) or isinstance(last, Pole):
        return False
    if isinstance(a, Straight) and isinstance(b, Straight):
        one, other = (np.sign(step.end - step.start) for step in (first, last))
        return bool(np.abs(one * np.array(a.direction) + other * np.array(b.direction)).max() < SAME_WAY)
    if isinstance(a, Conic) and isinstance(b, Conic):
        if a is not b:
            if max(abs(a.a - b.a), abs(a.b - b.b), *np.abs(np.subtract(a.centre, b.centre))) > SAME_CURVE:
                return False
            if max(*np.abs(np.subtract(a.x, b.x)), *np.abs(np.subtract(a.y, b.y))) > SAME_WAY:
                return False
        return (first.end - first.start) * (last.end - last.start) < 0
    return False


def _width(step: Step) -> float:
    return abs(step.end - step.start) if isinstance(step.path, Conic) else 0.0


def _folded(loop: Loop, dropped: set[int], net: Net) -> Loop:
    starts = [net.ends(step)[0] for step in loop]
    first = next((k for k, vertex in enumerate(starts) if vertex not in dropped), None)
    if first is None:
        return loop
    found: Loop = []
    for k in range(len(loop)):
        step = loop[(first + k) % len(loop)]
        if starts[(first + k) % len(loop)] in dropped and found:
            before = found[-1]
            path, end = before.path, step.end
            if path is not step.path:
                if isinstance(path, Conic) and isinstance(step.path, Conic):
                    end = before.end + (step.end - step.start)
                elif isinstance(path, Simple):  # of a step that is hardly longer than a vertex, whatever its path
                    end = path.parameter(step.places[2])
            found[-1] = Step(path, before.start, end)
        else:
            found.append(step)
    return found

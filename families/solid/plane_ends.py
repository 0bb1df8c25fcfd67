"""The plane faces in which a body ends: at the ground, at the sides of the plan, and on the lids of its pieces.

What is left open in a plane by the other faces, and the lines in which planes meet, are the edges there; a step to
either side of each tells on which of them the body shows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from families.solid.boundary import Loop, Step
from families.solid.curves import AXES, Straight
from families.solid.face_net import ONE, Net, Patch
from families.solid.plane_regions import regions
from families.solid.surfaces import Flat

Array = NDArray[np.float64]
# [mm], lengths of that step, tried in turn: no longer than a sliver is wide, and no shorter than it takes a skin that
# is upright at its foot to leave the wall by more than `OFF`, the step off the plane.
ASIDE, OFF = (0.03, 0.002, 0.5), 2e-10
AMID = 0.4141, 0.4142, 0.4143  # of an edge's length: in its middle another vault may begin


@dataclass(frozen=True)
class Box:
    """The walls [mm] between which a body stands, from the ground to `top`, and the levels of lids in it."""

    half: tuple[float, float]
    top: float
    lids: tuple[float, ...]

    @property
    def planes(self) -> list[Flat]:
        """Sides, ground and lids."""
        sides = [Flat(axis, sign * self.half[axis]) for axis in (0, 1) for sign in (-1, 1)]
        return [*sides, *(Flat(2, z) for z in (0.0, *self.lids))]

    def corners(self) -> Iterable[Array]:
        """Where three planes meet, and the upper ends of the sides."""
        for x, y in product((-1, 1), (-1, 1)):
            for z in (0.0, *self.lids, self.top):
                yield np.array([x * self.half[0], y * self.half[1], z])

    def lines(self) -> Iterable[Step]:
        """The lines in which two planes meet."""
        for x, y in product((-1, 1), (-1, 1)):
            yield Step(Straight(2, (x * self.half[0], y * self.half[1], 0.0)), 0.0, self.top)
        for z, axis, sign in product((0.0, *self.lids), (0, 1), (-1, 1)):
            side = sign * self.half[1 - axis]
            yield Step(
                Straight(axis, (0.0, side, z) if axis == 0 else (side, 0.0, z)), -self.half[axis], self.half[axis]
            )


@dataclass(frozen=True)
class _Border:
    """An edge in a plane, and whether a face lies there already, on its left and on its right."""

    plane: Flat
    step: Step
    covered: tuple[bool, bool]


def close(net: Net, box: Box, inside: Callable[[Array], NDArray[np.bool_]]) -> None:
    """Add the plane faces that are missing to the net of a body.

    Args:
        net: with all other faces.
        box: the planes.
        inside: whether points (n, 3) [mm] are in the body.

    Raises:
        ValueError: the edges in a plane do not close.
    """
    borders = _borders(net, box)
    for aside in ASIDE:
        try:
            patches = _patches(borders, aside, inside)
        except ValueError:
            if aside == ASIDE[-1]:
                raise
            continue
        break
    for patch in patches:
        net.add(patch)


def _borders(net: Net, box: Box) -> list[_Border]:
    """The edges with a face on one side only, and the lines in which planes meet where there is no edge yet."""
    open_ = [(k, edge.step) for k, edge in enumerate(net.edges) if edge.uses == 1]
    lines = net.cut([[line] for line in box.lines()])
    frame = [(-1, step) for line in lines for step in line if net.find(step) is None]
    steps = [*open_, *frame]
    if not steps:
        return []
    places = np.stack([step.places for _, step in steps])
    found = []
    for plane in box.planes:
        faces = set(net.covered.get(plane, []))
        for j in np.flatnonzero((np.abs(places[:, :, plane.axis] - plane.place) < ONE).all(axis=1)):
            k, step = steps[j]
            found.append(_Border(plane, step, ((k, True) in faces, (k, False) in faces)))
    return found


def _patches(borders: list[_Border], aside: float, inside: Callable[[Array], NDArray[np.bool_]]) -> list[Patch]:
    by_plane: dict[tuple[Flat, bool], Loop] = {}  # a body may lie above one part of a plane and below another
    for border, (left, right, up) in zip(borders, _shown(borders, aside, inside), strict=True):
        if left != right:
            by_plane.setdefault((border.plane, up), []).append(border.step if left else border.step.reversed)
    return [
        Patch(plane, loops, flipped=up) for (plane, up), steps in by_plane.items() for loops in regions(plane, steps)
    ]


def _shown(
    borders: list[_Border], aside: float, inside: Callable[[Array], NDArray[np.bool_]]
) -> list[tuple[bool, bool, bool]]:
    """For each edge whether a face is missing on its left, on its right, and whether the body is above that."""
    if not borders:
        return []
    before, middle, after = np.stack([border.step.points(*AMID) for border in borders], axis=1)
    axes = np.array([border.plane.axis for border in borders])
    rows = np.arange(len(borders))
    middle[rows, axes] = [border.plane.place for border in borders]
    normals = AXES[axes]
    left = np.cross(normals, after - before)
    reach = np.array([np.abs(border.step.places[2] - border.step.places[0]).max() for border in borders])
    left *= (np.minimum(aside, 0.1 * reach) / np.linalg.norm(left, axis=1))[:, None]
    spots = [middle + side * left + up * OFF * normals for side in (1, -1) for up in (1, -1)]
    left_up, left_down, right_up, right_down = inside(np.concatenate(spots)).reshape(4, -1)
    covered = np.array([border.covered for border in borders])
    lefts, rights = (left_up != left_down) & ~covered[:, 0], (right_up != right_down) & ~covered[:, 1]
    return list(zip(lefts.tolist(), rights.tolist(), np.where(lefts, left_up, right_up).tolist(), strict=True))

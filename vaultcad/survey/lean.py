"""Whether a scan stands upright: its walls and its floor tell, and a scan that leans is fitted as if it did not.

The vertical is the direction that the normals of walls are most nearly square to: the least eigenvector of the sum of
their outer products, reweighted so that haunches and furniture do not count (Huber 1981). A floor that is square to it
confirms it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import degrees, hypot

import numpy as np
from numpy.typing import NDArray

from segmentation.notes import Note
from vaultcad.pose import Pose, tilted
from vaultcad.survey.thinned_scan import Thin, floor_of

Array = NDArray[np.float64]

STEEP = 0.25  # |nz| of what may be a wall; a scan that leans by more than some degrees is to be stood up first
SCALES = (0.1, 0.05, 0.03)  # of n · up, beyond which a normal is rather a haunch's
FEWEST_ON_WALLS = 300  # points of walls that tell a vertical
CROSSING = 0.05  # share of the normals' spread along the second direction: walls in one direction leave one tilt open
PLUMB, WALLS = 0.05, 0.42  # of n · up, that a wall is within; share of what is steep that must be, as haunches are not
FLOOR = 0.02  # m; half a layer of points that are a floor
LEAST, ALONE = np.radians(0.2), np.radians(0.7)  # what is taken for upright, with and without a floor that says so too
LARGEST_LEAN = np.radians(8.0)  # more is no lean of a room
AGREE, SAME = np.radians(0.7), np.radians(0.3)  # between walls and floor; a floor may slope by itself
CHUNK = 1 << 20


@dataclass(frozen=True, eq=False)
class Lean:
    """A scan that leans: a rotation vector (2,) about its x and y axes [rad] that brings level points where they are.

    centre: (3,) the point that stays [m].
    """

    vector: tuple[float, float]
    centre: Array

    @property
    def angle(self) -> float:
        """How far from upright [rad]."""
        return hypot(*self.vector)

    @property
    def matrix(self) -> Array:
        """(3, 3): level points about the centre in the scan."""
        return tilted(self.vector)

    def levelled(self, points: NDArray[np.floating]) -> NDArray[np.floating]:
        """Points (n, 3) of the scan set upright, of the same type."""
        out = np.empty_like(points)
        for k in range(0, len(points), CHUNK):
            out[k : k + CHUNK] = (points[k : k + CHUNK] - self.centre) @ self.matrix + self.centre
        return out

    def thinned(self, thin: Thin) -> Thin:
        """The thinned points set upright."""
        points: Array = np.asarray(self.levelled(thin.points), np.float64)
        return replace(thin, points=points, normals=thin.normals @ self.matrix)

    def pose(self, pose: Pose) -> Pose:
        """Where a pose among the level points is in the scan."""
        x, y, z = self.matrix @ (np.array([pose.x, pose.y, pose.z]) - self.centre) + self.centre
        return Pose(float(x), float(y), float(z), pose.yaw, self.vector)


def lean_of(thin: Thin) -> tuple[Lean | None, tuple[Note, ...]]:
    """How a scan leans, None if it stands upright or cannot tell; and what is to be said of it.

    Walls decide whether it does, as floors may slope by themselves; where the floor agrees it says by how much, for it
    is planer. Without a floor, as in cropped scans, what walls there are tell less.
    """
    walls, floor = _by_walls(thin.normals), _by_floor(thin)
    lean, notes = _leaning(walls, floor, thin)
    if floor is None or (notes and lean is None):
        return lean, notes
    return lean, (*notes, *_sloping(floor if lean is None else floor @ lean.matrix))


def _leaning(walls: Array | None, floor: Array | None, thin: Thin) -> tuple[Lean | None, tuple[Note, ...]]:
    """The same from what walls and floor are square to (3,)."""
    if walls is None:
        if floor is None or _tilt(floor) < ALONE:
            return None, ()
        text = f"the floor slopes by {degrees(_tilt(floor)):.1f}°, and no walls tell the vertical: taken as it is"
        return None, (Note("tilt", text),)
    up, least = walls, ALONE
    if floor is not None:
        apart = float(np.arccos(np.clip(walls @ floor, -1, 1)))
        if apart > AGREE and _tilt(walls) > ALONE:
            text = (
                f"walls lean by {degrees(_tilt(walls)):.1f}°, the floor by {degrees(_tilt(floor)):.1f}° another way: "
                "taken as it is; level the scan if it leans"
            )
            return None, (Note("tilt", text),)
        up, least = (floor if apart < SAME else walls), LEAST
    if _tilt(walls) >= LARGEST_LEAN:
        text = f"walls lean by {degrees(_tilt(walls)):.0f}°, more than rooms do: taken as it is; level the scan"
        return None, (Note("tilt", text),)
    if _tilt(walls) <= least or _tilt(up) == 0:
        return None, ()
    angle, across = _tilt(up), np.array([-up[1], up[0]]) / hypot(up[0], up[1])
    text = f"the scan leans by {degrees(angle):.2f}°: it is fitted upright, and the vaults lean with it"
    if floor is None:
        text += "; no floor confirms it"
    return Lean((float(angle * across[0]), float(angle * across[1])), thin.points.mean(axis=0)), (Note("tilt", text),)


def _sloping(floor: Array) -> Iterator[Note]:
    """What is to be said of a floor that is not square to the vertical, by its normal (3,) in a level scan."""
    if _tilt(floor) > LEAST:
        down, fall = degrees(np.arctan2(floor[1], floor[0])) % 360, 1000 * np.tan(_tilt(floor))
        where = f"down at {down:.0f}° from x, counterclockwise"
        yield Note("floor", f"the floor slopes by {degrees(_tilt(floor)):.2f}°, {fall:.0f} mm in a metre, {where}")


def _tilt(up: Array) -> float:
    return float(np.arctan2(hypot(up[0], up[1]), up[2]))


def _by_walls(normals: Array) -> Array | None:
    """The direction (3,) that wall normals are square to; None if there are too few, or in one direction only.

    Haunches alone tell none: where there are more on one side, as over an apse, they would seem to lean.
    """
    up = np.array([0.0, 0.0, 1.0])
    steep = normals[np.abs(normals[:, 2]) < STEEP]
    if len(steep) < FEWEST_ON_WALLS:
        return None
    values = np.zeros(3)
    for scale in SCALES:
        for _ in range(4):
            weight = 1 / (1 + ((steep @ up) / scale) ** 2) ** 2
            values, vectors = np.linalg.eigh((steep.T * weight) @ steep)
            up = vectors[:, 0] * np.sign(vectors[2, 0] or 1.0)
    if (np.abs(steep @ up) < PLUMB).mean() < WALLS:
        return None
    return up if values[1] > CROSSING * values[2] else None


def _by_floor(thin: Thin) -> Array | None:
    """The normal (3,) of the floor, upwards; None if there is none."""
    points = thin.points[floor_of(thin.points, thin.normals)]
    if len(points) < FEWEST_ON_WALLS:
        return None
    weight = np.ones(len(points))
    up = np.array([0.0, 0.0, 1.0])
    for _ in range(8):
        centre = weight @ points / weight.sum()
        _, vectors = np.linalg.eigh(((points - centre).T * weight) @ (points - centre))
        up = vectors[:, 0] * np.sign(vectors[2, 0] or 1.0)
        weight = 1 / (1 + ((points - centre) @ up / FLOOR) ** 2) ** 2
    return np.asarray(up, np.float64)

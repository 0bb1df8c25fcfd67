"""Which figures are read from a moved vault, and where: crown, springings, walls, and the quarters of its sections."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import atan2, degrees

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.change.motion import Places
from vaultcad.deformation import Movement
from vaultcad.mechanisms import Body

Array = NDArray[np.float64]
Term = tuple[Array, Array]  # a place (3,) [m] and a way (3,), times its weight

QUARTERS = (0.25, 0.5, 0.75)
AXES = ("x", "y")
DOWN = np.array([0.0, 0.0, -1.0])
SPOTS: Array = np.linspace(-0.5, 0.5, 5)  # along a side, from its middle, as shares of its half
INWARDS = 0.999  # places on the plan's edge are taken so far from its middle
STEPS = 40  # of halving the height in which the intrados is
NEAR = 1.5  # m; a wall without stone so near has not been seen
DEEPEST = 1.5  # m below the springing over which the rotation of walls is taken, or as far as they are seen
SHALLOWEST = 0.3  # m of a wall that tell no rotation
SURE = 1.96  # standard deviations of the 95 % of a normal distribution
VERTICAL = 5e-5  # m/m, standard deviation of a scan's vertical: 10 arc seconds, as levelled scanners state it
WINDS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")


@dataclass(frozen=True)
class Reading:
    """A figure to be read: its terms add up to it.

    words: of a positive and a negative value; "{}" stands for the wind. facing: (3,) in the vault's frame: its azimuth
    is told; of a negative value that of the opposite where `turns`. over: what the terms are divided by, a length [m]
    for rotations.
    """

    name: str
    terms: tuple[Term, ...]
    words: tuple[str, str]
    facing: Array | None = None
    turns: bool = False
    over: float | None = None
    level: float = 0.0  # m, distance over which an error of the scan's vertical counts


@dataclass(frozen=True)
class Sights:
    """What was seen of walls: places (m, 3) [m] and normals (m, 3) of blocks of stone below the springing."""

    place: Array = field(default_factory=lambda: np.empty((0, 3)))
    normal: Array = field(default_factory=lambda: np.empty((0, 3)))

    def below(self, place: Array, normal: Array) -> float:
        """How far down a wall that faces away along `normal` is seen near a place [m]."""
        near = np.linalg.norm((self.place - place)[:, :2], axis=1) < NEAR
        mine = near & (self.normal @ normal > np.sqrt(0.5))
        return float(-self.place[mine, 2].min()) if mine.any() else 0.0


def readings(vault: Vault, body: Body, walls: Sights) -> list[Reading]:
    """All figures of a vault, in the order in which they are told."""
    crown = crown_of(vault)
    return [
        Reading("crown settlement", ((crown, DOWN),), ("down", "up")),
        *_spreads(vault, body, crown),
        *_supports(vault, body, crown),
        *_rotations(vault, walls),
        *_quarters(vault, crown),
    ]


def places(all_: list[Reading]) -> Places:
    """Where these figures are read."""
    rows = [(k, place, way) for k, one in enumerate(all_) for place, way in one.terms]
    return Places(
        np.array([k for k, _, _ in rows], np.int64),
        np.array([place for _, place, _ in rows]).reshape(-1, 3),
        np.array([way for _, _, way in rows]).reshape(-1, 3),
    )


def on_intrados(vault: Vault, xy: Array) -> tuple[Array, Array]:
    """Where the plumb line through points (n, 2) [m] meets the intrados, and the normals there, both (n, 3)."""
    low, high = np.full(len(xy), -0.01), np.full(len(xy), vault.top + 0.01)
    for _ in range(STEPS):
        middle = (low + high) / 2
        inside = vault.distance(np.column_stack([xy, middle])) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    found = np.column_stack([xy, np.maximum((low + high) / 2, 0.0)])
    return found, vault.evaluate(found).normal


def crown_of(vault: Vault) -> Array:
    """The place (3,) [m] of the crown: over the middle of the plan, or of a plan round a court the highest nearest."""
    low, high = vault.plan.box
    middle = (np.asarray(low) + np.asarray(high)) / 2
    if any(side.centre is not None and not side.inside for side in vault.plan.sides):
        steps = np.linspace(low + 0.01, high - 0.01, 41)
        grid = np.stack(np.meshgrid(*steps.T, indexing="ij"), axis=-1).reshape(-1, 2)
        grid = grid[vault.plan.holds(grid)]
        height = on_intrados(vault, grid)[0][:, 2]
        highest = grid[height > height.max() - 0.01]
        middle = highest[np.argmin(np.linalg.norm(highest - middle, axis=1))]
    out: Array = on_intrados(vault, middle[None])[0][0]
    return out


def movement_of(one: Reading, mean: float, std: float, yaw: float) -> Movement:
    """What is told of a figure with that mean and standard deviation [m], in a frame turned by `yaw` [rad]."""
    over = 1.0 if one.over is None else one.over
    value, limit = float(mean) / over, SURE * float(np.hypot(std, VERTICAL * one.level)) / over
    bearing = None if one.facing is None else azimuth(one.facing, yaw)
    if bearing is not None and one.turns and value < 0:
        bearing = (bearing + 180) % 360
    words = one.words[0 if value >= 0 else 1].format(wind(bearing) if bearing is not None else "")
    size = abs(value) if one.turns else value
    return Movement(one.name, size, limit, "m" if one.over is None else "m/m", words.strip(), bearing)


def azimuth(facing: Array, yaw: float) -> float | None:
    """Of a direction (3,) in a frame turned by `yaw` [rad]: degrees clockwise from +y; None where it is plumb."""
    if np.hypot(facing[0], facing[1]) < 0.05:
        return None
    return (90.0 - degrees(atan2(facing[1], facing[0]) + yaw)) % 360


def wind(bearing: float) -> str:
    """Of an azimuth [deg], by the eight winds."""
    return WINDS[round(bearing / 45) % 8]


def _spreads(vault: Vault, body: Body, crown: Array) -> Iterator[Reading]:
    for axis, name in enumerate(AXES):
        ends = _ends(vault, body, crown, axis)
        terms = tuple((place, way / len(side)) for side, way in ends for place in side)
        yield Reading(f"spread along {name}", terms, ("apart", "together"), ends[1][1])
    if len(vault.plan.sides) == 4:
        for name, k in (("SW-NE", 0), ("SE-NW", 1)):
            corners = np.column_stack([vault.corners[[k, k + 2]], np.zeros(2)])
            way = (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0])
            terms = ((corners[0], -way), (corners[1], way))
            yield Reading(f"spread of the diagonal {name}", terms, ("apart", "together"), way)


def _supports(vault: Vault, body: Body, crown: Array) -> Iterator[Reading]:
    for axis, name in enumerate(AXES):
        (south, _), (north, way) = _ends(vault, body, crown, axis)
        terms = tuple((at, sign * DOWN / len(side)) for side, sign in ((north, 1), (south, -1)) for at in side)
        far = float(np.linalg.norm(north[0] - south[0]))
        yield Reading(
            f"differential settlement along {name}", terms, ("lower at {}", "lower at {}"), way, turns=True, level=far
        )
    if len(vault.plan.sides) == 4:
        signs = (0.5, -0.5, 0.5, -0.5)
        terms = tuple((np.append(corner, 0.0), sign * DOWN) for corner, sign in zip(vault.corners, signs, strict=True))
        along = np.append(vault.corners[2] - vault.corners[0], 0.0)
        yield Reading("twist", terms, ("lower on the diagonal through {}", "higher on the diagonal through {}"), along)


def _rotations(vault: Vault, walls: Sights) -> Iterator[Reading]:
    for side in vault.plan.sides:
        middle = side.points(2)[1]
        if side.centre is None:
            normal = np.array([*side.normal, 0.0])
            along = np.array(side.start) + np.outer((1 + SPOTS) / 2, np.array(side.end) - side.start)
        else:
            out = (middle - side.centre) / side.radius
            normal = np.append(out if side.inside else -out, 0.0)
            along = middle[None]
        places = np.column_stack([along, np.zeros(len(along))])
        depth = min(walls.below(np.append(middle, 0.0), normal), DEEPEST)
        if depth > SHALLOWEST:
            part, foot = normal / len(places), np.array([0.0, 0.0, depth])
            terms = tuple(term for place in places for term in ((place, part), (place - foot, -part)))
            bearing = azimuth(normal, 0.0)
            where = "" if bearing is None else f" at {wind(bearing)} of the plan"
            yield Reading(
                f"rotation of the wall{where}",
                terms,
                ("outwards to {}", "inwards from {}"),
                normal,
                over=depth,
                level=depth,
            )


def _quarters(vault: Vault, crown: Array) -> Iterator[Reading]:
    low, high = (np.asarray(end) for end in vault.plan.box)
    for axis, name in enumerate(AXES):
        xy = np.repeat(crown[None, :2], len(QUARTERS), axis=0)
        xy[:, axis] = low[axis] + np.array(QUARTERS) * (high - low)[axis]
        if not vault.plan.holds(xy).all():
            continue
        found, normals = on_intrados(vault, xy)
        for share, place, normal in zip(QUARTERS, found, normals, strict=True):
            yield Reading(
                f"offset at {share:g} of the span along {name}", ((place, normal),), ("into the stone", "into the room")
            )
        way = np.eye(3)[axis]
        terms = ((found[2], normals[2]), (found[0], -normals[0]))
        words = ("farther into the stone at {}", "farther into the stone at {}")
        yield Reading(f"asymmetry along {name}", terms, words, way, turns=True)


def _ends(vault: Vault, body: Body, crown: Array, axis: int) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Places (k, 3) along the springings at both ends of an axis, each end with its way outwards (3,)."""
    found = []
    spots = SPOTS if len(vault.plan.sides) == 4 else np.zeros(1)
    for sign in (-1, 1):
        places = np.zeros((len(spots), 3))
        places[:, 1 - axis] = crown[1 - axis] + spots * body.half[1 - axis]
        places[:, axis] = sign * body.half[axis] * INWARDS
        found.append((places, sign * np.eye(3)[axis]))
    return found[0], found[1]

"""An ideal section line to measure along: even steps, with normals, parted where it has kinks."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from math import radians

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.plan import Plan
from families.void.columns import heights
from families.void.upright import Outline, Upright, outlines

Floats = NDArray[np.float64]

STEP = 0.01  # m, of the guide: half a cell of the profile
LINE_STEPS = 481  # of an outline
ON_VAULT = 0.002  # m off the vault's surface, beyond which a line is a wall's
KINK = radians(6)  # beyond which a line has a corner
SLIVER = 0.04  # m, of a stretch of a component that is a crease's own jitter
JUMP, JUMP_HALVINGS = 0.05, 20  # m, by which a line steps up at one place, which is found by so many halvings
TOUCH = 1e-6  # m
STEEPEST = 0.4  # least part of a normal within the plane; where it is less, the plane hardly cuts, and no line is sure


@dataclass(frozen=True, eq=False)
class Guide:
    """Samples of an ideal section line from left to right.

    at: (n, 2) [m]. tangent, normal: (n, 2), unit vectors within the plane, the normal into the stone. slant: (n,) part
    of the surface's normal within the plane. space_normal: (n, 3) of the surface. s: (n,) [m] along its piece. piece:
    (n,) number of the piece, which ends at kinks and walls. component: (n,).
    chord: where the room begins and ends in the plane [m].
    """

    at: Floats
    tangent: Floats
    normal: Floats
    slant: Floats
    space_normal: Floats
    s: Floats
    piece: NDArray[np.int64]
    component: NDArray[np.uint16]
    chord: tuple[float, float] = field(default=(0.0, 0.0), kw_only=True)

    def pieces(self) -> list[slice]:
        """The samples of each piece."""
        ends = np.flatnonzero(np.diff(self.piece, prepend=-1, append=-1))
        return [slice(a, b) for a, b in pairwise(ends.tolist())]


def guides(vault: Vault, plane: Upright) -> tuple[tuple[Outline, ...], tuple[Guide, ...]]:
    """The room's outlines in a plane, and a guide along what of each is the vault's."""
    lines = tuple(
        (_with_jumps(vault, plane, line), component) for line, component in outlines(vault, plane, LINE_STEPS)
    )
    return lines, tuple(guide for line, _ in lines if (guide := _guide(vault, plane, line)) is not None)


def _with_jumps(vault: Vault, plane: Upright, line: Floats) -> Floats:
    """A line (n, 2) whose steps up and down are moved to where the height jumps, as at the foot of a drum."""
    out, rise, run = line.copy(), np.abs(np.diff(line[:, 1])), np.diff(line[:, 0])
    at = np.flatnonzero((rise > JUMP) & (run > TOUCH))
    low, high = line[at].copy(), line[at + 1].copy()
    for _ in range(JUMP_HALVINGS if len(at) else 0):
        u = (low[:, 0] + high[:, 0]) / 2
        middle = np.column_stack([u, heights(vault, plane.places(u))])
        left = np.abs(middle[:, 1] - low[:, 1]) > np.abs(high[:, 1] - middle[:, 1])
        low[~left], high[left] = middle[~left], middle[left]
    jumps = (np.abs(high - low)[:, 1] > JUMP)[:, None]
    out[at], out[at + 1] = np.where(jumps, low, out[at]), np.where(jumps, high, out[at + 1])
    return out


def wall_guide(plan: Plan) -> tuple[tuple[Floats, ...], Guide]:
    """The plan's outlines, closed, and a guide along its sides, whose normals point out of it."""
    columns: list[tuple[Floats, Floats, Floats, Floats, Floats, Floats, NDArray[np.int64], NDArray[np.uint16]]] = []
    lines: list[Floats] = []
    for loop in plan.loops:
        rows = [resampled(side.points(1 if side.centre is None else 64), STEP) for side in loop]
        lines.append(np.concatenate([row[:-1] for row in rows] + [rows[0][:1]]))
        for at in rows:
            s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(at, axis=0), axis=1))])
            tangent = np.gradient(at, s, axis=0)
            tangent /= np.linalg.norm(tangent, axis=1)[:, None]
            normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])  # the plan lies on the left of its sides
            space = np.column_stack([normal, np.zeros(len(at))])
            number = np.full(len(at), len(columns), np.int64)
            columns.append((at, tangent, normal, np.ones(len(at)), space, s, number, np.zeros(len(at), np.uint16)))
    return tuple(lines), Guide(*(np.concatenate(column) for column in zip(*columns, strict=True)))


def resampled(line: Floats, step: float) -> Floats:
    """Points (m, 2) at about even steps [m] along a line (n, 2), its ends included."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    kept = np.concatenate([[True], np.diff(length) > 0])
    along = np.linspace(0, length[-1], max(2, round(length[-1] / step) + 1))
    return np.column_stack([np.interp(along, length[kept], line[kept, k]) for k in (0, 1)])


def _guide(vault: Vault, plane: Upright, line: Floats) -> Guide | None:
    parts: list[tuple[Floats, int]] = []
    for at, component in _stretches(vault, plane, line):
        if component and len(at) > 1:
            parts.append((_onto(vault, plane, at), component))
    if not parts:
        return None
    pieces = np.zeros(len(parts), np.int64)
    for k, ((a, _), (b, _)) in enumerate(pairwise(parts), 1):
        pieces[k] = pieces[k - 1] + (_apart(a[-1], b[0]) or _turn(a, b) > KINK)
    columns = [
        _samples(vault, plane, [p for p, n in zip(parts, pieces, strict=True) if n == k], k)
        for k in set(pieces.tolist())
    ]
    chord = float(line[0, 0]), float(line[-1, 0])
    return Guide(*(np.concatenate(column) for column in zip(*columns, strict=True)), chord=chord)


def _apart(a: Floats, b: Floats) -> bool:
    return bool(np.hypot(*(a - b)) > 3 * STEP)


def _turn(a: Floats, b: Floats) -> float:
    """Angle [rad] between the end of a line and the begin of the next."""
    one, other = a[-1] - a[-2], b[1] - b[0]
    return float(abs(np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other)))


def _stretches(vault: Vault, plane: Upright, line: Floats) -> list[tuple[Floats, int]]:
    """A line in steps, parted by component; 0 where it is a wall's."""
    at = resampled(line, STEP)
    surface = vault.evaluate(plane.placed(at), walls=True)
    cut = np.linalg.norm(_within(plane, surface.normal), axis=1) > STEEPEST
    component = np.where((np.abs(surface.distance) < ON_VAULT) & cut, surface.component, 0).astype(np.int64)
    found: list[tuple[Floats, int]] = []
    for a, b in pairwise(np.flatnonzero(np.diff(component, prepend=-1, append=-1)).tolist()):
        short = (b - a) * STEP < SLIVER and found
        if found and (found[-1][1] == component[a] or (short and found[-1][1] and component[a])):
            found[-1] = (np.concatenate([found[-1][0], at[a:b]]), found[-1][1])
        else:
            found.append((at[a:b], int(component[a])))
    return found


def _onto(vault: Vault, plane: Upright, at: Floats) -> Floats:
    """Points (n, 2) of chords, moved onto the surface; neighbours that now meet are one."""
    surface = vault.evaluate(plane.placed(at))
    within = _within(plane, surface.normal)
    size = np.maximum(np.linalg.norm(within, axis=1), STEEPEST)
    move = np.where(np.abs(surface.distance) < ON_VAULT, surface.distance / size**2, 0.0)
    return np.asarray(at - move[:, None] * within, np.float64)


def _within(plane: Upright, normal: Floats) -> Floats:
    """The parts (n, 2) of normals (n, 3) within a plane."""
    return np.column_stack([normal[:, :2] @ np.array(plane.direction), normal[:, 2]])


def _samples(
    vault: Vault, plane: Upright, parts: list[tuple[Floats, int]], piece: int
) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats, NDArray[np.int64], NDArray[np.uint16]]:
    at = np.concatenate([row for row, _ in parts])
    component = np.concatenate([np.full(len(row), k, np.uint16) for row, k in parts])
    apart = np.linalg.norm(np.diff(at, axis=0), axis=1)
    kept = np.concatenate([[True], apart > TOUCH])
    at, component = at[kept], component[kept]
    s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(at, axis=0), axis=1))])
    tangent = np.gradient(at, s, axis=0) if len(at) > 2 else np.repeat(np.diff(at, axis=0), len(at), axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1), TOUCH)[:, None]
    space = vault.evaluate(plane.placed(at)).normal
    within = _within(plane, space)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])  # the room lies on the right of a line from left to right
    normal *= np.where((normal * within).sum(axis=1) < 0, -1.0, 1.0)[:, None]
    slant = np.maximum((normal * within).sum(axis=1), STEEPEST)
    return at, tangent, normal, slant, space, s, np.full(len(at), piece, np.int64), component

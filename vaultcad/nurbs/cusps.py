"""Corners in which edges run out tangent to each other, as a groin and the wall arches do at the foot of a groin vault.

There edges are nearer to each other than a scan tells, so that each for itself they would cross. They keep the distance
that they have in the ideal: as far as that is less than `APART`, they are moved alike.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from vaultcad.nurbs.outline import Outline

Array = NDArray[np.float64]
TANGENT = np.cos(np.radians(12.0))  # of the angle of two edges at a corner
APART = 3e-3  # m
LOOKS = 200  # places at which the distance of edges is taken
FARTHEST = 0.6  # m, from the corner


def kept_apart(outline: Outline, nodes: Array) -> Array:
    """The nodes (n, 3) [m], where edges are tangent moved from those of the outline by what these are on average."""
    shift = nodes - outline.nodes
    found = nodes.copy()
    leaving: dict[int, list[list[int]]] = {}
    for edge in outline.edges:
        for row in (list(edge.nodes), list(edge.nodes[::-1])):
            leaving.setdefault(row[0], []).append(row)
    for rows in leaving.values():
        ways = [outline.nodes[row[1]] - outline.nodes[row[0]] for row in rows]
        units = [way / np.linalg.norm(way) for way in ways]
        beside = [k for k, unit in enumerate(units) if sum(float(unit @ other) > TANGENT for other in units) > 1]
        if len(beside) > 1:
            _move_alike(outline, shift, [rows[k] for k in beside], found)
    return found


def _move_alike(outline: Outline, shift: Array, rows: list[list[int]], found: Array) -> None:
    """Edges that leave one corner, by their nodes from there."""
    lengths = [_lengths(outline.nodes[row]) for row in rows]
    s = np.linspace(0, min(FARTHEST, *(length[-1] / 2 for length in lengths)), LOOKS)
    places = [_at(s, length, outline.nodes[row]) for length, row in zip(lengths, rows, strict=True)]
    apart = np.min([np.linalg.norm(a - b, axis=1) for a, b in combinations(places, 2)], axis=0)
    end = float(s[np.flatnonzero(apart < APART)[-1]])
    mean = np.mean([_at(s, length, shift[row]) for length, row in zip(lengths, rows, strict=True)], axis=0)
    for length, row in zip(lengths, rows, strict=True):
        own = np.clip(length / max(end, 1e-9) - 1, 0, 1)[:, None]
        moved = own * shift[row] + (1 - own) * _at(length, s, mean)
        inner = np.array(row)[1:-1]
        found[inner] = np.where(own[1:-1] < 1, outline.nodes[inner] + moved[1:-1], found[inner])


def _lengths(places: Array) -> Array:
    found: Array = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    return found


def _at(s: Array, length: Array, values: Array) -> Array:
    """Values (n, 3) at lengths (n,) between given ones."""
    return np.column_stack([np.interp(s, length, column) for column in values.T])

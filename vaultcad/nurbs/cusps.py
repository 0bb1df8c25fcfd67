"""Corners in which edges run out tangent to each other, as a groin and the wall arches do at the foot of a groin vault.

There edges are nearer to each other than a scan tells, so that each for itself they would cross. They keep the distance
that they have in the ideal: as far as that is less than `APART`, free edges go along with those between two surfaces,
whose place is known, and stay on their own surface; where there are none of one kind, all go along with all.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from vaultcad.nurbs.meeting import FreeSurface
from vaultcad.nurbs.outline import Edge, Outline

Array = NDArray[np.float64]
TANGENT = np.cos(np.radians(12.0))  # of the angle of two edges at a corner
APART = 3e-3  # m
LOOKS = 200  # places at which the distance of edges is taken
FARTHEST = 0.6  # m, from the corner


def kept_apart(outline: Outline, nodes: Array, surfaces: Sequence[FreeSurface]) -> Array:
    """The nodes (n, 3) [m], where edges are tangent moved from those of the outline alike."""
    found = nodes.copy()
    leaving: dict[int, list[tuple[Edge, list[int]]]] = {}
    for edge in outline.edges:
        for row in (list(edge.nodes), list(edge.nodes[::-1])):
            leaving.setdefault(row[0], []).append((edge, row))
    for rows in leaving.values():
        ways = np.array([outline.nodes[row[1]] - outline.nodes[row[0]] for _, row in rows])
        ways /= np.linalg.norm(ways, axis=1, keepdims=True)
        beside = np.flatnonzero((ways @ ways.T > TANGENT).sum(axis=1) > 1)
        if len(beside) > 1:
            _move_alike(outline, nodes - outline.nodes, [rows[k] for k in beside], surfaces, found)
    return found


def _move_alike(
    outline: Outline,
    shift: Array,
    leaving: list[tuple[Edge, list[int]]],
    surfaces: Sequence[FreeSurface],
    found: Array,
) -> None:
    """Edges that leave one corner, with their nodes from there."""
    rows = [row for _, row in leaving]
    lengths = [_lengths(outline.nodes[row]) for row in rows]
    s = np.linspace(0, min(FARTHEST, *(length[-1] / 2 for length in lengths)), LOOKS)
    places = [_at(s, length, outline.nodes[row]) for length, row in zip(lengths, rows, strict=True)]
    apart = np.min([np.linalg.norm(a - b, axis=1) for a, b in combinations(places, 2)], axis=0)
    end = float(s[np.flatnonzero(apart < APART)[-1]])
    between = [len(edge.sides) == 2 for edge, _ in leaving]
    leading = [True] * len(rows) if all(between) or not any(between) else between
    mean = np.mean([_at(s, lengths[k], shift[rows[k]]) for k, leads in enumerate(leading) if leads], axis=0)
    for (edge, row), length, leads in zip(leaving, lengths, leading, strict=True):
        if leads and not all(leading):
            continue
        own = np.clip(length / max(end, 1e-9) - 1, 0, 1)[1:-1]
        inner = np.array(row)[1:-1][own < 1]
        share = own[own < 1][:, None]
        along = length[1:-1][own < 1]
        place = outline.nodes[inner] + share * shift[inner] + (1 - share) * _at(along, s, mean)
        if len(edge.sides) == 1:
            surface = surfaces[outline.faces[edge.sides[0][0]].field]
            for _ in range(3):
                off, normal = surface.off(place)
                place -= off[:, None] * normal
        found[inner] = place


def _lengths(places: Array) -> Array:
    found: Array = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    return found


def _at(s: Array, length: Array, values: Array) -> Array:
    """Values (n, 3) at lengths (n,) between given ones."""
    return np.column_stack([np.interp(s, length, column) for column in values.T])

"""Corners in which edges run out tangent to each other, as a groin and the wall arches do at the foot of a groin vault.

There edges of a face are nearer to each other than a scan tells, so that each for itself they would cross. Nodes of
free edges there go along with the nodes about them, those of edges between surfaces before all, as these alone have a
place that is known; then they are moved square onto their own surface.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.nurbs.meeting import FreeSurface
from vaultcad.nurbs.outline import Outline

Array = NDArray[np.float64]
APART = 2e-3  # m, up to which edges are not told apart
SAFE = 3.0  # times by how much a node's own way differs from the common one that it is apart where it is let go
ABOUT = 0.1  # m, standard deviation of the weights by which shifts are averaged
BETWEEN = 8  # places between nodes by which edges' distances are taken
ALIKE = 0.25  # m, likewise where all go along
FOLLOWING = 1e-3  # weight of nodes of free edges against those of edges between surfaces
ROUNDS = 3


def kept_apart(outline: Outline, nodes: Array, surfaces: tuple[FreeSurface, ...]) -> Array:
    """The nodes (n, 3) [m], moved from those of the outline alike where edges are all but tangent."""
    ideal, shift = outline.nodes, nodes - outline.nodes
    free, leading = np.zeros(len(nodes), bool), np.full(len(nodes), FOLLOWING)
    for edge in outline.edges:
        free[list(edge.nodes)[1:-1]] = len(edge.sides) == 1
    for edge in outline.edges:
        if len(edge.sides) == 2:
            leading[list(edge.nodes)] = 1.0
    square = ((ideal[:, None, :] - ideal[None, :, :]) ** 2).sum(axis=2)
    weight = np.exp(-square / (2 * ABOUT**2)) * leading
    common = weight @ shift / weight.sum(axis=1, keepdims=True)
    near = APART + SAFE * np.linalg.norm(shift - common, axis=1)
    own = np.where(free, np.clip(_apart(outline) / near - 1, 0, 1), 1.0)[:, None]
    found = ideal + own * shift + (1 - own) * common
    moved = own[:, 0] < 1
    for _ in range(ROUNDS):
        for surface, of in zip(surfaces, outline.of_region, strict=True):
            mine = of[moved[of]]
            off, normal = surface.off(found[mine])
            found[mine] -= off[:, None] * normal
    return np.asarray(found)


def alike(outline: Outline, nodes: Array) -> Array:
    """The nodes (n, 3) [m], all moved from those of the outline by what those about them are moved on average.

    This changes so slowly from place to place that no edges cross which do not in the ideal.
    """
    square = ((outline.nodes[:, None, :] - outline.nodes[None, :, :]) ** 2).sum(axis=2)
    weight = np.exp(-square / (2 * ALIKE**2))
    found: Array = outline.nodes + weight @ (nodes - outline.nodes) / weight.sum(axis=1, keepdims=True)
    return found


def _apart(outline: Outline) -> Array:
    """Of each node (n,) how far it is from the nearest other edge of its faces in the ideal [m]; 0 for corners."""
    from scipy.spatial import cKDTree

    found = np.full(len(outline.nodes), np.inf)
    found[: outline.corners] = 0.0
    fine = []
    for edge in outline.edges:
        row = outline.nodes[list(edge.nodes)]
        at = np.arange(BETWEEN * (len(row) - 1) + 1) / BETWEEN
        fine.append(np.column_stack([np.interp(at, np.arange(len(row)), column) for column in row.T]))
    for face in outline.faces:
        around = [k for loop in face.loops for k, _ in loop]
        for k in around:
            others = [fine[other] for other in around if other != k]
            inner = np.array(outline.edges[k].nodes)[1:-1]
            if others:
                reach, _ = cKDTree(np.concatenate(others)).query(outline.nodes[inner])
                found[inner] = np.minimum(found[inner], reach)
    return found

"""What the free route takes from a family: which faces its intrados has, where they meet and end, and their charts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vaultcad.nurbs.charts import Chart

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Edge:
    """An edge by its nodes, in order, and the faces on it: their indices, and whether their loops run the same way."""

    nodes: tuple[int, ...]
    sides: tuple[tuple[int, bool], ...]


@dataclass(frozen=True)
class Face:
    """A face by the index of its field, and its loops, the outer one first: edges, and whether they run forward."""

    field: int
    loops: tuple[tuple[tuple[int, bool], ...], ...]


@dataclass(frozen=True, eq=False)
class Region:
    """A part of a component that is one smooth surface. component: its id."""

    component: int
    name: str
    chart: Chart


@dataclass(frozen=True, eq=False)
class Outline:
    """The net of an intrados in the vault's frame.

    nodes: (n, 3) [m], those of edges' ends first, so many as `corners`; tangents: (n, 3) along the edge, 0 for corners.
    """

    regions: tuple[Region, ...]
    faces: tuple[Face, ...]
    edges: tuple[Edge, ...]
    nodes: Array
    tangents: Array
    corners: int

    @cached_property
    def of_region(self) -> list[NDArray[np.int64]]:
        """The nodes on each region's edges."""
        found: list[set[int]] = [set() for _ in self.regions]
        for edge in self.edges:
            for face, _ in edge.sides:
                found[self.faces[face].field].update(edge.nodes)
        return [np.array(sorted(nodes), np.int64) for nodes in found]

    def rings(self, region: int, places: Array) -> list[Array]:
        """The loops of a region's faces as rows of places (n, 3), closed without repeating the first."""
        return [
            places[row]
            for face in self.faces
            if face.field == region
            for row in (self.row(loop) for loop in face.loops)
        ]

    def row(self, loop: tuple[tuple[int, bool], ...]) -> list[int]:
        """The nodes of a loop."""
        found: list[int] = []
        for edge, forward in loop:
            nodes = self.edges[edge].nodes
            found += nodes[:-1] if forward else nodes[:0:-1]
        return found

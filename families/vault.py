"""The base of all families: parameters, components, and the numeric surface they share."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from families.parameters import Parametric
from families.parts import Piece, Plan

if TYPE_CHECKING:
    import build123d

    from families.sampling import Sample

IDENTITY = np.eye(3, 4)


@dataclass(frozen=True)
class Surface:
    """Where points stand against a vault: signed distance (n,) [m], component (n,), unit normal (n, 3) into the stone.

    Distances are positive in the stone and negative in the room. Component 0 is wall, else 1 + index in `components`.
    """

    distance: NDArray[np.float64]
    component: NDArray[np.uint16]
    normal: NDArray[np.float64]


@dataclass(frozen=True)
class Vault(Parametric):
    """A vault in its frame: origin at the centre of the plan on the springing, x and y along its sides, z up [m]."""

    id: ClassVar[str]
    title: ClassVar[str]
    aliases: ClassVar[dict[str, tuple[str, ...]]]  # language code -> names

    @property
    @abstractmethod
    def components(self) -> tuple[str, ...]:
        """Names of the components; the id of one is 1 + its index."""

    @property
    @abstractmethod
    def plan(self) -> Plan:
        """Half extents of the plan."""

    @abstractmethod
    def pieces(self) -> tuple[Piece, ...]:
        """The void, from which the numeric surface and the solid are both made."""

    def evaluate(
        self, xyz: NDArray[np.floating], *, frame: NDArray[np.float64] = IDENTITY, walls: bool = False
    ) -> Surface:
        """Signed distance, component and normal of points (n, 3) [m].

        Args:
            xyz: the points.
            frame: (3, 4) rigid motion that brings the points into the vault's frame.
            walls: the vault on its walls: points nearer to a wall, or below the springing, have component 0.
        """
        from families import kernel

        points = _points(xyz)
        table = kernel.pack(self.pieces(), self.components)
        if walls:
            return Surface(*kernel.surface(points, frame, table, kernel.pack_plan(self.plan)))
        return Surface(*kernel.surface(points, frame, table, kernel.pack_plan(None)))

    def distance(
        self, xyz: NDArray[np.floating], *, frame: NDArray[np.float64] = IDENTITY, walls: bool = False
    ) -> NDArray[np.float64]:
        """Signed distances (n,) [m] of points (n, 3), positive in the stone."""
        from families import kernel

        table = kernel.pack(self.pieces(), self.components)
        return kernel.distances(_points(xyz), frame, table, kernel.pack_plan(self.plan if walls else None))  # type: ignore[no-any-return]  # numba is untyped

    def intrados(self) -> build123d.Compound:
        """The intrados [mm]: one labelled, coloured face or shell a component."""
        from families import brep

        return brep.intrados(self)

    def solid(self, thickness: float = 0.15) -> build123d.Part:
        """The masonry [mm] between the intrados and an extrados with all radii larger by `thickness` [m]."""
        from families import brep

        return brep.solid(self, thickness)

    def sample(self, count: int, rng: np.random.Generator) -> Sample:
        """`count` points spread evenly over the intrados, with normals and components."""
        from families import sampling

        return sampling.sample(self, count, rng)


def _points(xyz: NDArray[np.floating]) -> NDArray[np.float64]:
    points = np.ascontiguousarray(xyz, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise ValueError(f"points of shape {points.shape} given; (n, 3) is needed")
    return points

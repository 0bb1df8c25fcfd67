"""The one value that reading a scan gives: points local to an origin, Z up, with what the scanner knew of each."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from segmentation.crs import Crs
from segmentation.notes import Note

Up = Literal["z", "y", "x", "-z", "-y", "-x"]
Floats = NDArray[np.floating[Any]]
F = TypeVar("F", bound=np.floating[Any])


ATTRIBUTES = ("xyz", "normals", "color", "intensity", "classification")
"""The fields of a Cloud that have a row for each point; all but the first may be None."""


def _no_stations() -> NDArray[np.float64]:
    return np.zeros((0, 3))


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points of a scan in metres, Z up, relative to `origin`.

    xyz: (n, 3) float32, or float64 where float32 would round by more than 0.1 mm; all finite.
    origin: (3,) float64, in the Z-up frame: `xyz + origin` are the file's coordinates turned Z-up.
    normals: (n, 3) float32 unit vectors as the file has them, or None.
    color: (n, 3) uint16 red, green, blue over the full range 0..65535, or None.
    intensity: (n,) uint16, or None.
    classification: (n,) uint8 by the LAS standard, or None.
    stations: (k, 3) float64 scanner positions, local like xyz; empty where the file tells none.
    source: the file, or None.
    up: the axis that was up in the file; another than "z" means that the points were turned when read.
    dropped: how many points of the file are no points: NaN, infinite, or a beam that nothing sent back.
    kept: (points in the file,) bool, True for those in xyz and in the same order; None where all are.
    aside: the points of the file that are left out of all work, being marked or far from all others, with the same
    origin; its own `kept` tells their places in the file. None where there are none.
    scale: (3,) metres in a unit of the file, by the file's axes.
    crs: the coordinate system that the file declares, or None.
    notes: what was assumed, left out or changed when the file was read.
    """

    xyz: Floats
    origin: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    normals: NDArray[np.float32] | None = None
    color: NDArray[np.uint16] | None = None
    intensity: NDArray[np.uint16] | None = None
    classification: NDArray[np.uint8] | None = None
    stations: NDArray[np.float64] = field(default_factory=_no_stations)
    source: Path | None = None
    up: Up = "z"
    dropped: int = 0
    kept: NDArray[np.bool_] | None = None
    aside: "Cloud | None" = None
    scale: NDArray[np.float64] = field(default_factory=lambda: np.ones(3))
    crs: Crs | None = None
    notes: tuple[Note, ...] = ()

    def __len__(self) -> int:
        return len(self.xyz)

    def in_file(self, xyz: Floats) -> NDArray[np.float64]:
        """Local points (m, 3) in the coordinates, the axes and the unit of the file, float64."""
        found = turn_back(np.asarray(xyz, np.float64) + self.origin, self.up)
        return found if (self.scale == 1).all() else found / self.scale

    def whole(self) -> "Cloud":
        """The cloud with the points set aside back in their places: all points of the file, but for those dropped."""
        if self.aside is None or self.aside.kept is None or self.kept is None:
            return self
        order = np.argsort(np.concatenate([np.flatnonzero(self.kept), np.flatnonzero(self.aside.kept)]), kind="stable")

        def merged(name: str) -> Any:
            mine, theirs = getattr(self, name), getattr(self.aside, name)
            return None if mine is None else np.concatenate([mine, theirs])[order]

        return replace(
            self,
            **{name: merged(name) for name in ATTRIBUTES},
            kept=self.kept | self.aside.kept if self.dropped else None,
            aside=None,
        )

    def spread(self, values: NDArray[Any], rest: Any = 0) -> NDArray[Any]:
        """Values (n,) of the points as values of all points of `whole()`, `rest` for those set aside."""
        if self.aside is None or self.aside.kept is None or self.kept is None:
            return values
        there = self.kept | self.aside.kept
        full = np.full(len(self) + len(self.aside), rest, values.dtype)
        full[self.kept[there]] = values
        return full


AXES: dict[Up, tuple[tuple[int, int, int], tuple[int, int, int]]] = {
    "z": ((0, 1, 2), (1, 1, 1)),
    "y": ((0, 2, 1), (1, -1, 1)),
    "x": ((1, 2, 0), (1, 1, 1)),
    "-z": ((0, 1, 2), (1, -1, -1)),
    "-y": ((0, 2, 1), (1, 1, -1)),
    "-x": ((2, 1, 0), (1, 1, -1)),
}
"""By the axis that is up in a file: its axes that become x, y and z, and their signs; all of them turns."""


def turn(xyz: NDArray[F], up: Up) -> NDArray[F]:
    """Points or directions (n, 3) of a file with that axis up, turned Z-up: (x, y, z) -> (x, -z, y) for "y"."""
    axes, signs = AXES[up]
    return xyz if up == "z" else xyz[:, axes] * np.array(signs, xyz.dtype)


def turn_back(xyz: NDArray[F], up: Up) -> NDArray[F]:
    """The inverse of `turn`: (x, y, z) -> (x, z, -y) for "y"."""
    axes, signs = AXES[up]
    return xyz if up == "z" else (xyz * np.array(signs, xyz.dtype))[:, np.argsort(axes)]


def stood_up(cloud: Cloud, up: Up) -> Cloud:
    """A cloud that was read with its Z up, with another axis of the file up.

    Raises ValueError if another axis than Z was up when it was read.
    """
    if cloud.up != "z":
        raise ValueError(f"up = {cloud.up!r}: the cloud was turned when it was read; read it with up = 'z'")
    return replace(
        cloud,
        xyz=turn(cloud.xyz, up),
        origin=turn(cloud.origin[None], up)[0],
        normals=None if cloud.normals is None else turn(cloud.normals, up),
        stations=turn(cloud.stations, up),
        up=up,
        aside=None if cloud.aside is None else stood_up(cloud.aside, up),
    )

"""The parameters of RANSAC shape detection, by the names of Schnabel, Wahl and Klein 2007."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Annotated, Self, get_args, get_type_hints

import numpy as np
from numpy.typing import NDArray

NAMES = ("plane", "sphere", "cylinder", "cone", "torus")  # the index is the kind of `primitives_numeric`
BOWS = (1, 2)  # kinds that a wall follows as it bellies, both ways or one way
FLAT = 0.16  # [rad] that a wall's normals may turn: a sagitta of 1/50 of its length. The flattest vaults turn by 0.3
STRAIGHT = 1e4  # radii of bows: beyond, nothing curves, and distances are lost to rounding


@dataclass(frozen=True)
class Limits:
    """Closed interval of a parameter with its unit ("m", "rad", "1") and meaning."""

    low: float
    high: float
    unit: str
    meaning: str


@dataclass(frozen=True)
class Settings:
    """What to look for. None leaves a parameter to the cloud: its size, its spacing, its noise.

    Raises ValueError, naming field, value and limits, where a value lies outside its range.
    """

    min_support: Annotated[
        float, Limits(0.0, math.inf, "1", "points a component needs; below 1 their share of the cloud")
    ] = 0.002
    epsilon: Annotated[float | None, Limits(1e-6, 10.0, "m", "largest distance of a point from its primitive")] = None
    alpha: Annotated[
        float, Limits(0.01, math.pi / 2, "rad", "largest angle between the normals of a point and its primitive")
    ] = math.radians(25.0)
    beta: Annotated[
        float | None, Limits(1e-4, 100.0, "m", "sampling resolution: points nearer than this are connected")
    ] = None
    overlooking_probability: Annotated[
        float, Limits(1e-9, 0.5, "1", "chance that a primitive of minimum support is missed")
    ] = 0.01
    sphere_r_min: Annotated[float, Limits(0.0, math.inf, "m", "smallest radius of a sphere")] = 0.0
    sphere_r_max: Annotated[float, Limits(0.0, math.inf, "m", "largest radius of a sphere")] = math.inf
    cylinder_r_min: Annotated[float, Limits(0.0, math.inf, "m", "smallest radius of a cylinder")] = 0.0
    cylinder_r_max: Annotated[float, Limits(0.0, math.inf, "m", "largest radius of a cylinder")] = math.inf
    r_tolerance: Annotated[
        float, Limits(0.0, 1.0, "m", "by how much a radius may pass its limits, which are given rounded")
    ] = 0.005
    primitives: Annotated[tuple[str, ...], "kinds to look for"] = ("plane", "sphere", "cylinder")

    def __post_init__(self) -> None:
        """Refuse what lies outside the declared ranges."""
        for name, limits in RANGES.items():
            value = getattr(self, name)
            if value is not None and not limits.low <= value <= limits.high:
                raise ValueError(f"{name} = {value:g} lies outside [{limits.low:g}, {limits.high:g}] {limits.unit}")
        for kind in ("sphere", "cylinder"):
            low, high = getattr(self, f"{kind}_r_min"), getattr(self, f"{kind}_r_max")
            if low > high:
                raise ValueError(f"{kind}_r_min = {low:g} m exceeds {kind}_r_max = {high:g} m: exchange them")
        unknown = sorted(set(self.primitives) - set(NAMES))
        if unknown or not self.primitives:
            raise ValueError(f"primitives = {self.primitives}: name at least one of {', '.join(NAMES)}")

    @property
    def kinds(self) -> tuple[int, ...]:
        """The kinds of `primitives_numeric` that are on, ascending."""
        return tuple(kind for kind, name in enumerate(NAMES) if name in self.primitives)

    def size_limits(self, kind: int) -> tuple[float, float]:
        """Bounds of the first size of a kind with their tolerance: radius [m], for a cone the half angle [rad]."""
        name = NAMES[kind]
        if name in ("sphere", "cylinder"):
            low, high = getattr(self, f"{name}_r_min"), getattr(self, f"{name}_r_max")
            return max(low - self.r_tolerance, 0.0), high + self.r_tolerance
        return CONE_ANGLES if name == "cone" else (0.0, math.inf)

    def min_points(self, points: int) -> int:
        """Minimum support in points, of a cloud of so many points."""
        return max(1, math.ceil(self.min_support * points if self.min_support < 1.0 else self.min_support))


@dataclass(frozen=True)
class Search(Settings):
    """What is looked for so that what the settings want is found: planes always, and walls that belly.

    Such a wall is no plane within epsilon, but a sphere or cylinder of `bow_r` [m] at least, on which nothing in the
    cloud turns by more than `FLAT`. It is that whatever the limits of radii, and even where spheres and cylinders are
    off.
    """

    bow_r: float = math.inf

    @classmethod
    def of(cls, wanted: Settings, extent: float) -> Self:
        """The search for those settings in a cloud of that extent [m]."""
        given = {field.name: getattr(wanted, field.name) for field in fields(wanted)}
        kinds = tuple({"plane": None, **dict.fromkeys(wanted.primitives)})
        return cls(**{**given, "primitives": kinds, "bow_r": extent / FLAT})

    @property
    def drawn(self) -> tuple[int, ...]:
        """The kinds that minimal sets are drawn of, ascending: those that are on, and those of walls that belly."""
        return tuple(sorted({*self.kinds, *BOWS}))

    def bounds(self, kind: int, sizes: NDArray[np.float64]) -> NDArray[np.float64]:
        """The interval (k, 2) that the first size (k,) of each primitive of a kind is to stay in: the nearest of
        them.
        """
        low, high = self.size_limits(kind)
        bows = [(self.bow_r, math.inf)]
        if kind not in BOWS:
            intervals = [(low, high)]
        elif kind not in self.kinds:
            intervals = bows
        else:
            intervals = [(low, high), *bows] if high < self.bow_r else [(min(low, self.bow_r), math.inf)]
        between = [(lower[1] + upper[0]) / 2.0 for lower, upper in pairwise(intervals)]
        ends: NDArray[np.float64] = np.minimum(np.array(intervals), STRAIGHT * self.bow_r)
        return ends[np.searchsorted(between, sizes)]


CONE_ANGLES = (math.radians(2.0), math.radians(88.0))  # a narrower cone is a cylinder, a wider one a plane


def _ranges() -> dict[str, Limits]:
    hints = get_type_hints(Settings, include_extras=True)
    found = {
        field.name: [arg for arg in get_args(hints[field.name]) if isinstance(arg, Limits)]
        for field in fields(Settings)
    }
    return {name: ranges[0] for name, ranges in found.items() if ranges}


RANGES = _ranges()

"""Ways along paths, of which the boundaries of faces are made."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from families.solid.curves import Path, Point

Array = NDArray[np.float64]


@dataclass(eq=False)
class Step:
    """A way along a path from one parameter to another, as a part of a face's boundary.

    A net keeps the numbers of its vertices, once they were asked for, in `ends`.
    """

    path: Path
    start: float
    end: float
    ends: tuple[int, int] | None = field(default=None, init=False, repr=False)

    @property
    def reversed(self) -> Step:
        """The way back."""
        back = Step(self.path, self.end, self.start)
        vars(back)["places"] = self.places[::-1]  # it need not be asked again
        if self.ends is not None:
            back.ends = self.ends[::-1]
        return back

    @cached_property
    def places(self) -> tuple[Point, Point, Point]:
        """Start, middle and end [mm]."""
        return self.path.at(self.start), self.path.at((self.start + self.end) / 2), self.path.at(self.end)

    def points(self, *shares: float) -> Array:
        """Points (n, 3) [mm] at shares of the way."""
        return self.path.points(self.start + np.array(shares) * (self.end - self.start))


@dataclass(eq=False)
class Pole(Step):
    """A boundary that is one point of space, and a line of the surface's parameters from `first` to `last`."""

    first: tuple[float, float]
    last: tuple[float, float]


Loop = list[Step]

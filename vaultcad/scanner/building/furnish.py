"""What stands and hangs in a building and hides some of it: pews on its floors, tie rods in its arches."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from vaultcad.scanner.building.build import Built
from vaultcad.scanner.building.elements import Building
from vaultcad.scanner.triangles import Triangles, prism, tube

Array = NDArray[np.float64]

WOOD, IRON = 0.2, 0.15  # reflectance
CLEAR = 0.8  # m, of pews to a scanner
WITHIN = 0.7  # of a plan's half extents, in which pews stand


def furnish(building: Building, built: Built, stations: Array, rng: np.random.Generator) -> list[Triangles]:
    """All that is asked for; it keeps clear of the stations (k, 3)."""
    rods = list(_rods(built, rng)) if building.rods else []
    return [*rods, *_pews(building, stations, rng)]


def _rods(built: Built, rng: np.random.Generator) -> Iterator[Triangles]:
    """An iron bar a hand above the springing of each arch that is open."""
    for arch in built.arches:
        half, up, radius = arch.span / 2, rng.uniform(0.03, 0.12), rng.uniform(0.011, 0.018)
        if not arch.blind:
            start, end = arch.place.out(np.array([[-half - 0.05, 0.0, up], [half + 0.05, 0.0, up]]))
            yield tube(start, end, (radius, radius), IRON)


def _pews(building: Building, stations: Array, rng: np.random.Generator) -> Iterator[Triangles]:
    """Boxes, one here and one there; one that would come too near to a station is left out."""
    for _ in range(building.pews):
        bay = building.bays[int(rng.integers(len(building.bays)))]
        size, height = rng.uniform([0.4, 0.3], [1.8, 0.6]), rng.uniform(0.4, 1.1)
        middle = rng.uniform(-1, 1, 2) * WITHIN * bay.vault.plan.half
        corners = middle + np.array([[x, y] for x in (-0.5, 0.5) for y in (-0.5, 0.5)]) * size
        there = bay.place.out(corners)
        near = np.hypot(*(stations[:, :2] - there.mean(axis=0)).T).min() < CLEAR + float(np.hypot(*size)) / 2
        if not near and not bay.slope and bay.vault.plan.holds(corners).all():
            yield prism(there, (bay.floor, bay.floor + height), WOOD)

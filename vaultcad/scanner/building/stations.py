"""Where scanners stand in a building: in as many bays as there are stations, far from each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vaultcad.errors import VaultcadError
from vaultcad.scanner.building.elements import Building
from vaultcad.scanner.places import middle_line
from vaultcad.scanner.shoot import caster_of
from vaultcad.scanner.triangles import Triangles

Array = NDArray[np.float64]

CLEARANCE = 0.3  # of a scanner to all that is built [m]
TRIES = 12  # of places in a bay
OFF = 0.25  # of a plan's half extents, that they lie off its middle
STOREYS_APART = 4.0  # as far as a metre of height counts in plan


def draw_stations(building: Building, mesh: Triangles, rng: np.random.Generator) -> Array:
    """Places (k, 3) [m], those that are declared or else drawn.

    Raises:
        VaultcadError: one stands in the stone or too near to it, or there is no room for any.
    """
    if building.stations:
        places = np.array(building.stations)
        for place, clear in zip(places, _clearance(mesh, places), strict=True):
            if clear < CLEARANCE:
                raise VaultcadError(
                    f"the station at {place[0]:g}, {place[1]:g}, {place[2]:g} is {clear:.2f} m from the next wall; "
                    f"it needs {CLEARANCE:g} m"
                )
        return places
    able = _places(building, mesh, rng)
    if not len(able):
        raise VaultcadError("there is no room for a scanner in any bay; take larger ones or name its stations")
    weighed = able * (1.0, 1.0, STOREYS_APART)
    chosen = [int(np.hypot(*(weighed - weighed.mean(axis=0))[:, :2].T).argmin())]
    while len(chosen) < min(building.settings.stations, len(able)):
        apart = np.linalg.norm(weighed[:, None] - weighed[chosen], axis=2).min(axis=1)
        chosen.append(int(apart.argmax()))
    stations: Array = able[chosen]
    return stations


def _places(building: Building, mesh: Triangles, rng: np.random.Generator) -> Array:
    """A place (n, 3) [m] with room about it near the middle of each bay that has one."""
    tried = []
    for bay in building.bays:
        plan = bay.vault.plan
        reach = np.minimum(plan.half, plan.width / 2)
        places = middle_line(plan, [0.5])[0] + rng.uniform(-OFF, OFF, (TRIES, 2)) * reach
        height = building.settings.station_height + rng.uniform(-0.05, 0.05, TRIES)
        tried.append(np.column_stack([bay.place.out(places), bay.floor_at(places) + height]))
    clear = (_clearance(mesh, np.concatenate(tried)) >= CLEARANCE).reshape(-1, TRIES)
    return np.array([xyz[good.argmax()] for xyz, good in zip(tried, clear, strict=True) if good.any()])


def _clearance(mesh: Triangles, places: Array) -> Array:
    """Distances (n,) [m] of places (n, 3) to the nearest surface."""
    import open3d as o3d

    asked = o3d.core.Tensor.from_numpy(np.ascontiguousarray(places, np.float32))
    distance: Array = caster_of(mesh).compute_distance(asked).numpy().astype(np.float64)
    return distance

"""A virtual laser scan of a building, with what every point shows."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vaultcad.scanner.building.build import Built, build
from vaultcad.scanner.building.elements import Arch, Bay, Building, Pier
from vaultcad.scanner.building.furnish import furnish
from vaultcad.scanner.building.place import Place
from vaultcad.scanner.building.stations import draw_stations
from vaultcad.scanner.scan import angular_step, shot_from
from vaultcad.scanner.settle import MODES, Settlement
from vaultcad.scanner.shoot import aim
from vaultcad.scanner.triangles import Triangles, join, split
from vaultcad.scanner.truth import truth_path
from vaultcad.scanner.waves import draw_waves

Array = NDArray[np.float64]

LONGEST_EDGE = 0.25  # of a mesh that is bent by the settlement [m]
FAR = np.array([[-np.inf] * 3, [np.inf] * 3])
WAVES = (1.0, 4.0)  # of the settlement, shortest and longest, as shares of the widest plan
OPTIONAL = ("drum", "pendentive", "squinch")  # components that begin so carry the vault and are not scored


@dataclass(frozen=True, eq=False)
class BuildingScan:
    """Points of all stations, one station after the other, each row by row upwards.

    xyz: (n, 3) [m], relative to `origin` (3,). vault, component, arch: (n,), 1-based numbers in `case`, 0 for none.
    kind: (n,), of `labels.Kind`. intensity, station: (n,). case: what was scanned and how.
    """

    xyz: Array
    origin: Array
    vault: NDArray[np.uint16]
    component: NDArray[np.uint16]
    arch: NDArray[np.uint16]
    kind: NDArray[np.uint8]
    intensity: NDArray[np.uint16]
    station: NDArray[np.uint8]
    case: dict[str, Any]

    def __len__(self) -> int:
        return len(self.xyz)


def scan_building(building: Building, *, rng: np.random.Generator) -> BuildingScan:
    """Scan a building from its stations.

    The same building and state of `rng` give the same bytes.

    Raises:
        VaultcadError: the building cannot stand as declared, or a station has no room; says which and why.
        MissingLibraryError: open3d, or a system library under it, is missing; says how to install it.
    """
    settings = building.settings
    place, stand, settle, surface, pilot, measure = rng.spawn(6)
    built = build(building)
    stations = draw_stations(building, built.mesh, place)
    still = join([split(built.mesh, LONGEST_EDGE), *furnish(building, built, stations, stand)])
    settlement = _settlement(building, built.mesh, settle)
    target = aim(replace(still, vertices=still.vertices + settlement(still.vertices)), surface)
    step = angular_step(target, stations, replace(settings, holes=0.0), FAR, pilot)
    shots, station, reported = shot_from(target, stations, step, settings, FAR, measure)
    table = built.labels.columns()[:, shots.component]
    there = Place(0.0, 0.0, 0.0, building.yaw)
    case = _case(building, built, there.out(reported) + building.origin, step, len(shots.xyz))
    return BuildingScan(
        there.out(shots.xyz),
        np.array(building.origin),
        table[1].astype(np.uint16),
        table[2].astype(np.uint16),
        table[3].astype(np.uint16),
        table[0].astype(np.uint8),
        shots.intensity,
        station,
        case,
    )


def write_building(scan: BuildingScan, path: Path) -> Path:
    """Write the points as `vaultcad.scanner.write_scan` does, and the truth beside.

    The truth is an .npz with `vault`, `component`, `arch`, `kind` and `station` (n,), all in the file's order, and
    `case`, a JSON string. Returns its path.

    Raises:
        ValueError: the suffix names no format that can be written.
        OSError: the file cannot be written.
    """
    from segmentation.io.whole import replacing
    from segmentation.io.write import write_cloud

    write_cloud(path, scan.xyz, origin=scan.origin, intensity=scan.intensity)
    columns = {name: getattr(scan, name) for name in ("vault", "component", "arch", "kind", "station")}
    with replacing(truth_path(path)) as beside:
        np.savez_compressed(beside, **columns, case=np.array(json.dumps(scan.case)))
    return truth_path(path)


def _settlement(building: Building, mesh: Triangles, rng: np.random.Generator) -> Callable[[Array], Array]:
    """Low waves over the whole, which fade out from the lowest springing down to the lowest floor."""
    bays = building.bays
    widest = max(bay.vault.plan.width for bay in bays)
    shortest, longest = (share * widest for share in WAVES)
    waves = (
        draw_waves(MODES, shortest, longest, rng),
        draw_waves(MODES, shortest, longest, rng),
        draw_waves(MODES, shortest, longest, rng),
    )
    foot = np.array([0.0, 0.0, min(bay.place.z for bay in bays)])
    depth = foot[2] - min(bay.floor for bay in bays)
    unit = Settlement((widest, widest), widest, depth, np.zeros(3), waves, 1.0)
    vaults = mesh.vertices[np.unique(mesh.triangles)]
    largest = float(np.linalg.norm(unit(vaults - foot), axis=1).max())
    field = replace(unit, scale=building.settings.settlement / largest)
    return lambda xyz: field(xyz - foot)


def _case(building: Building, built: Built, stations: Array, step: float, points: int) -> dict[str, Any]:
    """The truth before it settled, in file coordinates; ready for JSON."""
    settings = building.settings
    whole = Place(*building.origin, building.yaw)
    return {
        "name": building.name,
        "step": degrees(step),
        "settle": settings.settlement,
        "noise": settings.noise,
        "yaw": degrees(building.yaw),
        "points": points,
        "vaults": [_vault(bay, whole) for bay in building.bays],
        "arches": [_arch(arch, whole) for arch in built.arches],
        "piers": [_pier(pier, whole) for pier in built.piers],
        "stations": stations.tolist(),
        "settings": asdict(settings),
    }


def _vault(bay: Bay, whole: Place) -> dict[str, Any]:
    vault, place = bay.vault, bay.place.seen(whole)
    carrying = [k for k, name in enumerate(vault.components, 1) if name.startswith(OPTIONAL)]
    span_x, span_y = (2 * vault.plan.half).tolist()
    return {
        **vault.plain(),
        **({"name": bay.name} if bay.name else {}),
        "sizes": {"span_x": span_x, "span_y": span_y, **vault.values(), **vault.derived_values()},
        "components": list(vault.components),
        "centre": [place.x, place.y],
        "springing": place.z,
        "floor": bay.floor + whole.z,
        "yaw_deg": place.yaw_deg,
        "plan": place.out(vault.plan.outline()).tolist(),
        **({"group": bay.group} if bay.group else {}),
        **({"optional": carrying} if carrying and vault.id == "cloister" else {}),
    }


def _arch(arch: Arch, whole: Place) -> dict[str, Any]:
    place = arch.place.seen(whole)
    sizes = {"span": arch.span, "rise": arch.rise, "width": arch.width, "thickness": arch.thickness}
    return {**sizes, "place": place.origin.tolist(), "yaw_deg": place.yaw_deg, "blind": arch.blind}


def _pier(pier: Pier, whole: Place) -> dict[str, Any]:
    place = pier.place.seen(whole)
    height = pier.top - pier.place.z
    return {
        "kind": pier.kind,
        "size": pier.size,
        "height": height,
        "place": place.origin.tolist(),
        "yaw_deg": place.yaw_deg,
    }

"""What was scanned and how, written beside a virtual scan: all that scoring a fit needs."""

from __future__ import annotations

import json
from dataclasses import asdict
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from families import Vault
from families.declaration.ribs import rib_plans
from vaultcad.scanner.settings import ScannerSettings

if TYPE_CHECKING:
    from vaultcad.scanner.scan import VirtualScan


def case(
    vault: Vault, settings: ScannerSettings, stations: NDArray[np.float64], step: float, points: int
) -> dict[str, Any]:
    """The true vault before it settled, where it stands, and how it was scanned; ready for JSON.

    `parameters` are flat as in `Vault.values`, `profiles` names the profile of each field that is one, `derived` the
    sizes that follow [m], `components` the names of the labels 1, 2, ...; `pose` holds the middle of the plan on the
    springing in file coordinates [m] and the yaw of the x axis. `stations` are as reported, in file coordinates.
    """
    x, y, floor = settings.origin
    return {
        **vault.plain(),
        "derived": vault.derived_values(),
        "components": list(vault.components),
        "pose": {"origin": [x, y, floor + settings.wall_height], "yaw_deg": degrees(settings.yaw)},
        **(
            {"ribs": [rib.name for rib in rib_plans(vault.rib_lines(), vault.plan, settings.ribs)]}
            if settings.ribs
            else {}
        ),
        "points": points,
        "step_deg": degrees(step),
        "stations": (stations + settings.origin).tolist(),
        "settings": asdict(settings),
    }


def _ribs(vault: Vault, settings: ScannerSettings) -> dict[str, Any]:
    """The names of the ribs in the order of their numbers, where there are any."""
    if settings.ribs is None:
        return {}
    return {"ribs": [rib.name for rib in rib_plans(vault.rib_lines(), vault.plan, settings.ribs)]}


def vault_of(truth: dict[str, Any]) -> Vault:
    """The vault that a `case` describes."""
    return Vault.from_plain(truth)


def truth_path(path: Path) -> Path:
    """Where the truth of a scan lies: room.laz -> room.truth.npz."""
    return path.with_suffix(".truth.npz")


def write_scan(virtual: VirtualScan, path: Path) -> Path:
    """Write the points, with their intensity, as PLY, LAS, LAZ, E57 or text by the file's suffix, and the truth beside.

    The truth is an .npz with `component` (n,) uint16 and `station` (n,) uint8, both in the file's order, and `case`, a
    JSON string; where there are ribs, with `arch` (n,) uint16, their 1-based numbers in `ribs` of the case. Returns its
    path.

    Raises:
        ValueError: the suffix names no format that can be written.
        OSError: the file cannot be written.
    """
    from segmentation.io.whole import replacing
    from segmentation.io.write import write_cloud

    case = np.array(json.dumps(virtual.truth))
    write_cloud(path, virtual.xyz, origin=virtual.origin, intensity=virtual.intensity)
    with replacing(truth_path(path)) as beside:
        labels: dict[str, Any] = {"component": virtual.component, "station": virtual.station}
        if virtual.truth.get("ribs"):
            labels["arch"] = virtual.arch
        np.savez_compressed(beside, **labels, case=case)
    return truth_path(path)


def read_truth(path: Path) -> tuple[NDArray[np.uint16], dict[str, Any]]:
    """Labels (n,) and case of the truth that `write_scan` put beside a scan; `path` is the scan's or the truth's.

    Raises:
        OSError: there is no such file.
    """
    with np.load(path if path.suffix == ".npz" else truth_path(path)) as data:
        return data["component"], json.loads(str(data["case"]))

"""A virtual scan of a vault on its walls, settled and furnished, with its truth. Writes room.laz and room.truth.npz.

Usage: python examples/05_virtual_scan.py [FOLDER]
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families import Pointed, Trough
from segmentation import read
from vaultcad.scanner import ScannerSettings, read_truth, scan, vault_of, write_scan


def main(out: Path) -> None:
    vault = Trough(span_x=4.0, span_y=7.0, profile=Pointed(0.6))
    settings = ScannerSettings(points=100_000, settlement=0.02, tie_rods=3, yaw=0.3, scaffold=True)
    virtual = scan(vault, settings, rng=np.random.default_rng(3))
    path = out / "room.laz"
    write_scan(virtual, path)
    print(f"{path}: {len(virtual):,} points from {len(virtual.stations)} stations")

    # The truth has a label for each point of the file, the vault before it settled, and how it was scanned.
    component, case = read_truth(path)
    print(f"true vault: {vault_of(case)}")
    distance = vault.distance(_in_vault(read(path).xyz, case["pose"]))
    for k, name in enumerate(case["components"], 1):
        rms = np.sqrt(np.mean(distance[component == k] ** 2))
        print(f"{name}: {(component == k).sum():,} points, rms {1000 * rms:.1f} mm from the vault before it settled")
    print(f"no vault: {(component == 0).sum():,} points")


def _in_vault(xyz: NDArray[np.floating], pose: dict[str, Any]) -> NDArray[np.float64]:
    """Points of the file in the vault's frame."""
    yaw = np.radians(pose["yaw_deg"])
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    local: NDArray[np.float64] = (xyz - pose["origin"]) @ turn
    return local


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder)

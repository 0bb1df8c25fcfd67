"""A virtual scan of a whole church, of the file that declares it. Writes church.laz and church.truth.npz.

Usage: python examples/12_church.py [FOLDER] [--points N]
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from vaultcad.scanner.building import read_building, scan_building, write_building

DECLARED = Path(__file__).parent / "church.toml"


def main(out: Path, points: int) -> None:
    church = read_building(DECLARED)
    church = replace(church, settings=replace(church.settings, points=points))
    virtual = scan_building(church, rng=np.random.default_rng(3))
    path = out / "church.laz"
    write_building(virtual, path)
    print(f"{path}: {len(virtual):,} points from {church.settings.stations} stations")

    # The truth says of each point which vault, component and arch it shows, and of each of these where it stands.
    for number, vault in enumerate(virtual.case["vaults"], 1):
        count = np.count_nonzero(virtual.vault == number)
        print(
            f"{number:3} {vault['name']:10} {vault['family']:8} {count:7,} points, springing {vault['springing']:.2f} m"
        )
    for number, arch in enumerate(virtual.case["arches"], 1):
        count = np.count_nonzero(virtual.arch == number)
        print(f"arch {number:2}: span {arch['span']:.2f} m, rise {arch['rise']:.2f} m, {count:6,} points")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", nargs="?", type=Path, default=Path("out"))
    parser.add_argument("--points", type=int, default=400_000)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    main(given.folder, given.points)

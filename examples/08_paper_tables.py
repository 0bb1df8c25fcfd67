"""The tables of the paper again: seven ideal vaults at its sizes, segmented with its parameters. Writes tables.csv.

The paper (Figure 2) counts inliers in clouds of 1,000,000 points. Its sail, barrel and groin vaults stood on walls, as
their shares tell: 27 % for a sail over 6 x 6 m asks for walls 3 m high, 42 % for a groin vault for the wall arches
alone. Each such vault is segmented with and without walls.

Usage: python examples/08_paper_tables.py [FOLDER] [--points 1000000]
"""

import argparse
import csv
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from families import Barrel, Dome, Groin, Lunette, Mirror, Sail, Semicircular, Trough, Vault
from segmentation import PRESETS, compare, detect

PAPER_POINTS = 1_000_000
PILOT = 1000.0  # points a square metre, to tell how large the walls are


@dataclass(frozen=True)
class Case:
    """An ideal vault of the paper, the inliers it counts, and the height of the walls [m], None for none."""

    vault: Vault
    inliers: int
    walls: float | None = None


CASES = (
    Case(Sail(6.0, 6.0, 1.0), 267_476, 3.0),  # sphere of r 4.24
    Case(Barrel(6.0, 6.0), 390_903, 2.5),  # r 3.00
    Case(Lunette(6.0, 9.0, Semicircular(), 3, width_ratio=2.8 / 3.0, springing_ratio=0.0), 999_156),  # r 1.40 and 3.00
    Case(Trough(6.0, 12.0, south_ratio=0.5, north_ratio=0.5), 1_000_000),  # r 3.00
    Case(Mirror(9.0, 12.0, 6.0 / 9.0, 6.0 / 12.0, rise_ratio=1.0), 1_000_000),  # r 3.00
    Case(Groin(6.0, 6.0), 423_661, 0.0),  # r 3.00
    Case(Dome(5.0), 1_000_000),  # r 5.00, pendentives 7.07
)
HEAD = ("vault", "walls", "points", "components", "found", "paper", "ours", "mean_iou", "seconds")


def main(out: Path, points: int) -> None:
    print(f"{points:,} points each; inliers of the paper and ours as shares of the cloud")
    print("vault    walls components found   paper    ours mean IoU      s")
    rows = []
    for case in CASES:
        for walls in (None, case.walls) if case.walls is not None else (None,):
            rng = np.random.default_rng(5)
            xyz, normals, truth = cloud_of(case.vault, walls, points, rng)
            start = time.perf_counter()
            found = detect(xyz, normals, PRESETS[f"{case.vault.id}-ideal"], rng)
            seconds = time.perf_counter() - start
            # The paper has one figure for each vault: for the cloud with walls, if that is what its share tells.
            paper = case.inliers / PAPER_POINTS if walls == case.walls else None
            ours, iou = float((found.labels > 0).mean()), compare(found.labels, truth).mean_iou
            count, on_walls = len(case.vault.components), "yes" if walls is not None else "no"
            rows.append((case.vault.id, on_walls, points, count, len(found), paper, ours, iou, seconds))
            stated = "-" if paper is None else f"{paper:.1%}"
            print(
                f"{case.vault.id:<8} {on_walls:>5} {count:>10} {len(found):>5} {stated:>7} {ours:>7.1%}"
                f" {iou:>8.4f} {seconds:>6.1f}"
            )
    with (out / "tables.csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([HEAD, *rows])


def cloud_of(
    vault: Vault, walls: float | None, points: int, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.uint16]]:
    """Points (n, 3), normals (n, 3) and components (n,) of a vault on walls of that height [m], all equally dense."""
    if walls is None:
        found = vault.sample(points, rng)
        return found.xyz, found.normals, found.component
    area = vault_area(vault)
    share = area / (area + len(wall_points(vault, walls, PILOT, rng)[0]) / PILOT)
    found = vault.sample(round(share * points), rng)
    xyz, normals = wall_points(vault, walls, 1.02 * len(found) / area, rng)
    keep = np.sort(rng.permutation(len(xyz))[: points - len(found)])
    return (
        np.concatenate([found.xyz, xyz[keep]]),
        np.concatenate([found.normals, normals[keep]]),
        np.concatenate([found.component, np.zeros(len(keep), np.uint16)]),
    )


def vault_area(vault: Vault) -> float:
    """Area of the intrados [m²]."""
    return float(sum(child.area for child in vault.intrados().children)) / 1e6


def wall_points(
    vault: Vault, height: float, density: float, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Random points (n, 3) of the walls under a vault, up to its wall arches, with normals; so many a square metre."""
    half = np.array([vault.plan.half_x, vault.plan.half_y])
    top = vault.derived_values()["rise"]
    parts, directions = [], []
    for axis, sign in ((0, -1), (0, 1), (1, -1), (1, 1)):
        count = round(density * 2 * half[1 - axis] * (top + height))
        xyz = np.empty((count, 3))
        xyz[:, axis] = sign * half[axis]
        xyz[:, 1 - axis] = rng.uniform(-half[1 - axis], half[1 - axis], count)
        xyz[:, 2] = rng.uniform(-height, top, count)
        bare = (xyz[:, 2] < 0) | (vault.distance(xyz) < 0)
        parts.append(xyz[bare])
        directions.append(np.tile(-sign * np.eye(3)[axis], (int(bare.sum()), 1)))
    return np.concatenate(parts), np.concatenate(directions)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", nargs="?", default="out", type=Path)
    parser.add_argument("--points", default=PAPER_POINTS, type=int, help="of each cloud")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    main(arguments.folder, arguments.points)

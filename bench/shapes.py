"""Primitives in the paper's seven ideal vaults: component IoU over seeds, and time with the normals given."""

from __future__ import annotations

import argparse
import time

import numpy as np

from families import Barrel, Dome, Groin, Lunette, Mirror, Sail, Semicircular, Trough, Vault
from segmentation import compare, detect

# The sizes of the paper's Figure 2: radii 3.00 (sail 4.24, lunettes 1.40, dome 5.00 with pendentives 7.08).
IDEALS: tuple[Vault, ...] = (
    Sail(6.0, 6.0, 1.0),
    Barrel(6.0, 9.0),
    Lunette(6.0, 9.6, Semicircular(), 3, 1.0, 0.0, 0.933, 0.0),
    Trough(6.0, 10.0, Semicircular(), 0.6, 0.6),
    Mirror(8.0, 10.0, 0.75, 0.6, 1.0, 1.0),
    Groin(6.0, 6.0),
    Dome(5.0, Semicircular(), 0.4, 0.0),
)


def run(chosen: argparse.Namespace) -> None:
    """One row a vault: components found, least and mean IoU over all seeds, median seconds."""
    detect(IDEALS[0].sample(20_000, np.random.default_rng(0)).xyz)  # compiles
    print(f"\nideal vaults, {chosen.points:,} points, normals given, {chosen.seeds} seeds, automatic parameters")
    print(f"{'vault':8} {'found':>6} {'least IoU':>10} {'mean IoU':>9} {'s':>6}")
    for vault in IDEALS:
        cloud = vault.sample(chosen.points, np.random.default_rng(1))
        least, mean, found, seconds = [], [], set(), []
        for seed in range(chosen.seeds):
            start = time.perf_counter()
            result = detect(cloud.xyz, cloud.normals, rng=np.random.default_rng(seed))
            seconds.append(time.perf_counter() - start)
            judged = compare(result.labels, cloud.component)
            least.append(judged.least_iou)
            mean.append(judged.mean_iou)
            found.add(len(result.shapes))
        count = "/".join(map(str, sorted(found)))
        found_of = f"{vault.id:8} {count:>3}/{len(vault.components)}"
        print(f"{found_of} {min(least):10.4f} {np.mean(mean):9.4f} {np.median(seconds):6.2f}", flush=True)

"""Primitives in ideal and settled vaults: component IoU over seeds, and time with and without normals."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator

import numpy as np

from bench.clouds import IDEALS, SETTLED, Case, ideal, settled
from segmentation import compare, detect


def run(chosen: argparse.Namespace) -> None:
    """One row a cloud: components found, least and mean IoU over all seeds, seconds of wall clock and processor."""
    detect(ideal(IDEALS[0], 20_000).xyz)  # compiles
    print(
        f"\nideal and settled vaults, {chosen.points:,} points, {chosen.seeds} seeds, automatic parameters; least times"
    )
    print(f"{'cloud':14} {'normals':9} {'found':>6} {'least IoU':>10} {'mean IoU':>9} {'s':>6} {'cpu s':>6}")
    for case in _cases(chosen.points):
        for given in (True, False):
            print(_row(case, given, chosen.seeds), flush=True)


def _cases(points: int) -> Iterator[Case]:
    for vault in IDEALS:
        yield ideal(vault, points)
    for vault in IDEALS:
        if vault.id in SETTLED:
            yield settled(ideal(vault, points))


def _row(case: Case, given: bool, seeds: int) -> str:
    least, mean, found, seconds, cpu = [], [], set(), [], []
    for seed in range(seeds):
        start, busy = time.perf_counter(), time.process_time()
        result = detect(case.xyz, case.normals if given else None, rng=np.random.default_rng(seed))
        seconds.append(time.perf_counter() - start)
        cpu.append(time.process_time() - busy)
        judged = compare(result.labels, case.truth)
        least.append(judged.least_iou)
        mean.append(judged.mean_iou)
        found.add(len(result.shapes))
    count = "/".join(map(str, sorted(found))) + f" of {case.components}"
    return (
        f"{case.name:14} {'given' if given else 'estimated':9} {count:>6} {min(least):10.4f} {np.mean(mean):9.4f}"
        f" {min(seconds):6.2f} {min(cpu):6.2f}"
    )

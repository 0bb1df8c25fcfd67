"""Primitives in ideal and settled vaults: component IoU over seeds, and time with and without normals."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator

import numpy as np

from bench.clouds import IDEALS, SETTLED, Case, ideal, settled
from bench.figures import Figure, Table, clock, iou, label, number, processor
from segmentation import compare, detect

COLUMNS = (
    label("cloud"),
    label("normals"),
    number("found"),
    number("of"),
    iou("least IoU"),
    iou("mean IoU"),
    clock("clock"),
    processor("processor"),
)


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """One row a cloud: components found, least and mean IoU over all seeds, least times."""
    detect(ideal(IDEALS[0], 20_000).xyz)  # compiles
    yield Table(
        "clouds",
        "ideal and settled vaults, automatic parameters; least times",
        {"points": chosen.points, "seeds": chosen.seeds},
        COLUMNS,
        (_row(case, given, chosen.seeds) for case in _cases(chosen.points) for given in (True, False)),
    )


def _cases(points: int) -> Iterator[Case]:
    for vault in IDEALS:
        yield ideal(vault, points)
    for vault in IDEALS:
        if vault.id in SETTLED:
            yield settled(ideal(vault, points))


def _row(case: Case, given: bool, seeds: int) -> tuple[Figure, ...]:
    """found: of all seeds, the number that is farthest from the truth."""
    least, mean, found, seconds, cpu = [], [], [], [], []
    for seed in range(seeds):
        start, busy = time.perf_counter(), time.process_time()
        result = detect(case.xyz, case.normals if given else None, rng=np.random.default_rng(seed))
        seconds.append(time.perf_counter() - start)
        cpu.append(time.process_time() - busy)
        judged = compare(result.labels, case.truth)
        least.append(judged.least_iou)
        mean.append(judged.mean_iou)
        found.append(len(result.shapes))
    farthest = max(found, key=lambda n: abs(n - case.components))
    normals, means = "given" if given else "estimated", float(np.mean(mean))
    return case.name, normals, farthest, case.components, min(least), means, min(seconds), min(cpu)

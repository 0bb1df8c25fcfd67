"""What segmentation costs besides: the first call of a process, and a cloud of millions, each in a process of its own.

Run as `python -m bench.cost first|large …` it is that process.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bench.clouds import IDEALS
from bench.figures import Figure, Table, clock, iou, label, memory, processor
from bench.peers.job import memory as resident

LARGE = 19_200_000  # points of the trough
SMALL = 100_000  # points of the first call
FIRST = (
    label("normals"),
    label("cache"),
    clock("import"),
    clock("first"),
    clock("second"),
    clock("compiling"),
    processor("its processor"),
)
LARGEST = (clock("clock"), processor("processor"), memory("memory", "bytes", 1), iou("least IoU"))


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """First calls with an empty and a full cache of compiled code; then the large cloud."""
    yield Table("first call", "first call in a new process, a groin vault", {"points": SMALL}, FIRST, _first_calls())
    yield Table(
        "large",
        "a trough, float32, normals estimated, after a first call; memory a point beyond the cloud",
        {"points": chosen.large},
        LARGEST,
        (tuple(_process({}, "large", str(chosen.large)).values()) for _ in range(1)),
    )


def _first_calls() -> Iterator[tuple[Figure, ...]]:
    """A row each for normals and cache; compiling is what the first call takes beyond a second one."""
    for normals in ("given", "estimated"):
        with tempfile.TemporaryDirectory() as cache:
            empty, full = (_process({"NUMBA_CACHE_DIR": cache}, "first", normals) for _ in range(2))
        for name, took in (("empty", empty), ("full", full)):
            compiling, busy = took["first"] - full["second"], took["first_cpu"] - full["second_cpu"]
            yield normals, name, took["import"], took["first"], took["second"], compiling, busy


def options(parser: argparse.ArgumentParser) -> None:
    """What the command line says about costs."""
    parser.add_argument("--large", type=int, default=LARGE, help=f"points of the large cloud (cost), default {LARGE}")


def _process(environment: dict[str, str], *arguments: str) -> Any:
    command = [sys.executable, "-m", "bench.cost", *arguments]
    done = subprocess.run(command, env={**os.environ, **environment}, stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout)


def first(normals: str) -> dict[str, float]:
    """Seconds of the import, the first and the second call, by the clock and by the processor."""
    groin = next(vault for vault in IDEALS if vault.id == "groin")
    cloud = groin.sample(SMALL, np.random.default_rng(1))
    times = [(time.perf_counter(), time.process_time())]
    from segmentation.ransac.detect import detect

    times.append((time.perf_counter(), time.process_time()))
    for _ in range(2):
        detect(cloud.xyz, cloud.normals if normals == "given" else None)
        times.append((time.perf_counter(), time.process_time()))
    took, busy = np.diff(times, axis=0).T.tolist()
    names = ("import", "first", "second")
    return dict(zip(names, took, strict=True)) | {f"{k}_cpu": v for k, v in zip(names, busy, strict=True)}


def large(points: str) -> dict[str, float]:
    """Seconds, bytes a point beyond the cloud (peak of resident memory), and the least IoU."""
    from segmentation import compare, detect

    trough = next(vault for vault in IDEALS if vault.id == "trough")
    cloud = trough.sample(int(points), np.random.default_rng(1))
    xyz, truth = cloud.xyz.astype(np.float32), cloud.component
    del cloud
    detect(xyz[:SMALL])
    before = resident("VmRSS")
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # the peak starts anew
    start, busy = time.perf_counter(), time.process_time()
    labels = detect(xyz).labels
    seconds, cpu, peak = time.perf_counter() - start, time.process_time() - busy, resident("VmHWM")
    return {
        "seconds": seconds,
        "cpu": cpu,
        "bytes": (peak - before) / len(xyz),
        "iou": compare(labels, truth).least_iou,
    }


if __name__ == "__main__":
    print(json.dumps({"first": first, "large": large}[sys.argv[1]](sys.argv[2])))

"""What sections, unrolled maps and drawings of a large room take beyond its fit: the command without and with them.

By turns, on free cores; memory is that of all processes of a command together (proportional set size), at its most.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from bench.figures import Figure, Table, clock, label, memory, processor

ROOM = 9_000_000  # points
RUNS = 3
SEED = 1
EVERY = 0.1  # s between two looks at the memory
ASKED = {"nothing more": (), "sections, maps, drawings": ("--sections", "--unrolled", "--drawings")}
COLUMNS = (label("run", 3), label("besides the fit", 26), clock("clock"), processor("processor"), memory("memory"))


def options(parser: argparse.ArgumentParser) -> None:
    """What the command line says about what follows a fit."""
    parser.add_argument("--room", type=int, default=ROOM, help=f"points of the room (further), default {ROOM}")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """A row for each run of the command."""
    settings = {"points": chosen.room, "seed": SEED}
    yield Table("further", "a fit without and with what may follow it", settings, COLUMNS, _rows(chosen.room))


def _rows(points: int) -> Iterator[tuple[Figure, ...]]:
    with tempfile.TemporaryDirectory() as folder:
        scan, out = Path(folder) / "room.laz", Path(folder) / "out"
        _vaultcad("scan", "groin", "-o", str(scan), "--points", str(points), "--seed", str(SEED))
        _vaultcad("fit", str(scan), "-o", str(out))  # the first loads what the others find in memory
        for number in range(1, RUNS + 1):
            for besides, options in ASKED.items():
                yield f"{number}", besides, *_vaultcad("fit", str(scan), "-o", str(out), *options)


def _vaultcad(*arguments: str) -> tuple[float, float, float]:
    """Seconds by the clock and of the processor, and the largest memory [MiB], of a command and all its processes."""
    start, before = time.perf_counter(), _processor()
    most = 0.0
    command = [sys.executable, "-c", "from vaultcad.cli import main; raise SystemExit(main())", *arguments]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while process.poll() is None:
            most = max(most, sum(map(_resident, _family(process.pid))))
            time.sleep(EVERY)
        if process.returncode:
            raise RuntimeError(f"vaultcad {' '.join(arguments)}: exit code {process.returncode}")
    return time.perf_counter() - start, _processor() - before, most / 1024


def _processor() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _family(process: int) -> list[int]:
    """A process and those that it has started, and they."""
    found = [process]
    for parent in found:
        try:
            for task in os.scandir(f"/proc/{parent}/task"):
                found += map(int, Path(task, "children").read_text(encoding="ascii").split())
        except OSError:  # it has just ended
            continue
    return found


def _resident(process: int) -> float:
    """Its share of the memory [KiB], of what several share a part each; 0 where it has ended."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text(encoding="ascii").splitlines()
    except OSError:
        return 0.0
    return next((float(line.split()[1]) for line in lines if line.startswith("Pss:")), 0.0)

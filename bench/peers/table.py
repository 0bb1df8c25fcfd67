"""The comparison: every engine on every cloud, one after the other, in rounds; ratios to ours."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees
from pathlib import Path

import numpy as np

from bench.clouds import IDEALS, SETTLED, SETTLED_NAME, Case, ideal, settled
from bench.figures import Figure, Table, clock, iou, label, memory, number, processor
from bench.peers.job import ANSWER, CLOUD, LABELS, MISSING, Job, write_points
from segmentation import PRESETS, compare


@dataclass(frozen=True)
class Engine:
    """A row of the table: what it is called, its module here, and whether it chooses its own parameters."""

    name: str
    module: str
    automatic: bool = False


@dataclass(frozen=True)
class Run:
    """One engine on one cloud once."""

    seconds: float
    cpu: float
    peak: int
    found: int
    mean_iou: float


COLUMNS = (
    label("cloud"),
    label("engine", 32),
    clock("clock"),
    number("ratio", decimals=1),
    processor("processor"),
    number("its ratio", decimals=1),
    memory("memory"),
    number("found"),
    number("of"),
    iou("least IoU", 3),
    iou("most", 3),
)
OURS = Engine("vaultcad", "ours", automatic=True)
ENGINES = {
    "ours": OURS,
    "paper": Engine("vaultcad, the paper's parameters", "ours"),
    "cloudcompare": Engine("CloudCompare", "cloudcompare"),
    "cgal": Engine("CGAL", "cgal"),
    "pyransac3d": Engine("pyransac3d, 10,000 of the points", "pyransac"),
}


def options(parser: argparse.ArgumentParser) -> None:
    """What the command line says about the comparison."""
    parser.add_argument("--peers", default=",".join(ENGINES), help=f"engines of peers, of {','.join(ENGINES)}")
    parser.add_argument("--vaults", default="", help="clouds of peers, such as groin,dome; all if left out")
    parser.add_argument("--rounds", type=int, default=2, help="times that each engine runs (peers), default 2")
    parser.add_argument("--peer-python", default=sys.executable, help="interpreter that has cgal and pyransac3d")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """A row for each cloud and engine: times and their ratios to ours, memory, components found, mean IoU."""
    names = ["ours", *filter(None, chosen.peers.split(","))]
    unknown = [name for name in names if name not in ENGINES]
    if unknown:
        sys.exit(f"no engine {', '.join(unknown)}; there are {', '.join(ENGINES)}")
    notes: list[str] = []
    yield Table(
        "engines",
        "from the cloud in memory to the shapes, normals given, the paper's parameters; least times, ratios to ours, "
        "memory of the whole process",
        {"points": chosen.points, "rounds": chosen.rounds},
        COLUMNS,
        _rows(chosen, {name: ENGINES[name] for name in names}, notes),
        notes,
    )


def _rows(chosen: argparse.Namespace, engines: dict[str, Engine], notes: list[str]) -> Iterator[tuple[Figure, ...]]:
    missing: set[str] = set()
    for case in _cases(chosen):
        runs: dict[str, list[Run]] = {name: [] for name in engines}
        with tempfile.TemporaryDirectory() as folder:
            write_points(Path(folder) / CLOUD, case.xyz, -case.normals)  # CGAL finds no sphere but by outward normals
            for _ in range(chosen.rounds):
                for name in [name for name in engines if name not in missing]:
                    answer = _once(engines[name], case, folder, chosen.peer_python)
                    if isinstance(answer, str):
                        missing.add(name)
                        notes.append(f"{engines[name].name} left out: {answer}")
                    else:
                        runs[name].append(answer)
        for name in [name for name in engines if runs[name]]:
            yield _row(case, engines[name], runs[name], runs["ours"])


def _cases(chosen: argparse.Namespace) -> Iterator[Case]:
    """The clouds that are asked for, one at a time."""
    names = chosen.vaults.split(",") if chosen.vaults else [vault.id for vault in IDEALS]
    for vault in IDEALS:
        if vault.id in names:
            yield ideal(vault, chosen.points)
    for vault in IDEALS:
        if vault.id in SETTLED and (vault.id in names or SETTLED_NAME.format(vault.id) in names):
            yield settled(ideal(vault, chosen.points))


def _once(engine: Engine, case: Case, folder: str, peer_python: str) -> Run | str:
    """One run in a process of its own, or why there is none.

    Raises:
        RuntimeError: the process failed for another reason than a missing library.
    """
    _job(case, folder, engine.automatic).write()
    python = peer_python if engine.module in ("cgal", "pyransac") else sys.executable
    command = [python, "-m", f"bench.peers.{engine.module}", folder]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == MISSING:
        return done.stderr.strip().splitlines()[-1]
    if done.returncode != 0:
        raise RuntimeError(f"{engine.name} on {case.name} failed:\n{done.stderr}")
    answer = json.loads((Path(folder) / ANSWER).read_text(encoding="utf-8"))
    labels = np.load(Path(folder) / LABELS)
    judged = compare(labels, case.truth)
    return Run(answer["seconds"], answer["cpu"], answer["peak"], len(np.unique(labels[labels > 0])), judged.mean_iou)


def _job(case: Case, folder: str, automatic: bool) -> Job:
    """The paper's parameters; without its limits of radii, which the peers do not know. What has settled is real."""
    preset = PRESETS[f"{case.family}-{'ideal' if case.name == case.family else 'real'}"]
    return Job(
        folder,
        epsilon=preset.epsilon or 0.0,
        beta=preset.beta or 0.0,
        min_points=preset.min_points(len(case.xyz)),
        alpha_deg=degrees(preset.alpha),
        probability=preset.overlooking_probability,
        primitives=list(preset.primitives),
        automatic=automatic,
    )


def _row(case: Case, engine: Engine, runs: list[Run], ours: list[Run]) -> tuple[Figure, ...]:
    """found: of all rounds, the number that is farthest from the truth."""
    seconds, base = min(r.seconds for r in runs), min(r.seconds for r in ours)
    cpu, base_cpu = min(r.cpu for r in runs), min(r.cpu for r in ours)
    found = max((r.found for r in runs), key=lambda n: abs(n - case.components))
    peak, ious = max(r.peak for r in runs) / 2**20, [r.mean_iou for r in runs]
    times = seconds, seconds / base, cpu, cpu / base_cpu
    return case.name, engine.name, *times, peak, found, case.components, min(ious), max(ious)

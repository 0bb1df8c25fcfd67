"""The whole way on virtual scans of buildings: bays found and invented, families, arches, sizes, confidence, cost.

`--labelled FOLDER` takes the scans of a folder instead, with truths as `vaultcad scan --building` leaves them.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

import numpy as np

from bench.building_scores import Score, score, seen
from bench.figures import Figure, Table, clock, count, error, iou, label, memory, number, share, text
from bench.peers.job import memory as resident
from bench.rooms import CURVE, binned
from segmentation import read
from vaultcad.errors import NoVaultError, VaultcadError
from vaultcad.pipeline import fit_scan
from vaultcad.scanner.building import draw_building, scan_building, write_building
from vaultcad.scanner.building.draw import KINDS
from vaultcad.scanner.truth import truth_path

Found = TypeVar("Found")

FIRST = 90_000  # seed of the first building
DEFAULT = 20  # buildings
SHARED = 0.015  # m, within which the sizes of bays in rows are wanted
BINS = (0.0, 0.5, 0.8, 0.95, 0.99, 1.0)  # of the confidence
BUILDING = (
    label("building"),
    number("vaults"),
    count("found", "vaults", "more"),
    number("invented"),
    count("right", "vaults", "more"),
    iou("IoU", 3),
    number("arch recall", decimals=3),
    number("arch precision", decimals=3),
    number("stray", decimals=3),
    error("size", "mm", 1),
    clock("clock", decimals=1),
    memory("memory"),
    text("refused"),
)
SUMMARY = (
    number("vaults"),
    share("found", "vaults"),
    count("invented", "vaults", "less"),
    share("right", "vaults"),
    iou("IoU", 3),
    number("rows"),
    share("within 15 mm", "rows"),
    share("plans within 15 mm", "rows"),
    error("size", "mm", 1),
    clock("clock", decimals=1),
    memory("memory"),
)
FAMILIES = (label("family"), number("vaults"), share("right", "vaults"))


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--buildings", type=int, default=DEFAULT, help=f"buildings (buildings), default {DEFAULT}")
    parser.add_argument("--labelled", type=Path, help="folder of scans with truths instead of those (buildings)")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """One row a building, then the summary, the families and the curve of the confidence."""
    scores: list[Score] = []
    settings: dict[str, Figure] = {"buildings": chosen.buildings, "points": chosen.points, "first seed": FIRST}

    def rows() -> Iterator[tuple[Figure, ...]]:
        with TemporaryDirectory() as folder:
            for path in _labelled(chosen.labelled) if chosen.labelled else _drawn(chosen, Path(folder)):
                scores.append(_alone(_judged, path))
                yield _told(scores[-1])

    yield Table("buildings", "virtual scans of buildings", settings, BUILDING, rows(), detail=True)
    yield Table("summary", "virtual scans of buildings", settings, SUMMARY, [_summary(scores)])
    yield Table("families", "families told right", settings, FAMILIES, _families(scores))
    said = [one for s in scores for one in s.said]
    if said:
        stated, right = np.array([c for c, _ in said]), np.array([r for _, r in said])
        brier = f"Brier's score {np.mean((stated - right) ** 2):.4f}; always saying the mean gives {right.var():.4f}"
        yield Table("confidence", "does it hold?", settings, CURVE, binned(stated, right, BINS), [brier])


def _labelled(folder: Path) -> Iterator[Path]:
    yield from sorted(path for path in folder.glob("*.la[sz]") if truth_path(path).exists())


def _drawn(chosen: argparse.Namespace, folder: Path) -> Iterator[Path]:
    for k in range(chosen.buildings):
        yield _alone(_scanned, FIRST + k, list(KINDS)[k % len(KINDS)], chosen.points, folder)


def _alone(work: Callable[..., Found], *arguments: object) -> Found:
    """In a process of its own, so that its memory is its own."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(work, *arguments).result()


def _scanned(seed: int, kind: str, points: int, folder: Path) -> Path:
    """A scan of the first building drawn that can stand; OpenCASCADE cannot cut all vaults."""
    rng = np.random.default_rng(seed)
    path = folder / f"{kind}-{seed}.laz"
    while True:
        with suppress(VaultcadError):
            building = draw_building(rng, kind)
            building = replace(building, settings=replace(building.settings, points=points))
            write_building(scan_building(building, rng=rng), path)
            return path


def _judged(path: Path) -> Score:
    with np.load(truth_path(path)) as data:
        truth = {key: data[key] for key in ("vault", "component", "arch", "kind")}
        case = json.loads(str(data["case"]))
    cloud = read(path)
    if cloud.kept is not None:
        truth = {key: column[cloud.kept] for key, column in truth.items()}
    start = time.perf_counter()
    name, vaults = path.name.split(".")[0], seen(truth)
    try:
        result = fit_scan(cloud)
    except NoVaultError as error:
        return Score(name, vaults, seconds=time.perf_counter() - start, refusal=str(error))
    seconds = time.perf_counter() - start
    return Score(name, **score(truth, case, result), seconds=seconds, memory=resident("VmHWM"))


def _told(s: Score) -> tuple[Figure, ...]:
    return (
        *(s.name, s.vaults, s.found, s.invented, s.right, _mean(s.components)),
        *(s.arch_recall, s.arch_precision, s.stray, _millimetres(s.sizes), s.seconds, s.memory / 2**20, s.refusal),
    )


def _summary(scores: Sequence[Score]) -> tuple[Figure, ...]:
    vaults = max(1, sum(s.vaults for s in scores))
    sizes, plans = ([size for s in scores for size in getattr(s, name)] for name in ("sizes", "plans"))
    return (
        vaults,
        sum(s.found for s in scores) / vaults,
        sum(s.invented for s in scores),
        sum(s.right for s in scores) / vaults,
        _mean([c for s in scores for c in s.components]),
        len(sizes),
        float(np.mean(np.array(sizes) <= SHARED)) if sizes else None,
        float(np.mean(np.array(plans) <= SHARED)) if plans else None,
        _millimetres(sizes),
        _mean([s.seconds for s in scores]),
        max((s.memory for s in scores), default=0) / 2**20,
    )


def _families(scores: Sequence[Score]) -> Iterator[tuple[Figure, ...]]:
    for family in sorted({family for s in scores for family in s.families}):
        told = [s.families[family] for s in scores if family in s.families]
        right, true = (sum(column) for column in zip(*told, strict=True))
        yield family, true, right / true


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if len(values) else None


def _millimetres(sizes: Sequence[float]) -> float | None:
    """Their median."""
    return 1000 * float(np.median(sizes)) if len(sizes) else None

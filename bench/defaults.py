"""Does every fit of a default room leave all its files? What had to be nudged to be built, and by how much?"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from bench.figures import Figure, Table, count, label, number, text
from families import FAMILIES, family
from segmentation.cloud import Cloud
from vaultcad.errors import VaultcadError
from vaultcad.export.bundle import WRITERS, write_all
from vaultcad.labelled_scan import SEGMENTS
from vaultcad.pipeline import fit_scan
from vaultcad.scanner import ScannerSettings, scan

POINTS = 60_000
DEFAULT = 100  # seeds of each family
FIT = (label("family"), label("seed"), text("what was wrong or nudged"))
FILES = (
    label("family"),
    number("fits"),
    count("without all files", "fits", "less"),
    count("nudged", "fits", "less"),
)


@dataclass(frozen=True)
class Outcome:
    """What became of one room: what went wrong, if anything did, and the notes on bodies that were changed."""

    family: str
    seed: int
    wrong: str
    nudged: tuple[str, ...] = ()


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--defaults", type=int, default=DEFAULT, help=f"seeds a family (defaults), default {DEFAULT}")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """A row for each fit in which something went wrong or was nudged, then how many by family."""
    settings = {"rooms a family": chosen.defaults, "points": POINTS, "first seed": 0}
    outcomes: list[Outcome] = []
    yield Table("fits", "fits that were not all well", settings, FIT, _rows(chosen, outcomes), detail=True)
    yield Table("files", "default rooms, fitted and written", settings, FILES, _families(outcomes))


def _rows(chosen: argparse.Namespace, outcomes: list[Outcome]) -> Iterator[tuple[Figure, ...]]:
    asked = [(cls.id, seed) for cls in FAMILIES for seed in range(chosen.defaults)]
    with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
        for o in pool.map(one, asked, chunksize=4):
            outcomes.append(o)
            if told := "; ".join(filter(None, (o.wrong, *o.nudged))):
                yield o.family, str(o.seed), told


def _families(outcomes: Sequence[Outcome]) -> Iterator[tuple[Figure, ...]]:
    for cls in FAMILIES:
        mine = [o for o in outcomes if o.family == cls.id]
        yield cls.id, len(mine), sum(bool(o.wrong) for o in mine), sum(bool(o.nudged) for o in mine)


def one(asked: tuple[str, int]) -> Outcome:
    """One room, scanned as `vaultcad scan FAMILY --seed N` does, fitted and written."""
    name, seed = asked
    virtual = scan(family(name)(), ScannerSettings(points=POINTS), rng=np.random.default_rng(seed))
    try:
        model = fit_scan(Cloud(virtual.xyz.astype(np.float32))).model
        with TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            drawn = write_all(model, out, segments=Path.touch).model
            missing = {*WRITERS, SEGMENTS} - {path.name for path in out.iterdir()}
    except (VaultcadError, ValueError) as error:
        return Outcome(name, seed, str(error))
    notes = tuple(note.text for note in drawn.notes if note.code in ("nudged", "unbuilt"))
    return Outcome(name, seed, f"without {', '.join(sorted(missing))}" if missing else "", notes)

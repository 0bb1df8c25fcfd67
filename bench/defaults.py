"""Does every fit of a default room leave all its files? What had to be nudged to be built, and by how much?"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from families import FAMILIES, family
from segmentation.cloud import Cloud
from vaultcad.errors import VaultcadError
from vaultcad.export.bundle import SEGMENTS, WRITERS, write_all
from vaultcad.pipeline import fit_scan
from vaultcad.scanner import ScannerSettings, scan

POINTS = 60_000
DEFAULT = 100  # seeds of each family


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


def run(chosen: argparse.Namespace) -> None:
    """What went wrong, what was nudged, and how many by family."""
    print(f"\ndefault rooms of {POINTS:,} points, seeds 0 to {chosen.defaults - 1} of each family")
    asked = [(cls.id, seed) for cls in FAMILIES for seed in range(chosen.defaults)]
    with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
        outcomes = list(pool.map(one, asked, chunksize=4))
    for o in outcomes:
        for text in filter(None, (o.wrong, *o.nudged)):
            print(f"{o.family:8} {o.seed:3}  {text}")
    for cls in FAMILIES:
        mine = [o for o in outcomes if o.family == cls.id]
        wrong, nudged = sum(bool(o.wrong) for o in mine), sum(bool(o.nudged) for o in mine)
        print(f"{cls.id:8} {len(mine):4} fits, {wrong} without all files, {nudged} nudged")


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

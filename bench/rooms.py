"""The whole way on virtual scans of rooms: family, component IoU, deviation, time, and whether the confidence holds.

The constants of `vaultcad.fit.evidence` were found on scans of other seeds than these, 5000 to 5197.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from families import FAMILIES, Vault
from segmentation import compare, read
from vaultcad.errors import VaultcadError
from vaultcad.pipeline import fit_scan
from vaultcad.scanner import ScannerSettings, VirtualScan, draw, scan, write_scan

FIRST = 1000  # seed of the first room
DEFAULT = 100  # rooms
WEAK = 0.9  # mean IoU below which a room is looked at
BINS = (0.0, 0.5, 0.8, 0.95, 0.99, 1.0)  # of the confidence


@dataclass(frozen=True)
class Outcome:
    """What became of one room. refusal: why there is no vault; the rest is of the vault that holds most of the truth.

    mean_iou, least_iou: of its components. deviation: mean over its points [m]. vaults: how many were found.
    """

    seed: int
    true: str
    scene: str
    refusal: str = ""
    found: str = ""
    vaults: int = 0
    mean_iou: float = 0.0
    least_iou: float = 0.0
    deviation: float = 0.0
    confidence: float = 0.0
    seconds: float = 0.0

    @property
    def right(self) -> bool:
        """Whether the family is the true one."""
        return self.found == self.true


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--rooms", type=int, default=DEFAULT, help=f"virtual scans (rooms), default {DEFAULT}")
    parser.add_argument("--first", type=int, default=FIRST, help=f"seed of the first of them (rooms), default {FIRST}")
    parser.add_argument("--workers", type=int, default=1, help="processes (rooms, profiles), default 1")


def run(chosen: argparse.Namespace) -> None:
    """One row a room, then the summary, the confusion matrix and the curve of the confidence."""
    points = chosen.points // 4
    print(f"\nvirtual scans of rooms, {chosen.rooms} of them, {points:,} points, seeds from {chosen.first}")
    print("seed  true     found    vaults    IoU  least     mm  confidence     s  scene")
    outcomes = []
    with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
        for outcome in pool.map(partial(one, points=points, first=chosen.first), range(chosen.rooms)):
            _show(outcome)
            outcomes.append(outcome)
    _summarise(outcomes)
    _curve([o for o in outcomes if o.found])


def one(k: int, points: int, first: int) -> Outcome:
    """The k-th room: drawn, scanned, written, read, fitted, and judged."""
    true, rng = FAMILIES[k % len(FAMILIES)], np.random.default_rng(first + k)
    virtual, settings = _scanned(true, points, rng)
    parts = [
        f"{settings.stations} stations" if settings.stations > 1 else "1 station",
        f"noise {1000 * settings.noise:.1f} mm, settled {1000 * settings.settlement:.0f} mm",
        f"holes {settings.holes:.0%}" if settings.holes else "",
        "piers" if settings.walls == "piers" else "",
        "cropped" if settings.crop else "",
        "far" if any(settings.origin) else "",
    ]
    row = Outcome(first + k, true.id, ", ".join(part for part in parts if part))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "room.laz"
        write_scan(virtual, path)
        cloud = read(path)
        start = time.process_time()
        try:
            result = fit_scan(cloud)
        except VaultcadError as error:
            return replace(row, refusal=str(error), seconds=time.process_time() - start)
    seconds = time.process_time() - start
    own = result.labels.vault[virtual.component > 0]
    number = int(np.bincount(own, minlength=2)[1:].argmax()) + 1
    fitted = result.model.vaults[number - 1]
    judged = compare(np.where(result.labels.vault == number, result.labels.component, 0), virtual.component)
    return replace(
        row,
        found=fitted.vault.id,
        vaults=len(result.model.vaults),
        mean_iou=judged.mean_iou,
        least_iou=judged.least_iou,
        deviation=fitted.deviation.mean,
        confidence=fitted.confidence,
        seconds=seconds,
    )


def _scanned(true: type[Vault], points: int, rng: np.random.Generator) -> tuple[VirtualScan, ScannerSettings]:
    """A room under the first vault drawn that can be meshed; OpenCASCADE cannot cut all ellipses."""
    while True:
        vault, settings = draw(true, rng)
        with suppress(VaultcadError):
            return scan(vault, replace(settings, points=points), rng=rng), settings


def _show(o: Outcome) -> None:
    if not o.found:
        print(f"{o.seed}  {o.true:8} {o.refusal}; {o.scene}", flush=True)
        return
    numbers = f"{o.vaults:6} {o.mean_iou:6.3f} {o.least_iou:6.3f} {1000 * o.deviation:6.1f} {o.confidence:11.3f}"
    mark = "" if o.right and o.mean_iou >= WEAK else "  <"
    print(f"{o.seed}  {o.true:8} {o.found:8} {numbers} {o.seconds:5.1f}  {o.scene}{mark}", flush=True)


def _summarise(outcomes: Sequence[Outcome]) -> None:
    """Shares, and who was taken for whom."""
    found = [o for o in outcomes if o.found]
    right = sum(o.right for o in outcomes)
    ious = [o.mean_iou for o in outcomes]  # none for a room that was refused
    print(f"\nright {right} of {len(outcomes)}, refused {len(outcomes) - len(found)}, mean IoU {np.mean(ious):.3f},")
    print(
        f"{np.mean([o.mean_iou for o in found]):.3f} where a vault was found; {sum(o.vaults > 1 for o in found)} rooms "
        f"with a vault too many; {np.mean([o.seconds for o in outcomes]):.1f} s of processor time a room"
    )
    ids = [family.id for family in FAMILIES]
    print("rows true, columns found\n" + " " * 9 + " ".join(f"{name:>8}" for name in [*ids, "refused", "IoU"]))
    for name in ids:
        mine = [o for o in outcomes if o.true == name]
        counts = [sum(o.found == other for o in mine) for other in [*ids, ""]]
        iou = np.mean([o.mean_iou for o in mine]) if mine else np.nan
        print(f"{name:8} " + " ".join(f"{count:8}" for count in counts) + f" {iou:8.3f}")


def _curve(found: Sequence[Outcome]) -> None:
    """Reliability (Murphy and Winkler 1977) and Brier's score of the confidence."""
    said, right = np.array([o.confidence for o in found]), np.array([o.right for o in found])
    print("\nconfidence       rooms   said  right")
    for low, high in pairwise(BINS):
        mine = (said >= low) & ((said < high) | (high == BINS[-1]))
        if mine.any():
            print(f"{low:.2f} to {high:.2f} {mine.sum():9} {said[mine].mean():6.3f} {right[mine].mean():6.3f}")
    print(f"Brier's score {np.mean((said - right) ** 2):.4f}; always saying the mean gives {right.var():.4f}")

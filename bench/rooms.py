"""The whole way on virtual scans of rooms: family, component IoU, deviation, time, and whether the confidence holds.

The constants of `vaultcad.fit.evidence` were found on scans of other seeds than these, 5000 to 5197.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.figures import Figure, Table, count, iou, label, number, processor, share, text
from families import FAMILIES, Vault, family
from segmentation import compare, read
from vaultcad.errors import VaultcadError
from vaultcad.model import FittedVault
from vaultcad.pipeline import fit_scan
from vaultcad.scanner import ScannerSettings, VirtualScan, draw, scan, write_scan

FIRST = 1000  # seed of the first room
DEFAULT = 100  # rooms
GIVEN = ("settlement", "noise")  # of the scanner, where the command line says them
WEAK = 0.9  # mean IoU below which a room is looked at
BINS = (0.0, 0.5, 0.8, 0.95, 0.99, 1.0)  # of the confidence
ROOM = (
    label("seed"),
    text("true"),
    text("found"),
    number("vaults"),
    iou("IoU", 3),
    iou("least", 3),
    number("off", "mm", 1),
    number("confidence", decimals=3),
    processor("processor", decimals=1),
    text("scene"),
)
SUMMARY = (
    number("rooms"),
    count("right", "rooms", "more"),
    count("refused", "rooms", "less"),
    count("a vault too many", "rooms", "less"),
    iou("mean IoU", 3),
    iou("where found", 3),
    processor("processor", decimals=1),
)
CURVE = (label("said"), number("number"), number("stated", decimals=3), share("right", "number"))


@dataclass(frozen=True)
class Outcome:
    """What became of one room. refusal: why there is no vault; the rest is of the vault that holds most of the truth.

    mean_iou, least_iou: of its components. deviation: mean over its points [m]. vaults: how many were found.
    share: of the likelihood among the families.
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
    share: float = 0.0
    seconds: float = 0.0

    @property
    def right(self) -> bool:
        """Whether the family is the true one."""
        return self.found == self.true


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--rooms", type=int, default=DEFAULT, help=f"virtual scans (rooms), default {DEFAULT}")
    parser.add_argument("--first", type=int, default=FIRST, help=f"seed of the first of them (rooms), default {FIRST}")
    parser.add_argument("--families", type=names, default=None, help="ids of those over the rooms, with commas between")
    parser.add_argument("--settlement", type=float, default=None, help="of each room in m, not drawn (rooms)")
    parser.add_argument("--noise", type=float, default=None, help="of each room in m, not drawn (rooms)")
    parser.add_argument("--workers", type=int, default=1, help="processes (rooms, profiles), default 1")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """One row a room, then the summary, the confusion matrix and the curve of the confidence."""
    points = chosen.points // 4
    families = chosen.families or tuple(family.id for family in FAMILIES)
    settings = {"rooms": chosen.rooms, "points": points, "first seed": chosen.first}
    if chosen.families:
        settings["families"] = ", ".join(families)
    given = {name: value for name in GIVEN if (value := getattr(chosen, name)) is not None}
    settings |= given
    outcomes: list[Outcome] = []
    judged = partial(one, points=points, first=chosen.first, families=families, given=given)

    def rows() -> Iterator[tuple[Figure, ...]]:
        with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
            for outcome in pool.map(judged, range(chosen.rooms)):
                outcomes.append(outcome)
                yield _told(outcome)

    yield Table("rooms", "virtual scans of rooms", settings, ROOM, rows(), detail=True)
    yield Table("summary", "virtual scans of rooms", settings, SUMMARY, [_summary(outcomes)])
    ids = [family.id for family in FAMILIES]
    confusion = (label("family"), *map(number, [*ids, "refused"]), iou("IoU", 3))
    yield Table("families", "rows true, columns found", settings, confusion, _confusion(outcomes, families, ids))
    if found := [o for o in outcomes if o.found]:
        said = [(o.confidence, o.share, o.right) for o in found]
        yield reliability("confidence", "does the confidence hold?", settings, said)


def names(told: str) -> tuple[str, ...]:
    """Ids of families, of their names in any language with commas between."""
    return tuple(family(name).id for name in told.split(","))


def one(k: int, points: int, first: int, families: Sequence[str], given: Mapping[str, float]) -> Outcome:
    """The k-th room: drawn, scanned, written, read, fitted, and judged; under one family after the other.

    given: settings of the scanner that are not drawn.
    """
    true, rng = family(families[k % len(families)]), np.random.default_rng(first + k)
    virtual, settings = _scanned(true, rng, {"points": points, **given})
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
        share=share_of(fitted),
        seconds=seconds,
    )


def _scanned(
    true: type[Vault], rng: np.random.Generator, given: Mapping[str, Any]
) -> tuple[VirtualScan, ScannerSettings]:
    """A room under the first vault drawn that can be meshed; OpenCASCADE cannot cut all ellipses."""
    while True:
        vault, drawn = draw(true, rng)
        settings = replace(drawn, **given)
        with suppress(VaultcadError):
            return scan(vault, settings, rng=rng), settings


def _told(o: Outcome) -> tuple[Figure, ...]:
    if not o.found:
        return str(o.seed), o.true, "–", None, None, None, None, None, o.seconds, f"{o.refusal}; {o.scene}"
    mark = "" if o.right and o.mean_iou >= WEAK else "  <"
    figures = o.vaults, o.mean_iou, o.least_iou, 1000 * o.deviation, o.confidence, o.seconds
    return str(o.seed), o.true, o.found, *figures, o.scene + mark


def _summary(outcomes: Sequence[Outcome]) -> tuple[Figure, ...]:
    found = [o for o in outcomes if o.found]
    ious = [o.mean_iou for o in outcomes]  # none for a room that was refused
    return (
        len(outcomes),
        sum(o.right for o in outcomes),
        len(outcomes) - len(found),
        sum(o.vaults > 1 for o in found),
        float(np.mean(ious)),
        float(np.mean([o.mean_iou for o in found])) if found else None,
        float(np.mean([o.seconds for o in outcomes])),
    )


def _confusion(outcomes: Sequence[Outcome], drawn: Sequence[str], ids: Sequence[str]) -> Iterator[tuple[Figure, ...]]:
    """Who was taken for whom."""
    for name in drawn:
        mine = [o for o in outcomes if o.true == name]
        counts = [sum(o.found == other for o in mine) for other in [*ids, ""]]
        yield name, *counts, float(np.mean([o.mean_iou for o in mine])) if mine else None


def share_of(fitted: FittedVault) -> float:
    """How likely its family is if it is one of those that were tried: what is said without a look at the misfit."""
    return fitted.confidence / (fitted.confidence + sum(score for _, score in fitted.alternatives))


def reliability(
    name: str, title: str, settings: Mapping[str, Figure], told: Sequence[tuple[float, float, bool]]
) -> Table:
    """Curve of the confidence and Brier's score.

    told: of each vault what was said, its share of the likelihood among the families, and whether it was right.
    """
    said, shares, right = (np.array(column) for column in zip(*told, strict=True))
    brier, among = (float(np.mean((stated - right) ** 2)) for stated in (said, shares))
    note = f"Brier's score {brier:.4f}; with the shares among the families {among:.4f}, with the mean {right.var():.4f}"
    return Table(name, title, settings, CURVE, binned(said, right, BINS), [note])


def binned(said: NDArray[np.float64], right: NDArray[np.bool_], bins: Sequence[float]) -> Iterator[tuple[Figure, ...]]:
    """Reliability (Murphy and Winkler 1977): how many said so much, what they said, and how many of them were right."""
    for low, high in pairwise(bins):
        mine = (said >= low) & ((said < high) | (high == bins[-1]))
        if mine.any():
            yield f"{low:.2f} to {high:.2f}", int(mine.sum()), float(said[mine].mean()), float(right[mine].mean())

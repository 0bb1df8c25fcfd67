"""Vaults whose family is not tried: each room is fitted with all families, and once more without its own.

The second answer is wrong by construction. It should be none, or have a low confidence, but where another family makes
the same surface: a barrel with lunettes that have all but gone is a barrel.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing import get_context

import numpy as np

from bench.figures import Column, Figure, Table, count, label, number, text
from bench.rooms import reliability, share_of
from families import FAMILIES
from segmentation.cloud import Cloud
from vaultcad.errors import VaultcadError
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.scanner import draw, scan

FIRST = 20_000  # seed of the first room
ROOMS = 33
POINTS = 100_000
FARTHER, FEWER = 1.25, 0.98  # of distance and points with the true family, between which the surface is the same
SURE, UNSURE = 0.95, 0.5  # confidence
FIGURES: tuple[Column, ...] = (number("off", "mm", 1), number("share", decimals=3), number("confidence", decimals=3))
ROOM = (label("seed"), text("true"), text("found"), *FIGURES, text("why there is doubt"))
FAMILY = (
    label("family"),
    number("rooms"),
    count("refused", "rooms", "more"),
    number("same surface"),
    count("below 50 %", "rooms", "more"),
    count("95 % or more", "rooms", "less"),
)


@dataclass(frozen=True)
class Answer:
    """What was made of a room.

    points: of the vault. off: their rms [m]. share: of the likelihood among the families.
    """

    true: str
    found: str = ""
    points: int = 0
    off: float = np.inf
    share: float = 0.0
    confidence: float = 0.0
    why: str = ""

    @property
    def told(self) -> tuple[float, float, bool]:
        """As `reliability` takes it."""
        return self.confidence, self.share, self.found == self.true


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--strangers", type=int, default=ROOMS, help=f"rooms (strangers), default {ROOMS}")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """One row for each answer without the true family, then the counts by family and the curve of all answers."""
    settings: dict[str, Figure] = {"rooms": chosen.strangers, "points": POINTS, "first seed": FIRST}
    pairs: list[tuple[Answer, Answer]] = []

    def rows() -> Iterator[tuple[Figure, ...]]:
        with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
            for k, pair in enumerate(pool.map(one, range(FIRST, FIRST + chosen.strangers))):
                pairs.append(pair)
                yield (str(FIRST + k), *_row(pair[1]))

    yield Table("strangers", "rooms fitted without their family", settings, ROOM, rows(), detail=True)
    yield Table("families", "rooms fitted without their family", settings, FAMILY, _counted(pairs))
    for name, title, answers in (
        ("known", "with their family", [known for known, _ in pairs]),
        (
            "unknown",
            "without it, but for the same surface",
            [strange for known, strange in pairs if not _same(known, strange)],
        ),
    ):
        if found := [answer.told for answer in answers if answer.found]:
            yield reliability(name, f"does the confidence hold? {title}", settings, found)


def one(seed: int) -> tuple[Answer, Answer]:
    """A room fitted with its family and without it."""
    true, rng = FAMILIES[seed % len(FAMILIES)], np.random.default_rng(seed)
    while True:
        vault, settings = draw(true, rng)
        with suppress(VaultcadError):
            xyz = scan(vault, replace(settings, points=POINTS, origin=(0.0, 0.0, 0.0)), rng=rng).xyz
            break
    cloud = Cloud(xyz.astype(np.float32))
    known, strange = (
        _answer(cloud, FitSettings(families=tuple(f for f in FAMILIES if f is not without)), true.id)
        for without in (None, true)
    )
    return known, strange


def _answer(cloud: Cloud, settings: FitSettings, true: str) -> Answer:
    try:
        largest = max(fit_scan(cloud, settings).model.vaults, key=lambda one: one.vault.plan.area)
    except VaultcadError as error:
        return Answer(true, why=str(error))
    off, points = largest.deviation.rms, sum(part.points for part in largest.components)
    return Answer(true, largest.vault.id, points, off, share_of(largest), largest.confidence, largest.doubt)


def _same(known: Answer, strange: Answer) -> bool:
    return strange.points > FEWER * known.points and strange.off < FARTHER * known.off


def _row(answer: Answer) -> tuple[Figure, ...]:
    if not answer.found:
        return answer.true, "–", None, None, None, answer.why
    return answer.true, answer.found, 1000 * answer.off, answer.share, answer.confidence, answer.why


def _counted(pairs: Sequence[tuple[Answer, Answer]]) -> Iterator[tuple[Figure, ...]]:
    for name in ("all", *dict.fromkeys(known.true for known, _ in pairs)):
        mine = [pair for pair in pairs if name in ("all", pair[0].true)]
        other = [strange for known, strange in mine if not _same(known, strange)]
        found = [strange.confidence for strange in other if strange.found]
        refused = len(other) - len(found)
        unsure, sure = sum(c < UNSURE for c in found), sum(c >= SURE for c in found)
        yield name, len(mine), refused, len(mine) - len(other), unsure, sure

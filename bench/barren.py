"""Vaults where there are none, and none where there are: scenes without a vault, and vaults hard to tell from those.

The second half are shallow vaults (rise / span from 0.06) and vaults that have settled by 4 to 10 cm.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing import get_context

import numpy as np
from numpy.typing import NDArray

from bench.figures import Figure, Table, count, label, number, processor, text
from families import FAMILIES, Barrel, Groin, Sail, Segmental, Trough, Vault
from segmentation.cloud import Cloud
from vaultcad.errors import VaultcadError
from vaultcad.pipeline import fit_scan
from vaultcad.scanner import draw, scan
from vaultcad.scanner.barren import SCENES, draw_barren

FIRST = 9000  # seed of the first scene
SCANS = 200  # of either kind
POINTS = 60_000
SHALLOW = (0.06, 0.12)  # rise / span
STRONG = (0.04, 0.10)  # m of settlement
SUMMARISED = {
    "without a vault": "scenes without a vault; wrong: one was invented",
    "hard to tell": "shallow and strongly settled vaults; wrong: none was found",
}
SCAN = (label("seed"), text("kind"), processor("processor", decimals=1), text("found, or why nothing was"))
KIND = (label("kind"), number("scans"), count("wrong", "scans", "less"), processor("processor", decimals=1))


@dataclass(frozen=True)
class Outcome:
    """What became of one scan: its kind, whether it has a vault, what was found or why nothing was."""

    seed: int
    kind: str
    vaulted: bool
    found: tuple[str, ...]
    refusal: str
    seconds: float

    @property
    def wrong(self) -> bool:
        """Whether a vault was invented or lost."""
        return bool(self.found) != self.vaulted


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--scenes", type=int, default=SCANS, help=f"scans of either kind (barren), default {SCANS}")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """One row for each scan, then the counts by kind."""
    settings = {"scenes": chosen.scenes, "points": POINTS, "first seed": FIRST}
    for name, one in (("without a vault", barren), ("hard to tell", vaulted)):
        outcomes: list[Outcome] = []
        rows = _rows(one, chosen, outcomes)
        yield Table(f"scans {name}", f"scans {name}", settings, SCAN, rows, detail=True)
        yield Table(name, SUMMARISED[name], settings, KIND, _kinds(outcomes))


def _rows(
    one: Callable[[int], Outcome], chosen: argparse.Namespace, outcomes: list[Outcome]
) -> Iterator[tuple[Figure, ...]]:
    with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
        for o in pool.map(one, range(FIRST, FIRST + chosen.scenes)):
            outcomes.append(o)
            mark = "  <" if o.wrong else ""
            yield str(o.seed), o.kind, o.seconds, (", ".join(o.found) or o.refusal) + mark


def _kinds(outcomes: Sequence[Outcome]) -> Iterator[tuple[Figure, ...]]:
    for kind in ("all", *dict.fromkeys(o.kind for o in outcomes)):
        mine = [o for o in outcomes if kind in ("all", o.kind)]
        yield kind, len(mine), sum(o.wrong for o in mine), float(np.mean([o.seconds for o in mine]))


def barren(seed: int) -> Outcome:
    """A scene without a vault, fitted."""
    kind = list(SCENES)[seed % len(SCENES)]
    return _fitted(seed, kind, False, draw_barren(kind, np.random.default_rng(seed), POINTS))


def vaulted(seed: int) -> Outcome:
    """A vault that is hard to tell from none, fitted."""
    rng, kind = np.random.default_rng(seed), "shallow" if seed % 2 else "settled"
    while True:
        with suppress(VaultcadError, ValueError):
            if kind == "shallow":
                vault, (_, settings) = SHALLOW_VAULTS[seed // 2 % len(SHALLOW_VAULTS)](rng), draw(FAMILIES[0], rng)
                settings = replace(settings, settlement=rng.uniform(0, 0.03), walls="walls", crop=False)
            else:
                vault, settings = draw(FAMILIES[seed // 2 % len(FAMILIES)], rng)
                settings = replace(settings, settlement=rng.uniform(*STRONG))
            return _fitted(seed, kind, True, scan(vault, replace(settings, points=POINTS), rng=rng).xyz)


def _sizes(rng: np.random.Generator) -> tuple[float, float, float]:
    span = rng.uniform(3, 7)
    return span, span * rng.uniform(1, 1.6), rng.uniform(*SHALLOW)


def _barrel(rng: np.random.Generator) -> Vault:
    a, b, ratio = _sizes(rng)
    return Barrel(a, b, Segmental(ratio))


def _sail(rng: np.random.Generator) -> Vault:
    a, b, ratio = _sizes(rng)
    return Sail(a, b, max(0.1, 2 * ratio * a / np.hypot(a, b)))


def _groin(rng: np.random.Generator) -> Vault:
    a, b, ratio = _sizes(rng)
    return Groin(a, b, Segmental(ratio), Segmental(max(0.05, ratio * a / b)))


def _trough(rng: np.random.Generator) -> Vault:
    a, b, ratio = _sizes(rng)
    return Trough(a, 1.3 * b, Segmental(ratio), 0.6, 0.6)


SHALLOW_VAULTS: tuple[Callable[[np.random.Generator], Vault], ...] = (_barrel, _sail, _groin, _trough)


def _fitted(seed: int, kind: str, has_vault: bool, xyz: NDArray[np.float64]) -> Outcome:
    start = time.process_time()
    found: tuple[str, ...] = ()
    refusal = ""
    try:
        result = fit_scan(Cloud(xyz.astype(np.float32)))
        found = tuple(
            f"{f.vault.id} {f.confidence:.0%} {2 * f.vault.plan.half_x:.1f} x {2 * f.vault.plan.half_y:.1f} m"
            for f in result.model.vaults
        )
    except VaultcadError as error:
        refusal = str(error)
    return Outcome(seed, kind, has_vault, found, refusal, time.process_time() - start)

"""Sparse scans and scans that lean: is the answer right, refused, or at least within what is stated?

Virtual rooms of all families, whole and cropped, on walls and on piers: a few thousand points of each, drawn at random,
or all of them leaning by 1 to 3 degrees. The family is left to be recognised.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import hypot, pi, radians
from multiprocessing import get_context

import numpy as np
from numpy.typing import NDArray

from bench.figures import Figure, Table, count, error, label, number, share, text
from bench.uncertainty import Number, compared, within
from families import FAMILIES
from segmentation.cloud import Cloud
from vaultcad.errors import VaultcadError
from vaultcad.pipeline import fit_scan
from vaultcad.pose import tilted
from vaultcad.scanner import draw, scan
from vaultcad.scanner.turned import quarters, turned

FIRST = 60_000  # seed of the first room
POINTS = 150_000
FEW = (3_000, 5_000, 8_000, 20_000, 50_000)  # points that are left of it
LEANING = (1.0, 2.0, 3.0)  # degrees
DEFAULT = 105  # rooms of each kind
ROOM = (label("seed"), text("setting"), text("family"), text("what came of it"))
SETTING = (
    label("setting"),
    number("rooms"),
    count("right", "rooms", "more"),
    count("refused", "rooms", ""),
    count("another", "rooms", "less"),
    number("numbers"),
    share("within", "numbers"),
)
LEAN = (error("median", "°", 2), error("95 % below", "°", 2))

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Outcome:
    """What became of one room. verdict: "right", "refused", "another family". numbers: those with a deviation.

    tilt: error of what is said of the lean [rad].
    """

    seed: int
    family: str
    setting: str
    verdict: str
    told: str = ""
    numbers: list[Number] = field(default_factory=list)
    tilt: float = 0.0


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--limits", type=int, default=DEFAULT, help=f"rooms of each kind (limits), default {DEFAULT}")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """How many are right, and how often the truth is within what is stated, by number of points and by lean."""
    settings = {"rooms": chosen.limits, "points": POINTS, "first seed": FIRST}
    for name, one in (("sparse", sparse), ("leaning", leaning)):
        outcomes: list[Outcome] = []
        rows = _rows(one, chosen, outcomes)
        yield Table(f"{name} rooms", f"{name} rooms that were not all well", settings, ROOM, rows, detail=True)
        yield Table(name, f"{name} rooms", settings, SETTING, _settings(outcomes))
        tilts = np.degrees([o.tilt for o in outcomes if o.verdict == "right"])
        if len(tilts):
            lean = float(np.median(tilts)), float(np.quantile(tilts, 0.95))
            yield Table(f"lean, {name}", "error of what is said of the lean", settings, LEAN, [lean])


def _rows(
    one: Callable[[int], Outcome], chosen: argparse.Namespace, outcomes: list[Outcome]
) -> Iterator[tuple[Figure, ...]]:
    with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
        for o in pool.map(one, range(FIRST, FIRST + chosen.limits)):
            outcomes.append(o)
            if o.verdict != "right" or within(o.numbers).sum() < 0.7 * len(o.numbers):
                yield str(o.seed), o.setting, o.family, f"{o.verdict}: {o.told}"


def _settings(outcomes: Sequence[Outcome]) -> Iterator[tuple[Figure, ...]]:
    for setting in ("all", *dict.fromkeys(o.setting for o in outcomes)):
        mine = [o for o in outcomes if setting in ("all", o.setting)]
        verdicts = (sum(o.verdict == v for o in mine) for v in ("right", "refused", "another family"))
        numbers = [n for o in mine for n in o.numbers]
        yield setting, len(mine), *verdicts, len(numbers), float(within(numbers).mean()) if numbers else None


def sparse(seed: int) -> Outcome:
    """A room of which a few points are left."""
    count = FEW[seed // len(FAMILIES) % len(FEW)]

    def thinned(xyz: Array, rng: np.random.Generator) -> tuple[Array, float]:
        return xyz[rng.permutation(len(xyz))[:count]], 0.0

    return _outcome(seed, f"{count:,} points", thinned)


def leaning(seed: int) -> Outcome:
    """A room that leans."""
    angle = LEANING[seed // len(FAMILIES) % len(LEANING)]

    def tipped(xyz: Array, rng: np.random.Generator) -> tuple[Array, float]:
        way, lean = rng.uniform(0, 2 * pi), radians(angle)
        return xyz @ tilted((lean * np.cos(way), lean * np.sin(way))).T, lean

    return _outcome(seed, f"{angle:g} degrees", tipped)


def _outcome(seed: int, setting: str, change: Callable[[Array, np.random.Generator], tuple[Array, float]]) -> Outcome:
    cls, rng = FAMILIES[seed % len(FAMILIES)], np.random.default_rng(seed)
    while True:
        with suppress(VaultcadError, ValueError):
            vault, settings = draw(cls, rng)
            settings = replace(settings, points=POINTS, origin=(0.0, 0.0, 0.0))
            virtual = scan(vault, settings, rng=rng)
            break
    xyz, lean = change(virtual.xyz.astype(np.float64), rng)
    kind = f"{settings.walls}{', cropped' if settings.crop else ''}"
    try:
        vaults = fit_scan(Cloud(xyz.astype(np.float32))).model.vaults
    except VaultcadError as error:
        return Outcome(seed, cls.id, setting, "refused", f"{error} ({kind})")
    found = min(vaults, key=lambda one: hypot(one.pose.x, one.pose.y))  # the truth stands on the origin
    if found.vault.id != cls.id:
        return Outcome(seed, cls.id, setting, "another family", f"{found.vault.id} {found.confidence:.0%} ({kind})")
    yaw = radians(virtual.truth["pose"]["yaw_deg"])
    quarter = quarters(found.pose.yaw, yaw)
    true = turned(vault, quarter)
    numbers: list[Number] = []
    if true is not None and not lean:
        sizes = {**true[0], "x": 0.0, "y": 0.0, "z": settings.wall_height, "yaw": yaw + quarter * pi / 2}
        numbers = compared(found, sizes)
    elif true is not None:  # the pose leans too
        numbers = [n for n in compared(found, true[0] | dict.fromkeys(("x", "y", "z", "yaw"), 0.0)) if n.kind != "pose"]
    missed = [f"{n.name} {n.error:+.2f} ± {n.std:.2f}" for n in numbers if abs(n.error) > 1.96 * n.std]
    told = f"{found.confidence:.0%} ({kind}), {', '.join(missed)}"
    return Outcome(seed, cls.id, setting, "right", told, numbers, abs(found.pose.tilt - lean))

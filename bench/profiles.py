"""Is the true kind of arch among those that are said, and are rise and springing within what is stated?

Virtual rooms of all families and profiles that have settled by 0 to 5 cm, the family left to be recognised. Rooms whose
family is taken for another are counted apart: their arches are another's.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import hypot, radians
from multiprocessing import get_context

import numpy as np

from bench.figures import Figure, Table, error, label, number, share
from bench.rooms import CURVE, binned
from bench.uncertainty import WITHIN
from families import FAMILIES, Vault
from segmentation.cloud import Cloud
from vaultcad.errors import VaultcadError
from vaultcad.model import said
from vaultcad.pipeline import fit_scan
from vaultcad.scanner import ScannerSettings, VirtualScan, draw, scan
from vaultcad.scanner.turned import quarters, turned

FIRST = 40_000  # seed of the first room
POINTS = 80_000
SETTLED = 0.05  # m, at most
DEFAULT = 300  # rooms
BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0)  # of the chance of the likeliest kind
ARCHES = (
    label("arches", 24),
    number("number"),
    share("likeliest", "number"),
    share("among said", "number"),
    number("said", decimals=2),
    number("alone"),
    share("right alone", "alone"),
)
LENGTHS = (
    label("family"),
    label("length"),
    number("number"),
    share("within", "number"),
    error("error"),
    error("std"),
)


@dataclass(frozen=True)
class Arch:
    """One arch: where it is, its true kind, and how likely the fit takes each kind."""

    place: str
    true: str
    odds: dict[str, float]


@dataclass(frozen=True)
class Outcome:
    """What became of one room. lengths: name -> error and stated standard deviation of rise and springing [m]."""

    seed: int
    family: str
    other: str = ""
    arches: list[Arch] = field(default_factory=list)
    lengths: dict[str, tuple[float, float]] = field(default_factory=dict)


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--settled", type=int, default=DEFAULT, help=f"rooms (profiles), default {DEFAULT}")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """What was said of each arch, by place and by true kind; whether odds hold; rise and springing by family."""
    settings = {"rooms": chosen.settled, "points": POINTS, "first seed": FIRST}
    with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
        outcomes = list(pool.map(one, range(FIRST, FIRST + chosen.settled)))
    reasons = sorted({o.other for o in outcomes if o.other})
    left_out = [f"{sum(o.other == reason for o in outcomes)} left out: {reason}" for reason in reasons]
    title = f"what is said of arches in rooms that settled by 0 to {100 * SETTLED:g} cm"
    arches = [(o.family, arch) for o in outcomes for arch in o.arches]
    yield Table("arches", title, settings, ARCHES, _arches(arches), left_out)
    chances = np.array([max(arch.odds.values()) for _, arch in arches])
    right = np.array([max(arch.odds, key=arch.odds.__getitem__) == arch.true for _, arch in arches], np.bool_)
    yield Table("odds", "does the chance of the likeliest hold?", settings, CURVE, binned(chances, right, BINS))
    yield Table("lengths", "rise and springing; medians", settings, LENGTHS, _lengths(outcomes))


def _arches(arches: list[tuple[str, Arch]]) -> Iterator[tuple[Figure, ...]]:
    if not arches:
        return
    yield _row("all", [arch for _, arch in arches])
    for family, place in dict.fromkeys((family, arch.place) for family, arch in arches):
        yield _row(f"{family} {place}", [arch for own, arch in arches if (own, arch.place) == (family, place)])
    for kind in sorted({arch.true for _, arch in arches}):
        yield _row(f"true {kind}", [arch for _, arch in arches if arch.true == kind])


def _lengths(outcomes: list[Outcome]) -> Iterator[tuple[Figure, ...]]:
    for family in ("all", *(cls.id for cls in FAMILIES)):
        for name in ("rise", "springing"):
            told = [o.lengths[name] for o in outcomes if name in o.lengths and family in ("all", o.family)]
            if told:
                off, std = np.abs(np.array(told)).T
                share_within = float((off <= WITHIN * std).mean())
                yield family, name, len(told), share_within, float(np.median(off)), float(np.median(std))


def one(seed: int) -> Outcome:
    """One room: drawn, scanned, fitted, and compared."""
    cls, rng = FAMILIES[seed % len(FAMILIES)], np.random.default_rng(seed)
    vault, settings, virtual = _scanned(cls, rng)
    try:
        fitted = fit_scan(Cloud(virtual.xyz.astype(np.float32))).model.vaults
    except VaultcadError:
        return Outcome(seed, cls.id, "no vault found")
    nearest = min(fitted, key=lambda found: hypot(found.pose.x, found.pose.y))  # the truth stands on the origin
    if nearest.vault.id != cls.id:
        return Outcome(seed, cls.id, "taken for another family")
    yaw = radians(virtual.truth["pose"]["yaw_deg"])
    true = turned(vault, quarters(nearest.pose.yaw, yaw))
    if true is None:
        return Outcome(seed, cls.id, "turned by a right angle")
    sizes, kinds = true
    odds = {name: dict(nearest.odds.get(name, {kind: 1.0})) for name, kind in nearest.vault.kinds.items()}
    rise = nearest.parameters["rise"]
    spread = {} if nearest.covariance is None else nearest.covariance.stds()
    lengths = {
        "rise": (rise.value - sizes["rise"], rise.std or 0.0),
        "springing": (nearest.pose.z - settings.wall_height, spread.get("z", 0.0)),
    }
    return Outcome(seed, cls.id, "", [Arch(name, kinds[name], odds[name]) for name in kinds], lengths)


def _scanned(cls: type[Vault], rng: np.random.Generator) -> tuple[Vault, ScannerSettings, VirtualScan]:
    """The first room drawn that can be meshed, near the origin."""
    while True:
        with suppress(VaultcadError, ValueError):
            vault, settings = draw(cls, rng)
            moved = replace(settings, points=POINTS, settlement=rng.uniform(0, SETTLED), origin=(0.0, 0.0, 0.0))
            return vault, moved, scan(vault, moved, rng=rng)


def _row(name: str, arches: list[Arch]) -> tuple[Figure, ...]:
    kinds = [said(arch.odds) for arch in arches]
    first = [told[0] == arch.true for told, arch in zip(kinds, arches, strict=True)]
    among = [arch.true in told for told, arch in zip(kinds, arches, strict=True)]
    alone = [told[0] == arch.true for told, arch in zip(kinds, arches, strict=True) if len(told) == 1]
    size = float(np.mean([len(told) for told in kinds]))
    shares = float(np.mean(first)), float(np.mean(among))
    return name, len(arches), *shares, size, len(alone), float(np.mean(alone)) if alone else None

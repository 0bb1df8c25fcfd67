"""Is the true kind of arch among those that are said, and are rise and springing within what is stated?

Virtual rooms of all families and profiles that have settled by 0 to 5 cm, the family left to be recognised. Rooms whose
family is taken for another are counted apart: their arches are another's.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import hypot, radians
from multiprocessing import get_context

import numpy as np

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


def run(chosen: argparse.Namespace) -> None:
    """What was said of each arch, by place and by true kind; whether odds hold; rise and springing by family."""
    print(f"\nprofiles: {chosen.settled} rooms settled by 0 to {100 * SETTLED:g} cm, seeds from {FIRST}")
    with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
        outcomes = list(pool.map(one, range(FIRST, FIRST + chosen.settled)))
    for other in sorted({o.other for o in outcomes if o.other}):
        print(f"{sum(o.other == other for o in outcomes):4} left out: {other}")
    rows = [(o.family, arch) for o in outcomes for arch in o.arches]
    print(
        f"{'arches':28} {'number':>6} {'likeliest':>9} {'among said':>10} {'said':>5} {'alone':>6} {'right alone':>11}"
    )
    _row("all", [arch for _, arch in rows])
    for family, place in dict.fromkeys((family, arch.place) for family, arch in rows):
        _row(f"{family} {place}", [arch for own, arch in rows if (own, arch.place) == (family, place)])
    for kind in sorted({arch.true for _, arch in rows}):
        _row(f"true {kind}", [arch for _, arch in rows if arch.true == kind])
    print("chance of the likeliest   number  stated  right")
    chances = np.array([max(arch.odds.values()) for _, arch in rows])
    right = np.array([max(arch.odds, key=arch.odds.__getitem__) == arch.true for _, arch in rows])
    for low, high in pairwise(BINS):
        mine = (chances > low) & (chances <= high)
        if mine.any():
            print(f"{low:8.0%} to {high:4.0%} {mine.sum():14} {chances[mine].mean():7.1%} {right[mine].mean():6.1%}")
    print(f"{'lengths':28} {'number':>6} {'within':>7} {'|error| m':>10} {'std m':>7}")
    for family in ("all", *(cls.id for cls in FAMILIES)):
        for name in ("rise", "springing"):
            told = [o.lengths[name] for o in outcomes if name in o.lengths and family in ("all", o.family)]
            if told:
                error, std = np.abs(np.array(told)).T
                share = (error <= WITHIN * std).mean()
                figures = f"{len(told):6} {share:7.1%} {np.median(error):10.3f} {np.median(std):7.3f}"
                print(f"{family + ' ' + name:28} {figures}")


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


def _row(name: str, arches: list[Arch]) -> None:
    kinds = [said(arch.odds) for arch in arches]
    first = np.mean([told[0] == arch.true for told, arch in zip(kinds, arches, strict=True)])
    among = np.mean([arch.true in told for told, arch in zip(kinds, arches, strict=True)])
    alone = [told[0] == arch.true for told, arch in zip(kinds, arches, strict=True) if len(told) == 1]
    right = f"{np.mean(alone):11.1%}" if alone else f"{'–':>11}"
    size = np.mean([len(told) for told in kinds])
    print(f"{name:28} {len(arches):6} {first:9.1%} {among:10.1%} {size:5.2f} {len(alone):6} {right}")

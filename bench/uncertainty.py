"""Does the truth lie within the stated deviations? Virtual scans, fitted with their family given.

The truth is the vault before it settled. Deviations allow for other kinds of arches, so that sizes count whatever kind
was drawn, but for those that the true kind has not.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import hypot, pi, radians

import numpy as np
from numpy.typing import NDArray

from families import FAMILIES, Vault
from segmentation.cloud import Cloud
from vaultcad.errors import VaultcadError
from vaultcad.model import FittedVault
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.scanner import draw, scan
from vaultcad.scanner.turned import quarters, turned

FIRST = 7000  # seed of the first scan
POINTS = 80_000
WITHIN = 1.96  # standard deviations of the 95 % of a normal distribution
DEFAULT = 200  # scans


@dataclass(frozen=True)
class Number:
    """One number of a fit: how far it is from the truth, and how far it says it may be, in its unit."""

    family: str
    name: str
    kind: str  # "pose", "parameter" or "derived"
    error: float
    std: float


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--scans", type=int, default=DEFAULT, help=f"virtual scans (uncertainty), default {DEFAULT}")


def run(chosen: argparse.Namespace) -> None:
    """How often the truth is within, by kind of number, family, and name."""
    start = time.process_time()
    numbers, left_out = measure(range(FIRST, FIRST + chosen.scans))
    print(f"\nstated deviations against the truth, {chosen.scans} virtual scans, {POINTS:,} points, family given")
    for reason, count in left_out.items():
        print(f"{count:4} scans left out: {reason}")
    print(f"{'':26} {'numbers':>7} {'within':>7} {'|error|':>9} {'std':>9} {'|error| / std':>14}")
    _row("all", numbers)
    for kind in ("parameter", "derived", "pose"):
        _row(kind, [n for n in numbers if n.kind == kind])
    for family in FAMILIES:
        mine = [n for n in numbers if n.family == family.id]
        _row(family.id, mine)
        for name in dict.fromkeys(n.name for n in mine):
            _row(f"  {name}", [n for n in mine if n.name == name])
    print(f"{time.process_time() - start:.0f} s of processor time; within: of 1.96 std; the other columns are medians")


def measure(seeds: Iterable[int]) -> tuple[list[Number], dict[str, int]]:
    """All numbers of virtual scans over all families in turn, and how many scans are left out, by reason."""
    numbers: list[Number] = []
    left_out: dict[str, int] = {}
    for seed in seeds:
        found = _numbers(FAMILIES[seed % len(FAMILIES)], seed)
        if isinstance(found, str):
            left_out[found] = left_out.get(found, 0) + 1
        else:
            numbers += found
    return numbers, left_out


def _numbers(family: type[Vault], seed: int) -> list[Number] | str:
    """Those of one scan, or why there are none."""
    rng = np.random.default_rng(seed)
    vault, settings = draw(family, rng)
    try:
        virtual = scan(vault, replace(settings, points=POINTS), rng=rng)
    except (VaultcadError, ValueError):
        return "could not be scanned"
    try:
        fitted = fit_scan(Cloud(virtual.xyz.astype(np.float32)), FitSettings(families=(family,))).model.vaults
    except VaultcadError:
        return "refused, as no vault was found"
    nearest = min(fitted, key=lambda one: hypot(one.pose.x, one.pose.y))  # the truth stands on the origin
    yaw = radians(virtual.truth["pose"]["yaw_deg"])
    quarter = quarters(nearest.pose.yaw, yaw)
    true = turned(vault, quarter)
    if true is None:
        return "turned by a right angle"
    sizes = {**true[0], "x": 0.0, "y": 0.0, "z": settings.wall_height, "yaw": yaw + quarter * pi / 2}
    return compared(nearest, sizes)


def compared(fitted: FittedVault, true: dict[str, float]) -> list[Number]:
    """The numbers of a fit that have a deviation, beside the true sizes, of the pose too."""
    spread = {} if fitted.covariance is None else fitted.covariance.stds()
    found = []
    for name in ("x", "y", "z", "yaw"):
        error = getattr(fitted.pose, name) - true[name]
        error -= round(error / (2 * pi)) * 2 * pi if name == "yaw" else 0.0
        found.append(Number(fitted.vault.id, name, "pose", error, spread.get(name, 0.0)))
    for name, estimate in fitted.parameters.items():
        if name not in true:  # of another profile than the true one
            continue
        kind = "derived" if estimate.derived else "parameter"
        found.append(Number(fitted.vault.id, name, kind, estimate.value - true[name], estimate.std or 0.0))
    return [number for number in found if number.std > 0]


def within(numbers: Iterable[Number]) -> NDArray[np.bool_]:
    """Whether the truth lies within the stated 95 % of each."""
    return np.array([abs(n.error) <= WITHIN * n.std for n in numbers], np.bool_)


def _row(name: str, numbers: list[Number]) -> None:
    if numbers:
        error, std = np.abs([n.error for n in numbers]), np.array([n.std for n in numbers])
        middle = np.median(error), np.median(std), np.median(error / std)
        share = f"{within(numbers).mean():7.1%}"
        print(f"{name:26} {len(numbers):7} {share} {middle[0]:9.4f} {middle[1]:9.4f} {middle[2]:14.2f}")

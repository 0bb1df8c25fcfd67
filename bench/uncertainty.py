"""Does the truth lie within the stated deviations? Virtual scans, fitted with their family given.

The truth is the vault before it settled. Deviations allow for other kinds of arches, so that sizes count whatever kind
was drawn, but for those that the true kind has not.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from math import hypot, pi, radians

import numpy as np
from numpy.typing import NDArray

from bench.figures import Figure, Table, error, label, number, share
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
COLUMNS = (
    label("family"),
    label("name"),
    number("numbers"),
    share("within", "numbers"),
    error("error", "", 4),
    error("std", "", 4),
    number("error / std", decimals=2),
)


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


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """How often the truth is within, by kind of number, family, and name."""
    start = time.process_time()
    numbers, left_out = measure(range(FIRST, FIRST + chosen.scans))
    notes = [f"{count} scans left out: {reason}" for reason, count in left_out.items()]
    notes.append(f"{time.process_time() - start:.0f} s of processor time")
    yield Table(
        "deviations",
        f"stated deviations against the truth, family given; within: of {WITHIN} std; the other columns are medians",
        {"scans": chosen.scans, "points": POINTS, "first seed": FIRST},
        COLUMNS,
        _rows(numbers),
        notes,
    )


def _rows(numbers: list[Number]) -> Iterator[tuple[Figure, ...]]:
    yield from _row("all", "all", numbers)
    for kind in ("parameter", "derived", "pose"):
        yield from _row("all", kind, [n for n in numbers if n.kind == kind])
    for family in FAMILIES:
        mine = [n for n in numbers if n.family == family.id]
        yield from _row(family.id, "all", mine)
        for name in dict.fromkeys(n.name for n in mine):
            yield from _row(family.id, name, [n for n in mine if n.name == name])


def _row(family: str, name: str, numbers: list[Number]) -> Iterator[tuple[Figure, ...]]:
    """None where there are no numbers."""
    if numbers:
        off, std = np.abs([n.error for n in numbers]), np.array([n.std for n in numbers])
        middle = (float(np.median(column)) for column in (off, std, off / std))
        yield family, name, len(numbers), float(within(numbers).mean()), *middle


def measure(seeds: Iterable[int], points: int = POINTS) -> tuple[list[Number], dict[str, int]]:
    """All numbers of virtual scans over all families in turn, and how many scans are left out, by reason."""
    numbers: list[Number] = []
    left_out: dict[str, int] = {}
    for seed in seeds:
        found = _numbers(FAMILIES[seed % len(FAMILIES)], seed, points)
        if isinstance(found, str):
            left_out[found] = left_out.get(found, 0) + 1
        else:
            numbers += found
    return numbers, left_out


def _numbers(family: type[Vault], seed: int, points: int) -> list[Number] | str:
    """Those of one scan, or why there are none."""
    rng = np.random.default_rng(seed)
    vault, settings = draw(family, rng)
    try:
        virtual = scan(vault, replace(settings, points=points), rng=rng)
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

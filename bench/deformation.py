"""Is a settlement that was put into a virtual scan read back, and a change between two scans found where there is one?

Rooms of all families whose walls spread: the crown falls by 3 cm and the springings part by 2 cm. Once with the design
that a survey may know besides (the kinds of the arches, the level of the springing, all rises), once with nothing. The
truth of a figure is the movement at the places where it was read.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product
from math import pi
from multiprocessing import get_context

import numpy as np
from numpy.typing import NDArray

from bench.figures import Figure, Table, count, error, label, number, share
from families import FAMILIES, Vault
from segmentation.cloud import Cloud
from vaultcad.change.places import Sights, places, readings
from vaultcad.change.two_dates import ScanChange, compare_scans
from vaultcad.errors import VaultcadError
from vaultcad.mechanisms import Body
from vaultcad.model import FittedVault
from vaultcad.pipeline import FitSettings, fit_scan
from vaultcad.scanner import draw, scan
from vaultcad.scanner.scan import FOOTING
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.settle import DeclaredSettlement

FIRST = 4000  # seed of the first room
POINTS = 250_000  # as `bench.rooms` has by default
FALL, SPREAD = 0.03, 0.02  # m
CHANGE = 0.01  # m, by which a crown falls between two scans
CLOSE = 0.003  # m
DEFAULT = 100  # rooms
FIGURES = ("crown settlement", "spread along x", "spread along y")
KNOWN = ("kinds, springing and rises", "nothing")
WEBS = {False: "", True: ", pliant webs"}  # of which a reading says that its figures are hints
READ = (
    label("known", 42),
    label("figure", 18),
    number("rooms"),
    count("unread", "rooms", "less"),
    share("within limits", "rooms"),
    share("within 3 mm", "rooms"),
    error("error", "mm", 1),
    error("limit", "mm", 1),
)
TWO = (
    label("change", 22),
    number("rooms"),
    share("told rightly", "rooms"),
    error("error of the crown", "mm", 1),
    share("within limits", "rooms"),
    error("detectable", "mm", 1),
    count("failed", "rooms", "less"),
)


@dataclass(frozen=True)
class Read:
    """One figure of one room: its error and its limit [m]. pliant: whether its webs take up a movement."""

    pliant: bool
    known: str
    figure: str
    error: float
    limit: float


@dataclass(frozen=True)
class Compared:
    """One pair of scans: whether a change was reported, the crown's error and limit, and what is detectable [m]."""

    change: float
    changed: bool
    error: float
    limit: float
    detectable: float


def options(parser: argparse.ArgumentParser) -> None:
    """Those of this benchmark."""
    parser.add_argument("--moved", type=int, default=DEFAULT, help=f"rooms (deformation), default {DEFAULT}")


def run(chosen: argparse.Namespace) -> Iterator[Table]:
    """Figures read back, by what was known; pairs of scans without and with a change."""
    settings = {"rooms": chosen.moved, "points": POINTS, "first seed": FIRST}
    seeds = range(FIRST, FIRST + chosen.moved)
    with ProcessPoolExecutor(chosen.workers, get_context("spawn")) as pool:
        found = [row for rows in pool.map(read_back, seeds) for row in rows]
        pairs = [pair for pair in pool.map(compared, seeds) if pair]
    title = f"a crown that fell by {1000 * FALL:g} mm, springings {1000 * SPREAD:g} mm apart, read back; medians"
    yield Table("read back", title, settings, READ, _read(found, seeds))
    yield Table("two dates", "two scans of one vault", settings, TWO, _two([p for both in pairs for p in both], pairs))


def _read(found: list[Read], seeds: range) -> Iterator[tuple[Figure, ...]]:
    for pliant, known, figure in product(WEBS, KNOWN, FIGURES):
        mine = [one for one in found if (one.pliant, one.known, one.figure) == (pliant, known, figure)]
        if mine:
            off, limit = np.array([(abs(one.error), one.limit) for one in mine]).T
            shares = float((off <= limit).mean()), float((off <= CLOSE).mean())
            unread = sum(_family(seed).pliant == pliant for seed in seeds) - len(mine)
            medians = (1000 * float(np.median(column)) for column in (off, limit))
            yield known + WEBS[pliant], figure, len(mine), unread, *shares, *medians


def _two(pairs: list[Compared], rooms: list[list[Compared]]) -> Iterator[tuple[Figure, ...]]:
    for change in (0.0, CHANGE):
        mine = [pair for pair in pairs if pair.change == change]
        if mine:
            right = float(np.mean([pair.changed == (change > 0) for pair in mine]))
            off, limit = np.array([(abs(pair.error), pair.limit) for pair in mine if np.isfinite(pair.error)]).T
            within = float(np.mean(off <= limit))
            middle = 1000 * float(np.median(off)), within, 1000 * float(np.median([pair.detectable for pair in mine]))
            name = f"crown {-1000 * change:g} mm" if change else "none"
            yield name, len(mine), right, *middle, sum(len(room) < 2 for room in rooms)


def _family(seed: int) -> type[Vault]:
    """Families by turns."""
    return FAMILIES[seed % len(FAMILIES)]


def room(seed: int) -> tuple[Vault, ScannerSettings]:
    """A vault on walls and how it is scanned."""
    rng = np.random.default_rng(seed)
    vault, drawn = draw(_family(seed), rng)
    settings = ScannerSettings(
        points=POINTS, settlement=0.0, noise=drawn.noise, yaw=rng.uniform(-0.7, 0.7), stations=max(2, drawn.stations)
    )
    return vault, settings


def read_back(seed: int) -> list[Read]:
    """The figures of one room, by what was known."""
    vault, still = room(seed)
    settings = replace(still, crown_fall=FALL, spread_x=SPREAD, spread_y=SPREAD)
    with suppress(VaultcadError, ValueError):
        virtual = scan(vault, settings, rng=np.random.default_rng(seed))
        cloud = Cloud(virtual.xyz.astype(np.float32), stations=virtual.stations)
        free = fit_scan(cloud, FitSettings(families=(type(vault),))).model.vaults[0]
        turned = round((free.pose.yaw - settings.yaw) / (pi / 2)) % 2 == 1
        found = list(_compared(KNOWN[1], free, vault, settings))
        with suppress(VaultcadError, ValueError):
            given = FitSettings(families=(type(vault),), fix=design(vault, settings, turned))
            held = fit_scan(cloud, given).model.vaults[0]
            found = [*_compared(KNOWN[0], held, vault, settings), *found]
        return found
    return []


def design(vault: Vault, settings: ScannerSettings, turned: bool) -> dict[str, float | str]:
    """Kinds, springing and rises as they are to be held in a fit whose x axis is the vault's own, or its y axis."""
    levels, made = {**vault.ratios, **vault.held}, vault.derived_values()
    rises = {name: made[name] for name, by in levels.items() if "rise" in name and by in vault.values()}
    own: dict[str, float | str] = {**vault.kinds, **rises}
    named = {_other_axis(name): value for name, value in own.items()} if turned else own
    return {**named, "springing": settings.wall_height}


def _other_axis(name: str) -> str:
    """rise_x -> rise_y and back; others stay."""
    return name[:-1] + {"x": "y", "y": "x"}[name[-1]] if name.endswith(("_x", "_y")) else name


def _compared(known: str, fitted: FittedVault, vault: Vault, settings: ScannerSettings) -> Iterator[Read]:
    if fitted.deformation is None or (built := fitted.deformation.of("built")) is None:
        return
    true = truth(fitted, vault, settings)
    for name in FIGURES:
        movement = built.movement(name)
        if movement is not None and name in true:
            yield Read(vault.pliant, known, name, movement.value - true[name], movement.limit)


def truth(fitted: FittedVault, vault: Vault, settings: ScannerSettings) -> dict[str, float]:
    """What a vault has truly moved by [m], at the places where the figures of its fit are read, by their names."""
    wanted = readings(fitted.vault, Body.of(fitted.vault, settings.wall_height), Sights())
    at, placement = places(wanted), fitted.pose.placement()
    c, s = np.cos(settings.yaw), np.sin(settings.yaw)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    there = (at.place @ placement[:3, :3].T + placement[:3, 3] - [0.0, 0.0, settings.wall_height]) @ turn
    depth = min(FOOTING, settings.wall_height)
    moved = DeclaredSettlement.of(settings, vault.plan, vault.top, depth)(there)
    ways = at.way @ placement[:3, :3].T @ turn
    sums: NDArray[np.float64] = at.sums((moved * ways).sum(axis=1)[:, None])[:, 0]
    return {one.name: float(value) for one, value in zip(wanted, sums, strict=True)}


def compared(seed: int) -> list[Compared]:
    """Two pairs of scans of one room: without a change, and with one; the second scan stands elsewhere."""
    found = []
    vault, drawn = room(seed)
    if not vault.plan.holds(np.zeros((1, 2)))[0]:  # no crown over the middle, which is what falls
        return []
    before = replace(drawn, settlement=0.02)
    rng = np.random.default_rng(seed + 1)
    with suppress(VaultcadError, ValueError):
        first = scan(vault, before, rng=np.random.default_rng(seed))
        model = fit_scan(Cloud(first.xyz.astype(np.float32)), FitSettings(families=(type(vault),))).model
        for change in (0.0, CHANGE):
            points = int(POINTS * rng.uniform(0.7, 1.4))
            after = replace(before, crown_fall=change, points=points, visit=1)
            second = scan(vault, after, rng=np.random.default_rng(seed))
            turn, shift = rng.uniform(-0.02, 0.02), rng.uniform(-0.05, 0.05, 3)
            c, s = np.cos(turn), np.sin(turn)
            moved = second.xyz @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T + shift
            with suppress(VaultcadError):
                found.append(_pair(compare_scans(model, first.xyz, moved), change))
    return found


def _pair(told: ScanChange, change: float) -> Compared:
    one = told.vaults[0]
    crown = next((m for m in one.movements if m.name == FIGURES[0]), None)
    value, limit = (crown.value, crown.limit) if crown else (np.nan, np.nan)
    return Compared(change, any(v.changed for v in told.vaults), value - change, limit, one.cells.detectable)

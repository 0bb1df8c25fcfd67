"""What the vaults of a model are to one another: bays in rows, rooms, storeys."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import cos, nan, radians

import numpy as np
from numpy.typing import NDArray

from vaultcad.model import Assembly, FittedArch, PlacedVault

Array = NDArray[np.float64]

IN_LINE = cos(radians(25))  # of the ways to both neighbours, from which on a row goes straight through a bay
ALIKE = 0.15  # by which bays of a row differ in their width across it and in their rise at most, as a share
AS_LONG = 0.35  # and along it: the stairs or the door of a crypt take from its first bay, not from its width
OVER = 0.3  # share of the smaller plan that two vaults of two storeys have in common at least
PROBES = 24  # along each side of a plan, where it is compared with another


@dataclass(frozen=True)
class Building:
    """Vaults by their numbers, from 1.

    rows: neighbours as wide and as high in line, joined by arches, each in the order of its bays, from west to east or
    south to north; the longest first, those as long likewise. rooms: what arches join. storeys: from below, each with
    its floor in the scan's local frame [m]; that of the lowest is not known: NaN.
    """

    rows: tuple[tuple[int, ...], ...]
    rooms: tuple[tuple[int, ...], ...]
    storeys: tuple[tuple[int, ...], ...]
    floors: tuple[float, ...]

    def bay(self, vault: int) -> tuple[str, int]:
        """The row of a vault and its place in it, from 1.

        >>> Building(((2, 3), (1,)), ((1, 2, 3),), ((1, 2, 3),), (nan,)).bay(3)
        ('A', 2)
        """
        return next((letters(k), row.index(vault) + 1) for k, row in enumerate(self.rows) if vault in row)

    def name(self, vault: int) -> str:
        """In words: row A bay 2."""
        row, place = self.bay(vault)
        return f"row {row} bay {place}"

    def room(self, vault: int) -> int:
        """The number of its room, from 1."""
        return next(k for k, room in enumerate(self.rooms, 1) if vault in room)

    def storey(self, vault: int) -> int:
        """The number of its storey, from 1 for the lowest."""
        return next(k for k, storey in enumerate(self.storeys, 1) if vault in storey)

    def storey_of_arch(self, arch: PlacedVault) -> int:
        """That of the lower vault beside it; the lowest if there is none."""
        beside = arch.beside if isinstance(arch, FittedArch) else ()
        return min((self.storey(k) for k in beside if k), default=1)


def letters(k: int) -> str:
    """What the k-th row is called, from 0.

    >>> letters(0), letters(25), letters(26)
    ('A', 'Z', 'AA')
    """
    return (letters(k // 26 - 1) if k >= 26 else "") + chr(ord("A") + k % 26)


def building_of(model: Assembly) -> Building:
    """Rows, rooms and storeys of a model, or of vaults that were drawn, which nothing joins."""
    arches = [arch for arch in model.arches if isinstance(arch, FittedArch)]
    joined = sorted({(min(a.beside), max(a.beside)) for a in arches if _joins(a, len(model.vaults))})
    numbers = range(1, len(model.vaults) + 1)
    storeys = _storeys(model.vaults)
    floors = [nan]
    for storey in storeys[:-1]:
        below = [model.vaults[k - 1] for k in storey]
        floors.append(max(v.pose.z + v.vault.top + model.thickness_of(v) for v in below))
    return Building(_rows(model.vaults, joined), _groups(numbers, joined), storeys, tuple(floors))


def _joins(arch: FittedArch, vaults: int) -> bool:
    one, other = arch.beside
    return 0 < one <= vaults and 0 < other <= vaults and one != other


def _groups(numbers: Iterable[int], joined: Sequence[tuple[int, int]]) -> tuple[tuple[int, ...], ...]:
    """Numbers in groups that hang together, each in order, that with the lowest first."""
    group = {k: {k} for k in numbers}
    for one, other in joined:
        if group[one] is not group[other]:
            group[one] |= group[other]
            for k in group[other]:
                group[k] = group[one]
    return tuple(sorted({tuple(sorted(members)) for members in group.values()}))


def _rows(vaults: Sequence[PlacedVault], joined: Sequence[tuple[int, int]]) -> tuple[tuple[int, ...], ...]:
    """The longest chain of neighbours alike in line is a row, then the longest of what is left, and so on."""
    left = set(range(1, len(vaults) + 1))
    links = [(a, b) for a, b in joined if _are_alike(vaults[a - 1], vaults[b - 1])]
    rows = []
    while left:  # of chains as long the one with the lowest numbers
        here = [link for link in links if left.issuperset(link)]
        chains = [_chain(vaults, link, here) for link in here] or [(min(left),)]
        rows.append(_in_order(vaults, max(chains, key=lambda chain: (len(chain), [-k for k in sorted(chain)]))))
        left -= set(rows[-1])
    return tuple(sorted(rows, key=lambda row: (-len(row), _place_across(vaults, row, rows[0]), row)))


def _place_across(vaults: Sequence[PlacedVault], row: tuple[int, ...], first: tuple[int, ...]) -> float:
    """How far the middle of a row is north [m], or east where the first row runs from south to north."""
    x, y = _way(vaults, first[0], first[-1]) if len(first) > 1 else (1.0, 0.0)
    north = np.array([-y, x]) if x >= abs(y) else np.array([y, -x])
    return float(north @ np.mean([(vaults[k - 1].pose.x, vaults[k - 1].pose.y) for k in row], axis=0))


def _are_alike(one: PlacedVault, other: PlacedVault) -> bool:
    """Whether two neighbours are of one family, about as high, and as wide across the way from one to the other."""
    if one.vault.id != other.vault.id:
        return False
    way = _way((one, other), 1, 2)
    sizes = [(*_extents(placed, way), placed.vault.derived_values()["rise"]) for placed in (one, other)]
    limits = (AS_LONG, ALIKE, ALIKE)
    return all(abs(a - b) <= limit * max(a, b) for a, b, limit in zip(*sizes, limits, strict=True))


def _extents(placed: PlacedVault, way: Array) -> tuple[float, float]:
    """How far a plan reaches along a direction (2,) and across it [m]."""
    outline = placed.vault.plan.outline() @ placed.pose.placement()[:2, :2].T
    return float(np.ptp(outline @ way)), float(np.ptp(outline @ [-way[1], way[0]]))


def _chain(vaults: Sequence[PlacedVault], link: tuple[int, int], links: Sequence[tuple[int, int]]) -> tuple[int, ...]:
    """The bays that follow in line from a link at both ends."""
    chain = list(link)
    for _ in range(2):
        while (after := _after(vaults, chain, links)) is not None:
            chain.append(after)
        chain.reverse()
    return tuple(chain)


def _after(vaults: Sequence[PlacedVault], chain: list[int], links: Sequence[tuple[int, int]]) -> int | None:
    """The bay that goes on straightest behind the last of a chain."""
    last, way = chain[-1], _way(vaults, chain[-2], chain[-1])
    ahead = {b if a == last else a for a, b in links if last in {a, b}} - set(chain)
    straight = {k: float(way @ _way(vaults, last, k)) for k in sorted(ahead)}
    best = max(straight, key=lambda k: straight[k], default=None)
    return best if best is not None and straight[best] > IN_LINE else None


def _way(vaults: Sequence[PlacedVault], one: int, other: int) -> Array:
    """Unit vector (2,) in plan from one vault to another."""
    a, b = (vaults[k - 1].pose for k in (one, other))
    way: Array = np.array([b.x - a.x, b.y - a.y])
    return way / max(float(np.hypot(*way)), 1e-9)


def _in_order(vaults: Sequence[PlacedVault], chain: tuple[int, ...]) -> tuple[int, ...]:
    """From west to east, or, if it runs rather that way, from south to north."""
    first, last = (vaults[k - 1].pose for k in (chain[0], chain[-1]))
    x, y = last.x - first.x, last.y - first.y
    return chain[::-1] if (x if abs(x) >= abs(y) else y) < 0 else chain


def _storeys(vaults: Sequence[PlacedVault]) -> tuple[tuple[int, ...], ...]:
    """A vault that lies over another is a storey above it; from below. Others are where they spring about as high."""
    order = sorted(range(len(vaults)), key=lambda k: (vaults[k].pose.z, k))
    pairs = [(low, high) for low, high in combinations(order, 2) if _is_over(vaults[high], vaults[low])]
    if not pairs:
        return (tuple(range(1, len(vaults) + 1)),)
    level: dict[int, int] = {}
    for k in (k for k in order if any(k in pair for pair in pairs)):
        level[k] = max((level[low] + 1 for low, high in pairs if high == k), default=0)
    springs = {n: np.mean([vaults[k].pose.z for k in level if level[k] == n]) for n in set(level.values())}
    for k in (k for k in order if k not in level):
        level[k] = min(springs, key=lambda n: (abs(springs[n] - vaults[k].pose.z), n))
    return tuple(tuple(k + 1 for k in sorted(level) if level[k] == n) for n in sorted(springs))


def _is_over(high: PlacedVault, low: PlacedVault) -> bool:
    """Whether a vault springs above the crown of another, and covers much of the same ground."""
    if high.pose.z < low.pose.z + low.vault.top:
        return False
    small, large = sorted((high, low), key=lambda placed: placed.vault.plan.area)
    places = _probes(small)
    frame, here = large.pose.frame(), small.pose.placement()
    there = places @ here[:2, :2].T + here[:2, 3]
    inside = large.vault.plan.holds((there - [large.pose.x, large.pose.y]) @ frame[:2, :2].T)
    return bool(inside.mean() > OVER)


def _probes(placed: PlacedVault) -> Array:
    """Places (n, 2) all over a plan, in the vault's frame."""
    low, high = placed.vault.plan.box
    x, y = (np.linspace(a, b, PROBES + 2)[1:-1] for a, b in zip(low, high, strict=True))
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return grid[placed.vault.plan.holds(grid)]

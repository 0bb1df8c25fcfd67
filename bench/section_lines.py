"""How near are section lines to the stone? Ours along the model, ours without one, and a concave hull as the paper's.

Noisy points of ideal vaults that have settled, with clutter, where the true line is known: the settled surface, cut.
"""

from __future__ import annotations

from collections.abc import Iterator
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from bench.figures import Figure, clock, error, label, number
from families import FAMILIES, Vault
from families.void.upright import Upright
from vaultcad.scanner.settle import Settlement, draw_settlement
from vaultcad.sections.cut import profile, stations
from vaultcad.sections.free_profile import free_profile
from vaultcad.sections.guide import STEEPEST, guides
from vaultcad.sections.planes import genesis_planes

Floats = NDArray[np.float64]

FIRST = 71_000  # seed of the first vault
NOISE, SETTLED = 0.003, 0.03  # m
POINTS = 400_000  # of a vault
SLAB, GRID = 0.03, 0.02  # m
CLUTTER = 0.02  # share of the points that hang in the room below the vault
HULL_RATIO = 0.02  # of shapely's concave hull: as tight as one of the paper's grid
FAR = 0.06  # m, of the settled surface's samples from the plane
ROUNDS = 4  # of bringing a point back to where it was

COLUMNS = (
    label("family"),
    number("sections"),
    error("model, median", "mm", 2),
    error("model, 95 %", "mm", 2),
    error("free, median", "mm", 2),
    error("free, 95 %", "mm", 2),
    error("hull, median", "mm", 2),
    error("hull, 95 %", "mm", 2),
    number("within 2 std", "", 2),
    clock("time", "ms", 1),
)


def rows() -> Iterator[tuple[Figure, ...]]:
    """By family, of all its sections together."""
    whole: list[tuple[list[Floats], float]] = []
    for k, cls in enumerate(FAMILIES):
        found = list(_sections(cls(), np.random.default_rng(FIRST + k)))
        whole += found
        yield _row(cls.id, found)
    yield _row("all", whole)


def _row(name: str, found: list[tuple[list[Floats], float]]) -> tuple[Figure, ...]:
    joined = [np.concatenate([one[0][k] for one in found]) for k in range(4)]
    errors = [1000 * float(np.quantile(off, share)) for off in joined[:3] for share in (0.5, 0.95)]
    return name, len(found), *errors, float((joined[3] < 2).mean()), 1000 * float(np.mean([one[1] for one in found]))


def _sections(vault: Vault, rng: np.random.Generator) -> Iterator[tuple[list[Floats], float]]:
    """Of each upright section the distances of the three lines from the true one, errors by std, and the time."""
    sample = vault.sample(POINTS, rng)
    settlement = draw_settlement(sample.xyz[:5000], vault.plan, 1.5, SETTLED, rng)
    scanned = sample.xyz + settlement(sample.xyz) + rng.normal(0, NOISE, len(sample.xyz))[:, None] * sample.normals
    hanging = rng.random(len(scanned)) < CLUTTER
    scanned[hanging, 2] *= rng.uniform(0.3, 0.95, int(hanging.sum()))
    for plane in genesis_planes(vault):
        cut = plane.cut
        if not isinstance(cut, Upright):
            continue
        _, along = guides(vault, cut)
        points = scanned[np.abs(cut.off(scanned)) < SLAB]
        for guide in along:
            began = perf_counter()
            on = points[np.abs(vault.distance(points)) < FAR]  # as labelled
            runs = profile(guide, stations(vault, cut, guide, on, GRID), GRID)
            took = perf_counter() - began
            if not runs:
                continue
            ours, std = np.concatenate([run.line for run in runs]), np.concatenate([run.std for run in runs])
            drawn = cut.drawn(points)
            room = np.array([guide.at[:, 0].mean(), guide.at[:, 1].min()])
            free = free_profile(drawn, cut.off(points), room, GRID)
            hull = _hull(cut.drawn(on), room)
            off = [_apart(vault, cut, settlement, line) for line in (ours, free, hull)]
            yield [*off, off[0] / np.maximum(std, 1e-6)], took


def _apart(vault: Vault, cut: Upright, settlement: Settlement, drawn: Floats) -> Floats:
    """Distances (n,) [m] within the plane of drawn points (n, 2) from the settled surface.

    Each is brought back to where it would be at the ideal vault, of which distances are known everywhere.
    """
    at = cut.placed(drawn)
    back = at
    for _ in range(ROUNDS):
        back = at - settlement(back)
    surface = vault.evaluate(back)
    within = np.sqrt(np.maximum(1 - (surface.normal[:, :2] @ np.array(cut.normal)) ** 2, 0.0))
    return np.asarray(np.abs(surface.distance) / np.maximum(within, STEEPEST), np.float64)


def _hull(drawn: Floats, room: Floats) -> Floats:
    """The side towards the room of a concave hull about points on a grid, as the paper draws it."""
    import shapely

    cells = np.unique(np.round(drawn / GRID).astype(int), axis=0) * GRID
    hull = shapely.concave_hull(shapely.MultiPoint(cells), ratio=HULL_RATIO)
    edge = shapely.get_coordinates(shapely.segmentize(hull, GRID / 2))
    away = edge - room
    bins = np.round(np.arctan2(away[:, 1], away[:, 0]) * np.median(np.hypot(*away.T)) / GRID).astype(int)
    order = np.lexsort((np.hypot(*away.T), bins))
    first = np.unique(bins[order], return_index=True)[1]
    return np.asarray(edge[order][first], np.float64)

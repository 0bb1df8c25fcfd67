"""What stands and hangs in the room and hides some of the vault: tie rods, lamp, furniture, cornice, scaffold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from families import Vault
from vaultcad.scanner.places import middle_line
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.triangles import Triangles, box, prism, tube
from vaultcad.scanner.walls import any_of, walls_of

Array = NDArray[np.float64]

IRON, BRASS, STUCCO, STEEL = 0.15, 0.35, 0.6, 0.3  # reflectance
CLEAR = 0.4  # nothing stands nearer to the scanner [m]
HEADROOM = 2.3  # the lamp hangs no lower above the floor [m]


def furnish(vault: Vault, settings: ScannerSettings, stations: Array, rng: np.random.Generator) -> list[Triangles]:
    """All that the settings ask for, in the vault's frame [m]; keeps clear of `stations` (k, 3)."""
    rods = _tie_rods(vault, settings, rng)
    lamp = _lamp(vault, settings, rng) if settings.lamp else []
    boxes = _furniture(vault, settings, stations, rng)
    scaffold = _scaffold(vault, settings, stations, rng) if settings.scaffold else []
    return [*rods, *lamp, *boxes, *scaffold, *(_cornice(vault) if settings.cornice else [])]


def _tie_rods(vault: Vault, settings: ScannerSettings, rng: np.random.Generator) -> list[Triangles]:
    """Rods from wall to wall along x, a hand above the springing; between piers they stay the arches."""
    count, (a, b) = settings.tie_rods, (vault.plan.half_x, vault.plan.half_y)
    along = np.linspace(-1, 1, count) if settings.walls == "piers" else (2 * np.arange(count) + 1) / max(count, 1) - 1
    rods = []
    for y in along * b:
        z, radius = rng.uniform(0.02, 0.12), rng.uniform(0.011, 0.018)
        rods.append(tube([-a, y, z], [a, y, z], (radius, radius), IRON))
    return rods


def _lamp(vault: Vault, settings: ScannerSettings, rng: np.random.Generator) -> list[Triangles]:
    """A shade on a chain near the middle, about the springing or as high as the headroom asks."""
    x, y = middle_line(vault.plan, [0.5])[0] + rng.uniform(-0.08, 0.08, 2) * vault.plan.half
    crown = _height_of(vault, x, y)
    bottom = min(max(rng.uniform(-0.4, 0.1), HEADROOM - settings.wall_height), crown - 0.5)
    radius, height = rng.uniform(0.18, 0.4), rng.uniform(0.2, 0.35)
    return [
        tube([x, y, bottom], [x, y, bottom + height], (radius, 0.006), BRASS),
        tube([x, y, bottom + height], [x, y, crown + 0.1], (0.006, 0.006), IRON, sides=6),
    ]


def _height_of(vault: Vault, x: float, y: float) -> float:
    """Height of the intrados over a point of the plan [m], to a centimetre."""
    reach = vault.plan.half_x + vault.plan.half_y
    z = np.arange(0.0, 10 * reach, 0.01)
    inside = vault.distance(np.column_stack([np.full_like(z, x), np.full_like(z, y), z])) < 0
    return float(z[np.argmin(inside)])


def _furniture(vault: Vault, settings: ScannerSettings, stations: Array, rng: np.random.Generator) -> list[Triangles]:
    """Boxes against the walls; one that would come too near to a station is left out."""
    walls, floor = walls_of(vault.plan), -settings.wall_height
    parts = []
    for _ in range(settings.furniture):
        wall = any_of(walls, rng)
        width, depth, height = rng.uniform(0.6, 1.8), rng.uniform(0.3, 0.6), rng.uniform(0.6, 2.1)
        bright = rng.uniform(0.15, 0.5)
        middle = rng.uniform(-1, 1) * max(0.0, wall.half_length - width / 2)
        ends = (middle - width / 2, middle + width / 2)
        corners = np.array([wall.at(along, -d) for along in ends for d in (0.02, 0.02 + depth)])
        if _clear(corners.min(axis=0), corners.max(axis=0), stations):
            top = floor + min(height, 0.8 * settings.wall_height)
            parts.append(prism(corners, (floor, top), float(bright)))
    return parts


def _scaffold(vault: Vault, settings: ScannerSettings, stations: Array, rng: np.random.Generator) -> list[Triangles]:
    """A tower of four standards with a platform under the vault and rails; where a station leaves room."""
    size, floor = np.array([rng.uniform(0.7, 0.9), rng.uniform(1.3, 2.0)]), -settings.wall_height
    half = np.array([vault.plan.half_x, vault.plan.half_y])
    deck = max(-rng.uniform(0.7, 1.6), floor + 0.5)
    for _ in range(20):
        low = rng.uniform(-0.8, 0.8, 2) * half - size / 2
        high = low + size
        if (np.abs([low, high]) < 0.9 * half).all() and _clear(low, high, stations):
            break
    else:
        return []
    parts = [box([*low, deck - 0.05], [*high, deck], STEEL)]
    corners = [(x, y) for x in (low[0], high[0]) for y in (low[1], high[1])]
    parts += [tube([x, y, floor], [x, y, deck + 1.0], (0.024, 0.024), STEEL) for x, y in corners]
    for z in (deck + 0.5, deck + 1.0):
        for p, q in ((0, 1), (1, 3), (3, 2), (2, 0)):
            parts.append(tube([*corners[p], z], [*corners[q], z], (0.024, 0.024), STEEL))
    return parts


def _clear(low: Array, high: Array, stations: Array) -> bool:
    """Whether every station is at least `CLEAR` from a box in plan."""
    outside = np.maximum(np.maximum(low[:2] - stations[:, :2], stations[:, :2] - high[:2]), 0)
    return bool((np.linalg.norm(outside, axis=1) >= CLEAR).all())


def _cornice(vault: Vault) -> list[Triangles]:
    """Two fillets along all walls, just below the springing."""
    walls = [wall for pair in walls_of(vault.plan) for wall in pair]
    fillets = ((0.06, (-0.22, -0.12)), (0.14, (-0.12, -0.02)))
    return [part for out, levels in fillets for wall in walls for part in wall.bar((-out, out), levels, STUCCO)]

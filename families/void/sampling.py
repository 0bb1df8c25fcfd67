"""Points spread evenly over the intrados of a vault, exactly on it."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from families.declaration.pieces import BarrelPart, Piece
from families.declaration.vault import Vault
from families.void.sampling_strips import Strip, strips

Array = NDArray[np.float64]
GOLDEN = (sqrt(5) - 1) / 2
PILOT = 40_000  # points that tell how much of all strips shows
EXACT_POINT = 1e-9  # [m]
PROBE = 1e-6  # [m] into the stone, where the distance must be that


@dataclass(frozen=True)
class Sample:
    """Points (n, 3) [m], unit normals (n, 3) into the room, and components (n,), 1 + index in the vault's."""

    xyz: Array
    normals: Array
    component: NDArray[np.uint16]

    def __len__(self) -> int:
        """Number of points."""
        return len(self.xyz)


def sample(vault: Vault, count: int, rng: np.random.Generator) -> Sample:
    """`count` points, even by area: each strip of surface carries one lattice of the golden ratio.

    On equal-area coordinates of a strip the points are (i / n, frac(i φ)), which leaves no clumps and no gaps at any
    proportion of its sides, as the golden ratio is the number that fractions approach worst (Swinbank and Purser 2006,
    González 2010, for the sphere). `rng` shifts the
    lattices, and drops the few points above `count`.

    Raises:
        ValueError: `count` is below 1.
    """
    if count < 1:
        raise ValueError(f"{count} points asked for; at least 1 is needed")
    surfaces = _surfaces(vault)
    share = len(_lay(vault, surfaces, PILOT, rng)) / PILOT
    wanted = 1.002 * count / share  # the pilot is not exact, and a second pass costs more than a few points to drop
    while len(xyz := _lay(vault, surfaces, int(wanted) + 1, rng)) < count:
        wanted *= 1.005
    return _described(vault, xyz[np.sort(rng.permutation(len(xyz))[:count])])


def sample_spacing(vault: Vault, spacing: float, rng: np.random.Generator) -> Sample:
    """As many points as a square grid of that spacing [m] would have, spread as by `sample`.

    Raises:
        ValueError: the spacing is not above 0.
    """
    if not spacing > 0:
        raise ValueError(f"spacing = {spacing:g} m must be above 0")
    surfaces = _surfaces(vault)
    area = sum(strip.area for strip, _ in surfaces)
    return _described(vault, _lay(vault, surfaces, int(area / spacing**2) + 1, rng))


def _surfaces(vault: Vault) -> list[tuple[Strip, Piece]]:
    plan = vault.plan
    return [
        (strip, piece)
        for piece in vault.pieces()
        for part in piece.parts
        for strip in strips(part, plan, 0.0 if isinstance(part, BarrelPart) else piece.foot or 0.0)
    ]


def _lay(vault: Vault, surfaces: list[tuple[Strip, Piece]], total: int, rng: np.random.Generator) -> Array:
    """About `total` points (n, 3) over all strips, of which those are left that show."""
    density = total / sum(strip.area for strip, _ in surfaces)
    found = [_shown(vault, strip, piece, density * strip.area, rng) for strip, piece in surfaces]
    return np.concatenate(found)


def _shown(vault: Vault, strip: Strip, piece: Piece, count: float, rng: np.random.Generator) -> Array:
    first, turn = rng.random(2)
    i = np.arange(int(count - first) + 1 if count > first else 0)
    xyz, normal = strip.lay((i + first) / count, (i * GOLDEN + turn) % 1.0)
    beyond = vault.plan.distance(xyz[:, :2])
    inside = (beyond <= EXACT_POINT) & (xyz[:, 2] >= 0)
    if piece.foot is not None:  # below that the walls on the plan's edge are the plan's
        inside = (xyz[:, 2] >= piece.foot) | inside & (beyond < -EXACT_POINT)
    xyz, normal = xyz[inside], normal[inside]
    # The distance just behind the surface tells whether there is stone, not another piece of the void.
    shown = np.abs(vault.distance(xyz + PROBE * normal) - PROBE) < strip.probe_miss
    found: Array = xyz[shown]
    return found


def _described(vault: Vault, xyz: Array) -> Sample:
    here = vault.evaluate(xyz)
    return Sample(xyz, -here.normal, here.component)

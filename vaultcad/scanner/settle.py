"""How masonry settles: one smooth displacement of space, so that what meets before still meets after.

Two parts are added, each with its own random share. The springings spread outwards and the crown comes down, as vaults
do whose walls have given way (Heyman, "The stone skeleton", 1995); and all of it undulates by low waves, no shorter
than the shorter span. Below the springing the field fades to nothing within `depth`, so that the walls lean and the
floor stays. It is scaled to a largest displacement over the vault. Beside it a settlement can be declared, each of its
mechanisms with its own size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from families.declaration.plan import Plan
from vaultcad.scanner.settings import ScannerSettings
from vaultcad.scanner.waves import Waves, draw_waves

Array = NDArray[np.float64]

MODES = 5  # waves an axis: few, as settlement is smooth
LONGEST_WAVE = 3.0  # longest wave / width of the plan


@dataclass(frozen=True, eq=False)
class Settlement:
    """Displacement field u(p) [m] in the vault's frame."""

    half: tuple[float, float]  # half extents of the plan [m]
    rise: float  # crown above the springing [m]
    depth: float  # below the springing, where all motion ends [m]
    spread: Array  # (3,) outward motion of the springings in x and in y, fall of the crown, before scaling
    waves: tuple[Waves, Waves, Waves]
    scale: float  # [m]

    def __call__(self, xyz: NDArray[np.floating]) -> Array:
        """Displacements (n, 3) [m] of points (n, 3) [m]."""
        points = np.asarray(xyz, np.float64)
        # Beyond the plan (jambs, piers) things move along with its edge.
        xi, eta = (np.sin(np.clip(points[:, k] / self.half[k], -1, 1) * np.pi / 2) for k in (0, 1))
        height = _smoothstep(points[:, 2] / self.rise)
        field = np.column_stack([wave(points) for wave in self.waves]).astype(np.float64)
        field[:, 0] += self.spread[0] * xi * (1 - height)
        field[:, 1] += self.spread[1] * eta * (1 - height)
        field[:, 2] -= self.spread[2] * (1 - xi**2) * (1 - eta**2) * height
        return field * (self.scale * _smoothstep(points[:, 2] / self.depth + 1))[:, None]


@dataclass(frozen=True)
class DeclaredSettlement:
    """Displacement field u(p) [m] in the vault's frame, by mechanisms of declared sizes [m]; see `ScannerSettings`."""

    half: tuple[float, float]  # half extents of the plan [m]
    rise: float  # crown above the springing [m]
    depth: float  # below the springing, where all motion ends [m]
    crown_fall: float
    spread: tuple[float, float]  # of the spans along x and y
    one_sided: float
    twist: float

    @classmethod
    def of(cls, settings: ScannerSettings, plan: Plan, rise: float, depth: float) -> DeclaredSettlement:
        """As the settings of a scanner declare it, of a vault with this plan and rise [m]."""
        spread = settings.spread_x, settings.spread_y
        return cls(
            (plan.half_x, plan.half_y), rise, depth, settings.crown_fall, spread, settings.one_sided, settings.twist
        )

    def __call__(self, xyz: NDArray[np.floating]) -> Array:
        """Displacements (n, 3) [m] of points (n, 3) [m]."""
        points = np.asarray(xyz, np.float64)
        x, y = (np.clip(points[:, k] / self.half[k], -1, 1) for k in (0, 1))
        xi, eta = np.sin(x * np.pi / 2), np.sin(y * np.pi / 2)
        height = _smoothstep(points[:, 2] / self.rise)
        field = np.empty_like(points)
        field[:, 0] = self.spread[0] / 2 * xi * (1 - height)
        field[:, 1] = self.spread[1] / 2 * eta * (1 - height)
        field[:, 2] = -self.crown_fall * (1 - xi**2) * (1 - eta**2) * height
        field[:, 2] -= self.one_sided * (1 + x) / 2 + self.twist / 2 * x * y
        return field * _smoothstep(points[:, 2] / self.depth + 1)[:, None]


def draw_settlement(vault: Array, plan: Plan, depth: float, amplitude: float, rng: np.random.Generator) -> Settlement:
    """A random settlement whose largest displacement over the points `vault` (n, 3) [m] is `amplitude` [m].

    depth: below the springing, where motion ends [m].
    """
    half, short = (plan.half_x, plan.half_y), plan.width
    spread = rng.uniform(1, 4, 3)
    waves = (
        draw_waves(MODES, short, LONGEST_WAVE * short, rng),
        draw_waves(MODES, short, LONGEST_WAVE * short, rng),
        draw_waves(MODES, short, LONGEST_WAVE * short, rng),
    )
    unit = Settlement(half, float(vault[:, 2].max()), depth, spread, waves, 1.0)
    largest = float(np.linalg.norm(unit(vault), axis=1).max())
    return Settlement(half, unit.rise, depth, spread, waves, amplitude / largest)


def _smoothstep(t: Array) -> Array:
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)

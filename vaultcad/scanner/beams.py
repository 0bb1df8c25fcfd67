"""The physics of a phase-shift scanner: the grid of its beams, and what makes a range wrong, weak or missing.

Sources: FARO Focus data sheet (range noise, ranging error, angular accuracy, finest step); Soudarissanane et al. 2011,
"Scanning geometry: influencing factor on the quality of terrestrial laser scanning points", ISPRS J. 66 (noise against
range and incidence); Tang, Huber and Akinci 2007, "A comparative analysis of depth-discontinuity and mixed-pixel
detection algorithms", 3DIM (beams on two surfaces).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LOWEST, HIGHEST = -pi / 3, pi / 2  # elevations: the scanner's own foot hides what is below
FINEST = 0.009 * pi / 180  # step [rad]
EDGE = 0.03  # a step in range that no slanting surface explains is a depth edge from here on [m]


@dataclass(frozen=True)
class Grid:
    """Beams by rows of equal elevation, upwards, and columns of equal azimuth."""

    rows: int
    columns: int

    def angles(self, first: int, last: int) -> tuple[Array, Array]:
        """Elevation and azimuth [rad] of the beams of rows first..last - 1, each (rows, columns)."""
        elevation = LOWEST + (np.arange(first, last) + 0.5) * ((HIGHEST - LOWEST) / self.rows)
        azimuth = (np.arange(self.columns) + 0.5) * (2 * pi / self.columns)
        grid = np.meshgrid(elevation, azimuth, indexing="ij")
        return grid[0], grid[1]


def grid(step: float) -> Grid:
    """The grid of an angular step [rad], not finer than the instrument's finest."""
    step = max(step, FINEST)
    return Grid(max(1, ceil((HIGHEST - LOWEST) / step)), max(4, ceil(2 * pi / step)))


def directions(elevation: Array, azimuth: Array) -> Array:
    """Unit vectors (..., 3)."""
    flat = np.cos(elevation)
    return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation)], axis=-1)


def range_sigma(distance: Array, cosine: Array, noise: float) -> Array:
    """Standard deviation of a range [m]: `noise` at 10 m hit squarely, growing with range and with slant.

    distance: range [m]; cosine: of the incidence, to the surface's normal.
    """
    return noise * np.sqrt((1 + (distance / 10) ** 2) / 2) / np.maximum(cosine, 0.2)


def lost(signal: Array, dropout: float, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Which beams do not return: with probability exp(-signal / dropout), signal = reflectance × cos(incidence)."""
    draw = rng.random(signal.shape)
    return draw < np.exp(-signal / dropout) if dropout > 0 else np.zeros(signal.shape, np.bool_)


def intensity(signal: Array, distance: Array, rng: np.random.Generator) -> NDArray[np.uint16]:
    """Strength of the return, 0..65535: falls with range; speckle of 6 %."""
    strength = signal / (1 + (distance / 12) ** 2) * np.exp(0.06 * rng.standard_normal(signal.shape))
    return np.clip(strength * 65535, 1, 65535).astype(np.uint16)


def mixed(
    distance: Array, cosine: Array, step: float, before: Array | None, share: float, rng: np.random.Generator
) -> Array:
    """Ranges (rows, columns) of which a share of those at depth edges lie between near and far, as a beam on both.

    distance: inf where nothing was hit; cosine: of the incidence; before: ranges (columns,) of the row below the first.
    """
    below = np.vstack([distance[:1] if before is None else before[None], distance[:-1]])
    neighbours = np.stack([np.roll(distance, 1, 1), np.roll(distance, -1, 1), below])
    slant = np.sqrt(np.maximum(0, 1 - cosine**2)) / np.maximum(cosine, 1e-3)
    with np.errstate(invalid="ignore"):
        jump = np.abs(neighbours - distance)
        jump = np.where(np.isfinite(jump), jump, 0)
        other = np.take_along_axis(neighbours, jump.argmax(0)[None], 0)[0]
        edge = jump.max(0) > EDGE + 2 * step * np.where(np.isfinite(distance), distance, 0) * slant
        chosen = edge & (rng.random(distance.shape) < share)
        return np.where(chosen, distance + rng.random(distance.shape) * (other - distance), distance)

"""Smooth random functions of space: sums of a few plane cosine waves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Waves:
    """f(p) = √(2 / k) Σ cos(vectors · p + phases): mean 0 and variance 1 over space [1], close to normal for k >> 1."""

    vectors: NDArray[np.float32]  # (k, 3) [rad/m]
    phases: NDArray[np.float32]  # (k,) [rad]

    def __call__(self, xyz: NDArray[np.floating]) -> NDArray[np.float32]:
        """Values (n,) at points (n, 3) [m]."""
        points = np.asarray(xyz, np.float32)
        total = np.zeros(len(points), np.float32)
        # One wave at a time: a matrix of all of them would be k times the cloud. No BLAS: its sums depend on threads.
        for vector, phase in zip(self.vectors, self.phases, strict=True):
            total += np.cos(points[:, 0] * vector[0] + points[:, 1] * vector[1] + points[:, 2] * vector[2] + phase)
        return total * np.float32(np.sqrt(2 / len(self.phases)))


def draw_waves(count: int, shortest: float, longest: float, rng: np.random.Generator) -> Waves:
    """`count` waves of random direction, with wavelengths from `shortest` to `longest` [m]."""
    direction = rng.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    wavelength = rng.uniform(shortest, longest, count)
    vectors = direction * (2 * np.pi / wavelength)[:, None]
    return Waves(vectors.astype(np.float32), rng.uniform(0, 2 * np.pi, count).astype(np.float32))

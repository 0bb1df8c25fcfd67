"""How far points are from an arch as treatises draw it, and the kinds that a section may be of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import pi

import numpy as np
from numpy.typing import NDArray

from families.declaration.profiles import (
    BasketHandle,
    Curve,
    Elliptical,
    Pointed,
    Profile,
    Segmental,
    Semicircular,
    Stilted,
    junction,
)
from vaultcad.find.practice import PRACTICE

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ArchKind:
    """A kind of arch: its profile, how far rise / span goes in it, its share among arches beforehand, and mean and
    deviation of its parameters.
    """

    name: str
    profile: type[Profile]
    low: float
    high: float
    share: float
    usual: Mapping[str, tuple[float, float]]

    @cached_property
    def _ranges(self) -> dict[str, tuple[float, float]]:
        found = {p.name: (p.range.low, p.range.high) for p in self.profile().parameters()}
        return {name: (self.low, self.high) if name == "rise_ratio" else ends for name, ends in found.items()}

    def made(self, values: Mapping[str, float]) -> Profile:
        """The profile with these parameters, brought within its range."""
        return self.profile(**{name: min(max(values[name], low), high) for name, (low, high) in self._ranges.items()})


def _usual(kind: type[Profile], low: float, high: float) -> ArchKind:
    return ArchKind(kind.id, kind, low, high, PRACTICE[kind].share, PRACTICE[kind].usual)


KINDS: tuple[ArchKind, ...] = (
    _usual(Semicircular, 0.5, 0.5),
    _usual(Segmental, 0.05, 0.5),
    _usual(Pointed, 0.5, 1.5),
    _usual(BasketHandle, 0.15, 0.49),
    _usual(Elliptical, 0.1, 0.5),
    _usual(Stilted, 0.5, 1.2),
    ArchKind("raised", Elliptical, 0.5, 1.0, 0.05, {"rise_ratio": (0.65, 0.1)}),
)
"""The last is surmounted: half an ellipse that stands upright, higher than half its span."""


def distances(curve: Curve, points: Floats) -> tuple[Floats, Floats]:
    """Signed distances (n,) [m] of points (n, 2) from a whole arch about u = 0 on z = 0, positive outside, and the
    directions (n, 2) in which they grow.

    Below the springing an arch goes on as a wall, a segment as its circle. Distances to an ellipse are of first order.
    """
    x, z = np.abs(points[:, 0]), points[:, 1]
    if curve.arcs:
        away, normal = _from_arcs(curve, x, z)
    else:
        a, b = curve.half_span, curve.rise
        reach = np.maximum(np.hypot(x / a, z / b), 1e-9)
        slope = np.column_stack([x / a**2, z / b**2]) / reach[:, None]
        size = np.maximum(np.linalg.norm(slope, axis=1), 1e-9)
        away, normal = (reach - 1) / size, slope / size[:, None]
    upright = not curve.arcs or curve.arcs[0].z >= 0
    wall = (z < curve.stilt) & upright
    away = np.where(wall, x - curve.half_span, away)
    normal = np.where(wall[:, None], (1.0, 0.0), normal)
    normal[:, 0] *= np.where(points[:, 0] < 0, -1.0, 1.0)
    return away, normal


def _from_arcs(curve: Curve, x: Floats, z: Floats) -> tuple[Floats, Floats]:
    found = []
    for arc in curve.arcs:
        off = np.column_stack([x - arc.u, z - arc.z])
        size = np.maximum(np.linalg.norm(off, axis=1), 1e-9)
        found.append((size - arc.radius, off / size[:, None]))
    if len(found) == 1:
        return found[0]
    u, top = junction(curve)
    large = curve.arcs[1]
    haunch = (x - large.u) * (top - large.z) > (z - large.z) * (u - large.u)
    (small, small_normal), (wide, wide_normal) = found
    return np.where(haunch, small, wide), np.where(haunch[:, None], small_normal, wide_normal)


def drawn(curve: Curve, steps: int = 241) -> Floats:
    """The whole arch from springing to springing, (n, 2) [m]."""
    u = curve.half_span * np.sin(np.linspace(-pi / 2, pi / 2, steps))
    heights = np.array([curve.height(min(abs(float(v)), curve.half_span)) for v in u])
    line = np.column_stack([u, heights])
    feet = np.array([[-curve.half_span, 0.0], [curve.half_span, 0.0]])
    return np.concatenate([feet[:1], line, feet[1:]]) if curve.stilt else line

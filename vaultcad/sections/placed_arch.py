"""An arch of a kind over two feet, by its place and its own parameters: how far points are from it, and its sizes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import cos, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from families.declaration.profiles import Arc, Curve, junction
from vaultcad.sections.arch_curves import ArchKind, distances, drawn
from vaultcad.sections.field_fit import CurveFit
from vaultcad.sections.section import SectionArc
from vaultcad.uncertain import Estimate

Floats = NDArray[np.float64]
Size = Callable[[Floats], float]

MIDDLE, SPAN = 0.05, 0.05  # of the span: standard deviations of the middle and the half span beforehand
TILT = 0.02  # rad, by which springings are out of level
PLACE = ("middle", "springing", "half_span", "tilt")
STEP = 1e-5  # of a parameter, by which slopes are taken
STARTS = (0.5, 0.75)  # of the haunch's radius by the rise, from which a basket handle is fitted


@dataclass(frozen=True, eq=False)
class ArchPoints:
    """What is known of an arch: points (n, 2) [m] of its line from left to right, directions (n, 2) into the stone, its
    feet (2, 2) [m], left and right, how well their height is known [m], and how wide the vault is [m].
    """

    at: Floats
    normal: Floats
    feet: Floats
    foot_std: float
    width: float

    @property
    def half_span(self) -> float:
        """Between the feet [m]."""
        return float(self.feet[1, 0] - self.feet[0, 0]) / 2


SIZES: dict[str, tuple[Size, str]] = {
    "span": (lambda v: float(2 * v[2]), "clear width between the springings"),
    "middle": (lambda v: float(v[0]), "middle of the span in the section"),
    "springing": (lambda v: float(v[1]), "springing above the vault's"),
    "springing_left": (lambda v: float(v[1]) - float(v[2]) * sin(v[3]), "left springing above the vault's"),
    "springing_right": (lambda v: float(v[1]) + float(v[2]) * sin(v[3]), "right springing above the vault's"),
}
"""Of every arch: size by its parameters [m], and what it is."""


@dataclass(frozen=True, eq=False)
class PlacedArch:
    """A kind of arch over the feet of an arch, by its parameters: `PLACE`, then its own."""

    points: ArchPoints
    kind: ArchKind

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parameters."""
        return (*PLACE, *self.kind.usual)

    def beforehand(self) -> tuple[Floats, Floats]:
        """Mean and standard deviation of the parameters."""
        (u, z), half = self.points.feet.mean(axis=0).tolist(), self.points.half_span
        own = list(self.kind.usual.values())
        mean = [u, z, half, 0.0, *(m for m, _ in own)]
        std = [2 * MIDDLE * half, self.points.foot_std, 2 * SPAN * half, TILT, *(s for _, s in own)]
        return np.array(mean), np.array(std)

    def starts(self, rise: float) -> Iterator[Floats]:
        """Where fits begin, for a rise [m] as it looks."""
        mean, _ = self.beforehand()
        ratio = min(max(rise / (2 * self.points.half_span), self.kind.low + 0.01), self.kind.high - 0.01)
        for haunch in STARTS if "haunch_ratio" in self.kind.usual else STARTS[:1]:
            values = dict(zip(self.names, mean.tolist(), strict=True))
            values |= {name: {"rise_ratio": ratio, "haunch_ratio": haunch}[name] for name in self.kind.usual}
            yield np.array(list(values.values()))

    def curve(self, values: Floats) -> Curve:
        """The arch about its own middle."""
        told = dict(zip(self.names, values.tolist(), strict=True))
        return self.kind.made(told).curve(max(told["half_span"], 1e-2))

    def local(self, values: Floats, points: Floats) -> Floats:
        """Points (n, 2) as the arch has them, its middle at u = 0 and its springing at z = 0."""
        c, s = cos(values[3]), sin(values[3])
        off = points - values[:2]
        return np.asarray(off @ np.array([[c, -s], [s, c]]), np.float64)

    def residuals(self, values: Floats) -> Floats:
        """Distances (n,) [m] of the points, positive into the stone."""
        return distances(self.curve(values), self.local(values, self.points.at))[0]

    def slopes(self, values: Floats, here: Floats) -> Floats:
        """Derivatives (n, k) of the residuals, given these: by place from the normals, by shape as differences."""
        local = self.local(values, self.points.at)
        normal = distances(self.curve(values), local)[1]
        c, s = cos(values[3]), sin(values[3])
        out = np.empty((len(here), len(values)))
        out[:, :2] = -normal @ np.array([[c, s], [-s, c]])
        out[:, 3] = normal[:, 0] * local[:, 1] - normal[:, 1] * local[:, 0]
        for k in (2, *range(len(PLACE), len(values))):
            moved = values.copy()
            moved[k] += STEP
            column = (self.residuals(moved) - here) / STEP
            if not column.any():  # at the end of its range
                moved[k] = values[k] - STEP
                column = (here - self.residuals(moved)) / STEP
            out[:, k] = column
        return out

    def line(self, values: Floats) -> Floats:
        """As it stands, (n, 2) [m]."""
        return self.placed(values, drawn(self.curve(values)))

    def placed(self, values: Floats, local: Floats) -> Floats:
        """Where points (n, 2) of the arch about its own middle stand."""
        c, s = cos(values[3]), sin(values[3])
        return np.asarray(local @ np.array([[c, s], [-s, c]]) + values[:2], np.float64)

    def sizes(self, fit: CurveFit) -> Iterator[tuple[str, Estimate]]:
        """By name."""
        curve = self.curve(fit.values)
        for name, (size, meaning) in SIZES.items():
            yield name, self.estimate(fit, size, meaning)
        yield "rise", self.estimate(fit, lambda v: self.curve(v).rise, "crown above the springing")
        if curve.stilt:
            yield "stilt", self.estimate(fit, lambda v: self.curve(v).stilt, "upright part below the arc")
        names = ("haunch_radius", "crown_radius") if len(curve.arcs) > 1 else ("radius",) * len(curve.arcs)
        for k, name in enumerate(names):
            yield name, self.estimate(fit, _Radius(self, k), "radius of the arc")
        if "rise_ratio" in self.kind.usual:
            yield "rise_ratio", self.estimate(fit, self.ratio, "rise / span", unit="1")

    def ratio(self, values: Floats) -> float:
        """Rise / span."""
        curve = self.curve(values)
        return curve.rise / (2 * curve.half_span)

    def arcs(self, fit: CurveFit) -> Iterator[SectionArc]:
        """From left to right, each with its centre; those about the middle are one."""
        curve = self.curve(fit.values)
        spans = _spans(curve)
        for side, k, start, end in spans:
            yield SectionArc(
                self.estimate(fit, _Centre(self, k, side, 0), "centre of the arc"),
                self.estimate(fit, _Centre(self, k, side, 1), "centre of the arc above the vault's springing"),
                self.estimate(fit, _Radius(self, k), "radius of the arc"),
                start + float(fit.values[3]),
                end + float(fit.values[3]),
            )

    def estimate(self, fit: CurveFit, size: Size, meaning: str, unit: str = "m") -> Estimate:
        """A size [m] that follows from the parameters."""
        here, slopes = size(fit.values), np.zeros(len(fit.values))
        for k in range(len(slopes)):
            for step in (STEP, -STEP):
                moved = fit.values.copy()
                moved[k] += step
                if (slope := (size(moved) - here) / step) != 0:
                    slopes[k] = slope
                    break
        return Estimate(here, unit, sqrt(max(float(slopes @ fit.covariance @ slopes), 0.0)), meaning, derived=True)


@dataclass(frozen=True, eq=False)
class _Radius:
    """Of the k-th arc [m]."""

    placed: PlacedArch
    k: int

    def __call__(self, values: Floats) -> float:
        return self.placed.curve(values).arcs[self.k].radius


@dataclass(frozen=True, eq=False)
class _Centre:
    """A coordinate of the centre of the k-th arc on a side [m]."""

    placed: PlacedArch
    k: int
    side: float
    axis: int

    def __call__(self, values: Floats) -> float:
        arc = self.placed.curve(values).arcs[self.k]
        return float(self.placed.placed(values, np.array([[self.side * arc.u, arc.z]]))[0, self.axis])


def _spans(curve: Curve) -> list[tuple[float, int, float, float]]:
    """Of each arc from left to right its side, its number and the angles between which it is drawn [rad]."""
    if not curve.arcs:
        return []

    def angle(arc: Arc, u: float, z: float) -> float:
        return float(np.arctan2(z - arc.z, u - arc.u))

    right: list[tuple[int, float, float]] = []
    if len(curve.arcs) > 1:
        u, z = junction(curve)
        right.append((0, angle(curve.arcs[0], curve.half_span, curve.stilt), angle(curve.arcs[0], u, z)))
    else:
        u, z = curve.half_span, curve.stilt
    top = curve.arcs[-1]
    k, start, end = len(curve.arcs) - 1, angle(top, u, z), angle(top, 0.0, curve.rise)
    if abs(top.u) < 1e-9:  # the crown is within it
        middle = [(1.0, k, start, pi - start)]
    else:
        middle = [(-1.0, k, pi - end, pi - start), (1.0, k, start, end)]
    return [
        *((-1.0, n, pi - b, pi - a) for n, a, b in right),
        *middle,
        *((1.0, n, a, b) for n, a, b in right),
    ]

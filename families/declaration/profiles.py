"""Arch profiles (directrices) shared by all families: a half span becomes a curve of arcs or an ellipse."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import hypot, sqrt
from typing import Annotated, ClassVar

from families.declaration.parameters import Parametric, Range


@dataclass(frozen=True)
class Arc:
    """Circular arc of a profile, in the half plane u >= 0: centre and radius [m]."""

    u: float
    z: float
    radius: float


@dataclass(frozen=True)
class Curve:
    """Half of an arch in (u, z), u the distance from the axis, z above the springing [m].

    A vertical line of length `stilt` at u = half_span, then `arcs` from the springing to the crown
    (one or two, tangent to each other), or an ellipse with the half axes half_span and rise if there are none.
    """

    half_span: float
    rise: float
    stilt: float = 0.0
    arcs: tuple[Arc, ...] = ()

    @property
    def crown_radius(self) -> float:
        """Radius of curvature at the crown [m]."""
        return self.arcs[-1].radius if self.arcs else self.half_span**2 / self.rise

    def height(self, u: float) -> float:
        """Height [m] above the springing at a distance from the axis.

        >>> Pointed(1.0).curve(2.0).height(0.0)
        4.0
        """
        if not self.arcs:
            return self.rise * sqrt(max(1 - (u / self.half_span) ** 2, 0.0))
        arc = self.arcs[0] if len(self.arcs) > 1 and u > junction(self)[0] else self.arcs[-1]
        return arc.z + sqrt(max(arc.radius**2 - (u - arc.u) ** 2, 0.0))

    def grown(self, thickness: float) -> Curve:
        """The extrados: every radius plus `thickness` [m] about the same centres (R + t)."""
        arcs = tuple(Arc(a.u, a.z, a.radius + thickness) for a in self.arcs)
        top = arcs[-1] if arcs else None
        rise = self.rise + thickness if top is None else top.z + sqrt(top.radius**2 - top.u**2)
        return Curve(self.half_span + thickness, rise, self.stilt, arcs)

    def thickness_below(self, rise: float) -> float:
        """The thickness [m] with which `grown` reaches a rise [m]."""
        if not self.arcs:
            return rise - self.rise
        top = self.arcs[-1]
        return hypot(top.u, rise - top.z) - top.radius


def circle_through(half_span: float, rise: float) -> float:
    """Radius R = (S² + H²) / (2 H) [m] of the arc that rises by H over the half span S (or a cove's run).

    >>> circle_through(2.0, 1.0)
    2.5
    """
    return (half_span**2 + rise**2) / (2 * rise)


class Profile(Parametric, ABC):
    """An arch without its size: given the half span it yields the curve."""

    id: ClassVar[str]
    aliases: ClassVar[tuple[str, ...]] = ()

    def curve(self, half_span: float) -> Curve:
        """The curve over a half span [m].

        >>> curve = Segmental(rise_ratio=0.25).curve(2.0)
        >>> curve.rise, curve.crown_radius
        (1.0, 2.5)
        """
        return self.arch(half_span, self.rise(half_span))

    def rise(self, half_span: float) -> float:
        """Rise [m] over a half span [m]."""
        return 2 * half_span * float(getattr(self, "rise_ratio", 0.5))

    @abstractmethod
    def arch(self, half_span: float, rise: float) -> Curve:
        """An arch of this kind over a half span or a cove's run, with a given rise [m].

        Where the kind has no such arch (a segmental one steeper than a semicircle) the nearest kind that has one and
        passes into it continuously takes its place.
        """

    @classmethod
    def over(cls, ratio: float) -> Profile | None:
        """The profile with rise / span = ratio, its other parameters at their defaults; None if it cannot be."""
        try:
            return cls(rise_ratio=ratio)  # type: ignore[call-arg]  # every profile but the semicircle has it
        except ValueError:
            return None


@dataclass(frozen=True)
class Semicircular(Profile):
    """R = S = H."""

    id: ClassVar[str] = "semicircular"
    aliases: ClassVar[tuple[str, ...]] = ("tutto sesto", "plein cintre", "rundbogen", "medio punto")

    def arch(self, half_span: float, rise: float) -> Curve:
        """A circular arc, or half an ellipse if it is higher than half its span."""
        return segmental(half_span, rise) if rise <= half_span else Curve(half_span, rise)

    @classmethod
    def over(cls, ratio: float) -> Profile | None:
        """A semicircle where the ratio is one half."""
        return cls() if abs(ratio - 0.5) < 1e-9 else None


@dataclass(frozen=True)
class Segmental(Profile):
    """Less than a semicircle: R = (S² + H²) / (2 H), centre below the springing."""

    id: ClassVar[str] = "segmental"
    aliases: ClassVar[tuple[str, ...]] = ("ribassato", "surbaissé", "segmentbogen", "escarzano")
    rise_ratio: Annotated[float, Range(0.05, 0.5, "1", "rise / span; 0.5 is a semicircle")] = 0.3

    def arch(self, half_span: float, rise: float) -> Curve:
        """A circular arc, or half an ellipse if it is higher than half its span."""
        return segmental(half_span, rise) if rise <= half_span else Curve(half_span, rise)


@dataclass(frozen=True)
class Pointed(Profile):
    """Two arcs that meet at the crown; centres on the springing line, R = (S² + H²) / (2 S)."""

    id: ClassVar[str] = "pointed"
    aliases: ClassVar[tuple[str, ...]] = ("ogivale", "sesto acuto", "brisé", "spitzbogen", "apuntado")
    rise_ratio: Annotated[float, Range(0.5, 1.5, "1", "rise / span; 0.866 is equilateral")] = 0.75

    def arch(self, half_span: float, rise: float) -> Curve:
        """Two arcs, or one if it is lower than half its span."""
        if rise < half_span:
            return segmental(half_span, rise)
        radius = circle_through(rise, half_span)
        return Curve(half_span, rise, 0.0, (Arc(half_span - radius, 0.0, radius),))


@dataclass(frozen=True)
class BasketHandle(Profile):
    """Three centres: small arcs r at the haunches, a large one R = (S² + H² - 2 S r) / (2 (H - r)) at the crown."""

    id: ClassVar[str] = "basket-handle"
    aliases: ClassVar[tuple[str, ...]] = ("policentrico", "anse de panier", "korbbogen", "carpanel", "three-centred")
    rise_ratio: Annotated[float, Range(0.15, 0.49, "1", "rise / span")] = 0.35
    haunch_ratio: Annotated[float, Range(0.2, 0.95, "1", "radius of the haunch arcs / rise")] = 0.7

    def arch(self, half_span: float, rise: float) -> Curve:
        """Three centres, or half an ellipse if it is as high as half its span."""
        if rise >= half_span:
            return Curve(half_span, rise)
        small = rise * self.haunch_ratio
        large = (half_span**2 + rise**2 - 2 * half_span * small) / (2 * (rise - small))
        return Curve(half_span, rise, 0.0, (Arc(half_span - small, 0.0, small), Arc(0.0, rise - large, large)))


@dataclass(frozen=True)
class Elliptical(Profile):
    """Half an ellipse with the half axes S and H."""

    id: ClassVar[str] = "elliptical"
    aliases: ClassVar[tuple[str, ...]] = ("ellittico", "elliptique", "elliptisch", "elíptico")
    rise_ratio: Annotated[float, Range(0.1, 1.0, "1", "rise / span; 0.5 is a semicircle")] = 0.35

    def arch(self, half_span: float, rise: float) -> Curve:
        """Half an ellipse."""
        return Curve(half_span, rise)


@dataclass(frozen=True)
class Stilted(Profile):
    """A vertical H - S below a semicircle R = S."""

    id: ClassVar[str] = "stilted"
    aliases: ClassVar[tuple[str, ...]] = ("rialzato", "surhaussé", "gestelzt", "peraltado")
    rise_ratio: Annotated[float, Range(0.5, 1.2, "1", "rise / span; 0.5 is a semicircle")] = 0.6

    def arch(self, half_span: float, rise: float) -> Curve:
        """A semicircle on a vertical, or a circular arc if it is lower than half its span."""
        if rise < half_span:
            return segmental(half_span, rise)
        stilt = rise - half_span
        return Curve(half_span, rise, stilt, (Arc(0.0, stilt, half_span),))


def segmental(half_span: float, rise: float) -> Curve:
    """One circular arc over a half span or a cove's run, rise <= half_span [m]."""
    radius = circle_through(half_span, rise)
    return Curve(half_span, rise, 0.0, (Arc(0.0, rise - radius, radius),))


PROFILES: tuple[type[Profile], ...] = (Semicircular, Segmental, Pointed, BasketHandle, Elliptical, Stilted)
UNSTILTED: tuple[type[Profile], ...] = tuple(kind for kind in PROFILES if kind is not Stilted)


def as_kind(kind: type[Profile], profile: Profile) -> Profile | None:
    """A profile as one of another kind, as near as it can be, or None if it would be far."""
    if type(profile) is kind:
        return profile
    ratio = profile.rise(0.5)
    for near in (ratio, ratio - 0.02, ratio + 0.02, ratio - 0.06, ratio + 0.06):
        if (made := kind.over(near)) is not None:
            return made
    return kind.over(0.5) if abs(ratio - 0.5) < 0.1 else None


def junction(curve: Curve) -> tuple[float, float]:
    """Point (u, z) [m] where the haunch arc passes into the crown arc of a curve of two arcs."""
    small, large = curve.arcs
    du, dz = small.u - large.u, small.z - large.z
    k = large.radius / hypot(du, dz)
    return large.u + k * du, large.z + k * dz

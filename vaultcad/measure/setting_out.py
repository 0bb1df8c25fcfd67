"""By which rule an arch may have been set out: masons divided the span and put their compasses on the marks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import exp, hypot, pi, sqrt
from typing import NamedTuple

from families import PROFILES, Profile
from families.declaration.profiles import BasketHandle, Elliptical, Pointed, Segmental, Semicircular, Stilted
from vaultcad.model import FittedVault


def pointed_of(radius: float) -> float:
    """Rise / span of a pointed arch whose radius is so many spans; its centres are on the springing line.

    >>> round(pointed_of(1.0), 4)
    0.866
    """
    return sqrt(radius - 0.25)


def segment_of(radius: float) -> float:
    """Rise / span of a segment whose radius is so many spans.

    >>> round(segment_of(0.5), 4)
    0.5
    """
    return radius - sqrt(radius**2 - 0.25)


@dataclass(frozen=True)
class Rule:
    """A way to set out an arch of a kind: its rise / span, and what it says."""

    name: str
    kind: type[Profile]
    ratio: float
    says: str


RULES: tuple[Rule, ...] = (
    Rule("semicircle", Semicircular, 1 / 2, "one centre, half way along the span"),
    Rule("equilateral", Pointed, pointed_of(1), "centres at the springings: the radius is the span"),
    Rule("fifth-point", Pointed, pointed_of(4 / 5), "quinto acuto: the radius is four fifths of the span"),
    Rule("fourth-point", Pointed, pointed_of(3 / 4), "quarto acuto: the radius is three quarters of the span"),
    Rule("third-point", Pointed, pointed_of(2 / 3), "terzo acuto: the radius is two thirds of the span"),
    Rule(
        "lancet of a fourth", Pointed, pointed_of(5 / 4), "acute: centres a fourth of the span outside the springings"
    ),
    Rule("lancet of a third", Pointed, pointed_of(4 / 3), "acute: centres a third of the span outside the springings"),
    Rule("lancet of a half", Pointed, pointed_of(3 / 2), "acute: centres half the span outside the springings"),
    Rule("sixth of a circle", Segmental, segment_of(1), "an arc of 60°: the radius is the span"),
    Rule("fourth of a circle", Segmental, segment_of(sqrt(1 / 2)), "an arc of 90°: the centre is half the span below"),
    Rule("third of a circle", Segmental, segment_of(sqrt(1 / 3)), "an arc of 120°"),
    Rule("segment of a third", Segmental, 1 / 3, "it rises by a third of the span"),
    Rule("segment of a fourth", Segmental, 1 / 4, "it rises by a fourth of the span"),
    Rule("segment of a sixth", Segmental, 1 / 6, "it rises by a sixth of the span"),
    Rule("three-centred of two circles", BasketHandle, (2 - sqrt(3) / 2) / 3, "half Serlio's oval about two circles"),
    Rule("three-centred of a third", BasketHandle, 1 / 3, "it rises by a third of the span"),
    Rule("three-centred of a fourth", BasketHandle, 1 / 4, "it rises by a fourth of the span"),
    Rule("ellipse of a third", Elliptical, 1 / 3, "it rises by a third of the span"),
    Rule("ellipse of a fourth", Elliptical, 1 / 4, "it rises by a fourth of the span"),
    Rule("stilted by a fourth", Stilted, 1 / 2 + 1 / 8, "a semicircle on a stilt of a fourth of its radius"),
)
FREE = "none of these"
SET_OUT = 0.75  # chance that an arch follows a rule of its kind that stands here, before it was measured
CARE = 0.008  # standard deviation by which masons missed the rise / span that they had in mind


class Way(NamedTuple):
    """How an arch may have been built: chance, kind, its rise / span and the standard deviation of that."""

    chance: float
    kind: type[Profile]
    ratio: float
    std: float


def setting_out(arch: FittedVault) -> dict[str, float]:
    """How likely it is that each rule was followed, see `likely_rules`, of a fitted arch."""
    return likely_rules(_ways(arch))


def likely_rules(ways: Iterable[Way]) -> dict[str, float]:
    """How likely it is that each rule was followed, the likeliest first; `FREE` for what stands here not.

    Every kind of arch that it may be of has its own rise / span; what is known of that and of the masons' care says how
    near a rule must be.
    """
    chances: dict[str, float] = {}
    for way in ways:
        likely = _likely(way.kind, way.ratio, hypot(CARE, way.std))
        for name, weight in likely.items():
            chances[name] = chances.get(name, 0.0) + way.chance * weight / sum(likely.values())
    whole = sum(chances.values())
    return {name: chances[name] / whole for name in sorted(chances, key=lambda name: (-chances[name], name))}


def _ways(arch: FittedVault) -> Iterator[Way]:
    known = arch.numbers().get("rise_ratio")
    std = (known.std if known is not None else None) or 0.0
    kinds = {kind.id: kind for kind in PROFILES}
    for rival in arch.rivals:
        yield Way(rival.chance, kinds[rival.profiles["profile"]], rival.sizes["rise"] / rival.sizes["span"], std)
    if not arch.rivals:
        profile = arch.vault.profiles["profile"]
        yield Way(1.0, type(profile), profile.rise(0.5), std)


def _likely(kind: type[Profile], ratio: float, spread: float) -> dict[str, float]:
    """How likely a measured rise / span is by each rule for this kind of arch, and without any."""
    rules = [rule for rule in RULES if rule.kind is kind]
    ranges = [p.range for p in kind().parameters() if p.name == "rise_ratio"]
    if not ranges:
        return {rule.name: 1.0 for rule in rules}
    share = SET_OUT / len(rules) / (sqrt(2 * pi) * spread)
    found = {rule.name: share * exp(-(((ratio - rule.ratio) / spread) ** 2) / 2) for rule in rules}
    return found | {FREE: (1 - SET_OUT) / (ranges[0].high - ranges[0].low)}

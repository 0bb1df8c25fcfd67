"""Vaults as builders put them over bays and rooms, by their spans and a rise."""

from __future__ import annotations

from math import sqrt

import numpy as np

from families import (
    Barrel,
    Groin,
    Lunette,
    Mirror,
    Pointed,
    Profile,
    Sail,
    Segmental,
    Semicircular,
    Trough,
    Vault,
)
from families.declaration.lengths import with_lengths

Random = np.random.Generator


def arch_for(rise: float, span: float) -> Profile:
    """An arch of a rise over a span [m], of the kind that builders took for it."""
    ratio = rise / span
    if ratio > 0.505:
        return Pointed(ratio)
    return Semicircular() if ratio > 0.495 else Segmental(ratio)


def bay_vault(kind: str, span_x: float, span_y: float, rise: float) -> Vault:
    """A vault over a rectangle that is open to all sides, or across y [m]."""
    if kind == "groin":
        return Groin(span_x, span_y, arch_for(rise, span_x), arch_for(rise, span_y))
    if kind == "sail":
        return with_lengths(Sail(span_x, span_y), {"rise": min(1.25 * rise, 0.48 * sqrt(span_x**2 + span_y**2))})
    return Barrel(span_x, span_y, arch_for(rise, span_x))


def lunettes(span: float, length: float, rise: float, count: int) -> Lunette:
    """A barrel of a rise with so many lunettes a side [m]."""
    return Lunette(span, length, arch_for(rise, span), count=count)


def room_vault(rng: Random) -> Vault:
    """As over the rooms of a palace."""
    short = rng.uniform(3.2, 5.5)
    long = short * rng.uniform(1.05, 1.6)
    rise = rng.uniform(0.25, 0.42) * short
    run = rng.uniform(0.2, 0.3) * short
    return (
        lambda: Trough(short, long, arch_for(rise, short)),
        lambda: with_lengths(Mirror(short, long), {"run_x": run, "run_y": run, "cove_rise": run}),
        lambda: lunettes(short, long, rise, int(rng.integers(2, 4))),
        lambda: Barrel(short, long, arch_for(rise, short)),
        lambda: bay_vault("groin", short, long, rise),
        lambda: bay_vault("sail", short, short, rise),
    )[int(rng.integers(6))]()

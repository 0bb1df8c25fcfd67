"""Arches as builders chose them: what families are drawn with, and what a fit looks for first."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product

import numpy as np

from families.declaration.profiles import (
    BasketHandle,
    Elliptical,
    Pointed,
    Profile,
    Segmental,
    Semicircular,
    Stilted,
)

Random = np.random.Generator

DRAWN: dict[str, Callable[[Random], Profile]] = {
    Semicircular.id: lambda rng: Semicircular(),
    Segmental.id: lambda rng: Segmental(rng.uniform(0.2, 0.45)),
    Pointed.id: lambda rng: Pointed(rng.uniform(0.55, 0.9)),
    BasketHandle.id: lambda rng: BasketHandle(rng.uniform(0.28, 0.42), rng.uniform(0.5, 0.8)),
    Elliptical.id: lambda rng: Elliptical(rng.uniform(0.25, 0.45)),
    Stilted.id: lambda rng: Stilted(rng.uniform(0.52, 0.65)),
}
"""How each kind is drawn: not over the whole range of its parameters."""

COARSE_RISES = (0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.85, 1.0)
"""Rise / span of the arches that a fit looks for first."""
COARSE_KINDS: tuple[type[Profile], ...] = (Segmental, Elliptical, Pointed)
"""Kinds of these; the others lie between them."""


def drawn_arch(rng: Random, *kinds: str) -> Profile:
    """An arch of one of these kinds, by their ids; of any kind if none is given."""
    return DRAWN[str(rng.choice(kinds or list(DRAWN)))](rng)


def either(rng: Random, chance: float, value: float, low: float, high: float) -> float:
    """`value` with some probability, else one between low and high."""
    chosen, other = rng.random() < chance, float(rng.uniform(low, high))
    return value if chosen else other


def coarse_arches() -> Iterator[Profile]:
    """The arches that a fit looks for first, whatever they span."""
    for kind, ratio in product(COARSE_KINDS, COARSE_RISES):
        profile = kind.over(ratio)
        if profile is not None:
            yield profile

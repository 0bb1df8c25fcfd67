"""Vaults drawn over all ranges of all parameters, profiles and free corners, each from its own seed."""

from __future__ import annotations

from dataclasses import fields, replace
from math import exp, log
from typing import Any

import numpy as np

from families import Vault
from families.declaration.corners import Skew
from families.declaration.parameters import Parametric

SHORTEST, LONGEST = 1.5, 12.0  # [m] of lengths
SKEWED = 0.5  # of the vaults over four corners that have them free
FARTHEST = 0.3  # of the ranges in which corners are free: beyond it sides may cross


def anywhere(family: type[Vault], seed: int) -> Vault:
    """A vault of a family with values even over their ranges, lengths over their logarithms."""
    rng, ideal = np.random.default_rng(seed), family()
    arches: dict[str, Any] = {}
    for name in ideal.profiles:
        kinds = family.kinds_for(name)
        arch = kinds[int(rng.integers(len(kinds)))]()
        arches[name] = replace(arch, **_values(arch, rng))
    vault = replace(ideal, **_values(ideal, rng), **arches)
    if not family.four_corners or rng.random() > SKEWED:
        return vault
    return replace(vault, skew=Skew(*(FARTHEST * rng.uniform(-0.5, 0.5, 3)).tolist()))


def _values(declared: Parametric, rng: np.random.Generator) -> dict[str, Any]:
    """A value for each of a class's own parameters."""
    own = {field.name for field in fields(declared)}
    found: dict[str, Any] = {}
    for parameter in (p for p in declared.parameters() if p.name in own):
        low, high = parameter.range.low, parameter.range.high
        if parameter.range.unit == "m":
            found[parameter.name] = exp(rng.uniform(log(SHORTEST), log(LONGEST)))
        elif isinstance(getattr(declared, parameter.name), int):
            found[parameter.name] = int(rng.integers(int(low), int(high) + 1))
        else:
            found[parameter.name] = float(rng.uniform(low, high))
    return found

"""What builders mostly did: how often there is a kind of arch, its proportions, and how often constraints hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from families import BasketHandle, Elliptical, Pointed, Profile, Segmental, Semicircular, Stilted, Vault
from families.declaration.constraints import Constraint
from families.declaration.corners import Skew
from vaultcad.fit.solve import POSE, Solution

Array = NDArray[np.float64]

KEPT = 0.8  # how often a constraint of a family holds that seldom fails; of the others every second does
ALIKE_ARCHES = 2.0  # by so much likelier are arches of one kind where a family's are mostly alike
ASKEW = dict.fromkeys(Skew().values(), (0.0, 0.015))  # mean and deviation of what makes a plan no rectangle
KNOWN = {"x": 1.0, "y": 1.0, "z": 3.0, "yaw": 0.1}  # m, rad; standard deviation of the pose beforehand
HELD = 1e12  # inverse variance of a part of the pose that a user fixed


@dataclass(frozen=True)
class Practice:
    """How a kind of arch is used: its share among all arches, and mean and deviation of its parameters."""

    share: float
    usual: Mapping[str, tuple[float, float]]


PRACTICE: dict[type[Profile], Practice] = {
    Semicircular: Practice(0.35, {}),
    Segmental: Practice(0.20, {"rise_ratio": (0.32, 0.10)}),
    Pointed: Practice(0.15, {"rise_ratio": (0.75, 0.15)}),
    BasketHandle: Practice(0.10, {"rise_ratio": (0.35, 0.06), "haunch_ratio": (0.65, 0.12)}),
    Elliptical: Practice(0.12, {"rise_ratio": (0.38, 0.10)}),
    Stilted: Practice(0.08, {"rise_ratio": (0.60, 0.06)}),
}
"""From the proportions of the treatises; the semicircle is the simplest and the most usual. A stilted arch on a wall
looks like a semicircle that springs higher, so only the shares tell how often it is one."""


def log_prior(vault: Vault, kept: Iterable[Constraint]) -> float:
    """How likely the kinds of a vault's arches and its constraints are beforehand, as a logarithm."""
    held = {c.name for c in kept}
    arches = vault.profiles
    kinds = sum(log(PRACTICE[type(arch)].share) for arch in arches.values())
    if vault.alike and len({type(arches[name]) for name in vault.alike}) == 1:
        kinds += log(ALIKE_ARCHES)
    return kinds + sum(log(KEPT if c.name in held else 1 - KEPT) for c in vault.constraints if c.rare)


def arch_of(vault: Vault, name: str) -> str | None:
    """The field of the arch that a parameter shapes, if it does."""
    return next((p.path[0] for p in vault.parameters() if p.name == name and p.path[0] in vault.profiles), None)


def beforehand(solution: Solution) -> tuple[Array, Array]:
    """What is known of the unknowns without the scan: inverse variances (k,), and means (k,) from where they are."""
    vault = solution.placed.vault
    values, parameters, arches = vault.values(), {p.name: p for p in vault.parameters()}, vault.profiles
    precision, mean = np.empty(len(solution.names)), np.zeros(len(solution.names))
    for k, name in enumerate(solution.names):
        if name in POSE:
            precision[k] = HELD if name in solution.free.pose else KNOWN[name] ** -2
            continue
        parameter = parameters[name]
        place, own = parameter.path[0], parameter.path[-1]
        usual = PRACTICE[type(arches[place])].usual[own] if place in arches else {**ASKEW, **vault.usual}.get(name)
        if usual is None:
            precision[k] = 12 / (parameter.range.high - parameter.range.low) ** 2
        else:
            precision[k], mean[k] = usual[1] ** -2, usual[0] - values[name]
    return precision, mean

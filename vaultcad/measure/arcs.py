"""The circles that an arch is drawn with, and how sure their centres and radii are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from families import Vault
from families.declaration.profiles import Arc
from vaultcad.model import FittedVault
from vaultcad.uncertain import Estimate

STEP = 1e-5  # of a parameter, by which slopes are taken


@dataclass(frozen=True)
class ArcEstimate:
    """A circle that an arch is part of, or, if its centre is off the middle, one half of it, as in a mirror the other.

    across: of its centre from the middle towards the half that it draws, negative beyond the middle. height: of its
    centre in the scan's local frame.
    """

    across: Estimate
    height: Estimate
    radius: Estimate


def arcs_of(arch: FittedVault) -> tuple[ArcEstimate, ...]:
    """Those of a fitted barrel from the springing to the crown; none for an ellipse."""
    return tuple(
        ArcEstimate(
            _estimate(arch, _Part(k, "u"), "centre from the middle of the span"),
            _estimate(arch, _Part(k, "z"), "centre", height=True),
            _estimate(arch, _Part(k, "radius"), "radius"),
        )
        for k in range(len(_arcs(arch.vault)))
    )


@dataclass(frozen=True)
class _Part:
    """A number of the k-th circle of a barrel [m]."""

    k: int
    name: str

    def __call__(self, vault: Vault) -> float:
        return float(getattr(_arcs(vault)[self.k], self.name))


def springing_of(fitted: FittedVault) -> Estimate:
    """Height of a vault's or an arch's springing in the scan's local frame."""
    return _estimate(fitted, lambda vault: vault.lift, "springing", height=True)


def _arcs(vault: Vault) -> tuple[Arc, ...]:
    half = vault.values()["span"] / 2
    return vault.profiles["profile"].curve(half).arcs


def _estimate(fitted: FittedVault, size: Callable[[Vault], float], meaning: str, *, height: bool = False) -> Estimate:
    """A length that follows from the parameters; with `height` above the scan's origin instead of the springing."""
    vault, spread = fitted.vault, fitted.covariance
    here = size(vault)
    std = None
    if spread is not None:
        values, ranges = vault.values(), {p.name: p.range for p in vault.parameters()}
        slopes = np.zeros(len(spread.names))
        for k, name in enumerate(spread.names):
            if name == "z" and height:
                slopes[k] = 1.0
            elif name in values:
                step = STEP if values[name] + STEP <= ranges[name].high else -STEP
                slopes[k] = (size(vault.replaced({name: values[name] + step})) - here) / step
        std = spread.std(slopes) or None
    return Estimate(here + height * fitted.pose.z, "m", std, meaning, derived=True)

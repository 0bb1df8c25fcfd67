"""A fitted vault as JSON and back, so that FreeCAD's documents keep what the fit found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from math import isfinite, nan
from typing import Any

from vaultcad.model import Component, Deviation, Estimate, FittedVault, Pose
from vaultcad.workbench.declarations import vault_of

KEPT = ("pose", "confidence", "alternatives", "components", "deviation", "coverage", "converged", "as_built", "odds")
UNMEASURED = Deviation(nan, nan, nan, nan, {}, "")


def told(fitted: FittedVault) -> dict[str, Any]:
    """Plain values: family, title, profiles, parameters, pose [m, rad], `estimates`, components and deviations."""
    whole = asdict(fitted)
    found: dict[str, Any] = _finite(
        {
            "family": fitted.vault.id,
            "title": fitted.vault.title,
            "profiles": fitted.vault.kinds,
            "parameters": fitted.vault.values(),
            "estimates": {name: asdict(estimate) for name, estimate in fitted.parameters.items()},
            **{name: whole[name] for name in KEPT},
        }
    )
    return found


def fitted_vault(plain: Mapping[str, Any]) -> FittedVault:
    """The vault of family, profiles, parameters and pose, with what `told` tells of a fit if that is there.

    Without it the vault has no components, and a deviation that holds nothing.

    Raises:
        ValueError: an unknown name, or a value outside its range.
    """
    vault = vault_of(plain["family"], plain.get("profiles", {}), plain["parameters"])
    pose = Pose(**{**plain["pose"], "lean": tuple(plain["pose"].get("lean", (0.0, 0.0)))})
    if "estimates" not in plain:
        sizes = {name: Estimate(value, "m", None, derived=True) for name, value in vault.derived_values().items()}
        declared = {
            p.name: Estimate(vault.values()[p.name], p.range.unit, None, p.range.meaning) for p in vault.parameters()
        }
        return FittedVault(vault, pose, 1.0, (), {**declared, **sizes}, (), UNMEASURED, 0.0)
    return FittedVault(
        vault=vault,
        pose=pose,
        confidence=plain["confidence"],
        alternatives=tuple((name, score) for name, score in plain["alternatives"]),
        parameters={name: _estimate(estimate) for name, estimate in plain["estimates"].items()},
        components=tuple(Component(**{**c, "deviation": _deviation(c["deviation"])}) for c in plain["components"]),
        deviation=_deviation(plain["deviation"]) or UNMEASURED,
        coverage=plain["coverage"],
        converged=plain["converged"],
        as_built=_deviation(plain["as_built"]),
        odds=plain.get("odds", {}),
    )


def _estimate(plain: Mapping[str, Any]) -> Estimate:
    fields: dict[str, Any] = {name: tuple(v) if isinstance(v, list) else v for name, v in plain.items()}
    return Estimate(**fields)


def _deviation(plain: Mapping[str, Any] | None) -> Deviation | None:
    if plain is None:
        return None
    return Deviation(**{**plain, "within": {float(limit): share for limit, share in plain["within"].items()}})


def _finite(value: Any) -> Any:
    """Without what JSON cannot hold: None in place of what is no number, texts as keys."""
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float):
        return float(value) if isfinite(value) else None
    return value

"""model.json: a whole model as plain values and back, to be kept, edited by hand, and written in any format again."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from math import isfinite, nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families import Vault
from segmentation.crs import Crs
from segmentation.notes import Note
from vaultcad.deformation import deformation_of
from vaultcad.displacement import Displacement
from vaultcad.errors import ModelFileError
from vaultcad.model import Component, FittedArch, FittedPier, FittedVault, Model, PlacedVault, Rival
from vaultcad.pose import Pose
from vaultcad.uncertain import Covariance, Deviation, Estimate

MODEL = "model.json"
SCHEMA = 1
ABOUT = "a model of vaultcad; after an edit of parameters, poses or thickness `vaultcad export` writes it again"
SAME = 1e-9  # m, rad or 1; what an edited number is at least off the fitted one
THICKEST = 5.0  # m


def write_model(model: Model, path: Path) -> None:
    """Write `plain_model` as indented UTF-8 JSON."""
    told = json.dumps(plain_model(model), indent=1, ensure_ascii=False, allow_nan=False)
    path.write_text(told + "\n", encoding="utf-8")


def read_model(path: Path) -> Model:
    """The model that `write_model` wrote, with the edits that were made since; a note says which vaults were edited.

    Raises:
        ModelFileError: it is no such file, or an edit cannot be; names the field, the value and what it may be.
        OSError: it cannot be read.
    """
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise ModelFileError(f"{path}: is no JSON ({error}); give a model.json of vaultcad") from error
    if not isinstance(told, dict) or "vaults" not in told or "scan" not in told:
        raise ModelFileError(f"{path}: is no model of vaultcad; give the model.json that a fit left")
    if told.get("schema") != SCHEMA:
        raise ModelFileError(f"{path}: schema = {told.get('schema')!r} is not known; this version reads {SCHEMA}")
    try:
        return _model(told)
    except KeyError as error:
        raise ModelFileError(f"{path}: {error.args[0]} is missing; take it from the file as the fit left it") from None
    except (ValueError, TypeError, AttributeError) as error:
        raise ModelFileError(f"{path}: {error}; mend the file, or fit the scan again") from error


def plain_model(model: Model) -> dict[str, Any]:
    """All of a model but its notes' sources as plain values, ready for JSON."""
    return {
        "schema": SCHEMA,
        "about": ABOUT,
        "scan": {"name": model.scan.name, "points": model.points, "bounds": model.bounds.tolist()},
        "unit": model.unit,
        "crs": None if model.crs is None else asdict(model.crs),
        "origin": model.origin.tolist(),
        "thickness": model.thickness,
        "settings": finite(dict(model.settings)),
        "versions": dict(model.versions),
        "notes": [note._asdict() for note in model.notes],
        "vaults": [plain_vault(fitted) for fitted in model.vaults],
        "arches": [plain_arch(arch) for arch in model.arches],
        "piers": [_plain_pier(pier) for pier in model.piers],
        "ceiling": dict(model.ceiling),
    }


def plain_vault(fitted: FittedVault) -> dict[str, Any]:
    """A fitted vault as plain values: what `Vault.plain` tells, its pose [m, rad], and what else was found."""
    whole = asdict(replace(fitted, covariance=None, surface=None))
    if fitted.covariance is not None:
        whole["covariance"] = _plain_covariance(fitted.covariance)
    if fitted.surface is not None:
        whole["surface"] = fitted.surface.plain()
    found = {name: whole[name] for name in ("pose", *DECODERS)}
    told: dict[str, Any] = finite(
        {**fitted.vault.plain(), "title": fitted.vault.title, **found, "estimates": whole["parameters"]}
    )
    return told


def plain_arch(arch: FittedArch) -> dict[str, Any]:
    """A fitted arch likewise, with its depths and what is beside it."""
    depths = {"depth": finite(arch.depth), "depth_std": finite(arch.depth_std)}
    line = {"line": arch.line} if arch.line else {}
    return plain_vault(arch) | depths | {"beside": list(arch.beside)} | line


def _plain_pier(pier: FittedPier) -> dict[str, Any]:
    told: dict[str, Any] = finite(asdict(pier) | {"covariance": _plain_covariance(pier.covariance)})
    return told


def _plain_covariance(covariance: Covariance) -> dict[str, Any]:
    return {"names": covariance.names, "matrix": covariance.matrix.tolist()}


def placed_vault(told: Mapping[str, Any]) -> PlacedVault:
    """The vault that a table tells of: a fitted one, or without estimates one that was never fitted.

    Raises:
        ValueError: an unknown name, or a value of another kind or outside its range.
        KeyError: it has no pose.
        TypeError: something that was found is missing.
    """
    if "estimates" in told:
        return fitted_vault(told)
    own = {name: DECODERS[name](told[name]) for name in OWN if name in told}
    return PlacedVault(Vault.from_plain(told), _pose(told["pose"]), **own)


def fitted_vault(told: Mapping[str, Any]) -> FittedVault:
    """The vault that `plain_vault` tells of.

    Raises:
        ValueError: an unknown name, or a value of another kind or outside its range.
        KeyError: it has no pose, or no estimates.
        TypeError: something else that was found is missing.
    """
    return FittedVault(**_fitted(told))


def fitted_arch(told: Mapping[str, Any]) -> FittedArch:
    """The arch that `plain_arch` tells of; raises as `fitted_vault` does."""
    depth, std = _two("depth", told["depth"]), _two("depth_std", told.get("depth_std", (None, None)))
    below, above = map(int, told["beside"])
    return FittedArch(
        **_fitted(told), depth=depth, beside=(below, above), depth_std=std, line=str(told.get("line", ""))
    )


def _two(name: str, told: Any) -> tuple[float, float]:
    """Of the south and north of an arch, NaN where it is not known."""
    south, north = (nan if side is None else _number(name, side) for side in told)
    return south, north


def _fitted(told: Mapping[str, Any]) -> dict[str, Any]:
    """The fields of a fitted vault."""
    vault, pose = Vault.from_plain(told), _pose(told["pose"])
    read = {name: decode(told[name]) for name, decode in DECODERS.items() if name in told}
    if is_edited(told):
        read["surface"] = None  # which displaces the vault that was fitted
    return {"vault": vault, "pose": pose, "parameters": _estimates(vault, told["estimates"])} | read


def is_edited(told: Mapping[str, Any]) -> bool:
    """Whether a vault's parameters are others than those of its fit."""
    values = Vault.from_plain(told).values()
    estimates = told.get("estimates", {})
    return any(name in estimates and abs(estimates[name]["value"] - v) > SAME for name, v in values.items())


def finite(value: Any) -> Any:
    """Without what JSON cannot hold: None in place of what is no number, texts as keys."""
    if isinstance(value, Mapping):
        return {str(key): finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    if isinstance(value, float):
        return float(value) if isfinite(value) else None
    return value


def _model(told: Mapping[str, Any]) -> Model:
    scan, crs = told["scan"], told["crs"]
    arches = told.get("arches", [])  # which files of earlier versions do not have
    edited = [
        *(f"vault {k}" for k, vault in enumerate(told["vaults"], 1) if is_edited(vault)),
        *(f"arch {k}" for k, arch in enumerate(arches, 1) if is_edited(arch)),
    ]
    notes = [Note(note["code"], note["text"]) for note in told["notes"]]
    if edited:
        which = f"{', '.join(edited)} {'was' if len(edited) == 1 else 'were'}"
        text = f"{which} edited after the fit, whose deviations and coverage are told; bodies are ideal ones"
        notes.append(Note("edited", text))
    return Model(
        scan=Path(scan["name"]),
        points=int(scan["points"]),
        bounds=np.array(scan["bounds"], np.float64).reshape(2, 3),
        origin=_origin(told["origin"]),
        vaults=tuple(map(fitted_vault, told["vaults"])),
        arches=tuple(map(fitted_arch, arches)),
        piers=tuple(map(_pier, told.get("piers", []))),
        ceiling=told.get("ceiling", {}),
        thickness=thickness("thickness", told["thickness"]),
        settings=told["settings"],
        versions=told["versions"],
        unit=_number("unit", told["unit"]),
        crs=None if crs is None else Crs(**crs),
        notes=tuple(notes),
    )


def _pier(told: Mapping[str, Any]) -> FittedPier:
    covariance = Covariance(tuple(told["covariance"]["names"]), np.array(told["covariance"]["matrix"], np.float64))
    sizes = {name: _estimate(plain) for name, plain in told["parameters"].items()}
    return FittedPier(
        told["plan"], _pose(told["pose"]), sizes, int(told["points"]), _measured(told["deviation"]), covariance
    )


def thickness(name: str, value: Any) -> float:
    """A thickness [m]. Raises ValueError for what cannot be one."""
    if not 0 < _number(name, value) <= THICKEST:
        raise ValueError(f"{name} = {value!r} lies outside (0, {THICKEST:g}] m")
    return float(value)


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise ValueError(f"{name} = {value!r} is no number")
    return float(value)


def _origin(told: Any) -> NDArray[np.float64]:
    if not isinstance(told, list) or len(told) != 3:
        raise ValueError(f"origin = {told!r} is no place; give three numbers")
    return np.array([_number("origin", value) for value in told])


def _pose(told: Mapping[str, Any]) -> Pose:
    x, y, z, yaw = (_number(f"pose.{name}", told[name]) for name in ("x", "y", "z", "yaw"))
    first, second = (_number("pose.lean", v) for v in told.get("lean", (0.0, 0.0)))
    return Pose(x, y, z, yaw, (first, second))


def _estimates(vault: Vault, told: Mapping[str, Any]) -> dict[str, Estimate]:
    """Those of the fit; where a number was edited since, the new one, of which no deviation is known."""
    own = {**vault.values(), **vault.derived_values()}
    found: dict[str, Estimate] = {}
    for name, plain in told.items():
        estimate = _estimate(plain)
        if name in own and abs(own[name] - estimate.value) > SAME:
            estimate = replace(estimate, value=own[name], std=None, flags=())
        found[name] = estimate
    return found


def _estimate(told: Mapping[str, Any]) -> Estimate:
    fields: dict[str, Any] = {key: tuple(v) if isinstance(v, list) else v for key, v in told.items()}
    return Estimate(**fields)


def _deviation(told: Mapping[str, Any] | None) -> Deviation | None:
    if told is None:
        return None
    names = ("mean", "rms", "p95", "max", *(name for name in ("median", "signed_mean") if name in told))
    numbers = {name: nan if told[name] is None else told[name] for name in names}
    return Deviation(**numbers, within={float(k): v for k, v in told["within"].items()}, loa=told["loa"])


def _measured(told: Mapping[str, Any] | None) -> Deviation:
    deviation = _deviation(told)
    if deviation is None:
        raise ValueError("deviation = None is no measure; a vault that was fitted has one")
    return deviation


def _covariance(told: Mapping[str, Any] | None) -> Covariance | None:
    return None if not told else Covariance(tuple(told["names"]), np.array(told["matrix"], np.float64))


def _component(told: Mapping[str, Any]) -> Component:
    measured = {name: _deviation(told.get(name)) for name in ("deviation", "as_built", "nurbs")}
    return Component(**{**told, **measured})


DECODERS: dict[str, Callable[[Any], Any]] = {
    "confidence": float,
    "alternatives": lambda told: tuple((name, score) for name, score in told),
    "components": lambda told: tuple(map(_component, told)),
    "deviation": _measured,
    "coverage": float,
    "converged": bool,
    "as_built": _deviation,
    "nurbs": _deviation,
    "covariance": _covariance,
    "tolerance": float,
    "thickness": lambda told: None if told is None else thickness("thickness", told),
    "label": str,
    "solid": bool,
    "odds": dict,
    "doubt": str,
    "shell": lambda told: None if told is None else _estimate(told),
    "surface": lambda told: None if told is None else Displacement.from_plain(told),
    "deformation": deformation_of,
    "rivals": lambda told: tuple(Rival(**{**one, "constraints": tuple(one["constraints"])}) for one in told),
}
"""How what a fit found is read, by its names."""
OWN = ("thickness", "label", "solid")
"""What is known of those that were never fitted, too."""

"""report.json: all numbers of a model under stable keys (schema 1), in the scan's own coordinates turned into metres.

Only the bounds of the scan are in its own unit.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterable, Mapping
from math import degrees, isfinite
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.units import unit_of
from vaultcad.export.movements import plain_deformation
from vaultcad.measure.arcs import arcs_of, springing_of
from vaultcad.measure.building import Building, building_of, letters
from vaultcad.measure.routes import apart
from vaultcad.measure.setting_out import RULES, setting_out
from vaultcad.model import Component, FittedArch, FittedPier, FittedVault, Model, Rival
from vaultcad.pose import Pose
from vaultcad.uncertain import Covariance, Deviation, Estimate

SCHEMA = 1
DECIMALS = 6  # of metres and of shares: a micrometre, well below what any scan can tell
SLIGHT = 0.001  # chance of a rule below which it goes without saying
SHOWN_AS = {"rad": ("deg", degrees)}  # units that people do not read, and what is written in their place


def report(model: Model, *, correlations: bool = False) -> dict[str, Any]:
    """The content of report.json as plain values, the same for the same scan and settings.

    With `correlations` each vault has those of pose and fitted parameters.
    """
    building = building_of(model)
    return {
        "schema": SCHEMA,
        "scan": {
            "path": model.scan.name,  # wherever it lies, so that it gives the same bytes there
            "points": int(model.points),
            "bounds": [_row(row) for row in model.bounds],
            "unit": {"name": unit_of(model.unit), "metres": model.unit},
            "crs": None if model.crs is None else {"name": model.crs.name, "epsg": model.crs.epsg},
        },
        "origin": _row(model.origin),
        "settings": plain(model.settings),
        "versions": dict(sorted(model.versions.items())),
        "thickness": _number(model.thickness),
        "notes": [note._asdict() for note in model.notes],
        "vaults": [
            _vault(fitted, model) | _bay(building, k) | (_correlations(fitted) if correlations else {})
            for k, fitted in enumerate(model.vaults, 1)
        ],
        "arches": [arch(one, k, model) for k, one in enumerate(model.arches, 1)],
        "building": {
            "rows": {letters(k): list(row) for k, row in enumerate(building.rows)},
            "rooms": [list(room) for room in building.rooms],
            "storeys": [
                {"floor": _number(floor + float(model.origin[2])), "vaults": list(storey)}
                for floor, storey in zip(building.floors, building.storeys, strict=True)
            ],
        },
        "ceiling": {name: _number(area) for name, area in model.ceiling.items()},  # m²
        "piers": [_pier(pier, model.origin) for pier in model.piers],
    }


def write_report_json(model: Model, path: Path, *, correlations: bool = False) -> None:
    """Write `report` as indented UTF-8 JSON."""
    told = report(model, correlations=correlations)
    path.write_text(json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")


def in_shown_unit(estimate: Estimate) -> Estimate:
    """The estimate in the unit that people read: degrees for radians."""
    if estimate.unit not in SHOWN_AS:
        return estimate
    unit, convert = SHOWN_AS[estimate.unit]
    std = None if estimate.std is None else convert(estimate.std)
    return dataclasses.replace(estimate, value=convert(estimate.value), unit=unit, std=std)


def plain(value: Any) -> Any:
    """Settings as JSON knows them: mappings, lists, numbers, strings; anything else by its string."""
    match value:
        case Mapping():
            return {str(k): plain(v) for k, v in value.items()}
        case list() | tuple():
            return [plain(v) for v in value]
        case bool() | int() | str() | None:
            return value
        case float():
            return value if isfinite(value) else str(value)
        case np.generic():
            return plain(value.item())
        case _:
            return str(value)


def _bay(building: Building, vault: int) -> dict[str, Any]:
    """Where a vault stands among the others."""
    row, place = building.bay(vault)
    return {"bay": {"row": row, "number": place, "room": building.room(vault), "storey": building.storey(vault)}}


def arch(one: FittedArch, number: int, model: Model) -> dict[str, Any]:
    """An arch; heights and places in the coordinates of the pose [m], depth and neighbours south and north of it."""
    up = float(model.origin[2])
    south, north = one.depth
    rules = {rule.name: rule.says for rule in RULES}
    return {
        "id": number,
        "family": one.kind,
        "between": [beside or None for beside in one.beside],
        "profile": one.vault.kinds["profile"],
        "profile_odds": _odds(one.odds.get("profile", {})),
        "span": _estimate(one.parameters["span"]),
        "rise": _estimate(one.parameters["rise"]),
        "springing": _raised(springing_of(one), up),
        "width": _estimate(one.parameters["length"]),
        "thickness": _number(model.thickness_of(one)),
        "thickness_std": _number(one.ring_std) if one.thickness is None else None,
        "depth": {"south": _number(south), "north": _number(north)},
        "depth_std": {"south": _number(one.depth_std[0]), "north": _number(one.depth_std[1])},
        "arcs": [
            {"radius": _estimate(arc.radius), "across": _estimate(arc.across), "height": _raised(arc.height, up)}
            for arc in arcs_of(one)
        ],
        "setting_out": [
            {"rule": name, "chance": _number(chance), "says": rules.get(name, "")}
            for name, chance in setting_out(one).items()
            if chance >= SLIGHT
        ],
        "pose": _pose(one.pose, one.covariance, model.origin),
        "points": sum(c.points for c in one.components),
        "confidence": _number(one.confidence),
        "converged": one.converged,
        "deviation": _deviation(one.deviation),
        "as_built": _as_built(one),
        "coverage": _number(one.coverage),
        "tolerance": _number(round(one.tolerance, 4)),
    }


def _raised(estimate: Estimate, by: float) -> dict[str, Any]:
    return _estimate(dataclasses.replace(estimate, value=estimate.value + by))


def _odds(odds: Mapping[str, float]) -> dict[str, float | None]:
    return {kind: _number(chance) for kind, chance in odds.items()}


def _vault(fitted: FittedVault, model: Model) -> dict[str, Any]:
    origin = model.origin
    return {
        "family": fitted.vault.id,
        "confidence": _number(fitted.confidence),
        "alternatives": [{"family": name, "score": _number(score)} for name, score in fitted.alternatives],
        "doubt": fitted.doubt or None,
        "converged": fitted.converged,
        "pose": _pose(fitted.pose, fitted.covariance, origin),
        "corners": _corners(fitted, origin),
        "profiles": fitted.vault.kinds,
        "profile_odds": {name: _odds(odds) for name, odds in fitted.odds.items()},
        "rivals": [_rival(rival, fitted, origin) for rival in fitted.rivals],
        "parameters": {name: _estimate(value) for name, value in fitted.parameters.items()},
        "components": [_component(c) for c in fitted.components],
        "deviation": _deviation(fitted.deviation),
        "as_built": _as_built(fitted),
        "nurbs": _measured(fitted.nurbs),
        "coverage": _number(fitted.coverage),
        "tolerance": _number(round(fitted.tolerance, 4)),
        "thickness": _number(model.thickness_of(fitted)),
        "thickness_std": _number(fitted.measured_shell.std) if fitted.measured_shell else None,
        "deformation": plain_deformation(fitted.deformation),
    }


def _pier(pier: FittedPier, origin: NDArray[np.float64]) -> dict[str, Any]:
    return {
        "plan": pier.plan,
        "pose": _pose(pier.pose, pier.covariance, origin),
        "parameters": {name: _estimate(value) for name, value in pier.parameters.items()},
        "points": int(pier.points),
        "deviation": _deviation(pier.deviation),
    }


def _pose(pose: Pose, covariance: Covariance | None, origin: NDArray[np.float64]) -> dict[str, Any]:
    return {
        "origin": _row((pose.x + origin[0], pose.y + origin[1], pose.z + origin[2])),
        "yaw_deg": _number(degrees(pose.yaw)),
        "tilt_deg": _number(degrees(pose.tilt)),
        "lean_deg": [_number(degrees(part)) for part in pose.lean],  # rotation vector about x and y
        **_pose_std(covariance),
    }


def _rival(rival: Rival, fitted: FittedVault, origin: NDArray[np.float64]) -> dict[str, Any]:
    """One way in which the vault may have been built; the springing in the coordinates of the pose [m]."""
    return {
        "chance": _number(rival.chance),
        "profiles": dict(rival.profiles),
        "constraints": list(rival.constraints),
        "springing": _number(fitted.pose.z + rival.springing + float(origin[2])),
        "parameters": {name: _number(value) for name, value in rival.sizes.items()},
    }


def _corners(fitted: FittedVault, origin: NDArray[np.float64]) -> list[list[float | None]]:
    """The corners of the plan, counterclockwise, at the springing in the coordinates of the pose [m]."""
    corners = fitted.vault.corners
    flat = np.column_stack([corners, np.zeros(len(corners)), np.ones(len(corners))])
    return [_row(tuple((point[:3] + origin).tolist())) for point in flat @ fitted.pose.placement().T]


def _estimate(estimate: Estimate) -> dict[str, Any]:
    e = in_shown_unit(estimate)
    row: dict[str, Any] = {"value": _number(e.value), "unit": e.unit, "std": _number(e.std)}
    row |= {} if e.seen is None else {"seen": _number(e.seen)}
    row |= {"flags": list(e.flags)} if e.flags else {}
    return row | {"derived": True} if e.derived else row


def _pose_std(covariance: Covariance | None) -> dict[str, Any]:
    """Standard deviations of the pose, in metres and degrees; null for what was held."""
    if covariance is None:
        return {}
    stds = covariance.stds()
    return {
        "std": {name: _number(stds[name] or None) for name in "xyz"}
        | {"yaw_deg": _number(degrees(stds["yaw"]) or None)}
    }


def _correlations(fitted: FittedVault) -> dict[str, Any]:
    if fitted.covariance is None:
        return {}
    rows = fitted.covariance.correlations().tolist()
    return {"correlations": {"names": list(fitted.covariance.names), "matrix": [_row(row) for row in rows]}}


def _component(component: Component) -> dict[str, Any]:
    return {
        "id": int(component.id),
        "name": component.name,
        "points": int(component.points),
        "deviation": None if component.deviation is None else _deviation(component.deviation),
        "as_built": _measured(component.as_built),
        "nurbs": _measured(component.nurbs),
        "coverage": _number(component.coverage),
    }


def _as_built(fitted: FittedVault) -> dict[str, Any] | None:
    """Distances of the points to the as-built surface, and of that to the ideal one."""
    if fitted.as_built is None:
        return None
    told = {"deviation": _deviation(fitted.as_built)}
    return told if fitted.surface is None else told | {"from_ideal": _deviation(apart(fitted.vault, fitted.surface))}


def _measured(deviation: Deviation | None) -> dict[str, Any] | None:
    """Distances of points to a surface in which they had no part."""
    return None if deviation is None else {"deviation": _deviation(deviation)}


def _deviation(deviation: Deviation) -> dict[str, Any]:
    return {
        "mean": _number(deviation.mean),
        "signed_mean": _number(deviation.signed_mean),
        "median": _number(deviation.median),
        "rms": _number(deviation.rms),
        "p95": _number(deviation.p95),
        "max": _number(deviation.max),
        "within": {f"{limit:g}": _number(share) for limit, share in sorted(deviation.within.items())},
        "loa": deviation.loa,
    }


def _row(values: Iterable[float]) -> list[float | None]:
    return [_number(v) for v in values]


def _number(value: float | None) -> float | None:
    """Rounded; None for what is unknown or no number. Never -0.0."""
    return None if value is None or not isfinite(value) else round(float(value), DECIMALS) + 0.0

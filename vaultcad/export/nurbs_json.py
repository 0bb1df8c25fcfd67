"""nurbs.json: the free surfaces as numbers, and how far the stone is from them."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from vaultcad.nurbs.route import FreeRoute, FreeVault
from vaultcad.nurbs.spline_surface import DEGREE
from vaultcad.uncertain import Deviation

SCHEMA = 1
DECIMALS = 6  # of metres


def write_nurbs_json(route: FreeRoute, path: Path) -> None:
    """Write degrees, knots and control points [m, relative to the origin], tolerances and deviations [m]."""
    told = {
        "schema": SCHEMA,
        "route": "nurbs",
        "scan": route.model.scan.name,
        "origin": route.model.origin.tolist(),
        "net": route.net,
        "left_out": list(route.left_out),
        "vaults": [_vault(vault) for vault in route.vaults],
    }
    path.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")


def _vault(vault: FreeVault) -> dict[str, Any]:
    form, outline = vault.form, vault.form.outline
    shared = [share for share, edge in zip(form.crossing, outline.edges, strict=True) if len(edge.sides) == 2]
    components: dict[int, dict[str, Any]] = {}
    for region in outline.regions:
        found = vault.through.components.get(region.component)
        apart = None if vault.withheld is None else vault.withheld.components.get(region.component)
        components[region.component] = {
            "id": region.component,
            "name": region.name,
            "deviation": None if found is None else _deviation(found),
            "withheld": None if apart is None else _deviation(apart),
            "seen": True,
            "surfaces": [],
            "nets": [],
        }
    for k in form.unseen:
        components[outline.regions[k].component]["seen"] = False
    place = vault.fitted.pose.placement()
    for (_, region_index), surface in zip(vault.sheet.faces, vault.sheet.surfaces, strict=True):
        points = surface.points @ place[:3, :3].T + place[:3, 3]
        components[outline.regions[region_index].component]["surfaces"].append(
            {
                "degree": [DEGREE, DEGREE],
                "knots_u": _rounded(surface.knots_u),
                "knots_v": _rounded(surface.knots_v),
                "control_points": _rounded(points),
            }
        )
    for net in vault.nets:
        rows, columns, _ = net.points.shape
        components[outline.regions[net.region].component]["nets"].append([rows - 1, columns - 1])
    return {
        "vault": vault.number,
        "family": vault.fitted.vault.id,
        "valid": vault.sheet.valid,
        "watertight": vault.sheet.watertight,
        "edges": {
            "shared": len(shared),
            "intersected": round(float(np.mean(shared)) if shared else 1.0, 4),
            "led": form.led,
            "tolerance": round(vault.sheet.gap, DECIMALS),
        },
        "deviation": _deviation(vault.through.whole),
        "withheld": None if vault.withheld is None else _deviation(vault.withheld.whole),
        "components": list(components.values()),
    }


def _deviation(deviation: Deviation) -> dict[str, Any]:
    told = asdict(deviation) | {"within": {f"{limit:g}": share for limit, share in deviation.within.items()}}
    return {name: round(value, DECIMALS) if isinstance(value, float) else value for name, value in told.items()}


def _rounded(values: np.ndarray[Any, np.dtype[np.float64]]) -> Any:
    return (np.round(values, DECIMALS) + 0.0).tolist()

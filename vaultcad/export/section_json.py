"""sections.json: every section with its lines, arches and figures, as plain values."""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import groupby
from math import degrees, isfinite
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families.void.upright import Upright
from vaultcad.coordinates import Coordinates, placed, says
from vaultcad.model import Model
from vaultcad.sections.section import ModelLine, Section, SectionArc, SectionArch, SectionPart
from vaultcad.uncertain import Deviation, Estimate

SCHEMA = 1
DIGITS, ANGLE_DIGITS = 4, 6  # a tenth of a millimetre


def write_section_json(
    model: Model, sections: Sequence[Section], path: Path, coordinates: Coordinates = "file"
) -> None:
    """Write them all, lines also in space, in those coordinates; each section is one line of the file."""
    about = {
        "schema": SCHEMA,
        "scan": {"name": model.scan.name},
        "origin": [float(v) for v in model.origin],
        "coordinates": says(model, coordinates),
    }
    told = ",\n".join(_dumped(plain(model, section, coordinates)) for section in sections)
    path.write_text(f'{_dumped(about)[:-1]}, "sections": [\n{told}\n]}}\n', encoding="utf-8")


def _dumped(value: dict[str, Any]) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def plain(model: Model, section: Section, coordinates: Coordinates) -> dict[str, Any]:
    """One section. `line` holds points [u, z] [m], `scan_line` the same in space, in the coordinates of the file."""
    return {
        "id": section.id,
        "vault": section.vault or None,
        "arch": section.arch or None,
        "plane": _plane(model, section, coordinates),
        "slab": section.slab,
        "grid": section.grid,
        "points": section.points,
        "profile": [
            {
                "line": _rows(run.line),
                "scan_line": _rows(placed(model, section.in_scan(run.line), coordinates)),
                "std": _row(run.std),
                "components": _stretches(section, run.component),
            }
            for run in section.profile
        ],
        "ideal": [_model_line(section, line) for line in section.ideal],
        "as_built": [_model_line(section, line) for line in section.as_built],
        "arches": [_arch(arch) for arch in section.arches],
        "parts": [_part(part) for part in section.parts],
        "deviation": _deviation(section.deviation, section.bias, section.median),
    }


def _plane(model: Model, section: Section, coordinates: Coordinates) -> dict[str, Any]:
    plane = section.plane
    where: dict[str, Any] = {"kind": plane.kind, "name": plane.name, "told": plane.told}
    if isinstance(plane.cut, Upright):
        ends = section.in_scan(np.array([[0.0, 0.0], [1.0, 0.0]]))
        along = ends[1] - ends[0]
        where |= {
            "through": _row(np.array(plane.cut.origin)),
            "azimuth_deg": round(degrees(plane.cut.azimuth), ANGLE_DIGITS),
            "scan_through": _row(placed(model, ends[:1], coordinates)[0]),
            "scan_azimuth_deg": round(float(np.degrees(np.arctan2(along[1], along[0]))), ANGLE_DIGITS),
        }
    else:
        where["level"] = plane.cut.z
    return where


def _stretches(section: Section, component: NDArray[np.uint16]) -> list[dict[str, Any]]:
    """Runs of one component: its name, the first point and the last."""
    found, at = [], 0
    for number, run in groupby(component.tolist()):
        size = len(list(run))
        name = section.names[number - 1] if number else "wall"
        found.append({"component": name, "first": at, "last": at + size - 1})
        at += size
    return found


def _model_line(section: Section, line: ModelLine) -> dict[str, Any]:
    return {"line": _rows(line.line), "stretches": _stretches(section, line.component)}


def _arch(arch: SectionArch) -> dict[str, Any]:
    return {
        "kind": arch.kind,
        "odds": {name: round(chance, ANGLE_DIGITS) for name, chance in arch.odds.items()},
        "setting_out": {name: round(chance, ANGLE_DIGITS) for name, chance in arch.rules.items()},
        "sizes": {name: _estimate(size) for name, size in arch.sizes.items()},
        "arcs": [_arc(arc) for arc in arch.arcs],
        "line": _rows(arch.line),
        "rms": round(arch.rms, DIGITS + 1),
        "settlement": round(arch.settlement, DIGITS + 1),
        "components": list(arch.components),
    }


def _part(part: SectionPart) -> dict[str, Any]:
    return {
        "form": part.form,
        "arc": None if part.arc is None else _arc(part.arc),
        "line": _rows(part.line),
        "rms": round(part.rms, DIGITS + 1),
        "components": list(part.components),
    }


def _arc(arc: SectionArc) -> dict[str, Any]:
    sizes = {"u": _estimate(arc.u), "z": _estimate(arc.z), "radius": _estimate(arc.radius)}
    return sizes | {"start": round(arc.start, ANGLE_DIGITS), "end": round(arc.end, ANGLE_DIGITS)}


def _estimate(size: Estimate) -> dict[str, Any]:
    std = None if size.std is None or not isfinite(size.std) else round(size.std, ANGLE_DIGITS)
    return {"value": round(size.value, ANGLE_DIGITS), "unit": size.unit, "std": std}


def _deviation(deviation: Deviation | None, bias: float, median: float) -> dict[str, Any] | None:
    if deviation is None:
        return None
    told = {name: round(getattr(deviation, name), ANGLE_DIGITS) for name in ("mean", "rms", "p95", "max")}
    signed = {"bias": round(bias, ANGLE_DIGITS), "median": round(median, ANGLE_DIGITS)}
    return {**told, **signed, "within": {f"{k:g}": v for k, v in deviation.within.items()}, "loa": deviation.loa}


def _row(values: NDArray[np.float64]) -> list[float]:
    told: list[float] = _rounded(values).tolist()
    return told


def _rows(values: NDArray[np.float64]) -> list[list[float]]:
    told: list[list[float]] = _rounded(values).tolist()
    return told


def _rounded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.round(values, DIGITS) + 0.0, np.float64)

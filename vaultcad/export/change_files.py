"""The files of a comparison of two scans: figures, a coloured cloud, and a map, written all or nothing."""

from __future__ import annotations

import json
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families.drawing.deviation_colours import CONVENTION, UNKNOWN, limit_of, shades
from families.drawing.png import write_png
from families.drawing.sheet import Drawing
from families.drawing.svg import document
from segmentation.cloud import Cloud
from segmentation.io.whole import writing
from vaultcad.change.two_dates import ScanChange, VaultChange
from vaultcad.change.words import in_words
from vaultcad.export.folder import Place, check_target, replacing_folder
from vaultcad.export.movements import millimetres, plain_movement

CHANGE, CLOUD, MAP_SVG, MAP_PNG = "change.json", "change.laz", "change.svg", "change.png"
NAMES = (CHANGE, CLOUD, MAP_SVG, MAP_PNG)
SCHEMA = 1
PIXELS = 150.0  # of the map a metre, in SVG
DPI, INCHES = 130, 9.0  # of the picture, its width
UNDER_TITLE = 0.97  # of its height
LOOK = {"font.size": 9, "axes.titlesize": 9}
MAPPED = 0.25  # m, cells of the map, in each of which there are core points
GAP = 0.6  # m, between the maps of several vaults
LEAST_LIMIT = 0.005  # m, at which the scale of colours ends at the least


def write_change(change: ScanChange, out: Path, *, after: str, force: bool = False) -> Place:
    """Write all files into the folder `out`, which appears, or changes, as one when they are complete.

    after: the name of the second scan.

    Raises:
        ExportError: `out` is no folder, no earlier result or cannot be replaced as a whole, or none can be made there.
        WriteError: the disk is full, or a file cannot be written for another reason of the system's.
    """
    check_target(out, NAMES, force=True)
    drawing = change_map(change)
    size = (INCHES, INCHES * drawing.size[1] / drawing.size[0])
    with replacing_folder(out, force=force) as place:
        for name, write in (
            (CHANGE, lambda path: _write_json(change, path, after)),
            (CLOUD, lambda path: _write_cloud(change, path)),
            (MAP_SVG, lambda path: path.write_text(document(drawing, PIXELS), encoding="utf-8")),
            (MAP_PNG, lambda path: write_png(drawing, path, size, DPI, top=UNDER_TITLE, look=LOOK)),
        ):
            with writing(out / name):
                write(place.part / name)
    return place


def plain_change(change: ScanChange, after: str) -> dict[str, Any]:
    """All figures as plain values: lengths in millimetres, places in the coordinates of the first scan [m]."""
    registration, origin = change.registration, change.model.origin
    std = np.sqrt(np.diag(registration.covariance))
    return {
        "schema": SCHEMA,
        "before": change.model.scan.name,
        "after": after,
        "says": in_words(change),
        "registration": {
            "given": change.given,
            "points": registration.points,
            "turn": registration.turn.tolist(),
            "centre": (registration.centre + origin).tolist(),
            "shift_mm": [millimetres(v) for v in registration.shift],
            "std_turn_deg": [round(degrees(v), 6) for v in std[:3].tolist()],
            "std_shift_mm": [millimetres(v) for v in std[3:]],
            "systematic_mm": millimetres(registration.systematic),
        },
        "vaults": [_vault(one, origin) for one in change.vaults],
    }


def _vault(one: VaultChange, origin: NDArray[np.float64]) -> dict[str, Any]:
    on, cells = one.component > 0, one.cells
    names = enumerate(one.fitted.vault.components, 1)
    most = int(np.argmax(np.abs(cells.change))) if len(cells.change) else None
    return {
        "number": one.number,
        "family": one.fitted.vault.id,
        "changed": one.changed,
        "detectable_mm": millimetres(cells.detectable),
        "changed_share": round(float(cells.changed.mean()), 4) if most is not None else None,
        "largest": None if most is None else _largest(one, most, origin),
        "whole": _figures(one, on),
        "components": [{"id": k, "name": name, **_figures(one, one.component == k)} for k, name in names],
        "movements": [plain_movement(movement) for movement in one.movements],
    }


def _largest(one: VaultChange, most: int, origin: NDArray[np.float64]) -> dict[str, Any]:
    placement = one.fitted.pose.placement()
    place = placement[:3, :3] @ one.cells.place[most] + placement[:3, 3] + origin
    limit = one.cells.quantile * float(one.cells.std[most])
    return {
        "change_mm": millimetres(one.cells.change[most]),
        "limit_mm": millimetres(limit),
        "at": place.round(3).tolist(),
    }


def _figures(one: VaultChange, mine: NDArray[np.bool_]) -> dict[str, Any]:
    """Of core points: signed changes are positive into the stone."""
    mine = mine & np.isfinite(one.distances.change)
    change, lod = one.distances.change[mine], one.distances.lod[mine]
    if len(change) == 0:
        return {"cores": 0, "mean_mm": None, "median_mm": None, "max_mm": None, "significant": None, "lod95_mm": None}
    return {
        "cores": len(change),
        "mean_mm": millimetres(change.mean()),
        "median_mm": millimetres(np.median(change)),
        "max_mm": millimetres(change[np.argmax(np.abs(change))]),
        "significant": round(float((np.abs(change) > lod).mean()), 4),
        "lod95_mm": millimetres(np.median(lod)),
    }


def _write_json(change: ScanChange, path: Path, after: str) -> None:
    told = json.dumps(plain_change(change, after), indent=2, ensure_ascii=False, allow_nan=False)
    path.write_text(told + "\n", encoding="utf-8")


def _write_cloud(change: ScanChange, path: Path) -> None:
    """Core points in the coordinates of the first scan, coloured as the map."""
    from segmentation.io.write import write

    def joined(values: Any) -> Any:
        return np.concatenate([values(one) for one in change.vaults])

    moved = joined(lambda one: one.distances.change)
    settings = change.model.settings
    cloud = Cloud(
        joined(lambda one: one.cores),
        origin=change.model.origin,
        normals=joined(lambda one: one.normals).astype(np.float32),
        color=shades(moved, _limit(moved)).astype(np.uint16) * np.uint16(257),
        up=settings.get("up", "z"),
        scale=np.array(settings.get("scale", [change.model.unit] * 3)),
        crs=change.model.crs,
    )
    extra = {
        "change": moved.astype(np.float32),
        "lod": joined(lambda one: one.distances.lod).astype(np.float32),
        "significant": joined(lambda one: one.distances.significant).astype(np.uint8),
        "component": joined(lambda one: one.component),
        "vault": joined(lambda one: np.full(len(one.cores), one.number, np.uint16)),
    }
    write(path, cloud, extra)


def change_map(change: ScanChange) -> Drawing:
    """The changes of all vaults seen from above, side by side in their own frames; grey where nothing can be told.

    Dots mark what is larger than its level of detection.
    """
    limit = _limit(np.concatenate([one.distances.change[one.component > 0] for one in change.vaults]))
    grids = [_grid(one) for one in change.vaults]
    wide = sum(float(high[0] - low[0]) for low, high, _, _ in grids) + GAP * (len(grids) - 1)
    tall = max(float(high[1] - low[1]) for low, high, _, _ in grids)
    title = f"Change: {CONVENTION}; dots: above the level of detection"
    drawing = Drawing((0.0, 0.0), (wide, tall), title)
    left = 0.0
    for one, (low, high, values, dots) in zip(change.vaults, grids, strict=True):
        shift = np.array([left, 0.0]) - low
        for k in range(len(one.fitted.vault.plan.loops)):
            loop = np.concatenate([side.points(24)[:-1] for side in one.fitted.vault.plan.loops[k]])
            drawing.area([loop + shift], "unseen", UNKNOWN)
        drawing.cells(low + shift, high + shift, values, limit)
        drawing.dots(dots + shift, "scan")
        if len(change.vaults) > 1:
            drawing.text((left + float(high[0] - low[0]) / 2, -0.1), f"vault {one.number}", "label")
        left += float(high[0] - low[0]) + GAP
    drawing.scale(limit)
    return drawing


def _grid(one: VaultChange) -> tuple[Any, Any, Any, Any]:
    """Corners (2,), means a cell (nx, ny) [m], and places (m, 2) of what is significant, in the vault's frame."""
    low, high = (np.asarray(end, np.float64) for end in one.fitted.vault.plan.box)
    frame = one.fitted.pose.frame()
    use = (one.component > 0) & np.isfinite(one.distances.change)
    xy = (one.cores[use] @ frame[:, :3].T + frame[:, 3])[:, :2]
    counts = np.maximum(np.round((high - low) / MAPPED).astype(int), 1)
    cell = np.clip(((xy - low) / (high - low) * counts).astype(int), 0, counts - 1)
    flat = cell[:, 0] * counts[1] + cell[:, 1]
    number = np.bincount(flat, minlength=int(counts.prod()))
    total = np.bincount(flat, one.distances.change[use], int(counts.prod()))
    values = np.where(number > 0, total / np.maximum(number, 1), np.nan).reshape(counts.tolist())
    return low, high, values, xy[one.distances.significant[use]]


def _limit(change: NDArray[np.floating]) -> float:
    return max(limit_of(change), LEAST_LIMIT)

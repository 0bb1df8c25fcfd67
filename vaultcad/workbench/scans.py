"""Scans for FreeCAD: thinned and coloured to be shown, and fitted, with the deviation of each point shown."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from families.declaration.units import MM
from vaultcad.model_file import plain_vault

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from segmentation.cloud import Cloud
    from segmentation.voxel import Thinned
    from vaultcad.workbench.protocol import Request

FINEST = 0.01  # m, cells of the points that are shown
SHOWN = 100_000  # points at the most
BAY_WALL, DEEP = 0.5, 20.0  # m around and under a vault that belong to its bay
LOW_COVERAGE, LOW_CONFIDENCE = 0.5, 0.8  # shares below which coverage and confidence are pointed out


def read(request: Request) -> dict[str, Any]:
    """Write the thinned points of a scan to `path`: float32 (n, 3) [mm], then uint8 (n, 3) red, green, blue.

    Asked: scan, up ("z" or "y"), unit ("auto", as the file states it, or one of `UNITS`), path. Told: shown (n), points
    (of the scan), origin [m] to which they are relative, notes on what was assumed.
    """
    cloud, thinned = _scan(request)
    xyz = (thinned.xyz * MM).astype("<f4")
    _bytes(Path(request.text("path")), xyz.tobytes() + _colours(cloud, thinned).tobytes())
    return _told(cloud, thinned)


def fit(request: Request) -> dict[str, Any]:
    """Fit the vaults of a scan, and write the deviation of each shown point to `path`: float32 (n,) [mm].

    Deviations are NaN off the vaults, and infinite outside the box. Asked: scan, up, unit, family ("auto" or a name),
    thickness [m], seed, path, and box to fit only what is in it: `frame` (3, 4) that brings local points into the box's
    own axes, its corners `low` and `high` there [m]. Told: `vaults`, as `told` has them, each with `flags` and, if
    there are several, the box of its bay; and the scan as `read` tells it. The stages come as progress.

    Raises:
        NoVaultError: the scan holds none.
    """
    from families import FAMILIES
    from families import family as named
    from vaultcad.pipeline import STAGES, FitSettings, fit_scan

    name = request.text("family", "auto")
    families = tuple(FAMILIES) if name == "auto" else (named(name),)
    seed, thickness = int(request.number("seed", 0)), request.number("thickness", 0.15)
    # An object has no properties for free corners.
    settings = FitSettings(families, seed=seed, thickness=thickness, rectangular=True)
    stages = ("reading", *STAGES)
    share = 0.0

    def progress(stage: str) -> None:
        nonlocal share
        if stage in stages:  # else a bay that was found on the way
            share = stages.index(stage) / len(stages)
        request.progress(stage, share)

    progress(stages[0])
    cloud, thinned = _scan(request)
    inside = _inside(cloud, request.table("box"))
    result = fit_scan(_part(cloud, inside), settings, progress=progress)
    deviation = np.full(len(cloud), np.inf, np.float32)
    deviation[inside] = result.labels.deviation
    _bytes(Path(request.text("path")), (_means(thinned, deviation) * MM).astype("<f4").tobytes())
    several = len(result.model.vaults) > 1
    return {
        "vaults": [
            {**plain_vault(vault), "flags": flags(vault), "bay": bay(vault) if several else None}
            for vault in result.model.vaults
        ],
        **_told(cloud, thinned),
    }


def _told(cloud: Cloud, thinned: Thinned) -> dict[str, Any]:
    """What is said of a scan that was read."""
    return {
        "shown": len(thinned),
        "points": len(cloud),
        "origin": cloud.origin.tolist(),
        "notes": [note.text for note in cloud.notes],
    }


def flags(vault: Any) -> list[str]:
    """What a user should look at before the fit is used; vault: a FittedVault."""
    found = {
        "the fit did not settle": not vault.converged,
        f"only {vault.coverage:.0%} of the intrados was seen": vault.coverage < LOW_COVERAGE,
        vault.unlike: bool(vault.doubt),
        f"the family is not certain ({vault.confidence:.0%})": vault.confidence < LOW_CONFIDENCE,
    }
    unsure = [f"{name.replace('_', ' ')}: {kinds}" for name, kinds in vault.arches.items() if " or " in kinds]
    return [*(text for text, holds in found.items() if holds), *unsure]


def bay(vault: Any) -> dict[str, Any]:
    """The box of a vault with its walls, as `fit` takes one; vault: a FittedVault."""
    half = np.array([vault.vault.plan.half_x, vault.vault.plan.half_y]) + BAY_WALL
    top = vault.vault.derived_values()["rise"] + BAY_WALL
    return {"frame": vault.pose.frame().tolist(), "low": [*-half, -DEEP], "high": [*half, top]}


def _scan(request: Request) -> tuple[Cloud, Thinned]:
    up = request.text("up", "z")
    if up not in {"z", "y"}:
        raise ValueError(f"up = {up!r}: give z or y")
    unit = request.text("unit", "auto")
    path = Path(request.text("scan"))
    changed = path.stat().st_mtime_ns if path.exists() else 0  # a missing file is for the reader to refuse
    return _read(path, up, None if unit == "auto" else unit, changed)


@lru_cache(maxsize=1)
def _read(path: Path, up: str, unit: str | None, changed: int) -> tuple[Cloud, Thinned]:
    from segmentation.io import read

    cloud = read(path, up=cast(Literal["z", "y"], up), unit=unit)
    return cloud, _thinned(cloud)


def _thinned(cloud: Cloud) -> Thinned:
    """The cells of a grid that is as fine as `SHOWN` points allow."""
    from segmentation.voxel import thin

    size = FINEST
    while len(cells := thin(cloud.xyz, size, inverse=True)) > SHOWN:
        size *= max(1.05, (len(cells) / SHOWN) ** 0.5)  # cells of a surface go with the square of their edge
    return cells


def _colours(cloud: Cloud, thinned: Thinned) -> NDArray[np.uint8]:
    """Red, green, blue (n, 3): of the scan, else grey by its intensity, else grey by height."""
    if cloud.color is not None:
        return (thinned.mean(cloud.color) / 257).astype(np.uint8)
    values = thinned.xyz[:, 2] if cloud.intensity is None else thinned.mean(cloud.intensity)
    low, high = np.quantile(values, (0.02, 0.98))
    grey = 60 + 180 * np.clip((values - low) / max(high - low, 1e-9), 0, 1)
    return np.repeat(grey.astype(np.uint8)[:, None], 3, axis=1)


def _inside(cloud: Cloud, box: dict[str, Any]) -> NDArray[np.bool_]:
    """Which points of the cloud are in the box; all of them without one."""
    if not box:
        return np.ones(len(cloud), bool)
    try:
        frame, low, high = (np.asarray(box[key], float) for key in ("frame", "low", "high"))
        local = cloud.xyz @ frame[:, :3].T + frame[:, 3]
        inside: NDArray[np.bool_] = ((local >= low) & (local <= high)).all(axis=1)
    except (KeyError, TypeError, ValueError, IndexError):
        raise ValueError("box: give frame (3 rows of 4), low (3) and high (3) in metres") from None
    if not inside.any():
        raise ValueError("the box holds no point of the scan; move it over the vault")
    return inside


def _part(cloud: Cloud, inside: NDArray[np.bool_]) -> Cloud:
    """The points in the box alone."""
    if inside.all():
        return cloud
    columns = ("normals", "color", "intensity", "classification")
    cut = {name: column[inside] for name in columns if (column := getattr(cloud, name)) is not None}
    return replace(cloud, xyz=cloud.xyz[inside], kept=None, aside=None, **cut)


def _means(thinned: Thinned, deviation: NDArray[np.float32]) -> NDArray[np.float64]:
    """Mean (m,) over the points of each cell that have a deviation, else NaN, or infinite where all its points are."""
    cells = cast("NDArray[np.int32]", thinned.inverse)
    on = np.isfinite(deviation)
    sums = np.bincount(cells[on], deviation[on], minlength=len(thinned))
    counts = np.bincount(cells[on], minlength=len(thinned))
    tried = np.bincount(cells[~np.isinf(deviation)], minlength=len(thinned))
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.where(tried > 0, np.nan, np.inf))


def _bytes(path: Path, content: bytes) -> None:
    from segmentation.io.whole import replacing

    with replacing(path) as part:
        part.write_bytes(content)

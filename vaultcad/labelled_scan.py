"""The points of a fitted scan with what the fit said of each, as sections, maps, drawings and comparisons take them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Floats, Up, turn
from vaultcad.errors import ModelFileError
from vaultcad.model import FittedVault, Model

if TYPE_CHECKING:
    from segmentation.cloud import Cloud
    from vaultcad.fit.label import Labels

SEGMENTS = "segments.laz"
LABELS = ("vault", "component", "arch", "deviation")


@dataclass(frozen=True, eq=False)
class LabelledScan:
    """A model and all points of its scan.

    xyz: (n, 3) [m], local to the model's origin, z up. vault, component, arch: (n,) uint16, 0 for none. deviation: (n,)
    float32 [m], positive into the stone, NaN off vaults and arches. color: (n, 3) uint16 over the full range, or None.
    intensity: (n,) uint16, or None.
    """

    model: Model
    xyz: Floats
    vault: NDArray[np.uint16]
    component: NDArray[np.uint16]
    arch: NDArray[np.uint16]
    deviation: NDArray[np.float32]
    color: NDArray[np.uint16] | None = None
    intensity: NDArray[np.uint16] | None = None

    def of(self, number: int) -> NDArray[np.int64]:
        """The points of the vault with that 1-based number, as indices (m,)."""
        return np.flatnonzero(self.vault == number)

    def in_frame(self, fitted: FittedVault, which: NDArray[Any] | slice = slice(None)) -> NDArray[np.float64]:
        """Points (m, 3) [m] in a vault's own frame."""
        frame = fitted.pose.frame()
        own = self.xyz[which].astype(np.float64)
        # BLAS, which @ calls, takes ten times as long where there are three columns.
        moved: NDArray[np.float64] = np.einsum("nk,jk->nj", own, frame[:, :3])
        moved += frame[:, 3]
        return moved


def labelled_scan(model: Model, cloud: Cloud, labels: Labels) -> LabelledScan:
    """The scan that was just fitted."""
    return LabelledScan(
        model,
        cloud.xyz,
        labels.vault,
        labels.component,
        labels.arch,
        labels.deviation,
        cloud.color,
        cloud.intensity,
    )


def read_labelled_scan(folder: Path | str, *, labelled: bool = False) -> LabelledScan:
    """What `vaultcad fit` left in a folder: its model.json and its segments.laz.

    labelled: whether to leave out the points that are of no vault and no arch.

    Raises:
        ModelFileError: the folder has no model of vaultcad, or its points are not that model's.
        ReadError: the points are no whole LAS or LAZ file.
        OSError: a file cannot be read.
    """
    from segmentation.io.assemble import FLOAT32_REACH
    from segmentation.io.las import las_points, open_las
    from vaultcad.model_file import MODEL, read_model

    folder = Path(folder)
    for name in (MODEL, SEGMENTS):
        if not (folder / name).is_file():
            raise ModelFileError(f"{folder}: has no {name}; give the folder that vaultcad fit -o wrote")
    model = read_model(folder / MODEL)
    path = folder / SEGMENTS
    up: Up = model.settings.get("up", "z")
    scale = np.array(model.settings.get("scale", [model.unit] * 3))
    near = np.abs(turn(model.bounds * scale, up) - model.origin).max() < FLOAT32_REACH
    whole: dict[str, NDArray[Any]] = {}
    size = read = 0
    with open_las(path) as reader:
        if lacking := set(LABELS) - set(reader.header.point_format.dimension_names):
            raise ModelFileError(f"{path}: has no dimension {min(lacking)}; give what vaultcad fit wrote")
        colored = "red" in reader.header.point_format.dimension_names
        for chunk in las_points(path, reader):
            read += len(chunk)
            own = (np.asarray(chunk["vault"]) > 0) | (np.asarray(chunk["arch"]) > 0) if labelled else slice(None)
            points = chunk[own]
            xyz = np.column_stack([points.x, points.y, points.z]) * scale
            found: dict[str, NDArray[Any]] = {name: np.asarray(points[name]) for name in (*LABELS, "intensity")}
            found["xyz"] = (turn(xyz, up) - model.origin).astype(np.float32 if near else np.float64)
            if colored:
                found["color"] = np.column_stack([points.red, points.green, points.blue])
            for name, values in found.items():
                # Room for all, of which the system gives no more than is filled.
                room = (reader.header.point_count, *values.shape[1:])
                whole.setdefault(name, np.empty(room, values.dtype))[size : size + len(values)] = values
            size += len(points)
    if not read:
        raise ModelFileError(f"{path}: has no points; give what vaultcad fit wrote")
    whole = {name: values[:size] for name, values in whole.items()}
    if whole["vault"].max(initial=0) > len(model.vaults) or whole["arch"].max(initial=0) > len(model.arches):
        raise ModelFileError(f"{path}: has labels of more vaults than {MODEL}; give both files of one fit")
    for kind, fitted in (("vault", model.vaults), ("arch", model.arches)):
        shown = np.bincount(whole[kind], minlength=len(fitted) + 1)[1:].tolist()
        for number, (points, one) in enumerate(zip(shown, fitted, strict=True), 1):
            if points != (told := sum(component.points for component in one.components)):
                said = f"{path}: has {points:,} points of {kind} {number}, {MODEL} tells of {told:,}"
                raise ModelFileError(f"{said}; give both files of one fit")
    return LabelledScan(model, **whole)

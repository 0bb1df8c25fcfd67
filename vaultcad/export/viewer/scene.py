"""What the 3D view shows: the triangles of vaults and arches, and thinned points of the scan with their deviations."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import cos, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families.drawing.deviation_colours import STOPS, UNKNOWN, limit_of
from vaultcad.export.geometry import shell
from vaultcad.export.palette import colour
from vaultcad.export.viewer.packing import FINE, Floats, Packed
from vaultcad.model import FittedArch, FittedVault, Model

ON_VAULTS = 45_000  # points with a deviation at most
AROUND = 15_000  # other points of the rooms at most
BITS = 10  # a coordinate of a cell on the curve by which points are thinned

Field = Callable[[Floats], Floats]


def scene(
    model: Model,
    titles: Sequence[str],
    points: NDArray[np.floating],
    component: NDArray[np.integer],
    deviation: NDArray[np.floating],
    vault: NDArray[np.integer],
) -> bytes:
    """What scene.js reads, in the scan's local frame with x and y turned and moved to those of the first vault.

    Args:
        model: what was found.
        titles: of its vaults.
        points: (n, 3) of the scan in its local frame [m].
        component: (n,) theirs, 0 for none.
        deviation: (n,) [m], NaN off vaults and arches.
        vault: (n,) the vault of each by its number, 0 for none.
    """
    packed, frame = Packed(), _frame(model)
    fitted = [*model.vaults, *model.arches]
    parts = [part for k, one in enumerate(fitted) for part in _parts(one, k, model.thickness_of(one), frame, packed)]
    on = np.isfinite(deviation)
    shown = _thinned(points, np.flatnonzero(on), ON_VAULTS)
    area = sum(float(shell(one.vault, model.thickness_of(one)).areas.sum()) / 2 for one in fitted)
    clouds = []
    for owner in np.unique(vault[shown]).tolist():
        mine = shown[vault[shown] == owner]
        cloud = packed.places(_moved(points[mine], frame)) | {"owner": owner - 1}
        cloud["deviation"] = packed.lengths(deviation[mine].astype(np.float64))
        clouds.append(cloud | {"component": packed.add(component[mine].astype(np.uint16))})
    around = _thinned(points, np.flatnonzero(~on), AROUND)
    if len(around):
        clouds.append(packed.places(_moved(points[around], frame)))
    head = {
        "owners": [*titles, *(_arch_title(k, arch) for k, arch in enumerate(model.arches, 1))],
        "parts": parts,
        "clouds": clouds,
        "fine": FINE,
        "height": float(model.origin[2]),  # of z = 0 in the scan [m]
        "limit": limit_of(deviation),
        "spacing": round(sqrt(area / max(len(shown), 1)), 4),
        "stops": [[share, [c.red, c.green, c.blue]] for share, c in STOPS],
        "unknown": [UNKNOWN.red, UNKNOWN.green, UNKNOWN.blue],
        "stone": colour(0).hex,
    }
    return packed.with_head(head)


def _arch_title(number: int, arch: FittedArch) -> str:
    return f"arch {number}, {arch.kind}"


def _frame(model: Model) -> Floats:
    """(4, 4): from the scan's local frame into that of the view."""
    pose, frame = model.vaults[0].pose, np.eye(4)
    c, s = cos(pose.yaw), sin(pose.yaw)
    frame[:2, :2] = [[c, s], [-s, c]]
    frame[:2, 3] = -frame[:2, :2] @ [pose.x, pose.y]
    return frame


def _moved(points: NDArray[np.floating], frame: Floats) -> Floats:
    moved: Floats = points.astype(np.float64) @ frame[:3, :3].T + frame[:3, 3]
    return moved


def _parts(
    fitted: FittedVault, owner: int, thickness: float, frame: Floats, packed: Packed
) -> Iterator[dict[str, Any]]:
    """The triangles of each component as model.glb has them, then those of the rest of the stone."""
    mesh, told = shell(fitted.vault, thickness), {c.id: c for c in fitted.components}
    place = frame @ fitted.pose.placement()
    surface: Field | None = getattr(fitted, "surface", None)
    names = dict(enumerate(fitted.vault.components, 1)) | {0: "masonry"}
    of = np.where(mesh.component > len(fitted.vault.components), 0, mesh.component)
    for k in (k for k in names if (of == k).any()):
        used, corners = np.unique(mesh.triangles[of == k], return_inverse=True)
        part = packed.places(_moved(mesh.vertices[used], place))
        part |= {"owner": owner, "id": k, "name": names[k].replace("_", " "), "colour": colour(k).hex}
        part["index"] = packed.add(corners.ravel().astype(np.uint32))
        if surface is not None:
            part["moved"] = packed.lengths(surface(mesh.vertices[used]) @ place[:3, :3].T)
        deviation = told[k].deviation if k in told else None
        if deviation is not None:
            part["millimetres"] = [round(1000 * deviation.mean, 1), round(1000 * deviation.p95, 1)]
        yield part


def _thinned(points: NDArray[np.floating], which: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    """No more than so many of the points, evenly along a curve that fills space (Morton 1966)."""
    if not len(which):
        return which
    low, high = points[which].min(axis=0), points[which].max(axis=0)
    cells = ((points[which] - low) / np.maximum(high - low, 1e-9).max() * (2**BITS - 1)).astype(np.int64)
    code = np.zeros(len(which), np.int64)
    for bit in range(BITS):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    count = min(len(which), most)
    along: NDArray[np.intp] = which[np.argsort(code, kind="stable")]
    return along[np.arange(count) * len(which) // count]

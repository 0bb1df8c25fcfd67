"""E57 (ASTM E2807), read in chunks by the library under pye57: all scans, each by its pose."""

import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.crs import of_wkt
from segmentation.errors import COPY_AGAIN, ReadError
from segmentation.io.chunk import SIZE, Chunk
from segmentation.io.e57_bounds import ScanBounds
from segmentation.io.e57_check import check_e57
from segmentation.io.e57_records import check_records
from segmentation.io.facts import Facts
from segmentation.io.ranges import TOP
from segmentation.io.rest import tell_damaged, truncated
from segmentation.io.suspicions import run_of_zeros

CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
COLOR = ("colorRed", "colorGreen", "colorBlue")
NORMALS = ("nor:normalX", "nor:normalY", "nor:normalZ")
"""Names of the public extension for surface normals."""
TYPES = {
    **dict.fromkeys((*CARTESIAN, *SPHERICAL, "intensity"), "f8"),
    **dict.fromkeys((*COLOR, *NORMALS), "f4"),
    **dict.fromkeys(("cartesianInvalidState", "sphericalInvalidState"), "i1"),
}
UNIT = 1e-3
"""What the square of a quaternion may be off 1."""


@dataclass(frozen=True, eq=False)
class ScanPose:
    """Where a scan's own frame lies in the file's: file = rotation @ own + translation."""

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    is_identity: bool


def read_e57(path: Path, facts: Facts) -> Iterator[Chunk]:
    """The points of all scans in the file's coordinates, with colour, intensity, normals and scanner positions.

    A scanner's position is the translation of its scan's pose. A scan without pose tells none, nor does a lone scan
    whose pose is the identity, which is how merged clouds are written. Points with an invalid state are marked.
    Raises ReadError if the file is damaged, or a scan has neither cartesian nor spherical coordinates.
    """
    from pye57 import libe57

    for more in check_records(path, check_e57(path)):
        tell_damaged(facts, more)
    try:
        image = libe57.ImageFile(os.fsencode(path), "r")
    except Exception as error:
        raise _damaged(path, error) from error
    try:
        root = image.root()
        facts.format_unit = "m"
        if root.isDefined("coordinateMetadata"):
            text = root["coordinateMetadata"].value()
            facts.declare(of_wkt(text))
            if text.strip() and facts.crs is None:
                facts.tell("crs", "the coordinate system of the file cannot be read: nothing is taken from it")
        data = root["data3D"]
        scans = {k + 1: data[k] for k in range(len(data)) if data[k]["points"].childCount() > 0}
        total = sum(scan["points"].childCount() for scan in scans.values())
        done = 0
        for number, scan in scans.items():
            pose = _pose(path, scan, number, facts)
            lone = pose is None or (pose.is_identity and len(scans) == 1)
            stations = None if pose is None or lone else pose.translation[None]
            bounds = ScanBounds(
                scan, *((np.eye(3), np.zeros(3)) if pose is None else (pose.rotation, pose.translation))
            )
            first, zeros = done, dict[str, int]()
            for raw in _raw_chunks(path, image, scan):
                chunk = _chunk(raw, scan, pose, bounds)
                for field, length in _zeros(raw):
                    zeros[field] = max(zeros.get(field, 0), length)
                done += len(chunk.xyz)
                yield replace(chunk, stations=stations, done=done / total)
                stations = None
            if done - first < (count := scan["points"].childCount()):
                raise truncated(path, count, done - first)
            for field, length in zeros.items():
                what = f"{length:,} points in succession of scan {number} have {field} = 0"
                facts.tell("zeros", f"{what}: bytes lost from the file, or a plane that lies there")
            if off := bounds.broken():
                tell_damaged(facts, f"points of scan {number} lie outside its bounds by up to {off:.3g} m")
    except (ReadError, MemoryError):
        raise
    except Exception as error:  # the library and its binding raise whatever comes to their minds
        raise _damaged(path, error) from error
    finally:
        image.close()


def _raw_chunks(path: Path, image: Any, scan: Any) -> Iterator[dict[str, NDArray[Any]]]:
    """The fields of a scan that we know, chunk by chunk."""
    from pye57 import libe57

    points = scan["points"]
    prototype = libe57.StructureNode(points.prototype())
    have = {prototype.get(k).elementName() for k in range(prototype.childCount())}
    fields = [f for f in TYPES if f in have]
    if not (set(fields).issuperset(CARTESIAN) or set(fields).issuperset(SPHERICAL)):
        raise ReadError(path, "a scan has neither cartesian nor spherical coordinates", "export the scan again")
    capacity = min(SIZE, points.childCount())
    arrays = {f: np.empty(capacity, TYPES[f]) for f in fields}
    buffers = libe57.VectorSourceDestBuffer()
    for f, array in arrays.items():
        buffers.append(libe57.SourceDestBuffer(image, f, array, capacity, True, True))
    reader = points.reader(buffers)
    try:
        while n := reader.read():
            yield {f: array[:n] for f, array in arrays.items()}
    finally:
        with suppress(libe57.E57Exception):  # what broke it has been raised; left open it is never given back
            reader.close()


def _chunk(raw: dict[str, NDArray[Any]], scan: Any, pose: ScanPose | None, bounds: ScanBounds) -> Chunk:
    cartesian = CARTESIAN[0] in raw
    xyz = np.stack([raw[f] for f in CARTESIAN], axis=1) if cartesian else _cartesian(*(raw[f] for f in SPHERICAL))
    state = raw.get("cartesianInvalidState" if cartesian else "sphericalInvalidState")
    normals = np.stack([raw[f] for f in NORMALS], axis=1) if NORMALS[0] in raw else None
    own = xyz
    if pose is not None and not pose.is_identity:
        xyz = xyz @ pose.rotation.T + pose.translation
        normals = None if normals is None else normals @ pose.rotation.T.astype(np.float32)
    bounds.count(own, xyz, None if state is None else state == 0)
    return Chunk(
        xyz=xyz,
        normals=normals,
        color=np.stack([_scaled(raw[f], scan, "colorLimits", f) for f in COLOR], axis=1) if COLOR[0] in raw else None,
        intensity=_scaled(raw["intensity"], scan, "intensityLimits", "intensity") if "intensity" in raw else None,
        marks={} if state is None or not state.any() else {"with an invalid state": state != 0},
    )


def _zeros(raw: dict[str, NDArray[Any]]) -> Iterator[tuple[str, int]]:
    """Where a coordinate is lost, as each stands in bytes of its own, and the most points in succession that lost it.

    Beams that are zero all over lost none.
    """
    fields = CARTESIAN if CARTESIAN[0] in raw else SPHERICAL[:1]
    for field in fields:
        if run_of_zeros(raw[field]):
            state = raw.get("cartesianInvalidState", raw.get("sphericalInvalidState"))
            beams = np.logical_and.reduce([raw[other] == 0 for other in fields])
            there = ~beams if state is None else ~beams & (state == 0)
            if length := run_of_zeros(raw[field][there]):
                yield field, length


def _cartesian(r: NDArray[Any], azimuth: NDArray[Any], elevation: NDArray[Any]) -> NDArray[Any]:
    flat = r * np.cos(elevation)
    return np.stack([flat * np.cos(azimuth), flat * np.sin(azimuth), r * np.sin(elevation)], axis=1)


def _scaled(values: NDArray[Any], scan: Any, limits: str, field: str) -> NDArray[Any]:
    """The field over 0..65535 by the limits that the scan gives; a copy as it is where it gives none."""
    if not scan.isDefined(f"{limits}/{field}Minimum"):
        return values.copy()
    low, high = (float(scan[limits][field + end].value()) for end in ("Minimum", "Maximum"))
    if high <= low:
        return values.copy()
    return np.round(np.clip((values - low) * (TOP / (high - low)), 0, TOP)).astype(np.uint16)


def _pose(path: Path, scan: Any, number: int, facts: Facts) -> ScanPose | None:
    """The pose of a scan, which is the number-th of its file.

    Raises ReadError if its numbers make no motion.
    """
    if not scan.isDefined("pose"):
        return None
    pose = scan["pose"]
    w, x, y, z = quaternion = _numbers(pose, "rotation", "wxyz", [1.0, 0.0, 0.0, 0.0])
    n = w * w + x * x + y * y + z * z
    translation = np.array(_numbers(pose, "translation", "xyz", [0.0, 0.0, 0.0]))
    if not (np.isfinite(n) and np.isfinite(translation).all()):
        wrong = f"the pose of scan {number} is no motion (quaternion {quaternion}, translation {translation.tolist()})"
        raise ReadError(path, wrong, "export the scan again, registered")
    if n == 0:
        facts.tell(
            "pose", f"the pose of scan {number} has the quaternion 0 0 0 0: the scan is taken without a rotation"
        )
        w = n = 1.0
    elif abs(n - 1) > UNIT:
        tell_damaged(facts, f"the quaternion of the pose of scan {number} has the length {n**0.5:.4g}, not 1")
    rotation = np.eye(3) + (2 / n) * np.array(
        [
            [-y * y - z * z, x * y - w * z, x * z + w * y],
            [x * y + w * z, -x * x - z * z, y * z - w * x],
            [x * z - w * y, y * z + w * x, -x * x - y * y],
        ]
    )
    return ScanPose(rotation, translation, is_identity=bool((rotation == np.eye(3)).all() and not translation.any()))


def _numbers(node: Any, child: str, names: str, default: list[float]) -> list[float]:
    return [float(node[child][name].value()) for name in names] if node.isDefined(child) else default


def _damaged(path: Path, error: Exception) -> ReadError:
    return ReadError(path, f"is no whole E57 file ({str(error).splitlines()[0]})", COPY_AGAIN)

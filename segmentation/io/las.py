"""LAS and LAZ, read in chunks by laspy."""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.crs import Crs, of_geokeys, of_wkt
from segmentation.errors import COPY_AGAIN, ReadError
from segmentation.io.chunk import SIZE, Chunk
from segmentation.io.facts import Facts
from segmentation.io.las_check import Kept, check_las, contradictions, tell_other_points
from segmentation.io.laz_apart import ApartReader, DecoderError

NORMALS = ("NormalX", "NormalY", "NormalZ")
"""Extra dimensions for normals, named as CloudCompare does."""
NOISE = {7: "noise (class 7)", 18: "high noise (class 18)"}
"""Classes of the LAS standard that are no surface, and what they are called."""
WKT, KEYS, DOUBLES, LASZIP = 2112, 34735, 34736, 22204
"""Records that hold a well-known text, GeoTIFF keys, the real numbers of some of these, and how points are packed."""
SHORTEST_RECORD = 34
"""Bytes of that last one, without what it says of the parts of a point."""


def read_las(path: Path, facts: Facts) -> Iterator[Chunk]:
    """The points of a LAS or LAZ file with colour, intensity, classification and, as extra dimensions, normals.

    Points that are withheld, synthetic or of a noise class are marked; the coordinate system is told to `facts`.
    Raises ReadError if the file is damaged or holds fewer points than its header promises. LAZ has no checksums, so
    points are compared with the box and the counts of its header, and what differs is told.
    """
    with open_las(path, needed=_needed) as reader:
        kept = Kept(reader.header)
        facts.declare(_crs(reader, facts))
        total = reader.header.point_count
        done = 0
        for points in las_points(path, reader):
            done += len(points)
            chunk = _chunk(points, reader.header, done / total)
            kept.count(chunk.xyz, np.asarray(points["return_number"]))
            yield chunk
        if done:
            kept.tell(facts)
        packing = _packing(reader.header) if reader.header.are_points_compressed else b""
        if broken := contradictions(path, reader.header, packing):
            tell_other_points(facts, broken)


@contextmanager
def open_las(path: Path, needed: Callable[[Any], Any] | None = None) -> Iterator[Any]:
    """A laspy reader, to which a process of its own hands the points of a LAZ file.

    needed: by the header, which parts of the points are to be unpacked, as laspy names them; all by default. Raises
    ReadError if the header makes no sense or points lack.
    """
    import laspy

    check_las(path)
    # laspy logs what it also raises; without a handler that would reach standard error
    logging.getLogger("laspy").addHandler(logging.NullHandler())
    try:
        reader = laspy.open(path)
    except Exception as error:
        raise ReadError(path, f"is no whole LAS or LAZ file ({error})", COPY_AGAIN) from error
    try:
        if reader.header.are_points_compressed:
            reader._point_source = _unpacked(path, reader.header, needed)
        yield reader
    finally:
        reader.close()
        reader._source.close()  # which laspy leaves to whoever unpacks


def _unpacked(path: Path, header: Any, needed: Callable[[Any], Any] | None) -> ApartReader:
    """Who unpacks the points of a LAZ file."""
    from laspy import DecompressionSelection as Part

    record = _packing(header)
    if len(record) < SHORTEST_RECORD:
        raise ReadError(path, "is compressed, but does not say how", COPY_AGAIN)
    parts = Part.all() if needed is None else needed(header)
    return ApartReader(path, header, record, [part.name for part in Part if part.name and parts.is_set(part)])


def _packing(header: Any) -> bytes:
    """The record of a LAZ file that says how its points are packed; empty if there is none."""
    record = next((vlr.record_data for vlr in header.vlrs if vlr.record_id == LASZIP), None)
    return record if isinstance(record, bytes) else b""


def las_points(path: Path, reader: Any) -> Iterator[Any]:
    """The point records of the file, chunk by chunk. Raises ReadError if there are fewer than the header promises."""
    total = reader.header.point_count
    done = 0
    try:
        for points in reader.chunk_iterator(SIZE):
            done += len(points)
            yield points
    except DecoderError as error:
        wrong = f"is truncated or damaged: its header promises {total} points, which cannot be unpacked ({error})"
        raise ReadError(path, wrong, COPY_AGAIN) from error
    except Exception as error:
        raise _truncated(path, total) from error
    if done < total:
        raise _truncated(path, total)


def _needed(header: Any) -> Any:
    """What of the points is decompressed; the other dimensions of point formats 6 to 10 are passed over."""
    from laspy import DecompressionSelection as Part

    parts = Part.XY_RETURNS_CHANNEL | Part.Z | Part.CLASSIFICATION | Part.FLAGS | Part.INTENSITY | Part.RGB
    return parts | Part.ALL_EXTRA_BYTES if _has_normals(header.point_format) else parts


def _has_normals(point_format: Any) -> bool:
    """Whether there are extra dimensions for normals."""
    return set(NORMALS) <= set(point_format.dimension_names)


def _chunk(points: Any, header: Any, done: float) -> Chunk:
    xyz = np.empty((3, len(points))).T  # axes are looked at one by one
    for k, axis in enumerate("XYZ"):
        xyz[:, k] = points[axis] * header.scales[k] + header.offsets[k]
    return Chunk(
        xyz=xyz,
        normals=_columns(points, NORMALS) if _has_normals(points.point_format) else None,
        color=_columns(points, ("red", "green", "blue")) if "red" in points.array.dtype.names else None,
        intensity=np.array(points["intensity"]),
        classification=(classes := np.array(points["classification"])),
        marks=_marks(points, classes),
        done=done,
    )


def _marks(points: Any, classes: NDArray[np.uint8]) -> dict[str, NDArray[np.bool_]]:
    """What the file calls the points, where it calls any so."""
    found = {name: np.asarray(points[name]).astype(np.bool_) for name in ("withheld", "synthetic")}
    found |= {name: classes == number for number, name in NOISE.items()}
    return {name: mask for name, mask in found.items() if mask.any()}


def _text(record: Any) -> str:
    """What is in a record with a text, whatever it is encoded in."""
    return str(record.record_data_bytes().decode("utf-8", errors="replace"))


def _crs(reader: Any, facts: Facts) -> Crs | None:
    """The coordinate system: the well-known text if there is one that can be read, else the GeoTIFF keys."""
    records = [*reader.header.vlrs, *(reader.evlrs or [])]
    texts = [_text(vlr) for vlr in records if vlr.record_id == WKT and vlr.user_id == "LASF_Projection"]
    found = next((crs for text in texts if (crs := of_wkt(text)) is not None), None)
    if found is not None:
        return found
    if any(text.strip("\0 ") for text in texts):
        facts.tell("crs", "the coordinate system of the file cannot be read: nothing is taken from it")
    directory = next((vlr for vlr in records if vlr.record_id == KEYS and hasattr(vlr, "geo_keys")), None)
    if directory is None:
        return None
    reals = (vlr.doubles for vlr in records if vlr.record_id == DOUBLES and hasattr(vlr, "doubles"))
    doubles: list[Any] = next(reals, [])
    keys: dict[int, float] = {}
    for key in directory.geo_keys:
        if key.tiff_tag_location == 0:
            keys[key.id] = key.value_offset
        elif key.tiff_tag_location == DOUBLES and key.value_offset < len(doubles):
            keys[key.id] = doubles[key.value_offset].value
    return of_geokeys(keys)


def _columns(points: Any, names: tuple[str, ...]) -> NDArray[Any]:
    return np.stack([np.asarray(points[name]) for name in names], axis=1)


def _truncated(path: Path, total: int) -> ReadError:
    return ReadError(path, f"is truncated or damaged: its header promises {total} points", COPY_AGAIN)

"""The scan once more, every point in its order and coordinates, with what was found about it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmentation.cloud import Cloud
from segmentation.errors import ReadError
from segmentation.io.chunk import Progress
from segmentation.io.formats import READERS
from segmentation.io.las import las_points, open_las, read_las
from segmentation.io.stamp import stamp
from segmentation.io.whole import replacing
from segmentation.io.write_las import add_extras, open_writer, write_las

OLDEST = "1.2"
"""The first version of LAS that laspy writes."""


def write_labelled(
    scan: Path | str,
    path: Path | str,
    cloud: Cloud,
    extra: Mapping[str, NDArray[Any]],
    *,
    progress: Progress | None = None,
) -> None:
    """The points of `scan` to the LAS or LAZ file `path`, with extra dimensions; it appears whole or not at all.

    scan: the file that `cloud` was read from. extra: numbers (len(cloud),) under their names; a dimension of the same
    name in the scan is replaced.
    A LAS or LAZ scan is streamed: all its dimensions, scales, offsets, coordinate system and other records are kept.
    Of any other format the points of the cloud and those it has set aside are written, in the file's order, rounded to
    0.0001 of its unit, with colour, intensity, classification and normals; what is dropped, being no point, is left
    out. Points set aside or dropped get 0 or NaN.
    Raises ValueError if an extra has not the length of the cloud, ReadError if the scan is not the cloud's any more.
    """
    scan, path = Path(scan), Path(path)
    for name, values in extra.items():
        if values.shape != (len(cloud),):
            raise ValueError(f"{name} has the shape {values.shape}, expected is {(len(cloud),)}")
    with replacing(path) as beside:
        if READERS.get(scan.suffix.lower()) is read_las:
            _stream(scan, beside, cloud, extra, progress)
        else:
            write_las(beside, cloud.whole(), spread_all(cloud, extra))
            if progress is not None:
                progress(1.0)


def spread_all(cloud: Cloud, extra: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Numbers (n,) of the cloud's points as those of `cloud.whole()`: 0 or NaN for points set aside."""
    return {name: cloud.spread(values, np.nan if values.dtype.kind == "f" else 0) for name, values in extra.items()}


def _stream(scan: Path, path: Path, cloud: Cloud, extra: Mapping[str, NDArray[Any]], progress: Progress | None) -> None:
    import laspy

    with open_las(scan) as reader:
        total = reader.header.point_count
        read = len(cloud) + cloud.dropped + (0 if cloud.aside is None else len(cloud.aside))
        if total != read:
            wrong = f"holds {total} points, {read} when it was read"
            raise ReadError(scan, wrong, "leave the scan alone while it is worked on")
        header = reader.header.copy()
        header.version = max(header.version, laspy.header.Version.from_str(OLDEST))
        header.creation_date = header.creation_date or stamp().date()  # of the scan; today's would never be the same
        # the index of a cloud-optimised LAZ does not fit the new file
        header.vlrs = [vlr for vlr in header.vlrs if vlr.user_id != "copc"]
        add_extras(header, extra)
        old = reader.header.point_format.dtype()
        same = [name for name in old.names if name not in extra]
        front = _common_front(old, header.point_format.dtype(), same)
        at, done = 0, 0
        with open_writer(path, header) as writer:
            for points in las_points(scan, reader):
                labelled = laspy.ScaleAwarePointRecord.zeros(len(points), header=header)
                # The packed fields, so that not a bit of them changes: side by side, if they are.
                if front:
                    _bytes(labelled.array)[:, :front] = _bytes(points.array)[:, :front]
                else:
                    for name in same:
                        labelled.array[name] = points.array[name]
                kept = slice(None) if cloud.kept is None else cloud.kept[done : done + len(points)]
                n = len(points) if cloud.kept is None else int(cloud.kept[done : done + len(points)].sum())
                for name, values in extra.items():
                    if n < len(points) and values.dtype.kind == "f":
                        labelled.array[name] = np.nan
                    labelled.array[name][kept] = values[at : at + n]
                writer.write_points(labelled)
                at, done = at + n, done + len(points)
                if progress is not None:
                    progress(done / total)
            evlrs = [vlr for vlr in reader.evlrs or [] if vlr.user_id != "copc"]
            if evlrs:
                writer.write_evlrs(laspy.vlrs.vlrlist.VLRList(evlrs))


def _common_front(one: np.dtype[Any], other: np.dtype[Any], names: list[str]) -> int:
    """How many bytes of two kinds of records are these fields, at the front of both and in one order; 0 if not so."""
    places, there = ([(kind[name], _offset(kind, name)) for name in names] for kind in (one, other))
    size = sum(kind.itemsize for kind, _ in places)
    return size if places == there and max((at + kind.itemsize for kind, at in places), default=0) == size else 0


def _offset(records: np.dtype[Any], name: str) -> int:
    """How many bytes before a field."""
    return records.fields[name][1] if records.fields else 0


def _bytes(records: NDArray[Any]) -> NDArray[np.uint8]:
    """Records (n,) as the bytes (n, size) that they are."""
    return records.view(np.uint8).reshape(len(records), records.dtype.itemsize)

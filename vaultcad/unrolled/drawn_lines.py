"""Lines on a sheet and in space, in files: DXF, GeoJSON and CSV, by their suffix."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from families.unrolled.sheet import Sheet
from vaultcad.dxf_document import Layer, add_layers, dxf_document
from vaultcad.errors import ExportError
from vaultcad.unrolled.contours import Contour

OUTLINES, NAMES = "OUTLINES", "NAMES"
LAYERS = {  # of sheets that `write_sheet` wrote: what is on them no one has drawn
    OUTLINES: Layer(7, "CONTINUOUS", 35),
    NAMES: Layer(8, "CONTINUOUS", 18),
    "DEVIATION": Layer(1, "CONTINUOUS", 18),
    "HEIGHT": Layer(3, "CONTINUOUS", 13),
}
DRAWN = Layer(6, "CONTINUOUS", 25)
FORBIDDEN = re.compile(r"[<>/\\\":;?*|=`,]")  # in names of layers
LETTER = 0.08  # [m]
FLAT = 0.002  # [m] by which a chord may be off a curve that is read
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DrawnLine:
    """A line (n, 2) drawn on a sheet [m]. name: its layer, or what it is called."""

    name: str
    points: Array


@dataclass(frozen=True, eq=False)
class LiftedLine:
    """A line (n, 3) in the coordinates of the scan's file. deviation: (n,) [m] that was added to the ideal surface."""

    name: str
    component: str
    points: Array
    sheet: Array
    deviation: Array


def read_lines(path: Path) -> list[DrawnLine]:
    """The lines of a file that were drawn on a sheet.

    Raises:
        ExportError: it is of another kind or broken, or has no lines; says what is needed.
        OSError: it cannot be read.
    """
    if (reader := READERS.get(path.suffix.lower())) is None:
        raise ExportError(f"{path}: unknown suffix {path.suffix!r}; give one of {', '.join(READERS)}")
    try:
        found = [line for line in reader(path) if len(line.points)]
    except (ValueError, KeyError, TypeError, IndexError, AttributeError, csv.Error) as error:
        raise ExportError(f"{path}: cannot be read as {path.suffix[1:]} ({error}); give lines in metres") from error
    if not found:
        raise ExportError(f"{path}: has no lines; draw polylines on the sheet, on layers of your own")
    for line in found:
        if not np.isfinite(line.points).all():
            raise ExportError(f"{path}: {line.name} has a point that is no number; mend it")
    return found


def write_lifted(lines: Sequence[LiftedLine], path: Path, place: str) -> None:
    """Write lines in space to a file of a suffix in `WRITERS`; place: in which coordinates they are, in words."""
    WRITERS[path.suffix.lower()](lines, path, place)


def write_sheet(sheet: Sheet, lines: Iterable[Contour], path: Path, place: str) -> None:
    """Outlines and names of the components, lines of one level: DXF in metres of the sheet; place: which that is."""
    import shapely
    from ezdxf.enums import TextEntityAlignment

    def written(text: str, at: Array, height: float, layer: str) -> None:
        entity = space.add_text(text, height=height, dxfattribs={"layer": layer})
        entity.set_placement(tuple(at.round(6).tolist()), align=TextEntityAlignment.MIDDLE_CENTER)

    with dxf_document(path, place) as document:
        add_layers(document, LAYERS)
        space = document.modelspace()
        for leaf in sheet.leaves:
            for part in shapely.get_parts(leaf.outline):
                for ring in (part.exterior, *part.interiors) if isinstance(part, shapely.Polygon) else ():
                    corners = shapely.get_coordinates(ring)[:-1].round(6).tolist()
                    space.add_lwpolyline(corners, close=True, dxfattribs={"layer": OUTLINES})
            written(leaf.name, shapely.get_coordinates(leaf.outline.representative_point())[0], LETTER, NAMES)
        for line in lines:
            layer = line.what.upper()
            space.add_lwpolyline(line.line.round(6).tolist(), dxfattribs={"layer": layer})
            written(f"{line.level:.3f}", line.line[len(line.line) // 2], LETTER / 2, layer)


def _read_dxf(path: Path) -> Iterator[DrawnLine]:
    import ezdxf
    from ezdxf.lldxf.const import DXFError
    from ezdxf.path import make_path

    try:
        document = ezdxf.readfile(path)
    except (DXFError, OSError) as error:  # which it also raises for what is no DXF
        raise ValueError(error) from error
    for entity in document.modelspace().query("LINE LWPOLYLINE POLYLINE SPLINE ARC CIRCLE ELLIPSE"):
        if entity.dxf.layer not in LAYERS:
            points = [(v.x, v.y) for v in make_path(entity).flattening(FLAT)]
            yield DrawnLine(str(entity.dxf.layer), np.array(points))


def _read_json(path: Path) -> Iterator[DrawnLine]:
    told = json.loads(path.read_text(encoding="utf-8"))
    features = told["features"] if told.get("type") == "FeatureCollection" else [told]
    for k, feature in enumerate(features, 1):
        geometry = feature.get("geometry", feature)
        name = str((feature.get("properties") or {}).get("name", f"line {k}"))
        rows = geometry["coordinates"]
        match geometry["type"]:
            case "LineString":
                rows = [rows]
            case "MultiPolygon":
                rows = [ring for polygon in rows for ring in polygon]
            case "MultiLineString" | "Polygon":
                pass
            case other:
                raise ValueError(f"{name} is a {other}, no line")
        for row in rows:
            yield DrawnLine(name, np.array([[float(v) for v in point[:2]] for point in row]))


def _read_csv(path: Path) -> Iterator[DrawnLine]:
    lines: dict[str, list[tuple[float, float]]] = {}
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            lines.setdefault(row["line"], []).append((float(row["s"]), float(row["t"])))
    yield from (DrawnLine(name, np.array(points)) for name, points in lines.items())


def _write_dxf(lines: Sequence[LiftedLine], path: Path, place: str) -> None:
    names = [FORBIDDEN.sub("_", line.name) or "0" for line in lines]
    layers: dict[str, str] = {}  # to DXF names that differ by their case alone are one
    for name in names:
        layers.setdefault(name.lower(), name)
    with dxf_document(path, place) as document:
        add_layers(document, {name: DRAWN for name in layers.values() if name not in document.layers})
        for line, name in zip(lines, names, strict=True):
            document.modelspace().add_polyline3d(line.points.round(6).tolist(), dxfattribs={"layer": name})


def _write_json(lines: Sequence[LiftedLine], path: Path, place: str) -> None:
    features = [
        {
            "type": "Feature",
            "properties": {
                "name": line.name,
                "component": line.component,
                "deviation": line.deviation.round(6).tolist(),
            },
            "geometry": {"type": "LineString", "coordinates": line.points.round(6).tolist()},
        }
        for line in lines
    ]
    told: dict[str, Any] = {"type": "FeatureCollection", "coordinates": place, "features": features}
    path.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _write_csv(lines: Sequence[LiftedLine], path: Path, place: str) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("line", "component", "x", "y", "z", "s", "t", "deviation", "coordinates"))
        for k, line in enumerate(lines, 1):
            whole = np.column_stack([line.points, line.sheet, line.deviation])
            rows.writerows(
                [f"{line.name} {k}", line.component, *(f"{v:.6f}" for v in row), place] for row in whole.tolist()
            )


READERS: dict[str, Callable[[Path], Iterable[DrawnLine]]] = {
    ".dxf": _read_dxf,
    ".geojson": _read_json,
    ".json": _read_json,
    ".csv": _read_csv,
}
WRITERS: dict[str, Callable[[Sequence[LiftedLine], Path, str], None]] = {
    ".dxf": _write_dxf,
    ".geojson": _write_json,
    ".csv": _write_csv,
}

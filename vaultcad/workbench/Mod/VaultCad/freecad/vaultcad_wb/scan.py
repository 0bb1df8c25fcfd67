"""A scan in the document: its points thinned and coloured, and their deviations once it was fitted."""

from __future__ import annotations

import math
import tempfile
from array import array
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import FreeCAD as App
import Points

from .catalogue import scale
from .client import FITTER, GoneError
from .texts import complain, say, translate

BYTES, FLOATS = 3, 12  # of one point: its colour, and its coordinates
SHOWS = ("Colour", "Deviation")

Colour = tuple[float, ...]  # red, green, blue from 0 to 1


def load(document: Any, path: str, up: str = "Z", unit: str = "auto") -> Any:
    """Read a scan through the worker and show its points; what was assumed of it goes to the report view.

    unit: m, cm, mm, ft, ftUS or in; auto for the one that the file states, or metres.

    Raises:
        client.RefusedError: the file cannot be read; why.
        client.GoneError: the worker cannot be had.
    """
    with tempfile.TemporaryDirectory(prefix="vaultcad-") as folder:
        out = Path(folder) / "points"
        reply = FITTER.ask("read", scan=path, up=up.lower(), unit=unit, path=str(out))
        content = out.read_bytes()
    obj = document.addObject("Points::FeaturePython", "Scan")
    obj.Label = Path(path).stem
    Scan(obj)
    obj.File, obj.Up, obj.Unit, obj.Total = path, up, unit, reply["points"]
    for note in reply["notes"]:
        say(f"{Path(path).name}: {note}")
    obj.Origin = App.Vector(*reply["origin"])
    n = reply["shown"]
    xyz = array("f", content[: n * FLOATS])
    cloud = Points.Points()
    cloud.addPoints(list(zip(xyz[0::3], xyz[1::3], xyz[2::3], strict=True)))
    obj.Points = cloud
    rgb = [value / 255 for value in content[n * FLOATS : n * (FLOATS + BYTES)]]
    obj.ScanColor = list(zip(rgb[0::3], rgb[1::3], rgb[2::3], strict=True))
    obj.Color = obj.ScanColor
    if App.GuiUp:
        from .view import ScanView

        ScanView(obj.ViewObject)
        obj.ViewObject.DisplayMode = "Color"
        obj.ViewObject.PointSize = 2
    return obj


def is_scan(obj: Any) -> bool:
    """Whether an object of a document is a scan of ours."""
    return isinstance(getattr(obj, "Proxy", None), Scan)


def show_deviations(obj: Any, deviations: Sequence[float]) -> None:
    """Colour the points by their deviations [mm]: NaN off the vaults, infinite where an earlier one stands."""
    earlier = obj.Deviation or [math.nan] * len(deviations)
    obj.Deviation = [e if math.isinf(d) else d for d, e in zip(deviations, earlier, strict=True)]
    obj.Show = "Deviation"


def colour(deviation: float, limit: float) -> Colour:
    """The colour of a deviation [mm], positive in the stone; grey where there is none."""
    told = scale()
    if math.isnan(deviation):
        return tuple(told["unknown"])
    share = max(-1.0, min(1.0, deviation / limit))
    stops = told["stops"]
    (low, first), (high, last) = next(pair for pair in pairwise(stops) if share <= pair[1][0])
    t = (share - low) / (high - low)
    return tuple(a + t * (b - a) for a, b in zip(first, last, strict=True))


class Scan:
    """The behaviour of the object; the object's own properties hold all values."""

    def __init__(self, obj: Any) -> None:
        obj.Proxy = self
        for kind, name, group, text in (
            ("App::PropertyFile", "File", "Scan", translate("VaultCad", "the scan's file")),
            ("App::PropertyEnumeration", "Up", "Scan", translate("VaultCad", "the axis that is up in the file")),
            (
                "App::PropertyString",
                "Unit",
                "Scan",
                translate("VaultCad", "the unit of the file, or auto as it states it"),
            ),
            ("App::PropertyInteger", "Total", "Scan", translate("VaultCad", "points in the file")),
            (
                "App::PropertyVector",
                "Origin",
                "Scan",
                translate("VaultCad", "what the points are relative to, in metres"),
            ),
            (
                "App::PropertyEnumeration",
                "Show",
                "Colours",
                translate("VaultCad", "its own colours, or the deviations from the fit"),
            ),
            (
                "App::PropertyLength",
                "Limit",
                "Colours",
                translate("VaultCad", "deviation that has the strongest colour"),
            ),
            ("App::PropertyColorList", "Color", "Colours", ""),
            ("App::PropertyColorList", "ScanColor", "Colours", ""),
            ("App::PropertyFloatList", "Deviation", "Colours", ""),
        ):
            obj.addProperty(kind, name, group, text)
        obj.Up, obj.Show = ["Z", "Y"], list(SHOWS)
        obj.Limit = scale()["limit"]
        self._hide(obj)

    def execute(self, obj: Any) -> None:
        """Nothing to make: the points stay as they were read."""

    def onChanged(self, obj: Any, name: str) -> None:
        """Colour the points as is asked."""
        if name not in {"Show", "Limit", "Deviation"} or App.isRestoring() or "Deviation" not in obj.PropertiesList:
            return
        if obj.Show == "Deviation" and len(obj.Deviation) == len(obj.ScanColor) and obj.Limit.Value > 0:
            limit = obj.Limit.Value
            try:
                obj.Color = [colour(value, limit) for value in obj.Deviation]
            except GoneError as error:
                complain(str(error))
        elif obj.ScanColor:
            obj.Color = obj.ScanColor

    def onDocumentRestored(self, obj: Any) -> None:
        """What documents do not keep: which properties are hidden."""
        self._hide(obj)

    def dumps(self) -> None:
        """Nothing to keep: the object's properties hold all."""

    def loads(self, state: None) -> None:
        """Nothing was kept."""

    __getstate__, __setstate__ = dumps, loads  # the names that FreeCAD 0.20 knows them by

    def _hide(self, obj: Any) -> None:
        for name in ("File", "Up", "Unit", "Total", "Origin"):
            obj.setEditorMode(name, 1)
        for name in ("Color", "ScanColor", "Deviation"):
            obj.setEditorMode(name, 2)

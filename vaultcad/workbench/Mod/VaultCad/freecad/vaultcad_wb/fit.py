"""From a scan in the document to vaults in place: a fit under way, and what becomes of its result."""

from __future__ import annotations

import json
import tempfile
from array import array
from math import degrees, radians
from pathlib import Path
from typing import Any

import FreeCAD as App

from . import properties, scan, vault
from .client import FITTER, outcome
from .texts import translate
from .vault import MM

STEEPEST = radians(10)  # lean of a vault that stands in a scan which was not level
FAINT = 1e-9  # rad


class Fit:
    """A fit that runs in the worker; ask `poll` now and then until it gives the vaults."""

    def __init__(
        self, points: Any, family: str = "auto", region: dict[str, Any] | None = None, instead: Any = None
    ) -> None:
        """Begin.

        Args:
            points: the scan in the document.
            family: "auto", or the id of the one to fit.
            region: that the fit is to stay in, as `region` gives it; all of the scan if left out.
            instead: the vault that the result takes the place of.

        Raises:
            client.GoneError: the worker cannot be had.
        """
        self.points, self.region, self.instead = points, region, instead
        self.stage, self.share = "", 0.0
        self._folder = tempfile.TemporaryDirectory(prefix="vaultcad-")
        self._path = Path(self._folder.name) / "deviation"
        asked = {"scan": points.File, "up": points.Up.lower(), "family": family, "path": str(self._path)}
        asked["unit"] = getattr(points, "Unit", "auto")  # documents of earlier versions have none
        if region is not None:
            asked["box"] = region
        self._call = FITTER.begin("fit", **asked)

    def poll(self, timeout: float = 0.0) -> list[Any] | None:
        """The vaults once they stand in the document, None before.

        Raises:
            client.RefusedError: no vault was found; why.
            client.GoneError: the worker ended.
        """
        while (reply := self._call.poll(timeout)) is not None:
            if "progress" in reply:
                self.stage, self.share = reply["progress"], reply["share"]
                continue
            try:
                return self._place(outcome(reply)["vaults"])
            finally:
                self._folder.cleanup()
        return None

    def cancel(self) -> None:
        """End it; nothing changes in the document."""
        FITTER.stop()
        self._folder.cleanup()

    def _place(self, found: list[dict[str, Any]]) -> list[Any]:
        document = self.points.Document
        document.openTransaction(translate("VaultCad", "Fit vault"))
        try:
            made = [self._vault(document, report) for report in found]
            if self.instead is not None:
                document.removeObject(self.instead.Name)
            scan.show_deviations(self.points, array("f", self._path.read_bytes()))
            document.recompute()
        except Exception:
            document.abortTransaction()
            raise
        document.commitTransaction()
        return made

    def _vault(self, document: Any, report: dict[str, Any]) -> Any:
        obj = vault.make(document, report["family"])
        properties.choose(obj, obj.Proxy.declaration, report["profiles"], report["parameters"])
        obj.addProperty("App::PropertyLink", "Scan", "Fit", translate("VaultCad", "the scan that it was fitted to"))
        obj.Scan = self.points
        obj.Report = json.dumps({**report, "region": report["bay"] or self.region})
        pose = report["pose"]
        place = App.Vector(*(MM * pose[axis] for axis in "xyz"))
        turn = App.Rotation(App.Vector(0, 0, 1), degrees(pose["yaw"]))
        leans = App.Vector(*pose["lean"], 0)
        if leans.Length:
            turn = App.Rotation(leans, degrees(leans.Length)).multiply(turn)
        obj.Placement = self.points.Placement.multiply(App.Placement(place, turn))
        return obj


def region(box: Any, points: Any) -> dict[str, Any]:
    """The box of an object in its own axes: frame (3, 4) from the scan's points to there, low and high corner [m]."""
    shape = box.Shape.copy()
    shape.Placement = App.Placement()
    bounds = shape.BoundBox
    matrix = box.Placement.inverse().multiply(points.Placement).toMatrix().A
    frame = [[value / (MM if k == 3 else 1) for k, value in enumerate(matrix[4 * r : 4 * r + 4])] for r in range(3)]
    return {
        "frame": frame,
        "low": [value / MM for value in (bounds.XMin, bounds.YMin, bounds.ZMin)],
        "high": [value / MM for value in (bounds.XMax, bounds.YMax, bounds.ZMax)],
    }


def pose(obj: Any) -> dict[str, Any]:
    """Where a vault stands [m], its turn about the vertical and its lean [rad], relative to its scan's points."""
    place = obj.Placement
    if getattr(obj, "Scan", None) is not None:
        place = obj.Scan.Placement.inverse().multiply(place)
    up = App.Vector(0, 0, 1)
    leaning = App.Rotation(up, place.Rotation.multVec(up))
    if leaning.Angle > STEEPEST:
        why = translate("VaultCad", "it is tilted; turn it about the vertical only")
        raise ValueError(f"{obj.Label}: {why}")
    yaw, _, _ = leaning.inverted().multiply(place.Rotation).getYawPitchRoll()
    lean = [leaning.Angle * leaning.Axis.x, leaning.Angle * leaning.Axis.y] if leaning.Angle > FAINT else [0.0, 0.0]
    where = {"x": place.Base.x / MM, "y": place.Base.y / MM, "z": place.Base.z / MM}
    return {**where, "yaw": radians(yaw), "lean": lean}


def report(obj: Any) -> dict[str, Any] | None:
    """What the fit found of a vault; None if it was not fitted, or was changed since."""
    if not obj.Report:
        return None
    found: dict[str, Any] = json.loads(obj.Report)
    now = obj.Proxy.request(obj)
    same = now["profiles"] == found["profiles"] and all(
        abs(now["parameters"][name] - value) < 1e-9 for name, value in found["parameters"].items()
    )
    return found if same else None

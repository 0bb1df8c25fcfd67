"""What becomes of a fit that finds several vaults, and of one of them fitted anew; the fits themselves are given."""

import math
from array import array
from pathlib import Path

import FreeCAD as App
import given
from freecad.vaultcad_wb import client, fit, scan


class Answer:
    """A call whose result is there."""

    def __init__(self, vaults):
        self.reply = {"result": {"vaults": vaults}}

    def poll(self, timeout):
        return self.reply


def fitted(points, vaults, deviations, **how):
    """As if the worker had found that."""
    asked = {}

    def begin(do, **request):
        asked.update(request)
        Path(request["path"]).write_bytes(array("f", deviations).tobytes())
        return Answer(vaults)

    fit.FITTER = type("Worker", (), {"begin": staticmethod(begin)})
    return fit.Fit(points, **how).poll(), asked


def work():
    document = App.newDocument("several")
    document.UndoMode = 1
    points = scan.load(document, given.GIVEN["scan"])
    points.Placement.Base = App.Vector(0, 0, 1000)
    client.FITTER.stop()
    n = points.Points.CountPoints
    half, nan, inf = n // 2, math.nan, math.inf
    vaults = given.GIVEN["vaults"]
    both, _ = fitted(points, vaults, [1.0] * half + [nan] * (n - half))
    found = {
        "families": [obj.Family for obj in both],
        "states": [given.state(obj) for obj in both],
        "bases": [list(obj.Placement.Base) for obj in both],
        "poses": [fit.pose(obj) for obj in both],
    }
    region = fit.report(both[1])["region"]
    (_,), asked = fitted(
        points, vaults[:1], [inf] * half + [2.0] * (n - half), family="sail", region=region, instead=both[1]
    )
    found["asked"] = {"box": asked["box"], "family": asked["family"]}
    found["objects"] = [obj.Family for obj in document.Objects if hasattr(obj, "Family")]
    found["deviations"] = [points.Deviation[0], points.Deviation[-1]]
    document.undo()
    found["undone"] = [obj.Family for obj in document.Objects if hasattr(obj, "Family")]
    return found


given.told(work)

"""A scan read, a fit that is killed, one that is cancelled, one that comes to its end; undone, switched, exported."""

import math
import os
import signal

import FreeCAD as App
import given
from freecad.vaultcad_wb import client, exports, fit, properties, scan


def finished(job):
    stages = []
    while (found := job.poll(0.2)) is None:
        stages.append(job.stage)
    return found, list(dict.fromkeys(stages))


def look(document, points):
    return {
        "objects": [obj.Name for obj in document.Objects],
        "on": sum(not math.isnan(value) for value in points.Deviation),
        "colours": len(set(points.Color)),
    }


def work():
    document = App.newDocument("fitted")
    document.UndoMode = 1
    points = scan.load(document, given.GIVEN["scan"])
    document.recompute()
    found = {"shown": points.Points.CountPoints, "total": points.Total, "start": look(document, points)}

    job = fit.Fit(points)
    while not job.stage:
        job.poll(0.1)
    dying = client.FITTER.pid
    os.kill(dying, signal.SIGKILL)
    try:
        finished(job)
    except client.GoneError as error:
        found["killed"] = str(error)
    job = fit.Fit(points)
    job.poll(0.1)
    job.cancel()
    found["after"] = look(document, points)

    (obj,), stages = finished(fit.Fit(points))
    report = fit.report(obj)
    found["fit"] = {
        **look(document, points),
        "stages": stages,
        "state": given.state(obj),
        "report": report,
        "values": properties.values(obj, obj.Proxy.declaration),
        "base": list(obj.Placement.Base),
        "pose": fit.pose(obj),
    }
    for suffix in ("step", "ifc", "glb"):
        exports.export([obj], str(given.FOLDER / f"fitted.{suffix}"))
    obj.SpanX = obj.SpanX.Value + 10
    document.recompute()
    found["edited"] = fit.report(obj) is None
    exports.export([obj], str(given.FOLDER / "edited.ifc"))
    try:
        exports.export([obj], str(given.FOLDER / "fitted.dwg"))
    except client.RefusedError as error:
        found["suffix"] = str(error)

    (other,), _ = finished(fit.Fit(points, "lunette", None, obj))
    found["switched"] = {**look(document, points), "family": other.Family, "alternatives": report["alternatives"]}
    document.undo()
    found["undone"] = look(document, points)

    box = document.addObject("Part::Box", "Box")
    box.Length = box.Width = box.Height = "0.5 m"
    box.Placement.Base = App.Vector(1e6, 0, 0)
    document.recompute()
    try:
        finished(fit.Fit(points, region=fit.region(box, points)))
    except client.RefusedError as error:
        found["empty"] = str(error)
    document.saveAs(str(given.FOLDER / "fitted.FCStd"))
    before = look(document, points)
    App.closeDocument(document.Name)
    client.FITTER.stop()
    opened = App.openDocument(str(given.FOLDER / "fitted.FCStd"))
    again = next(obj for obj in opened.Objects if scan.is_scan(obj))
    after = look(opened, again)  # colours are kept with eight bits
    found["opened"] = {**after, "colours": 0} == {**before, "colours": 0} and client.FITTER.pid is None
    again.Show = "Colour"
    found["scale"] = [scan.colour(deviation, 20.0) for deviation in given.GIVEN["deviations"]]
    found["plain"] = list(again.Color) == list(again.ScanColor)
    return found


given.told(work)

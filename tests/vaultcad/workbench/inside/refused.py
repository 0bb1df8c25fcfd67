"""Values that cannot be, and a worker that is killed in the middle of a rebuild."""

import os
import signal
import threading

import FreeCAD as App
import given
from freecad.vaultcad_wb import client, vault


def work():
    document = App.newDocument("refused")
    document.UndoMode = 1
    obj = vault.make(document, "groin")
    document.recompute()
    found = {"start": given.state(obj)}

    obj.SpanX, obj.ProfileY = "400 m", "segmental"
    document.recompute()
    found["refused"] = {**given.state(obj), "span": obj.SpanX.Value, "profile": obj.ProfileY}
    obj.Thickness = "-1 mm"  # FreeCAD itself makes it 0
    document.recompute()
    found["thickness"] = obj.Thickness.Value

    obj.RiseX = "2 m"  # its profile leaves no choice
    document.recompute()
    found["no_choice"] = {**given.state(obj), "rise": obj.RiseX.Value}

    obj.setExpression("SpanX", "100 m")
    document.recompute()
    found["expression"] = {**given.state(obj), "why": obj.getStatusString()}
    obj.setExpression("SpanX", None)
    obj.SpanX = "5 m"
    document.recompute()
    found["mended"] = given.state(obj)

    document.openTransaction("rise")
    obj.ProfileX = "segmental"
    document.recompute()
    obj.RiseX = "2 m"
    document.recompute()
    document.commitTransaction()
    found["rise"] = {"ratio": obj.RiseRatioX, "rise": obj.RiseX.Value, "top": obj.Shape.BoundBox.ZMax}
    document.undo()
    document.recompute()
    found["fallen"] = given.state(obj)

    # Stopped, so that it is the rebuild that it dies in, however quick that is.
    first = client.BUILDER.pid
    os.kill(first, signal.SIGSTOP)
    threading.Timer(0.3, os.kill, (first, signal.SIGKILL)).start()
    obj.SpanX = "6 m"
    document.recompute()
    found["killed"] = {**given.state(obj), "why": obj.getStatusString()}
    obj.SpanX = "7 m"
    document.recompute()
    found["next"] = given.state(obj)
    found["another"] = client.BUILDER.pid not in {None, first}
    found["refused_first"] = _first_that_cannot_be(document)
    return found


def _first_that_cannot_be(document):
    """A vault that was never good has nothing to go back to."""
    obj = vault.make(document, "barrel")
    obj.Span = "1000 m"
    document.recompute()
    return {"states": list(obj.State), "null": obj.Shape.isNull(), "why": obj.getStatusString()}


given.told(work)

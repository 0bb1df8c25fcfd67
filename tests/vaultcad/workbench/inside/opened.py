"""The document of saved.py, opened where no worker can be had, and edited."""

import FreeCAD as App
import given


def work():
    document = App.openDocument(str(given.FOLDER / "saved.FCStd"))
    document.recompute(None, True)
    obj = document.getObject("Dome")
    found = {"state": given.state(obj)}
    obj.Radius = "4 m"
    document.recompute()
    return {**found, "edited": given.state(obj), "why": obj.getStatusString()}


given.told(work)

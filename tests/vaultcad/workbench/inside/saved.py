"""A document with a vault, saved."""

import FreeCAD as App
import given
from freecad.vaultcad_wb import vault


def work():
    document = App.newDocument("saved")
    obj = vault.make(document, "dome")
    obj.Thickness = "0.3 m"
    document.recompute()
    document.saveAs(str(given.FOLDER / "saved.FCStd"))
    return {"saved": given.state(obj)}


given.told(work)

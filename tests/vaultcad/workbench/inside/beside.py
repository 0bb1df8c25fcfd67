"""New vaults from the menu: each beside what is there, alone selected, made and undone in one step; and their icons."""

from pathlib import Path

import FreeCAD as App
import FreeCADGui as Gui
import given
import session
from freecad.vaultcad_wb import scan, view
from freecad.vaultcad_wb.catalogue import families
from PySide import QtGui


def box(thing):
    b = thing.BoundBox
    return [b.XMin, b.XMax, b.YMin, b.YMax, b.ZMin, b.ZMax]


def icon(obj):
    return Path(obj.ViewObject.Proxy.getIcon()).name


def user(found):
    window = session.window(dock=330)
    yield 500
    titles = [declaration["title"].capitalize() for declaration in families().values()]
    icons = [action.icon() for action in window.findChildren(QtGui.QAction) if action.text() in titles]
    found["pictures"] = len({bytes(drawn.pixmap(24).toImage().constBits()) for drawn in icons})
    found["fallback"] = view.icon("family_without_one")
    found["vaults"] = []
    for name in families():
        Gui.runCommand(f"VaultCad_New_{name}")
        yield 300
        obj = App.ActiveDocument.Objects[-1]
        found["vaults"].append(
            {
                "family": name,
                **given.state(obj),
                "base": list(obj.Placement.Base),
                "selected": [chosen.Name for chosen in Gui.Selection.getSelection()] == [obj.Name],
                "icon": icon(obj),
            }
        )
    document = App.ActiveDocument
    document.recompute()
    session.screenshot("beside")
    points = scan.load(document, given.GIVEN["scan"])
    points.Placement.Base.x = 1e5
    document.addObject("PartDesign::Plane", "Datum")
    document.getObject("Sail").Visibility = False
    document.recompute()
    before, steps = [obj.Name for obj in document.Objects], document.UndoCount
    Gui.runCommand("VaultCad_New_dome")
    yield 300
    found["scan"], found["past"] = box(points.Points), box(document.Objects[-1].Shape)
    found["steps"] = document.UndoCount - steps
    document.undo()
    found["undone"] = [obj.Name for obj in document.Objects] == before
    document.redo()
    yield 300
    again = document.Objects[-1]
    found["redone"] = [box(again.Shape), icon(again)]
    path = str(given.FOLDER / "beside.FCStd")
    document.saveAs(path)
    App.closeDocument(document.Name)
    opened = App.openDocument(path)
    yield 500
    found["opened"] = [icon(obj) for obj in opened.Objects if hasattr(obj, "Family")]


session.run(user)

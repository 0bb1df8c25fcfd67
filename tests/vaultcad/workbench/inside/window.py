"""A user's session in the window: a groin vault from the menu, its edit, the demo scan, a fit, and what it found."""

import time

import FreeCAD as App
import FreeCADGui as Gui
import given
import session
from PySide import QtGui
from session import screenshot

SECONDS = 120  # for the fit


def pixels(name):
    """How many colours the picture of the 3D view has."""
    image = QtGui.QImage(str(given.FOLDER / f"{name}.png"))
    across = range(300, image.width(), 7)
    found = [image.pixel(x, y) for x in across for y in range(120, image.height() - 40, 7)]
    return len(set(found))


def look_at(*objects):
    Gui.Selection.clearSelection()
    Gui.ActiveDocument.ActiveView.viewIsometric()
    Gui.SendMsgToActiveView("ViewFit")
    for obj in objects:
        Gui.Selection.addSelection(obj)


def user(found):
    window = session.window(dock=330)
    yield 500
    bar = window.menuBar().actions()
    entry = next(action for action in bar if action.text() == "VaultCad")
    menu = entry.menu().actions()
    new = menu[0].menu().actions()
    found["menu"] = [action.text() for action in menu]
    found["families"] = [action.text() for action in new]
    found["toolbar"] = [bar.windowTitle() for bar in window.findChildren(QtGui.QToolBar)]

    next(action for action in new if action.text() == "Groin vault").trigger()
    yield 500
    document = App.ActiveDocument
    groin = document.Objects[0]
    groin.ViewObject.Selectable = False  # or it would be all green in the picture of its properties
    look_at(groin)
    yield 800
    screenshot("vault")
    found["vault"] = {**given.state(groin), "pixels": pixels("vault")}
    groin.ViewObject.Selectable = True
    groin.ViewObject.Visibility = False

    from freecad.vaultcad_wb import commands, fit, panel

    scan = commands.ImportScan().load(given.GIVEN["scan"])
    look_at()
    yield 800
    screenshot("scan")
    found["scan"] = {"pixels": pixels("scan"), "mode": scan.ViewObject.DisplayMode}

    Gui.Selection.addSelection(scan)
    shown = []
    show = Gui.Control.showDialog
    panel.Gui.Control = type("Control", (), {"closeDialog": Gui.Control.closeDialog, "showDialog": None})
    panel.Gui.Control.showDialog = staticmethod(lambda page: (shown.append(page), show(page)))
    Gui.runCommand("VaultCad_Fit")
    yield 2000
    screenshot("fitting")
    end = time.monotonic() + SECONDS
    while len(shown) < 2 and time.monotonic() < end:
        yield 200
    look_at()
    yield 1000
    screenshot("fitted")
    fitted = next(obj for obj in document.Objects if getattr(obj, "Report", ""))
    found["fitted"] = {**given.state(fitted), "pixels": pixels("fitted"), "same": fit.report(fitted) is not None}
    table = shown[1].form[0].findChildren(QtGui.QTableWidget)[0]
    cells = [[table.item(row, column).text() for column in range(3)] for row in range(table.rowCount())]
    found["table"] = {name: (value, std) for name, value, std in cells}
    choice = shown[1].form[0].findChildren(QtGui.QComboBox)[0]
    found["alternatives"] = [choice.itemText(k) for k in range(choice.count())]

    Gui.Control.closeDialog()
    scan.ViewObject.Visibility = False
    fitted.Thickness = "0.3 m"
    document.recompute()
    look_at()
    below = App.Rotation(App.Vector(0, 0, 1), 35).multiply(App.Rotation(App.Vector(1, 0, 0), 115))
    Gui.ActiveDocument.ActiveView.setCameraOrientation(below)
    Gui.SendMsgToActiveView("ViewFit")
    yield 500
    screenshot("below")
    found["painted"] = len(set(fitted.ViewObject.DiffuseColor))
    scan.Limit = "20 mm"
    page = panel.ResultPanel([fitted])
    found["legend"] = [label.text() for label in page.form[0].findChildren(QtGui.QLabel)[1:4]]
    found["as fitted"] = page.form[0].findChildren(QtGui.QLabel)[0].text()
    fitted.SpanX = "5 m"
    document.recompute()
    page = panel.ResultPanel([fitted])
    found["edited"] = page.form[0].findChildren(QtGui.QLabel)[0].text()
    fitted.SpanX = "400 m"
    document.recompute()
    yield 100
    found["status"] = window.statusBar().currentMessage()
    Gui.Selection.clearSelection()
    Gui.Selection.addSelection(fitted, f"Face{1 + list(fitted.FaceNames).index('web_south')}")
    yield 300
    found["face"] = window.statusBar().currentMessage()
    screenshot("refused")
    document.undo()
    found["undone"] = [obj.Name for obj in document.Objects]
    document.redo()
    path = str(given.FOLDER / "window.FCStd")
    document.saveAs(path)
    App.closeDocument(document.Name)
    opened = App.openDocument(path)
    yield 500
    again = next(obj for obj in opened.Objects if getattr(obj, "Report", ""))
    found["again"] = len(set(again.ViewObject.DiffuseColor))


session.run(user)

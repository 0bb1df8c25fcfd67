"""Drives FreeCAD's window: a session is a generator that yields the milliseconds in which FreeCAD goes its own way."""

import os
import traceback

import FreeCAD as App
import FreeCADGui as Gui
import given
from PySide import QtCore, QtGui

WIDTH, HEIGHT = 1400, 900


def window(dock):
    """The main window in a corner of the screen, before a plain background; dock: width of what is beside the view."""
    view = App.ParamGet("User parameter:BaseApp/Preferences/View")
    view.SetBool("Simple", True)
    view.SetBool("Gradient", False)
    view.SetUnsigned("BackgroundColor", 0xFFFFFFFF)
    main = Gui.getMainWindow()
    main.move(0, 0)
    main.resize(WIDTH, HEIGHT)
    docks = [dock for dock in main.findChildren(QtGui.QDockWidget) if dock.isVisible()]
    main.resizeDocks(docks, [dock] * len(docks), QtCore.Qt.Horizontal)
    Gui.activateWorkbench("VaultCadWorkbench")
    return main


def screenshot(name):
    """What the X server shows: `QWidget.grab` leaves out the 3D view."""
    screen = QtGui.QApplication.primaryScreen()
    screen.grabWindow(0).save(str(given.FOLDER / f"{name}.png"))


def run(session):
    """Run session(found), tell what it put into `found`, and end FreeCAD."""
    found = {}
    steps = session(found)

    def step():
        try:
            QtCore.QTimer.singleShot(next(steps), step)
        except StopIteration:
            given.tell(found)
            os._exit(0)
        except BaseException:
            screenshot("failed")
            given.tell({"failed": traceback.format_exc()})
            os._exit(1)

    QtCore.QTimer.singleShot(1000, step)

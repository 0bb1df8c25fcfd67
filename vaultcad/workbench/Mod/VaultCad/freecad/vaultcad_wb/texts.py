"""Texts in the user's language, and lines in FreeCAD's report view.

Calls are written as Qt's lupdate finds them: translate("VaultCad", "the text itself").
"""

from __future__ import annotations

from typing import Any

import FreeCAD as App

CONTEXT = "VaultCad"


def translate(context: str, text: str) -> str:
    """The translation of a text, or the text itself where there is none, or no window."""
    qt: Any = getattr(App, "Qt", None)
    return str(qt.translate(context, text)) if qt is not None else text


def QT_TRANSLATE_NOOP(context: str, text: str) -> str:
    """A text that FreeCAD translates itself when it shows a command; here it is only marked for the translators."""
    return text


def say(text: str) -> None:
    """A line in the report view."""
    App.Console.PrintMessage(f"VaultCad: {text}\n")


def complain(text: str) -> None:
    """A line in red in the report view, and in the window's status bar."""
    App.Console.PrintError(f"VaultCad: {text}\n")
    if App.GuiUp:
        import FreeCADGui as Gui
        from PySide import QtCore

        # Later, for a recompute that is under way clears the bar when it ends.
        QtCore.QTimer.singleShot(0, lambda: Gui.getMainWindow().statusBar().showMessage(text, 10_000))

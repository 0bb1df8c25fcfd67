"""Texts in the user's language, and lines in FreeCAD's report view."""

from __future__ import annotations

from typing import Any

import FreeCAD as App

CONTEXT = "VaultCad"


def tr(text: str) -> str:
    """The translation of a text, or the text itself where there is none, or no window."""
    translate: Any = getattr(App, "Qt", None)
    return str(translate.translate(CONTEXT, text)) if translate is not None else text


def marked(context: str, text: str) -> str:
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

        Gui.getMainWindow().statusBar().showMessage(text, 10_000)

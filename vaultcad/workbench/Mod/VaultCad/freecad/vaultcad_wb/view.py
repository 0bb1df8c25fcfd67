"""How vaults and scans look in FreeCAD's window."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import FreeCAD as App
import FreeCADGui as Gui

ICONS = Path(__file__).parent / "icons"


def icon(name: str) -> str:
    """The path of an icon; that of a vault for a family that has none of its own."""
    path = ICONS / f"{name}.svg"
    return str(path if path.exists() else ICONS / "vault.svg")


class View:
    """What all of our view providers share."""

    icon_name = "workbench"

    def __init__(self, view: Any) -> None:
        view.Proxy = self

    def getIcon(self) -> str:
        """The icon in the tree."""
        return icon(self.icon_name)

    def dumps(self) -> None:
        """Nothing to keep."""

    def loads(self, state: None) -> None:
        """Nothing was kept."""

    __getstate__, __setstate__ = dumps, loads  # the names that FreeCAD 0.20 knows them by


class VaultView(View):
    """Colours the faces of a vault by component; a double click shows what the fit found."""

    def attach(self, view: Any) -> None:
        """The object is there: its family has an icon."""
        self.icon_name = view.Object.Proxy.declaration["id"]

    def updateData(self, obj: Any, name: str) -> None:
        """Faces were made anew: colour them."""
        if name == "FaceColors" and obj.FaceColors:
            obj.ViewObject.DiffuseColor = obj.FaceColors

    def doubleClicked(self, view: Any) -> bool:
        """Show the results of the fit, where there was one."""
        if not view.Object.Report:
            return False
        from .panel import show_results

        show_results(view.Object)
        return True


class FaceTeller:
    """Names the component of a face of a vault that is selected, in the status bar."""

    def addSelection(self, document: str, name: str, element: str, point: Any) -> None:
        """Called by FreeCAD for each thing that is selected."""
        names = getattr(App.getDocument(document).getObject(name), "FaceNames", None)
        if names and element.startswith("Face"):
            Gui.getMainWindow().statusBar().showMessage(names[int(element[4:]) - 1], 10_000)


class ScanView(View):
    """Points in their colours."""

    icon_name = "scan"

"""The workbench, which FreeCAD finds here when its window starts."""

from __future__ import annotations

import FreeCADGui as Gui

from .texts import QT_TRANSLATE_NOOP
from .view import icon


class VaultCadWorkbench(Gui.Workbench):
    """Vaults, scans, and the way from one to the other."""

    MenuText = "VaultCad"
    ToolTip = QT_TRANSLATE_NOOP("VaultCad", "Masonry vaults as parametric objects, and laser scans fitted with them")
    Icon = icon("workbench")

    def Initialize(self) -> None:
        """Called when the workbench is first chosen."""
        from .client import BUILDER, GoneError
        from .commands import register
        from .texts import complain
        from .view import FaceTeller

        try:
            names = register()
            BUILDER.begin("ping")  # what is slow to load is there when the first vault is made
        except GoneError as error:
            complain(str(error))
            return
        Gui.Selection.addObserver(FaceTeller())
        self.appendToolbar("VaultCad", list(names))
        self.appendMenu("VaultCad", list(names))

    def GetClassName(self) -> str:
        """Written in Python."""
        return "Gui::PythonWorkbench"


Gui.addWorkbench(VaultCadWorkbench())

"""The commands of menu and toolbar."""

from __future__ import annotations

from typing import Any

import FreeCAD as App
import FreeCADGui as Gui
from PySide import QtCore, QtGui

from . import panel, scan, vault
from .catalogue import families
from .client import GoneError, RefusedError
from .exports import FILTERS, export
from .fit import region
from .texts import QT_TRANSLATE_NOOP, complain, say, translate
from .view import icon

SCANS = "*.e57 *.las *.laz *.ply *.pcd *.ptx *.pts *.xyz *.csv *.txt *.asc"
UNITS = ("m", "cm", "mm", "ft", "ftUS", "in")
UNIT_OPTION = "--unit"  # what a refusal names if the unit of the scan is not clear


class Command:
    """What all commands share: texts that FreeCAD translates, an icon, and errors as a line in red."""

    menu = tip = image = ""

    def GetResources(self) -> dict[str, str]:
        """What FreeCAD shows."""
        return {"MenuText": self.menu, "ToolTip": self.tip, "Pixmap": icon(self.image)}

    def IsActive(self) -> bool:
        """Whether it can be chosen."""
        return True

    def Activated(self, index: int = 0) -> None:
        """Run it."""
        QtGui.QApplication.setOverrideCursor(QtCore.Qt.WaitCursor)
        try:
            self.run(index)
        except (RefusedError, GoneError, ValueError) as error:
            complain(str(error))
        finally:
            QtGui.QApplication.restoreOverrideCursor()

    def run(self, index: int) -> None:
        """The work itself."""
        raise NotImplementedError


class NewVault(Command):
    """A menu of the families."""

    menu = QT_TRANSLATE_NOOP("VaultCad", "New vault")
    tip = QT_TRANSLATE_NOOP("VaultCad", "Make a vault of a family; its sizes are properties")
    image = "vault"

    def GetCommands(self) -> tuple[str, ...]:
        """One command a family, registered beforehand."""
        return tuple(f"VaultCad_New_{name}" for name in families())

    def GetDefaultCommand(self) -> int:
        """The first family."""
        return 0

    def run(self, index: int) -> None:
        """Make a vault of the family that was chosen."""
        Gui.runCommand(self.GetCommands()[index])


class NewFamily(Command):
    """A vault of one family."""

    def __init__(self, declaration: dict[str, Any]) -> None:
        self.family = self.image = declaration["id"]
        self.menu = declaration["title"].capitalize()
        names = [names[0] for names in declaration["aliases"].values() if names]
        self.tip = f"{self.menu}: {', '.join(names)}"

    def run(self, index: int) -> None:
        """Make it in the active document, beside what is there, or in a new one; it alone is selected."""
        document = App.ActiveDocument or App.newDocument()
        document.openTransaction(translate("VaultCad", "New vault"))
        obj = vault.make(document, self.family)
        document.recompute()
        vault.put_beside(obj)
        document.recompute()
        document.commitTransaction()
        Gui.Selection.clearSelection()
        Gui.Selection.addSelection(obj)
        Gui.ActiveDocument.ActiveView.viewIsometric()
        Gui.SendMsgToActiveView("ViewFit")


class ImportScan(Command):
    """A scan from a file."""

    menu = QT_TRANSLATE_NOOP("VaultCad", "Import scan")
    tip = QT_TRANSLATE_NOOP("VaultCad", "Show the points of a laser scan, thinned and coloured")
    image = "scan"

    def run(self, index: int) -> None:
        """Ask for the file."""
        title, kind = translate("VaultCad", "Import scan"), translate("VaultCad", "Scans")
        path, _ = QtGui.QFileDialog.getOpenFileName(Gui.getMainWindow(), title, "", f"{kind} ({SCANS})")
        if not path:
            return
        try:
            self.load(path)
        except RefusedError as error:
            if UNIT_OPTION not in str(error):
                raise
            unit, said = QtGui.QInputDialog.getItem(Gui.getMainWindow(), title, str(error), UNITS, 0, False)
            if said:
                self.load(path, unit)

    def load(self, path: str, unit: str = "auto") -> Any:
        """Read a file into the active document, or into a new one; unit: as `scan.load` takes it."""
        document = App.ActiveDocument or App.newDocument()
        document.openTransaction(translate("VaultCad", "Import scan"))
        try:
            obj = scan.load(document, path, unit=unit)
        except (RefusedError, GoneError):
            document.abortTransaction()
            raise
        document.commitTransaction()
        document.recompute()
        Gui.ActiveDocument.ActiveView.viewIsometric()
        Gui.SendMsgToActiveView("ViewFit")
        return obj


class FitVault(Command):
    """From a scan to vaults."""

    menu = QT_TRANSLATE_NOOP("VaultCad", "Fit vault")
    tip = QT_TRANSLATE_NOOP(
        "VaultCad", "Fit vaults to the selected scan; a box that is selected too keeps the fit inside it"
    )
    image = "fit"

    def IsActive(self) -> bool:
        """Whether there is a scan."""
        return self._points() is not None

    def run(self, index: int) -> None:
        """Begin, and show the panel."""
        points, box = self._points(), self._box()
        panel.start(points, region=None if box is None else region(box, points))

    def _points(self) -> Any:
        """The selected scan, or the only one of the document."""
        chosen = [obj for obj in Gui.Selection.getSelection() if scan.is_scan(obj)]
        if not chosen and App.ActiveDocument is not None:
            chosen = [obj for obj in App.ActiveDocument.Objects if scan.is_scan(obj)]
        return chosen[0] if len(chosen) == 1 else None

    def _box(self) -> Any:
        shapes = [obj for obj in Gui.Selection.getSelection() if hasattr(obj, "Shape") and not vault.is_vault(obj)]
        return shapes[0] if shapes else None


class Export(Command):
    """Vaults to a file."""

    menu = QT_TRANSLATE_NOOP("VaultCad", "Export vaults")
    tip = QT_TRANSLATE_NOOP("VaultCad", "Write the selected vaults, or all, as STEP, IFC or GLB with their components")
    image = "export"

    def IsActive(self) -> bool:
        """Whether there is a vault."""
        return bool(self._vaults())

    def run(self, index: int) -> None:
        """Ask for the file."""
        title = translate("VaultCad", "Export vaults")
        path, chosen = QtGui.QFileDialog.getSaveFileName(Gui.getMainWindow(), title, "", FILTERS)
        if path:
            suffix = "" if "." in path.rsplit("/", 1)[-1] else "." + chosen.split()[0].lower()
            vaults = self._vaults()
            export(vaults, path + suffix)
            say(f"{path + suffix}: {', '.join(obj.Label for obj in vaults)}")

    def _vaults(self) -> list[Any]:
        chosen = [obj for obj in Gui.Selection.getSelection() if vault.is_vault(obj)]
        if chosen or App.ActiveDocument is None:
            return chosen
        return [obj for obj in App.ActiveDocument.Objects if vault.is_vault(obj)]


def register() -> tuple[str, ...]:
    """Make all commands known to FreeCAD; the names of those in menu and toolbar.

    Raises:
        client.GoneError: the worker, who knows the families, cannot be had.
    """
    for name, declaration in families().items():
        Gui.addCommand(f"VaultCad_New_{name}", NewFamily(declaration))
    shown = {
        "VaultCad_New": NewVault(),
        "VaultCad_Import": ImportScan(),
        "VaultCad_Fit": FitVault(),
        "VaultCad_Export": Export(),
    }
    for name, command in shown.items():
        Gui.addCommand(name, command)
    return tuple(shown)

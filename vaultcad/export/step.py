"""STEP (AP214, mm): the exact masonry of each vault, its faces named and coloured by component."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from vaultcad.errors import ExportError
from vaultcad.export.geometry import masonry
from vaultcad.export.palette import Colour, colour
from vaultcad.model import FittedVault, Model, Pose

if TYPE_CHECKING:
    from OCP.Quantity import Quantity_Color
    from OCP.TDF import TDF_Label
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS_Shape
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

MM = 1000.0
NO_TIME = "1970-01-01T00:00:00"  # the same model gives the same bytes
SETTINGS = {"write.step.schema": "AP214IS", "write.step.unit": "MM"}


def write_step(model: Model, path: Path) -> None:
    """Write an assembly named after the scan, of one solid a vault, placed by its pose relative to `model.origin`.

    Raises:
        ExportError: no vault has a solid, or the translator failed.
    """
    if not any(fitted.solid for fitted in model.vaults):
        raise ExportError(f"{path.name}: no vault has a solid that could be written as STEP")
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    assembly = shapes.NewShape()
    _name(assembly, model.scan.stem)
    for k, fitted in enumerate(model.vaults, 1):
        if not fitted.solid:
            continue
        name = fitted.label or (f"{k} {fitted.vault.title}" if len(model.vaults) > 1 else fitted.vault.title)
        part = _part(shapes, document.Main(), fitted, model.thickness_of(fitted), name)
        _name(shapes.AddComponent(assembly, part, _location(fitted.pose)), name)
    shapes.UpdateAssemblies()

    STEPCAFControl_Controller.Init_s()
    for key, value in SETTINGS.items():
        Interface_Static.SetCVal_s(key, value)
    Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
    writer = STEPCAFControl_Writer()
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    with _quiet():
        written = writer.Transfer(document) and writer.Write(str(path)) == IFSelect_RetDone
    if not written:
        raise ExportError(f"{path.name} could not be written as STEP; is there space left in {path.parent}?")
    text = path.read_text(encoding="utf-8")
    path.write_text(_tidied(text, model.place, model.versions.get("vaultcad", "")), encoding="ascii", newline="\n")


def _part(shapes: XCAFDoc_ShapeTool, main: TDF_Label, fitted: FittedVault, thickness: float, name: str) -> TDF_Label:
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

    from families import brep

    vault, solid = fitted.vault, _solid(masonry(fitted.vault, thickness))
    colours = XCAFDoc_DocumentTool.ColorTool_s(main)
    part = shapes.AddShape(solid, False)
    _name(part, name)
    colours.SetColor(part, _rgb(colour(0)), XCAFDoc_ColorSurf)
    for face, component in brep.face_names(solid, vault):
        label = shapes.AddSubShape(part, face)
        _name(label, component)
        if component in vault.components:
            colours.SetColor(label, _rgb(colour(vault.components.index(component) + 1)), XCAFDoc_ColorSurf)
    return part


def _solid(shape: TopoDS_Shape) -> TopoDS_Shape:
    """The one solid within the compound that a boolean gives, or the compound if there are more.

    Faces lie where they are: of moved copies the translator writes neither names nor colours.
    """
    from OCP.ShapeUpgrade import ShapeUpgrade_RemoveLocations
    from OCP.TopAbs import TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer

    bare = ShapeUpgrade_RemoveLocations()
    bare.Remove(shape)
    whole = bare.GetResult()
    explorer = TopExp_Explorer(whole, TopAbs_SOLID)
    only = explorer.Current()
    explorer.Next()
    return whole if explorer.More() else only


def _location(pose: Pose) -> TopLoc_Location:
    from OCP.gp import gp_Trsf
    from OCP.TopLoc import TopLoc_Location

    matrix = pose.placement()
    matrix[:3, 3] *= MM
    motion = gp_Trsf()
    motion.SetValues(*(float(v) for v in matrix[:3].ravel()))
    return TopLoc_Location(motion)


def _name(label: TDF_Label, name: str) -> None:
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))


def _rgb(colour: Colour) -> Quantity_Color:
    from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB

    return Quantity_Color(*colour.unit, Quantity_TOC_sRGB)


@contextmanager
def _quiet() -> Iterator[None]:
    """The translator tells its progress on standard output; here only failures."""
    from OCP.Message import Message, Message_Gravity

    printers = list(Message.DefaultMessenger_s().Printers())
    levels = [printer.GetTraceLevel() for printer in printers]
    for printer in printers:
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    try:
        yield
    finally:
        for printer, level in zip(printers, levels, strict=True):
            printer.SetTraceLevel(level)


def _tidied(text: str, place: str, version: str) -> str:
    r"""In the header the place; fixed values for time and for what the translator counts; names in ASCII.

    The translator counts from the program's start. Strings of a STEP file are ASCII, with other characters as \X2\ and
    UTF-16 (ISO 10303-21, 6.4.3); the translator writes UTF-8 instead.
    """
    header = f"FILE_NAME('model.step','{NO_TIME}',(''),(''),'vaultcad {version}','vaultcad {version}','');"
    text = re.sub(r"FILE_NAME\(.*?\);", header, text, count=1, flags=re.DOTALL)
    told = f"FILE_DESCRIPTION(('coordinates relative to {place.replace(chr(39), 2 * chr(39))}'),'2;1');"
    text = re.sub(r"FILE_DESCRIPTION\(.*?\);", lambda _: told, text, count=1, flags=re.DOTALL)
    count = itertools.count(1)
    text = re.sub(r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()'\d+'", lambda found: f"{found[1]}'{next(count)}'", text)
    return re.sub(r"[^\x00-\x7f]+", lambda found: f"\\X2\\{found[0].encode('utf-16-be').hex().upper()}\\X0\\", text)

"""STEP (AP214, mm): the exact masonry of each vault, ideal and as built, its faces named and coloured by component."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from families.declaration.units import MM
from segmentation.io.stamp import stamp
from segmentation.temporary import announce
from vaultcad.displacement import Displacement
from vaultcad.errors import ExportError
from vaultcad.export.as_built import names_of, solid_of
from vaultcad.export.geometry import rib_solids
from vaultcad.export.palette import Colour, colour
from vaultcad.export.part21 import encoded, in_order, unbroken
from vaultcad.legible import legible
from vaultcad.model import Assembly, PlacedVault
from vaultcad.pose import Pose

if TYPE_CHECKING:
    from OCP.Quantity import Quantity_Color
    from OCP.TDF import TDF_Label
    from OCP.TDocStd import TDocStd_Document
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS_Shape
    from OCP.XCAFDoc import XCAFDoc_ShapeTool

SETTINGS = {"write.step.schema": "AP214IS", "write.step.unit": "MM"}


def write_step(model: Assembly, path: Path) -> None:
    """Write an assembly named after the scan, of the solids of each vault, arch or rib that `model.drawn` asks for.

    They are placed by the vault's pose relative to the origin; that of the stone is named after the ideal one.

    Raises:
        ExportError: no vault has a solid, or the translator failed.
    """
    parts = [(name, placed) for name, placed in _named(model) if placed.solid]
    if not any(placed.solid for placed in model.vaults):
        raise ExportError(f"{path.name}: no vault has a solid that could be written as STEP")
    document = new_document()
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    assembly = shapes.NewShape()
    names = [model.scan.stem]
    name_label(assembly, stand_in(0))
    for name, placed in parts:
        for more, surface in names_of(model, placed):
            part = _part(shapes, document.Main(), placed, model.thickness_of(placed), surface, stand_in(len(names)))
            name_label(shapes.AddComponent(assembly, part, location(placed.pose)), stand_in(len(names)))
            names.append(f"{name} {more}".rstrip())
        for rib, shape in (rib_solids(placed.vault, placed.ribs) if placed.ribs else {}).items():
            part = _plain_part(shapes, document.Main(), _solid(shape), stand_in(len(names)))
            name_label(shapes.AddComponent(assembly, part, location(placed.pose)), stand_in(len(names)))
            names.append(f"{name} {rib}")
    shapes.UpdateAssemblies()
    save(document, path, model, names, "model.step")


def new_document() -> TDocStd_Document:
    """An empty document for shapes with names and colours."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document

    return TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))


def save(document: TDocStd_Document, path: Path, model: Assembly, names: list[str], title: str) -> None:
    """Write a document, names for their stand-ins; `title` is the name that the file tells of itself.

    Raises:
        ExportError: the translator failed.
    """
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Writer

    STEPCAFControl_Controller.Init_s()
    for key, value in SETTINGS.items():
        Interface_Static.SetCVal_s(key, value)
    Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
    writer = STEPCAFControl_Writer()
    writer.SetColorMode(True)
    writer.SetNameMode(True)
    # The translator takes no path that is not UTF-8.
    text_only = legible(path.parent) == path.parent
    with TemporaryDirectory(dir=path.parent if text_only else None) as folder, _quiet():
        bare = Path(folder) / "model.step"
        announce(Path(folder))
        announce(bare)
        written = writer.Transfer(document) and writer.Write(str(bare)) == IFSelect_RetDone
        text = bare.read_text(encoding="ascii") if written else ""
    if not written:
        raise ExportError(f"{path.name} could not be written as STEP; is there space left in {path.parent}?")
    tidied = _tidied(text, model.place, model.versions.get("vaultcad", ""), names, title)
    path.write_text(tidied, encoding="ascii", newline="\n")


def _named(model: Assembly) -> Iterator[tuple[str, PlacedVault]]:
    """Vaults and arches by the names of their parts."""
    for k, placed in enumerate(model.vaults, 1):
        title = placed.vault.title
        yield placed.label or (f"{k} {title}" if len(model.vaults) > 1 else title), placed
    for k, arch in enumerate(model.arches, 1):
        yield arch.label or f"arch {k}", arch


def _part(
    shapes: XCAFDoc_ShapeTool,
    main: TDF_Label,
    placed: PlacedVault,
    thickness: float,
    surface: Displacement | None,
    name: str,
) -> TDF_Label:
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

    from families.solid import brep
    from families.solid.occ.shapes import faces

    vault, solid = placed.vault, _solid(solid_of(placed.vault, thickness, surface))
    shown = brep.face_names(solid_of(vault, thickness, None), vault)  # displaced faces are in the order of these
    colours = XCAFDoc_DocumentTool.ColorTool_s(main)
    part = _plain_part(shapes, main, solid, name)
    for face, (_, component) in zip(faces(solid), shown, strict=True):
        label = shapes.AddSubShape(part, face)
        name_label(label, component)
        if component in vault.components:
            colours.SetColor(label, rgb(colour(vault.components.index(component) + 1)), XCAFDoc_ColorSurf)
    return part


def _plain_part(shapes: XCAFDoc_ShapeTool, main: TDF_Label, solid: TopoDS_Shape, name: str) -> TDF_Label:
    """A body in the colour of stone."""
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

    part = shapes.AddShape(solid, False)
    name_label(part, name)
    XCAFDoc_DocumentTool.ColorTool_s(main).SetColor(part, rgb(colour(0)), XCAFDoc_ColorSurf)
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


def location(pose: Pose) -> TopLoc_Location:
    """Of a vault [mm]."""
    from OCP.gp import gp_Trsf
    from OCP.TopLoc import TopLoc_Location

    matrix = pose.placement()
    matrix[:3, 3] *= MM
    motion = gp_Trsf()
    motion.SetValues(*(float(v) for v in matrix[:3].ravel()))
    return TopLoc_Location(motion)


def name_label(label: TDF_Label, name: str) -> None:
    """Give a part its name."""
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name

    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))


def rgb(colour: Colour) -> Quantity_Color:
    """A colour as OpenCASCADE has it."""
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


def stand_in(k: int) -> str:
    """What the translator is told in place of the k-th name, for it knows little of how names are written."""
    return f"@{k}@"


def _tidied(text: str, place: str, version: str, names: list[str], title: str) -> str:
    """In the header the place, and the time of `stamp`; names for their stand-ins; an order that is not left to chance.

    The translator counts occurrences from the program's start, on which the breaks of their lines hang, too.
    """
    header = (
        f"FILE_NAME('{title}','{stamp():%Y-%m-%dT%H:%M:%S}',(''),(''),'vaultcad {version}','vaultcad {version}','');"
    )
    text = re.sub(r"FILE_NAME\(.*?\);", header, text, count=1, flags=re.DOTALL)
    told = f"FILE_DESCRIPTION(('coordinates relative to {encoded(place)}'),'2;1');"
    text = re.sub(r"FILE_DESCRIPTION\(.*?\);", lambda _: told, text, count=1, flags=re.DOTALL)
    count = itertools.count(1)
    text = re.sub(
        r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\()'\d+'(.*?;)",
        lambda found: f"{found[1]}'{next(count)}'{unbroken(found[2])}",
        text,
        flags=re.DOTALL,
    )
    return re.sub(r"'@(\d+)@'", lambda found: f"'{encoded(names[int(found[1])])}'", in_order(text))

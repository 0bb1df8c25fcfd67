"""STEP (AP214, mm) of the free route: a shell of trimmed, non-rational B-spline faces a vault, named by component."""

from __future__ import annotations

from pathlib import Path

from vaultcad.export.palette import colour
from vaultcad.export.step import location, name_label, new_document, rgb, save, stand_in
from vaultcad.nurbs.route import FreeRoute


def write_nurbs_step(route: FreeRoute, path: Path) -> None:
    """Write an assembly named after the scan, a shell a vault, placed by its pose relative to the origin.

    Raises:
        ExportError: the translator failed.
    """
    from OCP.XCAFDoc import XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

    document = new_document()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    assembly = shapes.NewShape()
    names = [route.model.scan.stem]
    name_label(assembly, stand_in(0))
    for vault in route.vaults:
        title = vault.fitted.label or f"{vault.number} {vault.fitted.vault.title}"
        part = shapes.AddShape(vault.sheet.shell, False)
        name_label(part, stand_in(len(names)))
        for face, region_index in vault.sheet.faces:
            region = vault.form.outline.regions[region_index]
            label = shapes.AddSubShape(part, face)
            name_label(label, region.name)
            colours.SetColor(label, rgb(colour(region.component)), XCAFDoc_ColorSurf)
        name_label(shapes.AddComponent(assembly, part, location(vault.fitted.pose)), stand_in(len(names)))
        names.append(title)
    shapes.UpdateAssemblies()
    save(document, path, route.model, names, path.name)

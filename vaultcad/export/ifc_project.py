"""How an IFC file begins: what it says of itself, its project, and where that is on the map."""

from __future__ import annotations

from segmentation.io.stamp import stamp
from vaultcad.export.ifc_author import Author, Entity
from vaultcad.model import Assembly


def begun(author: Author, model: Assembly, name: str) -> Entity:
    """The IfcProject of a file of that name, relative to the model's origin."""
    _header(author, model, name)
    project = author.root(
        "IfcProject",
        "project",
        Name=model.scan.stem,
        RepresentationContexts=(author.context,),
        UnitsInContext=author.units,
    )
    if model.origin.any() or model.crs is not None:
        _map_conversion(author, model)
    return project


def _header(author: Author, model: Assembly, name: str) -> None:
    """What a file says of itself."""
    header = author.file.header
    header.file_name.name = name
    header.file_name.time_stamp = f"{stamp():%Y-%m-%dT%H:%M:%S}"
    header.file_name.originating_system = header.file_name.preprocessor_version = _program(model)
    header.file_description.description = ("ViewDefinition [DesignTransferView_V1.0]",)


def _program(model: Assembly) -> str:
    return f"vaultcad {model.versions.get('vaultcad', '')}".strip()


def _map_conversion(author: Author, model: Assembly) -> None:
    """Where the model's origin is on the map."""
    easting, northing, height = (float(v) / model.unit for v in model.origin)
    named = {"Name": "unknown", "Description": "the scan's own coordinates"}
    if model.crs is not None:
        named = {"Name": model.crs.title, "Description": model.crs.name}
    grid = author.make("IfcProjectedCRS", **named, MapUnit=author.length(model.unit))
    author.make(
        "IfcMapConversion",
        SourceCRS=author.context,
        TargetCRS=grid,
        Eastings=easting,
        Northings=northing,
        OrthogonalHeight=height,
        XAxisAbscissa=1.0,
        XAxisOrdinate=0.0,
        Scale=1 / model.unit,
    )

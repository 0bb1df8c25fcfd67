"""IFC4: one IfcRoof a vault, made of one IfcSlab a component, with the fitted parameters as properties.

Components are slabs of type ROOF because that is how IFC decomposes a roof, and what Revit, ArchiCAD and Bonsai show
and schedule as one; a vault's web has no entity of its own. Bodies are triangulated: exact B-Rep in IFC is read wrong
by too many programs, and STEP carries it.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from segmentation.io.stamp import stamp
from vaultcad.export.geometry import Body, bodies
from vaultcad.export.ifc_author import Author, Entity
from vaultcad.export.palette import colour
from vaultcad.model import Assembly, Component, Deviation, FittedVault, PlacedVault

STATUS = ("NEW", "EXISTING", "DEMOLISH", "TEMPORARY", "OTHER", "NOTKNOWN", "UNSET")  # PEnum_ElementStatus


def write_ifc(model: Assembly, path: Path) -> None:
    """Write all vaults as IFC4, metres and radians, relative to `model.origin`, which is kept as IfcMapConversion.

    GlobalIds follow from `model.identity` and the place of the entity in the file, so that a second run changes no id.
    """
    author = Author(seed=model.identity)
    _header(author, model)
    project = author.root(
        "IfcProject",
        "project",
        Name=model.scan.stem,
        RepresentationContexts=(author.context,),
        UnitsInContext=author.units,
    )
    if model.origin.any() or model.crs is not None:
        _map(author, model)
    storey = _spaces(author, project)
    roofs = [_roof(author, placed, f"vault {k}", storey, model) for k, placed in enumerate(model.vaults, 1)]
    author.relate(
        "IfcRelContainedInSpatialStructure", "in storey", ("RelatingStructure", storey), ("RelatedElements", roofs)
    )
    # Its own writer stops on a full disk in the middle without a word, and takes no path that is not UTF-8.
    path.write_text(author.text(), encoding="utf-8", newline="\n")


def _header(author: Author, model: Assembly) -> None:
    header = author.file.header
    header.file_name.name = "model.ifc"
    header.file_name.time_stamp = f"{stamp():%Y-%m-%dT%H:%M:%S}"
    header.file_name.originating_system = header.file_name.preprocessor_version = _program(model)
    header.file_description.description = ("ViewDefinition [DesignTransferView_V1.0]",)


def _program(model: Assembly) -> str:
    return f"vaultcad {model.versions.get('vaultcad', '')}".strip()


def _map(author: Author, model: Assembly) -> None:
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


def _spaces(author: Author, project: Entity) -> Entity:
    """Site, building and storey, one in the other; the storey."""
    parent, place = project, None
    for kind, name in (("IfcSite", "Site"), ("IfcBuilding", "Building"), ("IfcBuildingStorey", "Storey")):
        place = author.placed(place)
        extra: dict[str, Any] = {"Elevation": 0.0} if kind == "IfcBuildingStorey" else {}
        space = author.root(kind, kind, Name=name, ObjectPlacement=place, CompositionType="ELEMENT", **extra)
        author.relate("IfcRelAggregates", f"in {kind}", ("RelatingObject", parent), ("RelatedObjects", (space,)))
        parent = space
    return parent


def _roof(author: Author, placed: PlacedVault, key: str, storey: Entity, model: Assembly) -> Entity:
    vault, thickness = placed.vault, model.thickness_of(placed)
    fitted = placed if isinstance(placed, FittedVault) else None  # one that was drawn has no figures
    place = author.placed(storey.ObjectPlacement, placed.pose.placement())
    roof = author.root(
        "IfcRoof",
        key,
        Name=placed.label or vault.title.capitalize(),
        Description=f"fitted to {model.scan.name}" if fitted else None,
        ObjectType=vault.title,
        ObjectPlacement=place,
        Tag=vault.id,
        PredefinedType=vault.roof_type,
    )
    pieces = bodies(vault, thickness)
    facts = {component.name: component for component in fitted.components} if fitted else {}
    slabs = [_slab(author, key, body, place, facts.get(body.name), thickness) for body in pieces]
    author.relate("IfcRelAggregates", f"{key} of", ("RelatingObject", roof), ("RelatedObjects", slabs))
    _masonry(author, key, [roof, *slabs], thickness)

    author.properties(roof, "Pset_RoofCommon", _common(author, vault.id))
    author.properties(roof, "VaultCAD_Parameters", _parameters(author, placed))
    if fitted:
        author.properties(roof, "VaultCAD_Deviation", _deviation(author, fitted.deviation, fitted.coverage))
    area = sum(body.intrados_area for body in pieces)
    areas = {"GrossArea": (area, "m2"), "NetArea": (area, "m2"), "ProjectedArea": (vault.plan.area, "m2")}
    author.quantities(roof, "Qto_RoofBaseQuantities", areas)
    author.quantities(roof, "VaultCAD_Quantities", {"NetVolume": (sum(body.volume for body in pieces), "m3")})
    return roof


def _slab(author: Author, key: str, body: Body, place: Entity, component: Component | None, thickness: float) -> Entity:
    slab = author.root(
        "IfcSlab",
        f"{key}/{body.name}",
        Name=body.name,
        Description=f"component {body.id} of segments.laz",
        ObjectType=body.name.split("_")[0],
        ObjectPlacement=author.placed(place),
        Representation=author.body(body.vertices, body.triangles, colour(body.id)),
        Tag=str(body.id),
        PredefinedType="ROOF",
    )
    author.properties(slab, "Pset_SlabCommon", [*_common(author, body.name), _load_bearing(author)])
    if component is not None and component.deviation is not None:
        rows = _deviation(author, component.deviation, component.coverage, component.points)
        author.properties(slab, "VaultCAD_Deviation", rows)
    author.quantities(
        slab,
        "Qto_SlabBaseQuantities",
        {
            "Depth": (thickness, "m"),
            "GrossArea": (body.intrados_area, "m2"),
            "NetArea": (body.intrados_area, "m2"),
            "GrossVolume": (body.volume, "m3"),
            "NetVolume": (body.volume, "m3"),
        },
    )
    return slab


def _masonry(author: Author, key: str, elements: list[Entity], thickness: float) -> None:
    stone = author.make("IfcMaterial", Name="Masonry", Category="stone")
    layer = author.make("IfcMaterialLayer", Material=stone, LayerThickness=float(thickness), Name="Vault")
    layers = author.make("IfcMaterialLayerSet", MaterialLayers=(layer,), LayerSetName="Vault masonry")
    author.relate(
        "IfcRelAssociatesMaterial", f"{key} masonry", ("RelatingMaterial", layers), ("RelatedObjects", elements)
    )


Row = tuple[str, Entity, str]


def _common(author: Author, reference: str) -> list[Row]:
    return [
        ("Reference", author.make("IfcIdentifier", reference), ""),
        ("Status", author.enumerated("Status", "EXISTING", STATUS, "PEnum_ElementStatus"), ""),
        ("IsExternal", author.value(False), ""),
    ]


def _load_bearing(author: Author) -> Row:
    return "LoadBearing", author.value(True), ""


def _parameters(author: Author, placed: PlacedVault) -> Iterator[Row]:
    fitted = placed if isinstance(placed, FittedVault) else None
    yield "family", author.value(placed.vault.id), "id of the vault family"
    for name, kinds in placed.arches.items():
        yield name, author.value(kinds), "kind of arch"
        if fitted and fitted.odds:
            odds = ", ".join(f"{kind} {chance:.0%}" for kind, chance in fitted.odds[name].items())
            yield f"{name}_odds", author.value(odds), "how likely each kind is, given how vaults settle"
    for name, estimate in placed.numbers().items():
        yield name, author.value(float(estimate.value), estimate.unit), estimate.meaning
        if estimate.std is not None:
            meaning = f"standard deviation of {name}"
            yield f"{name}_std", author.value(float(estimate.std), estimate.unit), meaning
    if fitted:
        yield "confidence", author.value(float(fitted.confidence), "share"), "how sure the family is, 0 to 1"


def _deviation(author: Author, deviation: Deviation, coverage: float, points: int | None = None) -> Iterator[Row]:
    if points is not None:
        yield "points", author.value(int(points)), "points of the scan on this component"
    for name, meaning in (
        ("mean", "mean distance of the points to the model"),
        ("rms", "root mean square of the distances"),
        ("p95", "95 % of the points lie nearer"),
        ("max", "largest distance"),
    ):
        yield name, author.value(float(getattr(deviation, name)), "m"), meaning
    for limit, share in sorted(deviation.within.items()):
        yield f"within_{1000 * limit:g}mm", author.value(float(share), "share"), "share of points not farther"
    yield "loa", author.value(deviation.loa), "USIBD level of accuracy"
    yield "coverage", author.value(float(coverage), "share"), "share of the surface with points on it"

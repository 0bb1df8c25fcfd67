"""IFC4: one IfcRoof a vault, made of one IfcSlab a component, one IfcMember an arch or rib, one IfcSpace a room.

Components are slabs of type ROOF because that is how IFC decomposes a roof, and what Revit, ArchiCAD and Bonsai show
and schedule as one; a vault's web has no entity of its own. Bodies are triangulated: exact B-Rep in IFC is read wrong
by too many programs, and STEP carries it. The stone as it stands is a second representation, "AsBuilt", in a context
of its own, so that nothing is counted twice and programs that know only "Body" show one of both.
"""

from __future__ import annotations

from pathlib import Path

from vaultcad.export.component_bodies import Body
from vaultcad.export.ifc_arch import member
from vaultcad.export.ifc_author import Author, Entity
from vaultcad.export.ifc_bodies import as_built, shapes
from vaultcad.export.ifc_members import type_members
from vaultcad.export.ifc_places import on_storey, rooms, spatial_structure
from vaultcad.export.ifc_project import begun
from vaultcad.export.ifc_properties import common, deviation, load_bearing, masonry, parameters
from vaultcad.export.ifc_ribs import rib_members
from vaultcad.measure.building import Building, building_of
from vaultcad.model import Assembly, Component, FittedVault, PlacedVault


def write_ifc(model: Assembly, path: Path) -> None:
    """Write vaults and arches as IFC4, metres and radians, relative to `model.origin`, kept as IfcMapConversion.

    GlobalIds follow from `model.identity` and the place of the entity in the file, so that a second run changes no id.
    """
    author = Author(seed=model.identity)
    project = begun(author, model, "model.ifc")
    building = building_of(model)
    storeys = spatial_structure(author, project, building)
    placed_in: list[tuple[Entity, int]] = []  # elements with their storeys
    for k, placed in enumerate(model.vaults, 1):
        n = building.storey(k)
        placed_in.append((_roof(author, placed, f"vault {k}", _name(model, building, k), storeys[n - 1], model), n))
    roofs = [roof for roof, _ in placed_in]
    for k, arch in enumerate(model.arches, 1):
        n = building.storey_of_arch(arch)
        placed_in.append((member(author, arch, k, storeys[n - 1], model), n))
    arches, ribs = [element for element, _ in placed_in[len(roofs) :]], list[Entity]()
    for k, placed in enumerate(model.vaults, 1):
        n = building.storey(k)
        ribs += (own := rib_members(author, placed, f"vault {k}", storeys[n - 1]))
        placed_in += [(rib, n) for rib in own]
    for n, storey in enumerate(storeys, 1):
        author.relate(
            "IfcRelContainedInSpatialStructure",
            "in storey" if n == 1 else f"in storey {n}",
            ("RelatingStructure", storey),
            ("RelatedElements", [element for element, of in placed_in if of == n]),
        )
    type_members(author, project, "arches", arches)
    type_members(author, project, "ribs", ribs)
    rooms(author, model, building, storeys, roofs)
    # Its own writer stops on a full disk in the middle without a word, and takes no path that is not UTF-8.
    path.write_text(author.text(), encoding="utf-8", newline="\n")


def _name(model: Assembly, building: Building, vault: int) -> str:
    """A vault's label, or the name of its bay if it is not alone."""
    placed = model.vaults[vault - 1]
    if placed.label or len(model.vaults) == 1:
        return placed.label or placed.vault.title.capitalize()
    row, place = building.bay(vault)
    return f"Row {row} bay {place}: {placed.vault.title}"


def _roof(author: Author, placed: PlacedVault, key: str, name: str, storey: Entity, model: Assembly) -> Entity:
    vault, thickness = placed.vault, model.thickness_of(placed)
    fitted = placed if isinstance(placed, FittedVault) else None  # one that was drawn has no figures
    place = on_storey(author, storey, placed)
    roof = author.root(
        "IfcRoof",
        key,
        Name=name,
        Description=f"fitted to {model.scan.name}" if fitted else None,
        ObjectType=vault.title,
        ObjectPlacement=place,
        Tag=vault.id,
        PredefinedType=vault.roof_type,
    )
    drawn = list(shapes(author, placed, model))
    pieces = [body for body, _ in drawn]
    facts = {component.name: component for component in fitted.components} if fitted else {}
    slabs = [_slab(author, key, body, shape, place, facts.get(body.name), thickness) for body, shape in drawn]
    author.relate("IfcRelAggregates", f"{key} of", ("RelatingObject", roof), ("RelatedObjects", slabs))
    masonry(author, key, [roof, *slabs], thickness)

    author.properties(roof, "Pset_RoofCommon", common(author, vault.id))
    author.properties(roof, "VaultCAD_Parameters", parameters(author, placed))
    if fitted:
        author.properties(roof, "VaultCAD_Deviation", deviation(author, fitted.deviation, fitted.coverage))
        if fitted.surface is not None:
            author.properties(roof, "VaultCAD_AsBuilt", as_built(author, fitted, model))
    area = sum(body.intrados_area for body in pieces)
    areas = {"GrossArea": (area, "m2"), "NetArea": (area, "m2"), "ProjectedArea": (vault.plan.area, "m2")}
    author.quantities(roof, "Qto_RoofBaseQuantities", areas)
    author.quantities(roof, "VaultCAD_Quantities", {"NetVolume": (sum(body.volume for body in pieces), "m3")})
    return roof


def _slab(
    author: Author,
    key: str,
    body: Body,
    shape: Entity,
    place: Entity,
    component: Component | None,
    thickness: float,
) -> Entity:
    slab = author.root(
        "IfcSlab",
        f"{key}/{body.name}",
        Name=body.name,
        Description=f"component {body.id} of segments.laz",
        ObjectType=body.name.split("_")[0],
        ObjectPlacement=author.placed(place),
        Representation=shape,
        Tag=str(body.id),
        PredefinedType="ROOF",
    )
    author.properties(slab, "Pset_SlabCommon", [*common(author, body.name), load_bearing(author)])
    if component is not None and component.deviation is not None:
        rows = deviation(author, component.deviation, component.coverage, component.points)
        author.properties(slab, "VaultCAD_Deviation", rows)
    if component is not None and component.as_built is not None:
        rows = deviation(author, component.as_built, component.coverage, component.points)
        author.properties(slab, "VaultCAD_AsBuilt", rows)
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

"""IFC4 of the free route: one IfcRoof a vault, of one IfcCovering a component, tessellated from its net.

A covering of type CEILING is what the room sees of a roof: these surfaces have no thickness, and claim none.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vaultcad.export.ifc_author import Author
from vaultcad.export.ifc_places import on_storey, spatial_structure
from vaultcad.export.ifc_project import begun
from vaultcad.export.ifc_properties import deviation
from vaultcad.export.nurbs_mesh import named_nets
from vaultcad.export.palette import colour
from vaultcad.measure.building import building_of
from vaultcad.nurbs.route import FreeRoute


def write_nurbs_ifc(route: FreeRoute, path: Path) -> None:
    """Write vaults, metres, relative to the model's origin; ids follow from the scan and the place in the file."""
    model = route.model
    author = Author(seed=f"{model.identity}/nurbs")
    project = begun(author, model, "nurbs.ifc")
    building = building_of(model)
    storeys = spatial_structure(author, project, building)
    held: dict[int, list[object]] = {}
    for vault in route.vaults:
        key, n = f"vault {vault.number}", building.storey(vault.number)
        place = on_storey(author, storeys[n - 1], vault.fitted)
        title = vault.fitted.vault.title
        roof = author.root(
            "IfcRoof",
            key,
            Name=vault.fitted.label or f"{title} by free surfaces",
            Description=f"B-spline surfaces through {model.scan.name}, without a family's shape",
            ObjectType=title,
            ObjectPlacement=place,
            Tag=vault.fitted.vault.id,
            PredefinedType="FREEFORM",
        )
        coverings = []
        told = vault.withheld or vault.through
        for name, of, net, _ in named_nets(route):
            if of is not vault:
                continue
            region = vault.form.outline.regions[net.region]
            triangles = net.triangles
            used, where = np.unique(triangles, return_inverse=True)
            covering = author.root(
                "IfcCovering",
                f"{key}/{name}",
                Name=name,
                ObjectType=region.name.split("_")[0],
                ObjectPlacement=author.placed(place),
                Representation=author.shape(
                    author.body(
                        net.points.reshape(-1, 3)[used],
                        where.reshape(-1, 3),
                        colour(region.component),
                        closed=False,
                    )
                ),
                Tag=str(region.component),
                PredefinedType="CEILING",
            )
            if (found := told.components.get(region.component)) is not None:
                author.properties(covering, "VaultCAD_Deviation", deviation(author, found, None))
            coverings.append(covering)
        author.relate("IfcRelAggregates", f"{key} of", ("RelatingObject", roof), ("RelatedObjects", coverings))
        author.properties(roof, "VaultCAD_Deviation", deviation(author, told.whole, None))
        held.setdefault(n, []).append(roof)
    for n, roofs in sorted(held.items()):
        author.relate(
            "IfcRelContainedInSpatialStructure",
            f"in storey {n}",
            ("RelatingStructure", storeys[n - 1]),
            ("RelatedElements", roofs),
        )
    path.write_text(author.text(), encoding="utf-8", newline="\n")

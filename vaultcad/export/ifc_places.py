"""Where IFC puts elements: site, building, storeys, and the rooms in them."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any

import numpy as np

from vaultcad.export.ifc_author import Author, Entity
from vaultcad.export.plan_shape import outline_rows
from vaultcad.measure.building import Building
from vaultcad.model import Assembly, PlacedVault


def spatial_structure(author: Author, project: Entity, building: Building) -> list[Entity]:
    """Site, building and storeys, one in the other; the storeys from below. The lowest is at the scan's zero."""
    site = _in(author, project, "IfcSite", None, 0.0)
    house = _in(author, site, "IfcBuilding", site.ObjectPlacement, 0.0)
    storeys = []
    for n, floor in enumerate(building.floors, 1):
        several = len(building.floors) > 1
        height = floor if isfinite(floor) else 0.0
        number = f" {n}" if several else ""
        storeys.append(_in(author, house, "IfcBuildingStorey", house.ObjectPlacement, height, number))
    return storeys


def _in(author: Author, parent: Entity, kind: str, place: Entity | None, height: float, number: str = "") -> Entity:
    """One place in another, so high above it [m]."""
    key = kind if number in {"", " 1"} else f"{kind}{number}"
    up = np.eye(4)
    up[2, 3] = height
    extra: dict[str, Any] = {"Elevation": height} if kind == "IfcBuildingStorey" else {}
    name = {"IfcSite": "Site", "IfcBuilding": "Building", "IfcBuildingStorey": "Storey"}[kind]
    space = author.root(
        kind,
        key,
        Name=f"{name}{number}",
        ObjectPlacement=author.placed(place, up if height else None),
        CompositionType="ELEMENT",
        **extra,
    )
    author.relate("IfcRelAggregates", f"in {key}", ("RelatingObject", parent), ("RelatedObjects", (space,)))
    return space


def on_storey(author: Author, storey: Entity, placed: PlacedVault) -> Entity:
    """The placement of a vault or an arch within its storey."""
    matrix = placed.pose.placement()
    matrix[2, 3] -= storey.Elevation
    return author.placed(storey.ObjectPlacement, matrix)


def rooms(
    author: Author, model: Assembly, building: Building, storeys: Sequence[Entity], roofs: Sequence[Entity]
) -> None:
    """An IfcSpace for what arches join, with the outlines of its bays at the lowest springing as its footprint."""
    spaces: dict[int, list[Entity]] = {}
    for number, room in enumerate(building.rooms, 1):
        level = min(building.storey(k) for k in room)
        storey = storeys[level - 1]
        low = min(model.vaults[k - 1].pose.z for k in room) - storey.Elevation
        rows = [
            np.column_stack([row, np.full(len(row), low)]) for k in room for row in outline_rows(model.vaults[k - 1])
        ]
        space = author.root(
            "IfcSpace",
            f"room {number}",
            Name=f"Room {number}",
            LongName=_bays(building, room),
            ObjectPlacement=author.placed(storey.ObjectPlacement),
            Representation=author.footprint(rows),
            CompositionType="ELEMENT",
            PredefinedType="INTERNAL",
        )
        author.relate(
            "IfcRelReferencedInSpatialStructure",
            f"under room {number}",
            ("RelatingStructure", space),
            ("RelatedElements", [roofs[k - 1] for k in room]),
        )
        area = sum(model.vaults[k - 1].vault.plan.area for k in room)
        author.quantities(space, "VaultCAD_Quantities", {"VaultedArea": (area, "m2")})
        spaces.setdefault(level, []).append(space)
    for level, inside in spaces.items():
        ends = ("RelatingObject", storeys[level - 1]), ("RelatedObjects", inside)
        author.relate("IfcRelAggregates", f"rooms of storey {level}", *ends)


def _bays(building: Building, room: Sequence[int]) -> str:
    """Those of a room in words: bays A1 to A4, B1."""
    told = []
    for row in building.rows:
        inside = ["{}{}".format(*building.bay(k)) for k in row if k in room]
        told += [f"{inside[0]} to {inside[-1]}"] if len(inside) > 1 else inside
    return f"bay{'s' * (len(room) > 1)} {', '.join(told)}"

"""The ribs under a vault in IFC: members of a type."""

from __future__ import annotations

from vaultcad.export.geometry import rib_bodies
from vaultcad.export.ifc_author import Author, Entity
from vaultcad.export.ifc_members import RIB
from vaultcad.export.ifc_places import on_storey
from vaultcad.export.ifc_properties import common, load_bearing, masonry
from vaultcad.export.palette import colour
from vaultcad.model import PlacedVault


def rib_members(author: Author, placed: PlacedVault, key: str, storey: Entity) -> list[Entity]:
    """An IfcMember for each of its ribs and bosses."""
    ribs = placed.ribs
    if ribs is None:
        return []
    made = []
    for body in rib_bodies(placed.vault, ribs):
        member = author.root(
            "IfcMember",
            f"{key}/{body.name}",
            Name=body.name,
            Description=f"under {key}",
            ObjectType=RIB,
            ObjectPlacement=on_storey(author, storey, placed),
            Representation=author.body(body.vertices, body.triangles, colour(0)),
            Tag=body.name,
            PredefinedType="USERDEFINED",
        )
        author.properties(member, "Pset_MemberCommon", [*common(author, RIB), load_bearing(author)])
        author.properties(
            member,
            "VaultCAD_Rib",
            [
                ("width", author.value(float(ribs.width), "m"), "width of the rib"),
                ("depth", author.value(float(ribs.depth), "m"), "depth below the line of the vault"),
            ],
        )
        volumes = {"GrossVolume": (body.volume, "m3"), "NetVolume": (body.volume, "m3")}
        author.quantities(member, "Qto_MemberBaseQuantities", volumes)
        made.append(member)
    masonry(author, f"{key} ribs", made, ribs.depth)
    return made

"""The types of IfcMembers: arches and ribs."""

from __future__ import annotations

from collections.abc import Sequence

from vaultcad.export.ifc_author import Author, Entity

ARCH, RIB = "ARCH", "RIB"  # IfcMemberTypeEnum of IFC4 has none for them
TYPES = {"arches": ("Arch", ARCH), "ribs": ("Rib", RIB)}
"""By what they are called together: the name of the type, and that of its elements."""


def type_members(author: Author, project: Entity, called: str, members: Sequence[Entity]) -> None:
    """The one type of all of these, if there are any."""
    if not members:
        return
    name, element = TYPES[called]
    kind = author.root("IfcMemberType", called, Name=name, ElementType=element, PredefinedType="USERDEFINED")
    author.relate("IfcRelDefinesByType", f"{called} of", ("RelatingType", kind), ("RelatedObjects", members))
    author.relate("IfcRelDeclares", f"{called} in", ("RelatingContext", project), ("RelatedDefinitions", (kind,)))

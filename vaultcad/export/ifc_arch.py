"""Arches in IFC: members of a type, with what was measured of them as properties."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from vaultcad.export.ifc_author import Author, Entity
from vaultcad.export.ifc_bodies import as_built, shapes
from vaultcad.export.ifc_places import on_storey
from vaultcad.export.ifc_properties import Row, common, deviation, load_bearing, masonry, parameters
from vaultcad.measure.arcs import arcs_of
from vaultcad.measure.setting_out import setting_out
from vaultcad.model import Assembly, FittedArch, PlacedVault

KIND = "ARCH"  # IfcMemberTypeEnum of IFC4 has none for arches


def member(author: Author, arch: PlacedVault, number: int, storey: Entity, model: Assembly) -> Entity:
    """An IfcMember for an arch: its ring, as deep as it was measured and as long as the arch is wide."""
    key, vault, thickness = f"arch {number}", arch.vault, model.thickness_of(arch)
    ((body, shape),) = shapes(author, arch, model, coloured=False)
    made = author.root(
        "IfcMember",
        key,
        Name=arch.label or key.capitalize(),
        Description=f"arch {number} of segments.laz" if isinstance(arch, FittedArch) else None,
        ObjectType=KIND,
        ObjectPlacement=on_storey(author, storey, arch),
        Representation=shape,
        Tag=str(number),
        PredefinedType="USERDEFINED",
    )
    masonry(author, key, [made], thickness)
    span = author.value(float(vault.values()["span"]), "m")
    author.properties(made, "Pset_MemberCommon", [*common(author, KIND), ("Span", span, ""), load_bearing(author)])
    author.properties(made, "VaultCAD_Parameters", parameters(author, arch))
    if isinstance(arch, FittedArch):
        author.properties(made, "VaultCAD_Arch", _arch(author, arch))
        author.properties(made, "VaultCAD_Deviation", deviation(author, arch.deviation, arch.coverage))
        if arch.surface is not None:
            author.properties(made, "VaultCAD_AsBuilt", as_built(author, arch, model))
    volumes = {"GrossVolume": (body.volume, "m3"), "NetVolume": (body.volume, "m3")}
    author.quantities(made, "Qto_MemberBaseQuantities", volumes)
    return made


def type_members(author: Author, project: Entity, members: Sequence[Entity]) -> None:
    """The one type of all arches, if there are any."""
    if not members:
        return
    kind = author.root("IfcMemberType", "arches", Name="Arch", ElementType=KIND, PredefinedType="USERDEFINED")
    author.relate("IfcRelDefinesByType", "arches of", ("RelatingType", kind), ("RelatedObjects", members))
    author.relate("IfcRelDeclares", "arches in", ("RelatingContext", project), ("RelatedDefinitions", (kind,)))


def _arch(author: Author, arch: FittedArch) -> Iterator[Row]:
    yield "kind", author.value(arch.kind), "transverse between two vaults, else a wall arch"
    yield "between", author.value(" and ".join(f"vault {k}" for k in arch.beside if k) or "none"), "vaults beside it"
    if arch.ring is not None:
        yield "depth", author.value(float(arch.ring), "m"), "of its ring under the vaults beside it"
    for k, arc in enumerate(arcs_of(arch), 1):
        for name, estimate in (("radius", arc.radius), ("centre_across", arc.across), ("centre_height", arc.height)):
            yield f"arc_{k}_{name}", author.value(float(estimate.value), "m"), estimate.meaning
            if estimate.std is not None:
                meaning = f"standard deviation of arc_{k}_{name}"
                yield f"arc_{k}_{name}_std", author.value(float(estimate.std), "m"), meaning
    rules = ", ".join(f"{name} {chance:.0%}" for name, chance in setting_out(arch).items() if chance >= 0.01)
    yield "setting_out", author.value(rules), "rules by which it may have been drawn, with their chances"

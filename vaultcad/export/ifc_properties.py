"""Properties of IFC elements: rows of name, value and meaning."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

from vaultcad.export.ifc_author import Author, Entity
from vaultcad.model import FittedVault, PlacedVault
from vaultcad.uncertain import Deviation

STATUS = ("NEW", "EXISTING", "DEMOLISH", "TEMPORARY", "OTHER", "NOTKNOWN", "UNSET")  # PEnum_ElementStatus
Row = tuple[str, Entity, str]


def masonry(author: Author, key: str, elements: list[Entity], thickness: float) -> None:
    """Say of elements that they are of stone, so thick [m]."""
    stone = author.make("IfcMaterial", Name="Masonry", Category="stone")
    layer = author.make("IfcMaterialLayer", Material=stone, LayerThickness=float(thickness), Name="Vault")
    layers = author.make("IfcMaterialLayerSet", MaterialLayers=(layer,), LayerSetName="Vault masonry")
    author.relate(
        "IfcRelAssociatesMaterial", f"{key} masonry", ("RelatingMaterial", layers), ("RelatedObjects", elements)
    )


def common(author: Author, reference: str) -> list[Row]:
    """What is common to all property sets of building elements."""
    return [
        ("Reference", author.make("IfcIdentifier", reference), ""),
        ("Status", author.enumerated("Status", "EXISTING", STATUS, "PEnum_ElementStatus"), ""),
        ("IsExternal", author.value(False), ""),
    ]


def load_bearing(author: Author) -> Row:
    """Masonry is."""
    return "LoadBearing", author.value(True), ""


def parameters(author: Author, placed: PlacedVault) -> Iterator[Row]:
    """Family, kinds of arches, all numbers with their standard deviations."""
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


def deviation(author: Author, found: Deviation, coverage: float | None, points: int | None = None) -> Iterator[Row]:
    """How far the scan is from the model."""
    if points is not None:
        yield "points", author.value(int(points)), "points of the scan on this component"
    for name, meaning in (
        ("mean", "mean distance of the points to the model"),
        ("signed_mean", "the same with signs, positive into the stone"),
        ("median", "half of the points lie nearer"),
        ("rms", "root mean square of the distances"),
        ("p95", "95 % of the points lie nearer"),
        ("max", "largest distance"),
    ):
        value = float(getattr(found, name))
        if isfinite(value):
            yield name, author.value(value, "m"), meaning
    for limit, share in sorted(found.within.items()):
        yield f"within_{1000 * limit:g}mm", author.value(float(share), "share"), "share of points not farther"
    yield "loa", author.value(found.loa), "USIBD level of accuracy"
    if coverage is not None:
        yield "coverage", author.value(float(coverage), "share"), "share of the surface with points on it"

"""Shapes of IFC elements: the body that a vault's component has, and where both are drawn that of its stone."""

from __future__ import annotations

from collections.abc import Iterator

from vaultcad.export.as_built import bodies_of
from vaultcad.export.component_bodies import Body
from vaultcad.export.ifc_author import Author, Entity
from vaultcad.export.ifc_properties import Row, deviation
from vaultcad.export.palette import colour
from vaultcad.measure.routes import apart
from vaultcad.model import Assembly, FittedVault, PlacedVault

BODY, STONE = "Body", "AsBuilt"
"""Identifiers of representations: what all programs show; beside it, in a context of its own, the stone."""


def shapes(
    author: Author, placed: PlacedVault, model: Assembly, *, coloured: bool = True
) -> Iterator[tuple[Body, Entity]]:
    """Each component's body that is its "Body", and its shape with all that is drawn of it."""
    thickness = model.thickness_of(placed)
    drawn = [bodies_of(placed.vault, thickness, surface) for surface in model.surfaces(placed)]
    for bodies in zip(*drawn, strict=True):
        parts = [
            author.body(body.vertices, body.triangles, colour(body.id if coloured else 0), identifier)
            for body, identifier in zip(bodies, (BODY, STONE), strict=False)
        ]
        yield bodies[0], author.shape(*parts)


def as_built(author: Author, fitted: FittedVault, model: Assembly) -> Iterator[Row]:
    """In which representation the stone is, how far the scan is from it, and it from the ideal vault."""
    surfaces = model.surfaces(fitted)
    shown = STONE if len(surfaces) > 1 else "none" if surfaces[0] is None else BODY
    yield "representation", author.value(shown), "identifier of the representation of the stone as it stands"
    if fitted.surface is not None:
        found = apart(fitted.vault, fitted.surface)
        for name, meaning in (
            ("mean", "mean distance between ideal and as-built surface"),
            ("signed_mean", "the same with its sign, positive into the stone"),
            ("rms", "root mean square of the distances between them"),
            ("p95", "95 % of the ideal surface is nearer to the as-built one"),
            ("max", "largest distance between them"),
        ):
            yield f"ideal_to_as_built_{name}", author.value(float(getattr(found, name)), "m"), meaning
    if fitted.as_built is not None:
        yield from deviation(author, fitted.as_built, fitted.coverage)

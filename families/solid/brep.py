"""The B-Rep of a vault [mm] from its pieces: void, intrados with named faces, and masonry with a thickness."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from OCP.TopoDS import TopoDS_Face, TopoDS_Shape

from families.declaration.palette import Colour, colour
from families.declaration.pieces import BarrelPart, Piece
from families.declaration.plan import Plan
from families.declaration.vault import Vault
from families.solid.bodies import Void
from families.solid.body import body
from families.solid.body import surface as laid
from families.solid.occ.shapes import faces, inner_points
from families.solid.roofs import FLOOR

if TYPE_CHECKING:
    import build123d

EXTRADOS, SIDE = "extrados", "side"
EXACT_FACE = 1e-6  # [m] that faces may be off the numeric surface
CORNER = 0.3  # [mm], see `workable`


def void(vault: Vault) -> TopoDS_Shape:
    """The room under the vault, above the springing and within the plan.

    Raises:
        ValueError: its faces do not close, or OpenCASCADE finds a fault in it.
    """
    return body(Void(vault.pieces(), vault.plan), None)


def surface(vault: Vault) -> TopoDS_Shape:
    """The faces of the void that are not "side": the intrados, and the walls of stilts below it."""
    return laid(Void(vault.pieces(), vault.plan))


def masonry(vault: Vault, thickness: float) -> TopoDS_Shape:
    """The void grown by a thickness [m] without the void itself; it stands on walls where the plan says so.

    Raises:
        ValueError: the thickness is not above 0, the faces do not close, or OpenCASCADE finds a fault in the body.
    """
    if not thickness > 0:
        raise ValueError(f"thickness = {thickness:g} m must be above 0")
    pieces, plan = vault.pieces(), vault.plan.grown(thickness)
    grown = Void(tuple(piece.grown(thickness) for piece in pieces), plan, _lowest_foot(pieces, plan))
    # What is taken away is not bounded by the plan: the mouths of lunettes stay open.
    return body(grown, Void(pieces, vault.plan))


def _lowest_foot(pieces: tuple[Piece, ...], plan: Plan) -> float:
    """The height [m] on which the stone stands: the springing, or a little below that at the foot of a ramp.

    Where the ends of a ramp are oblique, the walls' outer corners are farther down than the inner ones. Were the stone
    cut off at the springing there, its arch would end in a sliver that is narrower than any tolerance.
    """
    ramps = (part for piece in pieces for part in piece.parts if isinstance(part, BarrelPart) and part.slope)
    feet = (part.base + part.lift(part.local(x, y)[1]) for part in ramps for x, y in plan.corners.tolist())
    return min(FLOOR, min(feet, default=FLOOR))


def room(vault: Vault) -> build123d.Part:
    """The void as a body [mm], to be cut out of a block."""
    import build123d

    return _of_stone(build123d.Part(workable(void(vault))), f"void of {vault.called}")


def intrados(vault: Vault) -> build123d.Compound:
    """The surface towards the room [mm]: a child for each component, labelled and coloured, of one or more faces.

    A component of which nothing shows (the plane of a mirror vault without one) has no child.
    """
    import build123d

    named = named_faces(surface(vault), vault)
    children = [
        build123d.Compound(list(named[name]), label=name, color=named[name][0].color)
        for name in vault.components
        if name in named
    ]
    return build123d.Compound(label=f"{vault.id} intrados", children=children)


def solid(vault: Vault, thickness: float = 0.15) -> build123d.Part:
    """The masonry [mm] with all radii of the extrados larger by `thickness` [m]; `named_faces` tells its faces.

    Raises:
        ValueError: the thickness is not above 0.
    """
    import build123d

    return _of_stone(build123d.Part(workable(masonry(vault, thickness))), vault.title)


def workable(shape: TopoDS_Shape) -> TopoDS_Shape:
    """The shape itself, its corners given a tolerance with which CAD can go on working.

    Where a groin leaves a corner tangent to the arch on the wall, OpenCASCADE takes both to cross beyond the corner as
    soon as faces are joined, as build123d and CadQuery do after each step, and calls the result invalid.
    """
    from OCP.ShapeFix import ShapeFix_ShapeTolerance
    from OCP.TopAbs import TopAbs_VERTEX

    ShapeFix_ShapeTolerance().LimitTolerance(shape, CORNER, 0.0, TopAbs_VERTEX)
    return shape


def named_faces(shape: TopoDS_Shape | build123d.Shape, vault: Vault) -> dict[str, build123d.ShapeList[build123d.Face]]:
    """The faces of a void, an intrados or a solid by the names of `face_names`, each with its label and colour."""
    import build123d

    ids = {name: k for k, name in enumerate(vault.components, 1)}
    found: dict[str, build123d.ShapeList[build123d.Face]] = {}
    for wrapped, name in face_names(shape, vault):
        face = build123d.Face(wrapped, label=name, color=_colour(colour(ids.get(name, 0))))
        found.setdefault(name, build123d.ShapeList()).append(face)
    return found


def face_names(shape: TopoDS_Shape | build123d.Shape, vault: Vault) -> list[tuple[TopoDS_Face, str]]:
    """The faces of a void, an intrados or a solid, in their order, each with the component that it shows.

    Other faces are "side" (at the springing and where the plan cuts) or "extrados".
    """
    found = list(faces(getattr(shape, "wrapped", shape)))
    points = inner_points(found)
    here = vault.evaluate(points)
    ground = points[:, 2] < EXACT_FACE
    side = ground | (np.abs(vault.plan.distance(points[:, :2])) < EXACT_FACE)
    # Walls of a stilt stand on the plan's edge and are of the surface; other faces there only come near it, and those
    # below what is free of the plan are the plan's own.
    free = Void(vault.pieces(), vault.plan).free
    own = side & (points[:, 2] < free) if free is not None else ground
    shown = ~(ground | own) & (np.abs(here.distance) < EXACT_FACE)
    names = (EXTRADOS, SIDE, *vault.components)
    kind = np.where(shown, here.component + 1, side)
    return [(face, names[k]) for face, k in zip(found, kind, strict=True)]


def _of_stone(part: build123d.Part, label: str) -> build123d.Part:
    part.label, part.color = label, _colour(colour(0))
    return part


def _colour(shade: Colour) -> build123d.Color:
    import build123d

    return build123d.Color(*shade.unit)

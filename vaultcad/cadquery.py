"""Vaults in CadQuery: `vault("groin", span_x=5)`, and once this is imported `Workplane().vault("groin", span_x=5)`.

Lengths go in as the families declare them, in metres; bodies come out as CadQuery's users expect them, in millimetres
(or in metres with `unit="m"`). Without a thickness the body is the room under the vault, to be cut out of a block; with
one it is the masonry. The frame of the vault, with its origin at the centre of the plan on the springing, is that of
the workplane.

The faces of each component carry its name as a tag (`.faces(tag="web_south")`), others "extrados" or "side". As always
with CadQuery's tags, these are the faces as they were made: later operations cut the body, not the faces of the tag.
"""

from __future__ import annotations

from typing import Any, Literal, TypeAlias, TypeVar

import cadquery as cq

from families import Vault, ideal

Unit: TypeAlias = Literal["mm", "m"]
Combine: TypeAlias = bool | Literal["a", "s", "cut"]
Plane = TypeVar("Plane", bound=cq.Workplane)

SCALES: dict[str, float] = {"mm": 1.0, "m": 1e-3}  # of a millimetre
THICKNESS = (0.01, 5.0)  # [m]


def vault(family: str | Vault, *, thickness: float | None = None, unit: Unit = "mm", **parameters: Any) -> cq.Workplane:
    """A vault on the XY plane.

    Args:
        family: a name in any language, or a vault that is made already, as that of a fit.
        thickness: of the masonry [m]; None for the room under it.
        unit: of the body's lengths.
        parameters: as `families.ideal` takes them: `span_x=5, profile_x="pointed", rise_y=2`, lengths in metres.

    Raises:
        ValueError: an unknown name, a value that cannot be, or a vault that OpenCASCADE cannot build.

    >>> room = vault("mirror", span_x=5, span_y=7, rise=0.6)
    >>> round(room.val().BoundingBox().ylen), round(room.faces(tag="plane").val().Center().z)
    (7000, 600)
    """
    return on_workplane(cq.Workplane(), family, thickness=thickness, unit=unit, **parameters)


def on_workplane(
    self: Plane,
    family: str | Vault,
    *,
    thickness: float | None = None,
    unit: Unit = "mm",
    combine: Combine = True,
    clean: bool = False,
    **parameters: Any,
) -> Plane:
    """`Workplane.vault`: the same at each point of the stack, or at the workplane's origin, with its orientation.

    Args:
        self: the workplane.
        family: see `vault`.
        thickness: see `vault`.
        unit: see `vault`.
        combine: as CadQuery's primitives have it: True joins it to the body in the chain, "cut" takes it away from it.
        clean: join faces that lie on one surface; that makes one face of webs which belong to one barrel.
        parameters: see `vault`.
    """
    shape, names = _made(family, thickness, unit, parameters)
    placed: Plane = self.eachpoint(shape, True, False, False)
    faces: dict[str, list[cq.Face]] = {}
    for body in placed.vals():
        for face, name in zip(body.Faces(), names, strict=True):
            faces.setdefault(name, []).append(face)
    for name, own in faces.items():
        placed.newObject(own).tag(name)
    # One by one: as a compound, bays that touch would get in each other's way.
    match combine:
        case True | "a":
            placed = self.union(placed, clean=clean)
        case "cut" | "s":
            placed = self.cut(placed, clean=clean)
    return placed


def _made(
    family: str | Vault, thickness: float | None, unit: str, parameters: dict[str, Any]
) -> tuple[cq.Shape, list[str]]:
    """A vault's body in its own frame, and the name of each of its faces in their order."""
    from families.solid import brep

    if unit not in SCALES:
        raise ValueError(f"unit = {unit!r}; choose one of {', '.join(SCALES)}")
    if thickness is not None and not THICKNESS[0] <= thickness <= THICKNESS[1]:
        raise ValueError(f"thickness = {thickness:g} lies outside [{THICKNESS[0]:g}, {THICKNESS[1]:g}] m")
    if isinstance(family, Vault):
        if parameters:
            raise ValueError(f"{', '.join(parameters)}: this {family.title} is made already; use its replaced()")
        made = family
    else:
        made = ideal(family, **parameters)
    shape = cq.Shape.cast(brep.workable(brep.void(made) if thickness is None else brep.masonry(made, thickness)))
    names = {cq.Face(face): name for face, name in brep.face_names(shape.wrapped, made)}
    whole = shape.Solids()[0] if len(shape.Solids()) == 1 else shape
    return _scaled(whole, SCALES[unit]), [names[face] for face in whole.Faces()]


def _scaled(shape: cq.Shape, factor: float) -> cq.Shape:
    return shape if factor == 1 else shape.scale(factor)


cq.Workplane.vault = on_workplane

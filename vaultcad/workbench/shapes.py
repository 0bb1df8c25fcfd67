"""A vault as a BREP file [mm], with the component and colour of each face."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Shape

    from families import Vault
    from vaultcad.workbench.protocol import Request


def build(request: Request) -> dict[str, Any]:
    """Write the masonry, or with thickness 0 the intrados, of a vault in its own frame to `path`.

    Asked: family, profiles, parameters [m, rad], thickness [m], path, and `lengths` [m] of sizes that are to decide on
    a parameter. Told: `faces`, the component of each face in the order of the file; `colours` by component; the
    `parameters`, and the `sizes` that follow from them [m, rad].
    """
    from families import Vault as Base
    from families.declaration.lengths import with_lengths
    from families.declaration.palette import colour
    from segmentation.io.whole import replacing

    plain = {"profiles": request.texts("profiles"), "parameters": request.numbers("parameters")}
    vault = Base.from_plain({"family": request.text("family"), **plain})
    if lengths := request.numbers("lengths"):
        vault = with_lengths(vault, lengths)
    path = Path(request.text("path"))
    shape, names = made(vault, request.number("thickness", 0.0))
    with replacing(path) as part:
        _write(shape, part)
    ids = {name: 1 + k for k, name in enumerate(vault.components)}
    colours = {name: colour(ids.get(name, 0)).unit for name in dict.fromkeys(names)}
    return {"faces": names, "colours": colours, "parameters": vault.values(), "sizes": vault.derived_values()}


def made(vault: Vault, thickness: float) -> tuple[TopoDS_Shape, list[str]]:
    """The shape [mm] and the component of each of its faces, in their order.

    Raises:
        ValueError: the thickness [m] is below 0, or OpenCASCADE cannot build the vault.
    """
    from families.solid import brep

    shape = brep.masonry(vault, thickness) if thickness else brep.surface(vault)
    return shape, [name for _, name in brep.face_names(shape, vault)]


def _write(shape: TopoDS_Shape, path: Path) -> None:
    from OCP.BRepTools import BRepTools
    from OCP.Message import Message_ProgressRange
    from OCP.TopTools import TopTools_FormatVersion

    # The format of OpenCASCADE 6 to 7.5: every FreeCAD reads it. Triangles are FreeCAD's to make.
    version = TopTools_FormatVersion.TopTools_FormatVersion_VERSION_2
    if not BRepTools.Write_s(shape, str(path), False, False, version, Message_ProgressRange()):
        raise OSError(f"{path} could not be written; is there space left?")

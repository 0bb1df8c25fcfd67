"""The files of the free route, in a folder of their own or beside those of a fit."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from segmentation.io.whole import writing
from vaultcad.export.folder import check_target, replacing_folder
from vaultcad.export.nurbs_dxf import write_nurbs_dxf
from vaultcad.export.nurbs_ifc import write_nurbs_ifc
from vaultcad.export.nurbs_json import write_nurbs_json
from vaultcad.export.nurbs_mesh import write_nurbs_glb, write_nurbs_obj
from vaultcad.export.nurbs_step import write_nurbs_step
from vaultcad.nurbs.route import FreeRoute

NURBS_WRITERS: dict[str, Callable[[FreeRoute, Path], None]] = {
    "nurbs.step": write_nurbs_step,
    "nurbs.ifc": write_nurbs_ifc,
    "nurbs.glb": write_nurbs_glb,
    "nurbs.obj": write_nurbs_obj,
    "nurbs.dxf": write_nurbs_dxf,
    "nurbs.json": write_nurbs_json,
}


def write_nurbs(route: FreeRoute, out: Path, *, force: bool = False) -> Path | None:
    """Write all of them into the folder `out`, all or none; where an earlier result that was changed is kept.

    Raises:
        ExportError: `out` is no folder, no earlier result, or cannot be replaced as a whole.
        WriteError: the disk is full, or a file cannot be written for another reason of the system's.
    """
    check_target(out, NURBS_WRITERS, force=True)
    with replacing_folder(out, force=force) as place:
        for name, write in NURBS_WRITERS.items():
            with writing(out / name):
                write(route, place.part / name)
    return place.kept

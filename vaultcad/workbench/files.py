"""Vaults of a FreeCAD document as STEP, IFC or GLB, through the exporters that a fit uses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vaultcad.model_file import placed_vault

if TYPE_CHECKING:
    from vaultcad.workbench.protocol import Request

OWN = ("thickness", "label")  # what the document says of a vault


def export(request: Request) -> dict[str, Any]:
    """Write vaults to `path`, whose suffix says how.

    Asked: path, name (of the document), origin [m], and vaults: each with family, profiles, parameters and pose, its
    label and thickness [m], 0 for the usual one, and the rest of what the fit told of it as long as it is as fitted.
    Told: path.

    Raises:
        ExportError: it cannot be written, or a vault not be built.
    """
    from segmentation.io.whole import replacing
    from vaultcad.errors import ExportError
    from vaultcad.export.buildable import buildable, refusal
    from vaultcad.export.glb import write_glb
    from vaultcad.export.ifc import write_ifc
    from vaultcad.export.step import write_step
    from vaultcad.model import Assembly
    from vaultcad.versions import versions

    writers = {".step": write_step, ".stp": write_step, ".ifc": write_ifc, ".glb": write_glb}
    path = Path(request.text("path"))
    write = writers.get(path.suffix.lower())
    if write is None:
        raise ValueError(f"{path.name}: unknown suffix {path.suffix!r}; name one of {', '.join(writers)}")
    try:
        vaults = tuple(
            replace(
                placed_vault({name: value for name, value in plain.items() if name not in OWN}),
                thickness=float(plain.get("thickness", 0)) or None,
                label=str(plain.get("label", "")),
            )
            for plain in request.tables("vaults")
        )
        origin = np.array([float(value) for value in request.arguments.get("origin", (0, 0, 0))]).reshape(3)
    except (KeyError, TypeError) as error:
        raise ValueError(f"vaults: {type(error).__name__} {error}; give family, parameters and pose of each") from None
    scan = Path(request.text("name", "vaults"))
    built = buildable(Assembly(scan=scan, origin=origin, vaults=vaults, versions=versions()))
    for placed in built.vaults:
        if not placed.solid:
            raise ExportError(refusal(placed.vault, built.thickness_of(placed)))
    with replacing(path) as part:
        write(built, part)
    return {"path": str(path)}

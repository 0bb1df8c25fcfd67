"""`vaultcad export`: a model that a fit left, in any format again."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from families import Ribs
from families.declaration.ribs import RIB_KINDS
from vaultcad.cli.errors import refusing
from vaultcad.cli.options import AsBuilt, Bounds, number_info, single
from vaultcad.cli.outputs import check_file
from vaultcad.cli.reading import show_notes

if TYPE_CHECKING:
    from collections.abc import Callable

    from vaultcad.model import Model

SUFFIXES = (".step", ".stp", ".ifc", ".glb", ".wld", ".dxf", ".html", ".json")
EVERY_KIND = ",".join(RIB_KINDS)
Thickness = Annotated[
    float | None,
    number_info(
        "thickness",
        Bounds(0.01, 5, "m", "of the masonry of all vaults, whatever the model says"),
    ),
]
RibWidth = Annotated[
    float | None, number_info("rib_width", Bounds(0.05, 2, "m", "draw ribs of that width under rib and groin vaults"))
]
RibDepth = Annotated[
    float, number_info("rib_depth", Bounds(0.03, 2, "m", "their depth below the vault; default 0.2 m"))
]
RibKinds = Annotated[
    str,
    typer.Option("--ribs", help="Where ribs run, of diagonal, wall, ridge; with commas between them.", metavar="KINDS"),
]


def command() -> Any:
    """The command for the program."""
    return single(export, "export")


def export(
    model: Annotated[Path, typer.Argument(help="The model.json of a result, as it is or edited.")],
    out: Annotated[Path, typer.Option("--out", "-o", help=f"File to write, by its suffix: {', '.join(SUFFIXES)}.")],
    thickness: Thickness = None,
    as_built: AsBuilt = "both",
    rib_width: RibWidth = None,
    rib_depth: RibDepth = Ribs.depth,
    ribs: RibKinds = EVERY_KIND,
) -> None:
    """Write a fitted model again: STEP, IFC, GLB, the plan (dxf), the report (html, json), or the world file of CAD.

    Parameters, poses and thickness may have been edited by hand in model.json; the deviations stay those of the fit.
    """
    check_file(out, SUFFIXES, inputs=[model])
    from segmentation.io.whole import replacing
    from vaultcad.errors import ModelFileError
    from vaultcad.export.buildable import buildable
    from vaultcad.model_file import read_model

    if not model.is_file():
        raise ModelFileError(f"{model}: no such file; give the model.json that a fit left")
    told = replace(read_model(model), drawn=as_built)
    if thickness is not None:
        told = replace(told, thickness=thickness, vaults=tuple(replace(v, thickness=thickness) for v in told.vaults))
    if rib_width is not None:
        with refusing():
            section = Ribs(rib_width, rib_depth, tuple(ribs.split(",")))
        told = replace(told, vaults=tuple(replace(v, ribs=section) for v in told.vaults))
    drawn = buildable(told)
    with replacing(out) as beside:
        # The report tells what was fitted; what is drawn has to be built.
        _writer(out)(replace(told, notes=drawn.notes) if out.suffix.lower() == ".json" else drawn, beside)
    show_notes(drawn.notes)


def _writer(out: Path) -> Callable[[Model, Path], None]:
    from vaultcad.export.bundle import WRITERS

    name = {".stp": "model.step", ".dxf": "plan.dxf", ".html": "report.html", ".json": "report.json"}
    suffix = out.suffix.lower()
    return WRITERS[name.get(suffix, f"model{suffix}")]

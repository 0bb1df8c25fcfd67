"""`vaultcad drawings`: sheets to scale of a model that a fit left."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

if TYPE_CHECKING:
    from vaultcad.sections.section import Section

from vaultcad.cli.options import Force, Vaults, single
from vaultcad.cli.outputs import check_result, show_kept

Paper = Literal["A4", "A3", "A2", "A1", "A0"]


def command() -> Any:
    """The command for the program."""
    return single(drawings, "drawings")


def drawings(
    model: Annotated[Path, typer.Argument(help="The folder of a result, or its model.json alone.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the drawings; earlier ones are replaced.")],
    scale: Annotated[
        int | None, typer.Option(metavar="N", min=1, help="One to how much, as 50; by default what fits on the paper.")
    ] = None,
    paper: Annotated[Paper | None, typer.Option(help="The paper; by default A3, or larger where it has to be.")] = None,
    vault: Vaults = None,
    force: Force = False,
) -> None:
    """Draw a fitted model to scale: sections, plan, dimensions, centres of arches, as DXF, PDF and SVG.

    A sheet a vault, and one of the whole building. With the folder, sections have the scan's line and its arches, too.
    """
    from vaultcad.cli.reading import show_notes
    from vaultcad.drawings.bundle import CAD, PAGES, sheets, svg_name, write_drawings
    from vaultcad.drawings.sheet import Wish
    from vaultcad.errors import ModelFileError
    from vaultcad.export.buildable import buildable
    from vaultcad.export.folder import replacing_folder
    from vaultcad.model_file import MODEL, read_model

    path = model / MODEL if model.is_dir() else model
    if not path.is_file():
        raise ModelFileError(f"{path}: no such file; give the model.json that a fit left, or its folder")
    check_result(out, [CAD, PAGES], inputs=[path.parent], force=force)
    drawn = buildable(read_model(path))
    cuts = _sections(model) if model.is_dir() else ()
    made = sheets(drawn, Wish(scale, paper), sorted({*(vault or ())}), cuts)
    names = [CAD, PAGES, *map(svg_name, made)]
    check_result(out, names, inputs=[path.parent], force=force)
    with replacing_folder(out, force=force) as place:
        write_drawings(made, drawn.place, place.part)
    show_kept(place.kept)
    show_notes(drawn.notes)
    for sheet in made:
        typer.echo(f"{sheet.title}, 1:{sheet.scale}")
    typer.echo(f"{out}: {', '.join(names)}")


def _sections(folder: Path) -> Sequence[Section]:
    """What the points of a result show, if it has them."""
    from vaultcad.labelled_scan import SEGMENTS, read_labelled_scan
    from vaultcad.sections.cuts import sections

    return sections(read_labelled_scan(folder)) if (folder / SEGMENTS).is_file() else ()

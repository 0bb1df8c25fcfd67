"""`vaultcad sections`: cuts through a fitted scan and its model."""

from __future__ import annotations

from functools import partial
from math import isfinite, radians
from pathlib import Path
from typing import Annotated, Any

import typer

from vaultcad.cli.errors import InputError, refusing
from vaultcad.cli.options import Bounds, Force, InSpace, Vault, number_info, single
from vaultcad.cli.outputs import check_file, check_result, show_kept

SUFFIXES = (".json", ".dxf")
PLANE = "X,Y,AZIMUTH"


def command() -> Any:
    """The command for the program."""
    return single(sections, "sections")


def sections(
    result: Annotated[Path, typer.Argument(help="The folder of a result, which has model.json and segments.laz.")],
    out: Annotated[
        Path, typer.Option("--out", "-o", help="Folder for all files, or one file: sections.json, sections.dxf.")
    ],
    vault: Vault = None,
    plane: Annotated[
        list[str] | None,
        typer.Option(
            metavar=PLANE,
            help="An upright plane through a place of the scan [m], its direction from x counterclockwise [°], in place"
            " of those that each vault's genesis asks for; may be repeated.",
        ),
    ] = None,
    every: Annotated[
        float | None,
        number_info("every", Bounds(0.05, 50, "m", "between planes across each vault along its axis, likewise")),
    ] = None,
    slab: Annotated[
        float, number_info("slab", Bounds(0.002, 0.5, "m", "to either side of a plane from which points are taken"))
    ] = 0.03,
    grid: Annotated[float, number_info("grid", Bounds(0.002, 0.5, "m", "cells along a line"))] = 0.02,
    coordinates: InSpace = "file",
    png: Annotated[bool, typer.Option("--png", help="Pictures of the sections besides the drawings.")] = False,
    force: Force = False,
) -> None:
    """Cut scan and model by the planes that each vault's genesis asks for, or by planes given.

    Each section has the stone's line and the model's, and its arches with span, rise, centres and radii: of which kind
    each may be, and by which rule it may have been set out. In sections.json, sections.dxf and a drawing a section.
    """
    from segmentation.io.whole import replacing
    from vaultcad.export.folder import replacing_folder
    from vaultcad.export.section_files import SECTIONS, WRITERS, Writer, drawn_names, write_drawings
    from vaultcad.export.section_json import write_section_json
    from vaultcad.labelled_scan import read_labelled_scan
    from vaultcad.sections.cuts import sections as cut

    writers: dict[str, Writer] = {**WRITERS, SECTIONS: partial(write_section_json, coordinates=coordinates)}
    planes = [_plane(text) for text in plane or ()]
    single_file = out.suffix.lower() in SUFFIXES
    if single_file:
        check_file(out, SUFFIXES, inputs=[result])
    else:
        check_result(out, [*WRITERS], inputs=[result], force=force)
    scan = read_labelled_scan(result)
    with refusing():
        found = cut(scan, vault=vault, planes=planes, every=every, slab=slab, grid=grid)
    if single_file:
        with replacing(out) as beside:
            writers[f"sections{out.suffix.lower()}"](scan.model, found, beside)
    else:
        names = [*WRITERS, *drawn_names(found, ".svg"), *(drawn_names(found, ".png") if png else ())]
        check_result(out, names, inputs=[result], force=force)
        with replacing_folder(out, force=force) as place:
            for name, write in writers.items():
                write(scan.model, found, place.part / name)
            write_drawings(found, place.part, pictures=png)
        show_kept(place.kept)
    for section in found:
        arches = ", ".join(f"{arch.kind} {arch.odds[arch.kind]:.0%}" for arch in section.arches)
        typer.echo(f"{section.id}  {section.points:,} points" + (f"  {arches}" if arches else ""))
    typer.echo(f"{out}: {len(found)} sections")


def _plane(text: str) -> tuple[float, float, float]:
    """A place [m] and an azimuth [rad]."""
    try:
        x, y, azimuth = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(f"--plane {text}: is no plane; give {PLANE}, as 2.5,-1,90") from None
    if not all(map(isfinite, (x, y, azimuth))):
        raise InputError(f"--plane {text}: is no plane; give {PLANE}, as 2.5,-1,90")
    return x, y, radians(azimuth)

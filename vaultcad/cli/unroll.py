"""`vaultcad unroll`: the intrados of a fitted scan laid flat, and lines drawn on it back in space."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vaultcad.cli.errors import InputError
from vaultcad.cli.options import Bounds, Force, InSpace, Vault, number_info, single
from vaultcad.cli.outputs import check_file, check_result, show_kept
from vaultcad.cli.status import status

if TYPE_CHECKING:
    from vaultcad.coordinates import Coordinates

STAGES = ("reading", "laying flat", "writing")
Pixel = Annotated[
    float | None, number_info("pixel", Bounds(0.0005, 0.5, "m", "side of a pixel; if left out, as points lie"))
]


def command() -> Any:
    """The command for the program."""
    return single(unroll, "unroll")


def unroll(
    result: Annotated[Path, typer.Argument(help="Folder that vaultcad fit -o wrote.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the maps, or with --back the file to write.")],
    vault: Vault = None,
    pixel: Pixel = None,
    what: Annotated[
        str, typer.Option(metavar="NAMES", help="What is mapped, with commas between.")
    ] = "deviation,height,intensity,colour",
    back: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Lines drawn on the sheet (dxf, geojson, csv) to bring back.")
    ] = None,
    coordinates: InSpace = "file",
    force: Force = False,
) -> None:
    """Lay the intrados flat: maps of deviation, height, intensity and colour, with contour lines and outlines.

    Barrels and planes keep all lengths, domes and webs come in gores. With --back, cracks or stains that were drawn on
    a sheet go back to where they are on the vault, in the coordinates of the scan.
    """
    if back is not None:
        _bring_back(result, back, out, vault, coordinates)
        return
    from vaultcad.export.folder import replacing_folder
    from vaultcad.labelled_scan import read_labelled_scan
    from vaultcad.unrolled.maps import UNROLLED, write_maps
    from vaultcad.unrolled.raster import WHAT

    chosen = tuple(name.strip() for name in what.split(","))
    if unknown := [name for name in chosen if name not in WHAT]:
        raise InputError(f"--what {unknown[0]}: is none of {', '.join(WHAT)}")
    check_result(out, [UNROLLED], inputs=[result], force=force)
    with status(STAGES) as bar:
        bar.stage("reading")
        scan = read_labelled_scan(result, labelled=True)
        bar.stage("laying flat")
        with replacing_folder(out, force=force) as place:
            written = write_maps(
                scan,
                place.part,
                () if vault is None else (vault,),
                pixel=pixel,
                what=chosen,
                progress=lambda name: bar.stage("laying flat", name),
            )
    show_kept(place.kept)
    _say(written.notes)
    for sheet in written.sheets:
        typer.echo(_told(sheet))
    typer.echo(f"unrolled to {out}")


def _told(sheet: Mapping[str, Any]) -> str:
    """How large a sheet is, and how true lengths are on it."""
    left, foot, right, top = sheet["bounds"]
    parts, more = len(sheet["parts"]), sheet["distorted_more"]
    worst = min(sheet["distortion"], sheet["distortion_limit"]) if more else sheet["distortion"]
    true = f"lengths within {100 * worst:.2f} %" + (f" but for {100 * more:.2f} % of the surface" if more else "")
    size = f"{right - left:.2f} x {top - foot:.2f} m in pixels of {1000 * sheet['pixel']:g} mm"
    return f"vault {sheet['vault']}: {sheet['family']}, {parts} {'part' if parts == 1 else 'parts'}, {size}; {true}"


def _bring_back(result: Path, drawn: Path, out: Path, vault: int | None, coordinates: Coordinates) -> None:
    from segmentation.io.whole import replacing
    from vaultcad.coordinates import says
    from vaultcad.labelled_scan import read_labelled_scan
    from vaultcad.unrolled.back import lift_lines
    from vaultcad.unrolled.drawn_lines import WRITERS, read_lines, write_lifted

    check_file(out, WRITERS, inputs=[drawn])
    lines = read_lines(drawn)
    with status(STAGES) as bar:
        bar.stage("reading")
        scan = read_labelled_scan(result, labelled=True)
        if vault is None and len(scan.model.vaults) > 1:
            raise InputError(f"{drawn}: say on whose sheet it was drawn, --vault 1 to {len(scan.model.vaults)}")
        bar.stage("laying flat")
        lifted, notes = lift_lines(scan, vault or 1, lines, coordinates)
        bar.stage("writing")
        with replacing(out) as beside:
            write_lifted(lifted, beside, says(scan.model, coordinates))
    _say(notes)
    typer.echo(f"{len(lifted)} lines of {len(lines)} drawn, coordinates {says(scan.model, coordinates)}: {out}")


def _say(notes: Iterable[str]) -> None:
    for note in notes:
        typer.echo(f"vaultcad: {note}", err=True)

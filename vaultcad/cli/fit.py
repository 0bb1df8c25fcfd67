"""`vaultcad fit`: from a scan to a model."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

if TYPE_CHECKING:
    from numpy.typing import NDArray


from vaultcad.cli.ahead import SOLIDS, importing
from vaultcad.cli.errors import InputError, refusing
from vaultcad.cli.further import Further
from vaultcad.cli.nurbs import NET, tell
from vaultcad.cli.options import AsBuilt, Bounds, Force, Seed, number_info, single
from vaultcad.cli.outputs import check_folder, show_kept
from vaultcad.cli.reading import Columns, KeepMarked, Origin, Unit, has_up, read_scan, show_notes
from vaultcad.cli.standing import Standing, axis_read, fit_standing
from vaultcad.cli.status import status

STAGES = ("reading", "thinning", "finding", "labelling", "measuring", "writing")
Thickness = Annotated[float, number_info("thickness", Bounds(0.01, 5, "m", "of masonry whose back is not in the scan"))]


def command() -> Any:
    """The command for the program."""
    return single(fit, "fit")


def fit(
    scan: Annotated[Path, typer.Argument(help="Scan: E57, LAS, LAZ, PLY, PCD, PTX, PTS, XYZ, CSV.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the result; an earlier result is replaced.")],
    family: Annotated[
        str, typer.Option(metavar="NAME", help="auto, or what the vault is, in any language: see vaultcad families.")
    ] = "auto",
    up: Standing = None,
    unit: Unit = None,
    columns: Columns = None,
    origin: Origin = None,
    keep_marked: KeepMarked = False,
    seed: Seed = 0,
    thickness: Thickness = 0.15,
    as_built: AsBuilt = "both",
    fix: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="Hold a size, as rise=2.5, or x, y, springing, yaw, or an arch, as profile=pointed; may be repeated.",
        ),
    ] = None,
    free: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Let a constraint go, as vaultcad families lists them; may be repeated."),
    ] = None,
    review: Annotated[bool, typer.Option("--review", help="Draw the fit to review.png, to be looked at.")] = False,
    correlations: Annotated[
        bool, typer.Option("--correlations", help="Tell the correlations of the fitted numbers in report.json.")
    ] = False,
    route: Annotated[
        Literal["family", "nurbs"],
        typer.Option(help="nurbs: free surfaces beside the family's, in nurbs.step, .ifc, .glb, .obj, .dxf and .json."),
    ] = "family",
    net: Annotated[float, number_info("net", NET)] = 0.25,
    sections: Annotated[
        bool, typer.Option("--sections", help="Cuts by the planes of each vault, too, in sections/: vaultcad sections.")
    ] = False,
    unrolled: Annotated[
        bool, typer.Option("--unrolled", help="Maps of the intrados laid flat, too, in unrolled/: vaultcad unroll.")
    ] = False,
    drawings: Annotated[
        bool,
        typer.Option("--drawings", help="Sheets to scale, too: drawings.dxf, drawings.pdf; see vaultcad drawings."),
    ] = False,
    coloured: Annotated[
        Literal["ply", "laz"] | None,
        typer.Option(help="The vaults' points in the colours of their deviations, too: deviation.ply or .laz."),
    ] = None,
    force: Force = False,
    json: Annotated[bool, typer.Option("--json", help="Print report.json instead of the summary.")] = False,
) -> None:
    """Fit the vaults in a scan of rooms: STEP, IFC, GLB, labelled points, report.

    Finds each vault, recognises its family, fits all parameters, labels every point, measures the deviation.
    """
    from vaultcad.cli.summary import show_summary
    from vaultcad.fit.demands import demand

    further = Further(net if route == "nurbs" else None, sections, unrolled, drawings, coloured)
    check_folder(out, inputs=[scan], review=review, force=force, more=further.names)
    families = _families(family)
    fixed, freed = _fixed(fix or []), tuple(free or [])
    with refusing():
        demand(families, fixed, freed)

    from segmentation.io import write_labelled

    with status(STAGES) as bar:
        bar.stage("reading")
        cloud = read_scan(
            scan,
            up=axis_read(up),
            unit=unit,
            columns=columns,
            origin=origin,
            keep_marked=keep_marked,
            progress=importing(SOLIDS, bar.share),
        )

        from vaultcad.export.bundle import write_all
        from vaultcad.pipeline import FitSettings

        settings = FitSettings(families, seed, thickness, fixed, freed)
        cloud, result = fit_standing(cloud, settings, up, upright=has_up(scan), stage=bar.stage)
        asked = further.asked(result, cloud, bar.stage)
        surfaces = asked.surfaces
        bar.stage("writing")
        labels = result.labels
        extra: dict[str, NDArray[Any]] = {
            "component": labels.component,
            "vault": labels.vault,
            "arch": labels.arch,
            "deviation": labels.deviation,
        }
        written = write_all(
            replace(result.model if surfaces is None else surfaces.measured, drawn=as_built),
            out,
            segments=lambda path: write_labelled(scan, path, cloud, extra),
            points=result.points,
            component=result.component,
            vault=result.vault,
            deviation=result.deviation,
            review=review,
            correlations=correlations,
            force=force,
            more=asked.more,
            sheets=asked.sheets,
            progress=lambda name: bar.stage("writing", name),
        )
    show_notes(written.model.notes)
    show_kept(written.kept)
    if json:
        typer.echo(written.report.rstrip())
    else:
        show_summary(result.model, out)
        if surfaces is not None:
            tell(surfaces)


def _families(name: str) -> Any:
    """The families to choose from."""
    from families import FAMILIES
    from families import family as named

    if name == "auto":
        return tuple(FAMILIES)
    with refusing():
        return (named(name),)


def _fixed(texts: list[str]) -> dict[str, float | str]:
    """Sizes and kinds of arches by name from texts like rise=2.5, profile=pointed; the yaw is given in degrees."""
    found: dict[str, float | str] = {}
    for text in texts:
        name, _, value = text.partition("=")
        name = name.strip().replace("-", "_")
        if "profile" in name and value:
            found[name] = value.strip()
            continue
        try:
            found[name] = float(value) * (pi / 180 if name == "yaw" else 1)
        except ValueError:
            raise InputError(
                f"--fix {text}: is no name with a number; write it like --fix rise=2.5, or --fix profile=pointed"
            ) from None
    return found

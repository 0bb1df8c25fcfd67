"""`vaultcad nurbs`: free surfaces through the points of a fitted scan."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vaultcad.cli.options import Bounds, Force, Vaults, number_info, single
from vaultcad.cli.outputs import check_result, show_kept

if TYPE_CHECKING:
    from vaultcad.nurbs.route import FreeRoute, FreeVault

NET = Bounds(0.02, 5, "m", "distance of the lines of the nets")
Net = Annotated[float, number_info("net", NET)]


def command() -> Any:
    """The command for the program."""
    return single(nurbs, "nurbs")


def nurbs(
    result: Annotated[Path, typer.Argument(help="Folder that vaultcad fit wrote, with model.json and segments.laz.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the files; an earlier result is replaced.")],
    vault: Vaults = None,
    net: Net = 0.25,
    force: Force = False,
) -> None:
    """Model vaults by free surfaces: nurbs.step, nurbs.ifc, nurbs.glb, nurbs.obj, nurbs.dxf, nurbs.json.

    B-spline surfaces run through the points of each component, without the shape of a family, and meet where they
    cross. The model of the fit gives what is a component's and the directions of its net.
    """
    from vaultcad.export.nurbs_files import NURBS_WRITERS, write_nurbs

    check_result(out, [*NURBS_WRITERS], inputs=[result], force=force)
    from vaultcad.labelled_scan import read_labelled_scan
    from vaultcad.nurbs.route import free_route

    route = free_route(read_labelled_scan(result, labelled=True), net, sorted({*(vault or ())}))
    kept = write_nurbs(route, out, force=force)
    tell(route)
    show_kept(kept)


def tell(route: FreeRoute) -> None:
    """One line a vault; what was left out, or is not as it should be, on standard error."""
    for why in route.left_out:
        typer.echo(f"vaultcad: {why}", err=True)
    for vault in route.vaults:
        if not (vault.sheet.valid and vault.sheet.watertight):
            fault = "leaves gaps" if vault.sheet.valid else "has a fault by OpenCASCADE's check"
            typer.echo(f"vaultcad: vault {vault.number}: the sheet of free surfaces {fault}", err=True)
        if vault.form.led:
            why = "where they would meet, edges cross; they were led through common edges instead"
            typer.echo(f"vaultcad: vault {vault.number}: {why}", err=True)
        for k in vault.form.unseen:
            name = vault.form.outline.regions[k].name
            typer.echo(f"vaultcad: vault {vault.number}: {name} has too few points; its edges alone shape it", err=True)
        typer.echo(
            f"vault {vault.number}, free surfaces: {_told(vault)}, edges to {1000 * vault.sheet.gap:.1f} mm; "
            f"the points they run through {1000 * vault.through.whole.mean:.1f} mm"
        )


def _told(vault: FreeVault) -> str:
    """How far stone is from them that had no part in them."""
    if vault.withheld is None:
        return "too few points to withhold some, by which to tell how far they are off"
    d = vault.withheld.whole
    return f"{1000 * d.mean:.1f} mm off withheld points on the mean, 95 % within {1000 * d.p95:.1f} mm"

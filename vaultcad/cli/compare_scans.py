"""`vaultcad compare-scans`: what has changed between two scans of one vault."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from vaultcad.cli.options import Bounds, Force, Seed, number_info, single
from vaultcad.cli.outputs import check_result, show_kept
from vaultcad.cli.reading import KeepMarked, Unit, read_scan, show_notes
from vaultcad.cli.status import status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vaultcad.model import Model

STAGES = ("reading", "fitting", "comparing", "writing")
DEFAULT_ERROR = 0.002  # m
Error = Annotated[
    float,
    number_info(
        "registration-error",
        Bounds(0, inf, "m", "standard deviation along each axis of a registration that is --registered"),
    ),
]


class _Read(NamedTuple):
    """One of the scans: points (n, 3) [m] local to an origin (3,), and its model where there is one."""

    xyz: NDArray[Any]
    origin: NDArray[Any]
    model: Model | None
    cloud: Any


def command() -> Any:
    """The command for the program."""
    return single(compare_scans, "compare-scans")


def compare_scans(
    before: Annotated[Path, typer.Argument(help="First scan, or the folder of its fit.")],
    after: Annotated[Path, typer.Argument(help="Second scan of the same vaults, or the folder of its fit.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the result; an earlier result is replaced.")],
    registered: Annotated[
        bool,
        typer.Option("--registered", help="Both are in one system already; else they are registered on what stays."),
    ] = False,
    registration_error: Error = DEFAULT_ERROR,
    unit: Unit = None,
    keep_marked: KeepMarked = False,
    seed: Seed = 0,
    force: Force = False,
) -> None:
    """Say what has changed between two scans of one vault: figures with limits, a map, a coloured cloud.

    The second scan is registered on floor and lower walls of the first. A scan that is no folder of a fit is fitted.
    """
    from vaultcad.change.two_dates import compare_scans as compared
    from vaultcad.change.words import in_words
    from vaultcad.export.change_files import NAMES, write_change

    check_result(out, NAMES, inputs=[before, after], force=force)
    with status(STAGES) as bar:
        bar.stage("reading")
        first, second = (_read(path, unit=unit, keep_marked=keep_marked) for path in (before, after))
        bar.stage("fitting")
        model = _fitted(first, seed)
        bar.stage("comparing")
        change = compared(
            model,
            first.xyz,
            second.xyz,
            registered=registration_error if registered else None,
            shift=second.origin - first.origin,
            poses=lambda: [fitted.pose for fitted in _fitted(second, seed).vaults],
        )
        bar.stage("writing")
        place = write_change(change, out, after=after.name, force=force)
    show_notes(model.notes)
    show_kept(place.kept)
    for line in in_words(change):
        typer.echo(line)
    typer.echo(f"{out}: {', '.join(sorted(NAMES))}")


def _read(path: Path, *, unit: str | None, keep_marked: bool) -> _Read:
    """A scan, or what a fit left of one."""
    if path.is_dir():
        from vaultcad.labelled_scan import read_labelled_scan

        labelled = read_labelled_scan(path)
        return _Read(labelled.xyz, labelled.model.origin, labelled.model, None)
    cloud = read_scan(
        path, up="z", unit=unit, columns=None, origin=None, keep_marked=keep_marked, progress=lambda done: None
    )
    return _Read(cloud.xyz, cloud.origin, None, cloud)


def _fitted(scan: _Read, seed: int) -> Model:
    """The model of a scan; one that has none is fitted."""
    if scan.model is not None:
        return scan.model
    from vaultcad.pipeline import FitSettings, fit_scan

    model: Model = fit_scan(scan.cloud, FitSettings(seed=seed)).model
    return model

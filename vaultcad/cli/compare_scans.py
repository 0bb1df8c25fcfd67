"""`vaultcad compare-scans`: what has changed between two scans of one vault."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from vaultcad.cli.errors import InputError
from vaultcad.cli.options import Bounds, Force, Seed, number_info, single
from vaultcad.cli.outputs import check_result, show_kept
from vaultcad.cli.reading import Columns, KeepMarked, Origin, Unit, has_up, is_text, read_scan, show_notes
from vaultcad.cli.standing import AxisOrAuto, Standing, axis_read, fit_standing
from vaultcad.cli.status import status

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from segmentation.cloud import Cloud, Up
    from vaultcad.model import Model
    from vaultcad.pose import Pose

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
    """One of the scans: points (n, 3) [m] local to an origin (3,), and its model, or its cloud where it has none."""

    xyz: NDArray[Any]
    origin: NDArray[Any]
    model: Model | None
    cloud: Cloud | None
    upright: bool  # whether its format says which axis is up

    def standing(self, up: Up) -> _Read:
        """With that axis of its file up, where that says nothing of it; a scan that was read with z up."""
        if self.cloud is None or self.upright or up == "z":
            return self
        from segmentation.cloud import stood_up

        cloud = stood_up(self.cloud, up)
        return self._replace(xyz=cloud.xyz, origin=cloud.origin, cloud=cloud)

    def fitted(self, seed: int, up: AxisOrAuto) -> _Read:
        """With a model; a scan that has none is fitted, and stands as it was found to."""
        if self.cloud is None:
            return self
        from vaultcad.pipeline import FitSettings

        cloud, result = fit_standing(self.cloud, FitSettings(seed=seed), up, upright=self.upright)
        return _Read(cloud.xyz, cloud.origin, result.model, None, self.upright)


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
    up: Standing = None,
    unit: Unit = None,
    columns: Columns = None,
    origin: Origin = None,
    keep_marked: KeepMarked = False,
    seed: Seed = 0,
    force: Force = False,
) -> None:
    """Say what has changed between two scans of one vault: figures with limits, a map, a coloured cloud.

    The second scan is registered on floor and lower walls of the first. A scan that is no folder of a fit is fitted.
    How files are to be read holds for both; the second stands as the first does unless its format says otherwise.
    """
    from vaultcad.change.two_dates import compare_scans as compared
    from vaultcad.change.words import in_words
    from vaultcad.export.change_files import NAMES, write_change

    check_result(out, NAMES, inputs=[before, after], force=force)
    said = {"--up": up, "--unit": unit, "--columns": columns, "--origin": origin, "--keep-marked": keep_marked or None}
    scans = [path for path in (before, after) if not path.is_dir()]
    if not scans and (told := [name for name, value in said.items() if value is not None]):
        raise InputError(f"{told[0]}: says how a scan is read, and both are folders of fits; leave it out")
    texts = [path for path in scans if is_text(path)] or scans  # of a text and another file, the columns are the text's

    with status(STAGES) as bar:
        bar.stage("reading")
        first, second = (
            _read(
                path,
                up=axis_read(up),
                unit=unit,
                columns=columns if path in texts else None,
                origin=origin,
                keep_marked=keep_marked,
            )
            for path in (before, after)
        )
        bar.stage("fitting")
        first = first.fitted(seed, up)
        model = first.model
        assert model is not None
        if up in (None, "auto"):
            second = second.standing(model.settings.get("up", "z"))

        def poses() -> Sequence[Pose]:
            other = second.fitted(seed, "z").model
            return [fitted.pose for fitted in other.vaults] if other is not None else ()

        bar.stage("comparing")
        change = compared(
            model,
            first.xyz,
            second.xyz,
            registered=registration_error if registered else None,
            shift=second.origin - first.origin,
            poses=poses,
        )
        bar.stage("writing")
        place = write_change(change, out, after=after.name, force=force)
    show_notes(model.notes)
    show_kept(place.kept)
    for line in in_words(change):
        typer.echo(line)
    typer.echo(f"{out}: {', '.join(sorted(NAMES))}")


def _read(
    path: Path,
    *,
    up: Up,
    unit: str | None,
    columns: str | None,
    origin: tuple[float, float, float] | None,
    keep_marked: bool,
) -> _Read:
    """A scan, or what a fit left of one."""
    if path.is_dir():
        from vaultcad.labelled_scan import read_labelled_scan

        labelled = read_labelled_scan(path)
        return _Read(labelled.xyz, labelled.model.origin, labelled.model, None, True)
    cloud = read_scan(
        path,
        up=up,
        unit=unit,
        columns=columns,
        origin=origin,
        keep_marked=keep_marked,
        progress=lambda done: None,
    )
    return _Read(cloud.xyz, cloud.origin, None, cloud, has_up(path))

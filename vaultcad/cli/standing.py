"""A scan's fit with the axis up that --up tells, or on which vaults are found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from vaultcad.cli.options import Axis
from vaultcad.cli.reading import doubts
from vaultcad.errors import NoVaultError

if TYPE_CHECKING:
    from segmentation.cloud import Cloud, Up
    from vaultcad.pipeline import FitSettings, Result

AxisOrAuto = Literal[Axis, "auto"] | None
Standing = Annotated[
    AxisOrAuto,
    typer.Option(
        "--up",
        help="The axis that is up in the scan; auto tries all, and takes longer. By default z; where the format"
        " tells of none and nothing stands with z up, y and -y are tried.",
    ),
]


def axis_read(up: AxisOrAuto) -> Up:
    """The axis with which up a scan is read, before others are tried."""
    return "z" if up is None or up == "auto" else up


def fit_standing(
    cloud: Cloud,
    settings: FitSettings,
    up: AxisOrAuto,
    *,
    upright: bool,
    stage: Callable[[str], None] = lambda name: None,
) -> tuple[Cloud, Result]:
    """The cloud as it stands, and its fit.

    upright: whether its format says which axis is up.

    Raises:
        NoVaultError: nothing stands so; says what was assumed of the scan, too.
    """
    import numpy as np

    from vaultcad.find.upright import stand_up
    from vaultcad.pipeline import fit_scan

    try:
        if up == "auto":
            stage("standing up")
            cloud = stand_up(cloud, np.random.default_rng(settings.seed), families=settings.families)
        return cloud, fit_scan(cloud, settings, progress=stage)
    except NoVaultError as error:
        if up is not None or upright:
            raise NoVaultError("; ".join([str(error), *doubts(cloud.notes)])) from error
        stage("standing up")
        cloud = _stood_otherwise(cloud, settings, error)
        return cloud, fit_scan(cloud, settings, progress=stage)


def _stood_otherwise(cloud: Cloud, settings: FitSettings, refusal: NoVaultError) -> Cloud:
    """A scan in which nothing stands with z up, with another axis up, which is told.

    Raises:
        NoVaultError: nothing stands so either; says what was wrong with z up.
    """
    import numpy as np

    from segmentation.notes import Note
    from vaultcad.find.upright import PHONES, stand_up

    try:
        stood: Cloud = stand_up(cloud, np.random.default_rng(settings.seed), families=settings.families, axes=PHONES)
    except NoVaultError:
        raise NoVaultError("; ".join([str(refusal), *doubts(cloud.notes)])) from refusal
    text = f"up: {stood.up} is taken for up, for nothing stands with z up; --up says otherwise"
    return replace(stood, notes=(*stood.notes, Note("up-assumed", text)))

"""`vaultcad ideal`: points of an ideal vault."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from families import Vault
from vaultcad.cli.errors import InputError
from vaultcad.cli.family import FamilyGroup, vault_of
from vaultcad.cli.options import Bounds, Seed, number_info
from vaultcad.cli.outputs import check_file

POINTS = 1_000_000
Points = Annotated[
    int | None,
    number_info("points", Bounds(1, 1e9, "1", f"number of points; {POINTS:,} if no spacing is given"), integer=True),
]
Spacing = Annotated[float | None, number_info("spacing", Bounds(1e-4, 10, "m", "distance of the points instead"))]


def command() -> Any:
    """The command for the program."""
    return FamilyGroup("ideal", "Points of an ideal vault, with normals and component labels.", ideal)


def ideal(
    cls: type[Vault],
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write: .ply, .las, .laz, .e57, .xyz or .txt.")],
    declared: Mapping[str, Any],
    points: Points = None,
    spacing: Spacing = None,
    seed: Seed = 0,
) -> None:
    """Points of an ideal vault, evenly by area."""
    from segmentation.io.write import WRITERS

    check_file(out, WRITERS)
    if points is not None and spacing is not None:
        raise InputError(f"--points {points} and --spacing {spacing:g} exclude each other; leave one out")
    vault = vault_of(cls, declared)

    import numpy as np

    from families.void.sampling import sample, sample_spacing
    from segmentation.io.write import write_cloud

    rng = np.random.default_rng(seed)
    found = sample(vault, points or POINTS, rng) if spacing is None else sample_spacing(vault, spacing, rng)
    write_cloud(out, found.xyz, normals=found.normals, extra={"component": found.component})
    typer.echo(f"{len(found):,} points of {vault.called}: {out}")

"""`vaultcad segment`: the primitives of a scan."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Annotated, Any

import typer

from segmentation.ransac.presets import PRESETS
from segmentation.ransac.settings import RANGES, Settings
from vaultcad.cli.errors import InputError, refusing
from vaultcad.cli.options import Axis, Option, Seed, number, single, with_options
from vaultcad.cli.outputs import check_file
from vaultcad.cli.reading import Columns, KeepMarked, Unit, read_scan, show_notes
from vaultcad.cli.status import status
from vaultcad.cli.tables import show_table

STAGES = ("reading", "thinning", "search", "refinement", "labelling", "writing")
SIZES = {"radius": "radius", "angle": "half angle", "major": "radius of the ring", "minor": "radius of the tube"}


def command() -> Any:
    """The command for the program."""
    default = Settings()
    values = {name: getattr(default, name) for name in RANGES}
    options = [number(n, r, "by the data if left out" if values[n] is None else values[n]) for n, r in RANGES.items()]
    kinds = f"kinds to look for, with commas between; default {','.join(default.primitives)}"
    return single(with_options(segment, [*options, Option("primitives", str, kinds, "KINDS")]), "segment")


def segment(
    scan: Annotated[Path, typer.Argument(help="Scan: E57, LAS, LAZ, PLY, PCD, PTX, PTS, XYZ, CSV.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write; .laz and .las keep all that the scan has.")],
    declared: Mapping[str, Any],
    preset: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Parameters of the paper: groin-ideal, groin-real, and so for each family."),
    ] = None,
    up: Annotated[Axis, typer.Option(help="The axis that is up in the scan.")] = "z",
    unit: Unit = None,
    columns: Columns = None,
    keep_marked: KeepMarked = False,
    seed: Seed = 0,
) -> None:
    """Label the planes, spheres and cylinders of a scan; cones and tori too, if asked for.

    Every point is written with the extra dimension `component`, 0 for none. Parameters are those of Schnabel, Wahl
    and Klein (2007); what is not given is chosen by the cloud's own spacing and noise.
    """
    from segmentation.io.write import WRITERS

    check_file(out, WRITERS, inputs=[scan])
    settings = settings_of(preset, declared)

    import numpy as np

    from segmentation.io import write_labelled
    from segmentation.io.labelled import spread_all
    from segmentation.io.write import write
    from segmentation.ransac.detect import detect

    with status(STAGES) as bar:
        bar.stage("reading")
        cloud = read_scan(
            scan, up=up, unit=unit, columns=columns, origin=None, keep_marked=keep_marked, progress=bar.share
        )
        found = detect(
            cloud.xyz,
            cloud.normals,
            settings,
            np.random.default_rng(seed),
            lambda stage, shapes: bar.stage(stage, f"({shapes} found)" if shapes else ""),
        )
        bar.stage("writing")
        extra = {"component": found.labels}
        if out.suffix.lower() in (".las", ".laz"):
            write_labelled(scan, out, cloud, extra, progress=bar.share)
        else:
            write(out, cloud.whole(), spread_all(cloud, extra))
    show_notes([*cloud.notes, *found.notes])
    rows = [
        (
            str(s.id),
            s.primitive.name,
            _sizes(s.primitive),
            f"{s.count:,}",
            f"{s.count / len(cloud):.1%}",
            f"{1000 * s.rms:.1f}",
        )
        for s in found.shapes
    ]
    show_table(("id", "primitive", "size", "points", "share", "rms, mm"), rows, numbers=[0, 3, 4, 5])
    rest = int((found.labels == 0).sum())
    typer.echo(
        f"{len(found)} components, {rest:,} of {len(cloud):,} points in none, epsilon {found.epsilon:.4f} m: {out}"
    )


def settings_of(preset: str | None, declared: Mapping[str, Any]) -> Settings:
    """The settings of a preset, or the automatic ones, with the options that were given.

    Raises:
        InputError: an unknown preset or kind, or limits that exclude each other.
    """
    if preset is not None and preset not in PRESETS:
        raise InputError(f"--preset {preset}: unknown; there are {', '.join(PRESETS)}")
    base = Settings() if preset is None else PRESETS[preset]
    given = {field.name: declared[field.name] for field in fields(Settings) if field.name in declared}
    if "primitives" in given:
        given["primitives"] = tuple(kind.strip() for kind in given["primitives"].split(","))
    with refusing():
        return replace(base, **given)


def _sizes(primitive: Any) -> str:
    from math import degrees

    shown = {"angle": lambda v: f"{degrees(v):.1f}°"}
    have = [(text, getattr(primitive, name), name) for name, text in SIZES.items() if hasattr(primitive, name)]
    return ", ".join(f"{text} {shown.get(name, lambda v: f'{v:.3f} m')(value)}" for text, value, name in have)

"""`vaultcad compare`: labels against a truth."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from vaultcad.cli.errors import refusing
from vaultcad.cli.options import single

Format = Literal["table", "json", "csv"]


def command() -> Any:
    """The command for the program."""
    return single(compare, "compare")


def compare(
    labels: Annotated[Path, typer.Argument(help="Labelled cloud: .las, .laz, .ply or .npz with `component`.")],
    truth: Annotated[Path, typer.Argument(help="The same points with their true labels, in the same order.")],
    format: Annotated[Format, typer.Option(help="How to write the figures.")] = "table",
) -> None:
    """Judge the labels of a cloud by a truth: per component counts, their ratio, IoU, precision and recall.

    Components are matched one to one so that the sum of IoU is largest; their numbers need not agree.
    """
    from segmentation.comparison import compare as judge
    from segmentation.io.labels import read_labels

    found, true = read_labels(labels), read_labels(truth)
    with refusing():
        comparison = judge(found, true)
    typer.echo(getattr(comparison, format)().rstrip("\n"))

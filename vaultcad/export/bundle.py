"""Everything that a fit leaves behind, written all or nothing."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from segmentation.io.whole import writing
from vaultcad.errors import ExportError
from vaultcad.export.buildable import buildable
from vaultcad.export.glb import write_glb
from vaultcad.export.ifc import write_ifc
from vaultcad.export.report_html import write_report_html
from vaultcad.export.report_json import SCHEMA, write_report_json
from vaultcad.export.review import write_review
from vaultcad.export.step import write_step
from vaultcad.export.world import write_world
from vaultcad.model import Model

REPORT = "report.json"
SEGMENTS = "segments.laz"
PAGE = "report.html"
REVIEW = "review.png"
WRITERS: dict[str, Callable[[Model, Path], None]] = {
    "model.step": write_step,
    "model.ifc": write_ifc,
    "model.glb": write_glb,
    "model.wld": write_world,
    PAGE: write_report_html,
    REPORT: write_report_json,
}


def write_all(
    model: Model,
    out: Path,
    *,
    segments: Callable[[Path], None],
    points: NDArray[np.floating] | None = None,
    component: NDArray[np.integer] | None = None,
    deviation: NDArray[np.floating] | None = None,
    vault: NDArray[np.integer] | None = None,
    review: bool = False,
    correlations: bool = False,
    progress: Callable[[str], None] = lambda name: None,
) -> Model:
    """Write all files of a model into the folder `out`, which appears only when they are complete; the model as drawn.

    Args:
        model: what was found.
        out: the folder; what it holds of an earlier result is replaced, anything else in it stays.
        segments: writes the labelled scan to the path it is given (segments.laz).
        points: thinned points (n, 3) of the scan for the report's drawings; with their component, deviation and vault
            as `write_report_html` takes them.
        component: see points.
        deviation: see points.
        vault: see points.
        review: whether to draw review.png too, as `write_review` does; it needs points, component and deviation.
        correlations: whether report.json holds those of the fitted numbers.
        progress: is told each file's name before it is written.

    Raises:
        ValueError: a review without the points that it shows.
        ExportError: `out` is something else than a new or empty folder or an earlier result, or cannot be written.
        WriteError: the disk is full, or a file cannot be written for another reason of the system's.
    """
    writers = dict(WRITERS)
    writers[PAGE] = partial(write_report_html, points=points, component=component, deviation=deviation, vault=vault)
    writers[REPORT] = partial(write_report_json, correlations=correlations)
    if review:
        if points is None or component is None or deviation is None:
            raise ValueError("a review shows points; give points, component and deviation, or leave review out")
        writers[REVIEW] = partial(write_review, points=points, component=component, deviation=deviation, vault=vault)
    check_target(out)
    with _beside(out) as part, ThreadPoolExecutor(1) as beside:
        # Most of its time goes into packing, beside which the solids are made.
        labelled = beside.submit(segments, part / SEGMENTS)
        solids = buildable(model)
        if not any(fitted.solid for fitted in solids.vaults):
            del writers["model.step"]
        for name, write in writers.items():
            progress(name)
            with writing(out / name):
                # The report tells what was fitted; what is drawn has to be built.
                write(replace(model, notes=solids.notes) if name == REPORT else solids, part / name)
        progress(SEGMENTS)
        with writing(out / SEGMENTS):
            labelled.result()
        _into_place(part, out)
    return solids


def check_target(out: Path) -> None:
    """See that a result may be written to `out`, before the work that leads to it.

    Raises:
        ExportError: `out` is a file, or a folder that holds something and no earlier result; names it and the way out.
    """
    if not out.exists():
        return
    if not out.is_dir():
        raise ExportError(f"{out} is a file; name a folder for the result with -o")
    if any(out.iterdir()) and not _is_result(out):
        raise ExportError(f"{out} holds other files and no earlier result; name a new or empty folder with -o")


def _is_result(out: Path) -> bool:
    try:
        told = json.loads((out / REPORT).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(told, dict) and told.get("schema") == SCHEMA


@contextmanager
def _beside(out: Path) -> Iterator[Path]:
    """A folder next to `out` that is gone in the end, with the folders above it that had to be made, if it fails."""
    made = [folder for folder in out.absolute().parents if not folder.exists()]
    part = out.absolute().with_name(f".{out.absolute().name}.{os.getpid()}.part")
    try:
        try:
            part.mkdir(parents=True)
        except OSError as error:
            raise ExportError(f"{out} cannot be made ({error.strerror}); name another folder with -o") from error
        yield part
    finally:
        shutil.rmtree(part, ignore_errors=True)
        for folder in made:
            if folder.exists() and not any(folder.iterdir()):
                folder.rmdir()


def _into_place(part: Path, out: Path) -> None:
    """Move the whole folder, or into a folder that is there each file.

    The report goes away first and comes last: where there is one, the files beside it belong to it. Files of an earlier
    result that this one has not go with it.
    """
    if not out.exists():
        part.rename(out)
        return
    for name in (REPORT, *({REVIEW, *WRITERS} - {path.name for path in part.iterdir()})):
        (out / name).unlink(missing_ok=True)
    for path in sorted(part.iterdir(), key=lambda p: (p.name == REPORT, p.name)):
        path.replace(out / path.name)

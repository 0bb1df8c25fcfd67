"""Everything that a fit leaves behind, written all or nothing."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from segmentation.io.whole import writing
from vaultcad.export.buildable import buildable
from vaultcad.export.dxf import write_dxf
from vaultcad.export.folder import check_target, replacing_folder
from vaultcad.export.glb import write_glb
from vaultcad.export.ifc import write_ifc
from vaultcad.export.marker import REPORT
from vaultcad.export.report_html import write_report_html
from vaultcad.export.report_json import write_report_json
from vaultcad.export.review import write_review
from vaultcad.export.step import write_step
from vaultcad.export.world import write_world
from vaultcad.labelled_scan import SEGMENTS
from vaultcad.model import Model
from vaultcad.model_file import MODEL, write_model
from vaultcad.one_thread import one_thread
from vaultcad.processes import beside

PAGE = "report.html"
REVIEW = "review.png"
MANY = 1_000_000  # points, whose packing holds the solids up for longer than a process takes to begin
SEVERAL = 4  # vaults, the drawings of which take longer than a process to begin
BODIES = ("model.step", "model.ifc", "model.glb")
WRITERS: dict[str, Callable[[Model, Path], None]] = {
    "model.step": write_step,
    "model.ifc": write_ifc,
    "model.glb": write_glb,
    "model.wld": write_world,
    "plan.dxf": write_dxf,
    MODEL: write_model,
    PAGE: write_report_html,
    REPORT: write_report_json,
}


class Written(NamedTuple):
    """What a result was written with: the model as drawn, the text of its report, and where an earlier one is kept."""

    model: Model
    report: str
    kept: Path | None


@one_thread
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
    force: bool = False,
    more: Mapping[str, Callable[[Path], None]] = MappingProxyType({}),
    sheets: Mapping[str, Callable[[Model, Path], None]] = MappingProxyType({}),
    progress: Callable[[str], None] = lambda name: None,
) -> Written:
    """Write all files of a model into the folder `out`, which appears, or changes, as one when they are complete.

    Args:
        model: what was found.
        out: the folder; an earlier result in it is replaced, anything else in it stays.
        segments: writes the labelled scan to the path it is given (segments.laz).
        points: thinned points (n, 3) of the scan for the report's drawings; with their component, deviation and vault
            as `write_report_html` takes them.
        component: see points.
        deviation: see points.
        vault: see points.
        review: whether to draw review.png too, as `write_review` does; it needs points, component and deviation.
        correlations: whether report.json holds those of the fitted numbers.
        force: whether to replace what a person has changed, or made under the name of one of the files; else the
            earlier result is kept under another name.
        more: writers of further files, or folders, by their names.
        sheets: writers of such as show the model as drawn, which they are given.
        progress: is told each file's name before it is written.

    Raises:
        ValueError: a review without the points that it shows.
        ExportError: `out` is no folder, no earlier result or cannot be replaced as a whole, or none can be made there.
        WriteError: the disk is full, or a file cannot be written for another reason of the system's.
    """
    writers = dict(WRITERS)
    writers[PAGE] = partial(write_report_html, points=points, component=component, deviation=deviation, vault=vault)
    writers[REPORT] = partial(write_report_json, correlations=correlations)
    if review:
        if points is None or component is None or deviation is None:
            raise ValueError("a review shows points; give points, component and deviation, or leave review out")
        writers[REVIEW] = partial(write_review, points=points, component=component, deviation=deviation, vault=vault)
    # What would be lost is kept: the work is done by now.
    check_target(out, [*writers, *more, *sheets, SEGMENTS], force=True)

    def bodies(tell: Callable[[str], None]) -> Model:
        tell("model.step")
        solids = buildable(model)
        if not any(fitted.solid for fitted in solids.vaults):
            del writers["model.step"]
        # These tell what was fitted; what is drawn has to be built, which whoever reads the model does again.
        told = {REPORT: replace(model, notes=solids.notes), MODEL: model}

        def write(names: Collection[str], tell: Callable[[str], None]) -> None:
            for name in names:
                tell(name)
                with writing(out / name):
                    writers[name](told.get(name, solids), place.part / name)

        drawings = [name for name in writers if name not in BODIES]
        with beside(partial(write, drawings), long=len(model.vaults) > SEVERAL) as drawn:
            write([name for name in writers if name in BODIES], tell)
            for name, write_sheets in sheets.items():
                tell(name)
                with writing(out / name):
                    write_sheets(solids, place.part / name)
            drawn(tell)
        return solids

    # Most of the time goes into packing the scan, and into solids, for which a process is forked; in that the packer
    # would wait without end for its threads, which stay here.
    with (
        replacing_folder(out, force=force) as place,
        beside(bodies, long=model.points > MANY or bool(more)) as drawn,
        ThreadPoolExecutor(1) as packer,
    ):
        labelled = packer.submit(segments, place.part / SEGMENTS)
        for name, write_further in more.items():
            progress(name)
            with writing(out / name):
                write_further(place.part / name)
        solids = drawn(progress)
        progress(SEGMENTS)
        with writing(out / SEGMENTS):
            labelled.result()
        report = (place.part / REPORT).read_text(encoding="utf-8")
    return Written(solids, report, place.kept)

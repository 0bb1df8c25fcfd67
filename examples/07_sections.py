"""Plan, two sections and a map of deviations of a fitted scan. Writes model/ (all that a fit leaves) and sections.png.

Usage: python examples/07_sections.py [FOLDER [SCAN]]
"""

import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")
from matplotlib import pyplot as plt
from numpy.typing import NDArray

from families import Groin
from families.drawing.png import paint
from families.drawing.section import PLANES
from segmentation import read, write_labelled
from vaultcad.export.bundle import write_all
from vaultcad.export.drawing import deviations, plan, section
from vaultcad.export.seen import seen
from vaultcad.pipeline import FitSettings, fit_scan

ROOM = Path(__file__).with_name("room.laz")


def main(out: Path, scan: Path = ROOM) -> None:
    cloud = read(scan)
    result = fit_scan(cloud, FitSettings(families=(Groin,)), progress=print)
    labels = result.labels
    extra: dict[str, NDArray[Any]] = dict(vars(labels))  # component, vault and deviation of each point
    write_all(result.model, out / "model", segments=lambda path: write_labelled(scan, path, cloud, extra))

    vault = seen(result.model, result.points, result.component, result.deviation)[0]
    drawings = (plan(vault, scanned=True), deviations(vault), *(section(vault, plane) for plane in PLANES))
    figure, panels = plt.subplots(2, 2, figsize=(12, 11), layout="constrained")
    for axes, drawing in zip(panels.flat, drawings, strict=True):
        paint(axes, drawing)
    figure.savefig(out / "sections.png", dpi=110)
    print(out / "sections.png")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder, *map(Path, sys.argv[2:3]))

"""Plan, two sections and a map of deviations of a fitted scan. Writes model/ (all that a fit leaves) and sections.png.

Usage: python examples/07_sections.py [FOLDER [SCAN]]
"""

import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from numpy.typing import NDArray

from families import Groin
from segmentation import read, write_labelled
from vaultcad.export.bundle import write_all
from vaultcad.export.drawing import cut
from vaultcad.export.geometry import Body, bodies
from vaultcad.export.palette import colour
from vaultcad.pipeline import FitSettings, fit_scan

ROOM = Path(__file__).with_name("room.laz")
SLICE = 0.02  # m, to either side of a section


def main(out: Path, scan: Path = ROOM) -> None:
    cloud = read(scan)
    result = fit_scan(cloud, FitSettings(families=(Groin,)), progress=print)
    labels = result.labels
    extra: dict[str, NDArray[Any]] = dict(vars(labels))  # component, vault and deviation of each point
    write_all(result.model, out / "model", segments=lambda path: write_labelled(scan, path, cloud, extra))

    fitted = result.model.vaults[0]
    frame = fitted.pose.frame()
    local = cloud.xyz @ frame[:, :3].T + frame[:, 3]
    on, stone = labels.component > 0, bodies(fitted.vault, result.model.thickness)

    figure, ((plan, deviations), (across_x, across_y)) = plt.subplots(2, 2, figsize=(11, 10), layout="constrained")
    for k, name in enumerate(fitted.vault.components, 1):
        mine = local[labels.component == k][::5]
        plan.scatter(mine[:, 0], mine[:, 1], s=0.5, color=colour(k).hex, label=name)
    plan.set_title("Components")
    plan.legend(markerscale=15, loc="upper right")

    shown = deviations.scatter(
        *local[on, :2].T, s=0.5, c=1000 * labels.deviation[on], cmap="RdBu", vmin=-20, vmax=20, rasterized=True
    )
    figure.colorbar(shown, label="mm, above zero higher than the ideal vault")
    deviations.set_title(f"Deviation, rms {1000 * fitted.deviation.rms:.1f} mm")

    # A section shows the arches best a little inside the walls, not through the level crowns.
    draw_section(across_x, stone, local, 1, -0.8 * fitted.vault.plan.half_y)
    draw_section(across_y, stone, local, 0, 0.8 * fitted.vault.plan.half_x)
    for axes in (plan, deviations, across_x, across_y):
        axes.set_aspect("equal")
    figure.savefig(out / "sections.png", dpi=110)
    print(out / "sections.png")


def draw_section(axes: Axes, stone: tuple[Body, ...], points: NDArray[np.floating], axis: int, at: float) -> None:
    """The masonry cut where a coordinate is `at` [m], over the points (n, 3) near the cut."""
    near = points[np.abs(points[:, axis] - at) < SLICE][:, [1 - axis, 2]]
    axes.scatter(near[:, 0], near[:, 1], s=0.3, color="0.45")
    for body in stone:
        for outline in cut(body, axis, at):
            axes.fill(*outline[:, [1 - axis, 2]].T, facecolor=colour(body.id).hex, edgecolor="0.2", linewidth=0.6)
    axes.set_title(f"Section at {'xy'[axis]} = {at:.2f} m")


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
    folder.mkdir(parents=True, exist_ok=True)
    main(folder, *map(Path, sys.argv[2:3]))

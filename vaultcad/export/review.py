"""review.png: one picture from which a person sees whether a fit is right.

For each vault a plan with its components, a map of deviations, both sections through the crown with the scan's points,
and its sizes with their standard deviations. Several vaults of one scan first stand together in one plan, then one
below the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from families import family
from vaultcad.export.drawing import PLANES
from vaultcad.export.palette import colour
from vaultcad.export.report_json import in_shown_unit
from vaultcad.export.review_panels import INK, SOFT, Seen, bar, deviations, dots, plan, section
from vaultcad.model import Estimate, FittedVault, Model

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 110
WIDE, PANEL, FIGURES = 17.0, 5.8, 3.7  # [inch] the picture, a drawing, the column of figures
MARGIN, HEAD, GAP, LINE, OVERVIEW = 0.4, 1.3, 0.35, 0.22, 7.0  # [inch]
UNLIKELY = 0.001  # alternatives below that confidence go without saying
WARNING = "#b00020"
LOOK = {"font.size": 9, "axes.titlesize": 10, "hatch.linewidth": 0.5, "hatch.color": SOFT}


def write_review(
    model: Model,
    path: Path,
    points: NDArray[np.floating],
    component: NDArray[np.integer],
    deviation: NDArray[np.floating],
    vault: NDArray[np.integer] | None = None,
) -> None:
    """Write the picture as a PNG, the same bytes for the same model and points.

    Args:
        model: what was found.
        path: the file.
        points: (n, 3) thinned points of the scan in its local frame [m], walls and floor included.
        component: (n,) their components, 0 off the vault.
        deviation: (n,) their signed distances to the model [m], NaN off the vault.
        vault: (n,) number of the vault that each belongs to, 0 for none; without it all belong to the first.
    """
    from matplotlib import style
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    with style.context(["default", LOOK]):
        figure = draw_review(model, points, component, deviation, vault)
        FigureCanvasAgg(figure)
        figure.savefig(path, format="png", dpi=DPI, metadata={"Software": None})


def draw_review(
    model: Model,
    points: NDArray[np.floating],
    component: NDArray[np.integer],
    deviation: NDArray[np.floating],
    vault: NDArray[np.integer] | None = None,
) -> Figure:
    """The picture as matplotlib's figure; arguments as in `write_review`."""
    from matplotlib.figure import Figure

    xyz, owner = np.asarray(points, dtype=np.float64), np.ones(len(points)) if vault is None else vault
    found = []
    for k, fitted in enumerate(model.vaults, 1):
        frame = fitted.pose.frame()
        local, mine = xyz @ frame[:, :3].T + frame[:, 3], np.where(owner == k, component, 0)
        found.append(Seen(fitted, model.thickness_of(fitted), local, mine, np.asarray(deviation, dtype=np.float64)))
    several = len(found) > 1
    heights = [OVERVIEW * several, *(_height(seen) for seen in found)]
    figure = Figure(figsize=(WIDE, sum(heights)), facecolor="white")
    if several:
        _overview(ReviewSheet(figure, 0.0, OVERVIEW), model.scan.name, found)
    for k, seen in enumerate(found, 1):
        sheet = ReviewSheet(figure, sum(heights[:k]), heights[k])
        _title(sheet, seen.fitted, f"{k}  " if several else "", model.scan.name)
        _drawings(sheet, seen)
        _figures(sheet, seen)
    return figure


@dataclass(frozen=True)
class ReviewSheet:
    """A strip of the figure as wide as it is; places in it count from its upper left corner [inch]."""

    figure: Figure
    top: float
    tall: float

    def axes(self, left: float, top: float, wide: float, tall: float) -> Axes:
        """A panel."""
        width, height = self.figure.get_size_inches()
        return self.figure.add_axes((left / width, 1 - (self.top + top + tall) / height, wide / width, tall / height))

    def text(self, left: float, top: float, text: str, *, color: str = INK, size: float = 10, **look: Any) -> None:
        """A line of text, its foot at `top`."""
        width, height = self.figure.get_size_inches()
        self.figure.text(left / width, 1 - (self.top + top) / height, text, color=color, size=size, **look)


def _heights(seen: Seen) -> tuple[float, float]:
    """Of the panels of plan and sections [inch], at the scale that makes their squares as wide as a panel."""
    scale = PANEL / seen.side
    return scale * 2 * float(seen.half[1] + seen.around), scale * (seen.top + 2 * seen.around)


def _height(seen: Seen) -> float:
    """Of all that is drawn and told of a vault [inch]."""
    return HEAD + max(sum(_heights(seen)) + 2 * GAP, LINE * (len(_rows(seen.fitted)) + 2))


def _drawings(sheet: ReviewSheet, seen: Seen) -> None:
    upper, lower = _heights(seen)
    right, below = MARGIN + PANEL + GAP, HEAD + upper + GAP
    plan(sheet.axes(MARGIN, HEAD, PANEL, upper), seen)
    scale = sheet.axes(right + PANEL, HEAD + 0.1 * upper, 0.16, 0.8 * upper)
    deviations(sheet.axes(right, HEAD, PANEL, upper), scale, seen)
    for left, plane in zip((MARGIN, right), PLANES, strict=True):
        section(sheet.axes(left, below, PANEL, lower), seen, plane)


def _title(sheet: ReviewSheet, fitted: FittedVault, number: str, scan: str) -> None:
    sheet.text(MARGIN, 0.5, f"{number}{fitted.vault.title.capitalize()}", size=20, weight="bold")
    others = [f"{family(name).title} {score:.0%}" for name, score in fitted.alternatives[:3] if score >= UNLIKELY]
    arches = ", ".join(f"{name.replace('_', ' ')} {kind}" for name, kind in fitted.arches.items())
    line = f"confidence {fitted.confidence:.0%}" + (f" (or else {', '.join(others)})" if others else "")
    sheet.text(MARGIN, 0.78, "  ·  ".join(filter(None, (line, arches, scan))))
    if not fitted.converged:
        text = "The fit had not come to rest when it was stopped: take the figures with care."
        sheet.text(MARGIN, 1.02, text, color=WARNING, weight="bold")


def _figures(sheet: ReviewSheet, seen: Seen) -> None:
    """Sizes with their standard deviations, what the points say, and the components."""
    left = WIDE - FIGURES
    for k, (name, value, more, mark) in enumerate(_rows(seen.fitted)):
        y = HEAD + LINE * (k + 1)
        sheet.text(left - 0.2, y, "■" if mark else "", color=mark or INK)
        sheet.text(left, y, name)
        sheet.text(left + 2.15, y, value, ha="right")
        sheet.text(left + 2.2, y, more, color=SOFT)


def _rows(fitted: FittedVault) -> list[tuple[str, str, str, str]]:
    """Lines of name, value, what follows it, and the colour of its mark."""
    d, empty = fitted.deviation, ("", "", "", "")
    sizes = {name: e for name, e in fitted.parameters.items() if e.unit in {"m", "rad"}}
    rows = [(name, *_estimate(e), WARNING if e.flags else "") for name, e in sizes.items()]
    rows += [
        empty,
        ("deviation, rms", f"{1000 * d.rms:.1f} mm", "", ""),
        ("95 % below", f"{1000 * d.p95:.1f} mm", "", ""),
    ]
    if fitted.as_built is not None:
        rows.append(("as built, rms", f"{1000 * fitted.as_built.rms:.1f} mm", "", ""))
    rows += [("accuracy", d.loa, "", ""), ("surface seen", f"{fitted.coverage:.0%}", "", ""), empty]
    rows += [(c.name, f"{c.coverage:.0%}", "seen", colour(c.id).hex) for c in fitted.components]
    return [(name.replace("_", " "), value, more, mark) for name, value, more, mark in rows]


def _estimate(estimate: Estimate) -> tuple[str, str]:
    """A length or an angle, and how sure it is."""
    e = in_shown_unit(estimate)
    length = e.unit == "m"
    std = (f"± {1000 * e.std:.1f} mm" if length else f"± {e.std:.2f}°") if e.std else ""
    return f"{e.value:.3f} m" if length else f"{e.value:.2f}°", " ".join([std, *e.flags]).strip()


def _overview(sheet: ReviewSheet, scan: str, found: list[Seen]) -> None:
    """The plans of all vaults where they stand in the scan, in its local frame."""
    sheet.text(MARGIN, 0.5, f"{len(found)} vaults", size=20, weight="bold")
    sheet.text(MARGIN, 0.78, scan)
    axes = sheet.axes(MARGIN, HEAD - 0.3, WIDE - 2 * MARGIN, OVERVIEW - HEAD)
    for k, seen in enumerate(found, 1):
        out = seen.fitted.pose.placement()[:2]
        for points, shade in ((seen.walls, SOFT), (seen.points[seen.on], seen.shades)):
            dots(axes, points @ out[:, :3].T + out[:, 3], c=shade, s=1.0)
        for row in seen.edges():
            axes.plot(*(row @ out[:, :2].T + out[:, 3]).T, color=INK, linewidth=0.9)
        label = f"{k}  {seen.vault.title}\nrms {1000 * seen.fitted.deviation.rms:.0f} mm"
        box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "boxstyle": "round"}
        axes.text(float(out[0, 3]), float(out[1, 3]), label, ha="center", va="center", weight="bold", bbox=box)
    axes.set_aspect("equal")
    axes.set_axis_off()
    bar(axes, axes.get_xlim()[0], axes.get_ylim()[0], 1.0)

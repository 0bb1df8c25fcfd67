"""review.png: one picture from which a person sees whether a fit is right.

For each vault a plan with its components, a map of deviations, both sections through the crown with the scan's points,
and its sizes with their standard deviations. Several vaults of one scan first stand together in plans of the building,
by family and by deviation, then one below the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from families import family
from families.drawing.looks import INK, PAPER
from families.drawing.png import paint
from families.drawing.section import PLANES
from families.drawing.sheet import Drawing
from vaultcad.export.building_plan import building_plans
from vaultcad.export.drawing import deviations, plan, section
from vaultcad.export.palette import colour
from vaultcad.export.report_json import in_shown_unit
from vaultcad.export.seen import Seen, seen
from vaultcad.model import FittedVault, Model
from vaultcad.uncertain import Estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 110
WIDE, PANEL, FIGURES = 17.0, 5.8, 3.7  # [inch] the picture, a drawing, the column of figures
MARGIN, HEAD, GAP, LINE, OVERVIEW = 0.4, 1.1, 0.15, 0.22, 7.0  # [inch]
UNLIKELY = 0.001  # alternatives below that confidence go without saying
SOFT, WARNING = "#8a8a8a", "#b00020"
LOOK = {"font.size": 9, "axes.titlesize": 10}

Panels = tuple[Drawing, Drawing, Drawing, Drawing]


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

    found = seen(model, points, component, deviation, vault)
    several = len(found) > 1
    panels = [_drawings(one) for one in found]
    plans = list(building_plans(model, found)) if several else []
    heights = [HEAD * several + OVERVIEW * len(plans) / 2, *map(_height, found, panels)]
    figure = Figure(figsize=(WIDE, sum(heights)), facecolor=PAPER)
    if several:
        _overview(ReviewSheet(figure, 0.0, heights[0]), model, plans)
    for k, (one, drawings) in enumerate(zip(found, panels, strict=True), 1):
        sheet = ReviewSheet(figure, sum(heights[:k]), heights[k])
        _title(sheet, one.fitted, f"{k}  " if several else "", model.scan.name)
        _place(sheet, drawings)
        _figures(sheet, one.fitted)
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


def _drawings(one: Seen) -> Panels:
    """Plan, map of deviations, and both sections of a vault."""
    across_x, across_y = (section(one, plane) for plane in PLANES)
    return plan(one, scanned=True), deviations(one), across_x, across_y


def _rows_of_panels(drawings: Panels) -> tuple[float, float, float]:
    """The width [m] that all panels show, at one scale, and the heights [inch] of plans and of sections."""
    width = max(drawing.size[0] for drawing in drawings)
    heights = [PANEL / width * drawing.size[1] for drawing in drawings]
    return width, max(heights[:2]), max(heights[2:])


def _height(one: Seen, drawings: Panels) -> float:
    """Of all that is drawn and told of a vault [inch]."""
    _, *tall = _rows_of_panels(drawings)
    return HEAD + max(sum(tall) + 2 * GAP, LINE * (len(_rows(one.fitted)) + 2))


def _place(sheet: ReviewSheet, drawings: Panels) -> None:
    width, *tall = _rows_of_panels(drawings)
    for k, drawing in enumerate(drawings):
        row, column = divmod(k, 2)
        top = HEAD + row * (tall[0] + GAP)
        paint(sheet.axes(MARGIN + column * (PANEL + GAP), top, PANEL, PANEL / width * drawing.size[1]), drawing, width)


def _title(sheet: ReviewSheet, fitted: FittedVault, number: str, scan: str) -> None:
    sheet.text(MARGIN, 0.5, f"{number}{fitted.vault.title.capitalize()}", size=20, weight="bold")
    others = [f"{family(name).title} {score:.0%}" for name, score in fitted.alternatives[:3] if score >= UNLIKELY]
    arches = ", ".join(f"{name.replace('_', ' ')} {kind}" for name, kind in fitted.arches.items())
    line = f"confidence {fitted.confidence:.0%}" + (f" (or else {', '.join(others)})" if others else "")
    sheet.text(MARGIN, 0.78, "  ·  ".join(filter(None, (line, arches, scan))))
    warnings = [fitted.unlike] if fitted.doubt else []
    if not fitted.converged:
        warnings.append("The fit had not come to rest when it was stopped: take the figures with care.")
    if warnings:
        sheet.text(MARGIN, 1.02, " ".join(warnings), color=WARNING, weight="bold")


def _figures(sheet: ReviewSheet, fitted: FittedVault) -> None:
    """Sizes with their standard deviations, what the points say, and the components."""
    left = WIDE - FIGURES
    for k, (name, value, more, mark) in enumerate(_rows(fitted)):
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


def _overview(sheet: ReviewSheet, model: Model, plans: Sequence[Drawing]) -> None:
    """The plans of the building, those of a storey beside each other, in the scan's local frame."""
    arches = f", {len(model.arches)} arches" if model.arches else ""
    sheet.text(MARGIN, 0.5, f"{len(model.vaults)} vaults{arches}", size=20, weight="bold")
    sheet.text(MARGIN, 0.78, model.scan.name)
    wide = (WIDE - 2 * MARGIN - GAP) / 2
    for k, drawing in enumerate(plans):
        row, column = divmod(k, 2)
        left, top = MARGIN + column * (wide + GAP), HEAD + row * OVERVIEW
        paint(sheet.axes(left, top, wide, OVERVIEW - GAP), drawing)
